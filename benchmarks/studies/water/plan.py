"""Models of water, methods, steps and pressures of the runs."""

from dataclasses import dataclass, replace

from benchmarks.studies.liquids.plan import SPCE, WATER4
from benchmarks.studies.liquids.plan import Plan as Starts

#: 216 molecules each
MODELS = {liquid.key: liquid for liquid in (replace(WATER4, edge=6), SPCE)}
TEMPERATURE = 298.0
#: g/mL at this temperature and 1 atm, published: Abascal and Vega (2005); Berendsen et al. (1987), with Ewald sums
PUBLISHED = {"tip4p": 0.9979, "spce": 0.998}

OURS, SHAKE = "gear", "shake"
METHODS = {OURS: "`fix gear/quat`", SHAKE: "`fix shake` and `fix npt`"}


@dataclass(frozen=True)
class Series:
    """Samples of one model with one method, time step in fs and pressure in atm."""

    model: str
    method: str
    dt: float
    pressure: float = 1.0

    @property
    def name(self):
        """Name in file names."""
        return f"{self.model}_{self.method}_{self.dt:g}fs_{self.pressure:g}atm"

    @property
    def text(self):
        """In tables."""
        return f"{METHODS[self.method]}, {self.dt:g} fs"


#: pressures whose densities give the compressibility at 1 atm
APART = 500.0
COMPRESSED = tuple(Series("spce", OURS, 2.0, pressure) for pressure in (1.0 - APART, 1.0 + APART))
#: series for comparison: the long step, and the short step of another method with a small bias
LONG = {model: Series(model, OURS, 2.0) for model in MODELS}
SHORT = Series("tip4p", SHAKE, 0.5)
#: Series -> number of runs in each round
ROUND = {
    LONG["tip4p"]: 2,
    LONG["spce"]: 2,
    COMPRESSED[0]: 1,
    COMPRESSED[1]: 1,
    Series("tip4p", OURS, 3.0): 1,
    Series("tip4p", SHAKE, 2.0): 1,
    SHORT: 1,
}


@dataclass(frozen=True)
class Plan:
    """Durations in ps of a run: ``settle`` before samples, ``duration`` of ``blocks`` samples, ``every`` between rows.

    ``hours``: no further round begins after this time.  ``equilibration``: steps for a start.
    """

    hours: float = 1.0
    settle: float = 20.0
    duration: float = 100.0
    every: float = 0.024
    equilibration: int = 3000
    blocks: int = 5

    @property
    def lengths(self):
        """Variable of the deck -> picoseconds."""
        return {"settle": self.settle, "steps": self.duration}


QUICK = Plan(0.0, 0.1, 0.72, 0.024, 200)
