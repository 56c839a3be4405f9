"""Made-up series with known answers."""

from dataclasses import replace

import numpy as np

from benchmarks.engine.series import Series
from benchmarks.studies.cases import plan


def make(time, center, potential=None, translation=None, rotation=None):
    """Series at ``time`` (n,) with the given columns; other columns are zero or constant."""
    n = len(time)

    def column(values, default=0.0):
        return np.full(n, default) if values is None else np.asarray(values, dtype=float)

    potential, translation = column(potential), column(translation)
    rotation = column(rotation, 1.0)
    total = potential + translation + rotation
    center = np.asarray(center, dtype=float)
    return Series(time, time, center, potential, translation, rotation, total, np.zeros(n))


ENERGY = {1: -0.72360304, 2: -0.72360304, 3: 3.99270832}
# threshold 0.1 is passed at these times; chaos multiplies by ten in a tenth of it
PARTS = {1: 1000.0, 2: 270.0, 3: 800.0}


def made_up(run):
    """Series of a run of ``benchmarks/run cases`` as claimed in the paper."""
    time = np.arange(run.end + 1.0)
    center = np.zeros((len(time), 3))
    center[:, 0] = 90.0
    if run.formulation == "second":
        center[:, 0] += 0.1001 * 10 ** np.minimum((time / PARTS[run.case] - 1) * 10, 2)
    if run.case == 3:
        axis, sign = (2, -1) if run.formulation == "first" else (1, 1)
        center[:, axis] += sign * np.maximum(time - 900, 0)
    potential = -3.0 + np.sin(time)
    translation = 0.5 * np.minimum(time / 20, 1.0)
    rotation = ENERGY[run.case] - potential - translation
    if run.case == 3:
        decay = np.where(time < 1000, 1.0, 0.0)
        potential, rotation = potential * decay, ENERGY[3] - potential * decay - translation
    if run.case == 2 and run.formulation == "first":
        rotation = rotation + np.where(time > 4000, 0.3, 0.0)
    if run.omega == "predicted":
        center[-1] += 3.0
    if run.omega == "corrected":
        center[-1] += 1.0
    values = make(time, center, potential, translation, rotation)
    return replace(values, step=time / run.dt)


def made_up_results():
    """Results of ``benchmarks/run cases`` as claimed in the paper."""
    runs = plan.planned_runs(plan.STEP)
    return plan.Results(plan.STEP, {run.name: made_up(run) for run in runs})
