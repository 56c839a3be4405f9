"""Models of water, methods and steps of the runs."""

from dataclasses import dataclass, replace

from benchmarks.studies.liquids import SPCE, WATER4

#: 216 molecules each
MODELS = {liquid.key: liquid for liquid in (replace(WATER4, edge=6), SPCE)}
#: K; atm, of the series at constant pressure
TEMPERATURE, PRESSURE = 298.0, 1.0
#: g/mL at this temperature and 1 atm, published: Abascal and Vega (2005); Berendsen et al. (1987), with Ewald sums
PUBLISHED = {"tip4p": 0.9979, "spce": 0.998}

OURS, SHAKE, RIGID = "gear", "shake", "rigid"
METHODS = {OURS: "`fix gear/quat`", SHAKE: "`fix shake` and `fix npt`", RIGID: "`fix rigid/nvt/small`"}


#: ensembles: constant pressure, or the constant volume of the data file
NPT, NVT = "npt", "nvt"


@dataclass(frozen=True)
class Series:
    """Samples of one model with one method and time step in fs, in an ensemble."""

    model: str
    method: str
    dt: float
    ensemble: str = NPT

    @property
    def name(self):
        """Name in file names."""
        return f"{self.model}_{self.method}_{self.dt:g}fs_{self.ensemble}"

    @property
    def at_constant_pressure(self):
        """True at constant pressure."""
        return self.ensemble == NPT

    @property
    def text(self):
        """In tables."""
        return f"{METHODS[self.method]}, {self.dt:g} fs"


#: series for comparison: the long step of ours; a short step, and the two steps of Richardson's extrapolation
LONG = {model: Series(model, OURS, 2.0) for model in MODELS}
SHORT, EXTRAPOLATED = Series("tip4p", SHAKE, 0.5), (Series("tip4p", SHAKE, 1.0), Series("tip4p", SHAKE, 2.0))
#: constant volume: the long step of ours and of fix rigid/nvt/small
FIXED, RIVAL = (Series("tip4p", method, 2.0, NVT) for method in (OURS, RIGID))
#: Series -> nanoseconds that it should have; the series that lacks the largest part comes next
TARGETS = {
    LONG["tip4p"]: 6.0,
    Series("tip4p", OURS, 3.0): 5.0,
    Series("tip4p", SHAKE, 3.0): 4.0,
    EXTRAPOLATED[1]: 4.0,
    EXTRAPOLATED[0]: 1.5,
    SHORT: 1.5,
    FIXED: 2.0,
    RIVAL: 3.0,
    LONG["spce"]: 1.0,
}
#: number of runs between two looks at the clock
BATCH = 2


@dataclass(frozen=True)
class Plan:
    """Durations in ps of a run: ``settle`` before samples, ``duration`` of ``blocks``
    samples, ``every`` between rows, ``frame`` between frames of the dump.

    ``hours``: no further batch of runs begins after this time.
    ``shrinking`` and ``equilibration``: steps for a start, as in the study of liquids.  ``timed``: steps and rounds of
    the timing.
    """

    hours: float = 1.0
    settle: float = 20.0
    duration: float = 200.0
    every: float = 0.024
    frame: float = 0.096
    equilibration: int = 3000
    blocks: int = 10
    timed: tuple = (1000, 5)
    shrinking: int = 4000


QUICK = Plan(0.0, 0.024, 0.24, 0.024, 0.048, 200, 5, timed=(20, 2), shrinking=1000)
