"""Time of a step of many molecules of water, compared with rigid/nve/small, shake and a run without a fix."""

import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine import EXAMPLES, Finding, Job, Measurement, Study, Table

OURS, RIGID, SHAKE, FROZEN = "`fix gear/quat`", "`fix rigid/nve/small`", "`fix shake` and `fix nve`", "no fix"
#: method -> style of the fix
STYLES = {OURS: "gear/quat", RIGID: "rigid/nve/small", SHAKE: "shake", FROZEN: "none"}
#: largest time in the fix relative to fix rigid/nve/small
MOST_TIME = 1.0
#: ranks; time step in fs; molecules of examples/water/data.water, before they are replicated
RANKS, DT, MOLECULES = (1, 2), 0.5, 216
IN_TURN = Path(__file__).with_name("in.timing")


@dataclass(frozen=True)
class Plan:
    """Sizes of the runs: ``cells``: copies of the box along x, y, z; timed ``steps``; ``rounds``."""

    cells: tuple = (4, 3, 3)
    steps: int = 40
    rounds: int = 5

    @property
    def molecules(self):
        """Their number."""
        return math.prod(self.cells) * MOLECULES


QUICK = Plan((2, 1, 1), 10, 2)


@dataclass(frozen=True)
class Results:
    """``timings``: (method, ranks) -> seconds per step by round, (rounds, 3): whole step, LAMMPS' "Comm" and "Modify",
    of the slowest rank."""

    plan: Plan
    timings: dict

    def step(self, method, ranks):
        """Seconds per whole step, (rounds,)."""
        return self.timings[method, ranks][:, 0]

    def fix(self, method, ranks):
        """Seconds per step in the fix, (rounds,): "Modify", which includes the messages of the fix itself, and the
        time that it adds to LAMMPS' own messages."""
        _, comm, modify = self.timings[method, ranks].T
        return modify + comm - np.median(self.timings[FROZEN, ranks][:, 1])


def measure(lab):
    """Results; one run at a time, every round in a different order."""
    plan, jobs, timings = QUICK if lab.quick else Plan(), {}, {}
    for ranks, (method, style) in itertools.product(RANKS, STYLES.items()):
        variables = {"water": EXAMPLES / "water", "molecules": MOLECULES, "cells": " ".join(map(str, plan.cells))}
        variables |= {"style": style, "dt": DT, "steps": plan.steps}
        name = f"{style.replace('/', '-')}_{ranks}"
        jobs[name] = Job(IN_TURN, variables, plan.steps, ranks)
    runs = lab.in_turn(jobs, plan.rounds)
    for key, rounds in zip(itertools.product(RANKS, STYLES), runs.values()):
        times = [[run.log.timers[-1][section] for section in ("Loop", "Comm", "Modify")] for run in rounds]
        timings[key[::-1]] = np.array(times) / plan.steps
    return Results(plan, timings)


def ranged(seconds):
    """Median and range in milliseconds as text."""
    least, middle, most = 1e3 * np.percentile(seconds, (0, 50, 100))
    return f"{middle:.2f} ({least:.2f} to {most:.2f})"


def find(results):
    """Finding of Results."""
    header, measurements = ["ms per step"], []
    rows = [[method] for method in STYLES]
    for ranks in RANKS:
        words = f"{ranks} rank{'s' * (ranks > 1)}"
        header += [f"in the fix, {words}", f"whole step, {words}"]
        for row, method in zip(rows, STYLES):
            row.append("–" if method == FROZEN else ranged(results.fix(method, ranks)))
            row.append(ranged(results.step(method, ranks)))
        ours, theirs = (float(np.median(results.fix(method, ranks))) for method in (OURS, RIGID))
        what = f"{words}: time in the fix relative to {RIGID.strip('`')}"
        measurements.append(Measurement(what, ours / theirs, spec=".2f", least=0.0, most=MOST_TIME))
    whole = {method: f"{1e3 * np.median(results.step(method, 1)):.1f}" for method in STYLES}
    context = {"plan": results.plan, "dt": f"{DT:g}", "whole": whole}
    return Finding(measurements, {"time": Table(header, rows)}, context=context)


STUDY = Study("cost", "Cost of a step", 180.0, measure, find, blocks={"doc/accuracy.md": "cost.md.j2", "README.md": "cost.readme.md.j2"})
