"""Runs of water that compare fix gear/quat with LAMMPS' own fixes, and their results."""

import itertools
import math
import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from benchmarks.engine import EXAMPLES, Job, LammpsError
from benchmarks.engine.methods import Method

#: molecules in examples/water/data.water, before it is replicated
MOLECULES = 500
#: columns of the log with the kinetic energies, for fix gear/quat (True) and for other fixes; see in.sampling
KINETIC = {
    True: "temp f_move[1] " + " ".join(f"c_squares[{k}]" for k in range(1, 7)),
    False: "temp c_trans c_rot",
}


def _method(key, label, style, kind):
    return Method(key, label, {"motion": style and f"fix move all {style}"}, kind)


OURS = _method("gear-quat", "fix gear/quat", "gear/quat molecule", "momentum")
NVE_SMALL = _method("rigid-nve-small", "fix rigid/nve/small", "rigid/nve/small molecule", "rigid")
SMALL = _method("rigid-small", "fix rigid/small", "rigid/small molecule", "rigid")
FROZEN = _method("frozen", "no fix", "", "rigid")
RACE, TIMED, COMPARED = (OURS, NVE_SMALL), (OURS, NVE_SMALL, FROZEN), (OURS, NVE_SMALL, SMALL)


def bodies_of(cells):
    """Number of molecules in copies of the box along x, y, z."""
    return math.prod(cells) * MOLECULES


@dataclass(frozen=True)
class Plan:
    """Sizes of the runs.  ``cells`` are copies of the box along x, y, z; times are in fs.

    ``headline``: cells of the main comparison, with every number of ``ranks``; ``growth``: cells -> timed steps on one
    rank; ``pressure_dts``: from small to large.
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
    def sizes(self):
        """Numbers of bodies of ``growth``."""
        return tuple(map(bodies_of, self.growth))

    @property
    def interval(self):
        """Time between samples of the pressure: the largest step, so that all runs have samples at the same times."""
        return self.pressure_dts[-1]

    @property
    def scenes(self):
        """Timed scenes: (cells, ranks)."""
        more = [(self.headline, ranks) for ranks in self.ranks if ranks > 1]
        return [(cells, 1) for cells in self.growth] + more


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
class Timing:
    """One timed run: seconds of the slowest rank in all steps, in messages and in fixes.

    ``reported`` and ``allocated``: MiB per rank, from LAMMPS' sum and from the heap in use.  ``evaluations`` and
    ``seconds``: cost of the start of the method, None if it has none.
    """

    steps: int
    loop: float
    comm: float
    modify: float
    reported: float
    allocated: float
    evaluations: int = None
    seconds: float = None


@dataclass(frozen=True)
class Results:
    """All measurements.

    ``timings``: (key of the method, cells, ranks) -> list of Timing by round.  ``pressures``: (key,
    dt) -> samples (n,) in atm.  ``temperatures``: key -> {column of the log: samples (n,)}.
    """

    plan: Plan
    timings: dict
    pressures: dict
    temperatures: dict

    def fix_seconds(self, method, cells, ranks=1):
        """Seconds per step in the fix, shape (rounds,).

        It is the sum of LAMMPS' "Modify" and the increase of "Comm" relative to a run without a fix.
        "Modify" includes the communication of the fix itself; the increase is the time that
        the fix adds to LAMMPS' own communication.
        """
        bare = np.median([t.comm / t.steps for t in self.timings[FROZEN.key, cells, ranks]])
        own = self.timings[method.key, cells, ranks]
        return np.array([(t.modify + t.comm) / t.steps for t in own]) - bare

    def step_seconds(self, method, cells, ranks=1):
        """Seconds per whole step, shape (rounds,)."""
        return np.array([t.loop / t.steps for t in self.timings[method.key, cells, ranks]])

    def bytes_per_body(self, method, cells, kind):
        """Memory per body on one rank, minus the memory without a fix; ``kind``: field of Timing."""
        own, bare = (
            np.median([getattr(t, kind) for t in self.timings[m.key, cells, 1]])
            for m in (method, FROZEN)
        )
        return (own - bare) * 2**20 / bodies_of(cells)


# --- running --------------------------------------------------------------------------------------
_REPORTED = re.compile(r"^Total dynamically allocated memory: (\S+) Mbyte", re.M)
_ALLOCATED = re.compile(r"^Current reserved memory pool size: (\S+) Mbyte", re.M)


def _only(pattern, log, what):
    match = pattern.search(log.text)
    if not match:
        raise LammpsError(f"{log.path}: the log has no {what}")
    return float(match[1])


def read_timing(log, steps, ranks, started):
    """Timing from a log of in.timing; ``started``: True if it includes the start of fix gear/quat.

    Raises LammpsError if anything is missing.
    """
    try:
        first, timed = log.timers
        times = timed["Loop"], timed["Comm"], timed["Modify"]
    except (ValueError, KeyError) as error:
        text = f"{log.path}: not a finished timing with all sections: {error}"
        raise LammpsError(text) from error
    if timed["Ranks"] != ranks:
        raise LammpsError(f"{log.path}: it ran on {timed['Ranks']} ranks, not {ranks}")
    memory = _only(_REPORTED, log, "sum of memory"), _only(_ALLOCATED, log, "size of the heap")
    start = ()
    if started:
        if not log.start_evaluations:
            raise LammpsError(f"{log.path}: the log has no number of evaluations of the start")
        start = log.start_evaluations, first["Modify"] - timed["Modify"] / steps
    return Timing(steps, *times, *memory, *start)


def _deck(name):
    return Path(__file__).with_name(f"in.{name}")


def time_all(lab, plan):
    """``timings`` of Results: one run at a time, every round in a different order.

    For growth, which needs only steps, the start of fix gear/quat is left out.
    """
    jobs, keys, timings = {}, {}, {}
    for (cells, ranks), method in itertools.product(plan.scenes, TIMED):
        motion, steps = method.variables["motion"], plan.growth[cells]
        if method.gear and cells != plan.headline:
            motion += " start zero"
        variables = {"water": EXAMPLES / "water", "cells": " ".join(map(str, cells))}
        variables |= {"motion": motion, "dt": plan.timing_dt, "steps": steps}
        name = f"time_{method.key}_{bodies_of(cells)}_{ranks}"
        jobs[name], keys[name] = Job(_deck("timing"), variables, steps, ranks), (method, cells, ranks)
    for name, runs in lab.in_turn(jobs, plan.rounds).items():
        (method, cells, ranks), steps = keys[name], jobs[name].steps
        started = method.gear and cells == plan.headline
        rounds = [read_timing(run.log, steps, ranks, started) for run in runs]
        timings[method.key, cells, ranks] = rounds
    return timings


def _sampling(method, dt, time, interval, columns):
    """Job of in.sampling; times in fs."""
    variables = {"water": EXAMPLES / "water", "gear": "yes" if method.gear else "no"}
    variables |= {"columns": columns, "dt": f"{dt:.17g}", **method.variables}
    variables |= {"every": round(interval / dt), "steps": round(time / dt)}
    return Job(_deck("sampling"), variables, variables["steps"])


def sample_all(lab, plan):
    """``pressures`` and ``temperatures`` of Results."""
    times = plan.temperature_dt, plan.temperature_time, plan.temperature_interval
    jobs = {f"temperature_{m.key}": _sampling(m, *times, KINETIC[m.gear]) for m in RACE}
    keys = {}
    for dt, method in itertools.product(plan.pressure_dts, COMPARED):
        name = f"pressure_{method.key}_dt{dt:g}"
        keys[name] = method.key, dt
        jobs[name] = _sampling(method, dt, plan.pressure_time, plan.interval, "temp press")
    runs = lab.many(jobs)
    pressures = {key: runs[name].thermo["Press"] for name, key in keys.items()}
    return pressures, {m.key: runs[f"temperature_{m.key}"].thermo for m in RACE}


def measure(lab, plan=None):
    """Results.  Timings come first, one run at a time; samples follow in parallel."""
    plan = plan or (QUICK if lab.quick else Plan())
    with lab.share(0.75):
        timings = time_all(lab, plan)
    with lab.share(0.25):
        return Results(plan, timings, *sample_all(lab, plan))
