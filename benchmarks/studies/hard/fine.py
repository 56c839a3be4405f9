"""The paper's 50 million steps of 0.0001: nothing but rounding is left."""

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor, series

TITLE, SECONDS = "The paper's 50 million steps", 100.0
#: largest error of the energy by ``compensate``, and deviation of the squared length of q from 1: without
#: projection, rounding makes the length walk at random, and the orientation does not depend on it
MOST, MOST_LENGTH = {"no": 2e-10, "yes": 1e-12}, 2e-12
SUMS = {"no": "plain", "yes": "compensated"}


def measure(lab, steps=50_000_000, **options):
    """(compensate, formulation) -> Series; ``options``: variables of the deck."""
    axes = {"compensate": tuple(SUMS), "formulation": FORMULATIONS}
    settings = {"steps": steps, "every": 10_000} | options
    return lab.sweep("fine", deck("hard/fine"), axes, lambda run: series.of_log(run.log), settings)


def find(results):
    """Finding of what ``measure`` returns."""
    measurements, curves = [], []
    for (compensate, formulation), run in results.items():
        error = np.abs(run.total - run.total[0])
        label = f"{formulation}, {SUMS[compensate]}"
        what = f"{formulation} formulation, {SUMS[compensate]} sums: largest error of the energy"
        measurements.append(Measurement(what, float(error.max()), most=MOST[compensate]))
        line = "-" if compensate == "no" else "--"
        worst = floor(np.maximum.accumulate(error)[1:])
        curves.append(Curve(label, run.time[1:], worst, formulation, line))
    worst = max(float(run.q_error.max()) for run in results.values())
    what = "all runs: largest deviation of the squared length of q from 1"
    measurements.append(Measurement(what, worst, most=MOST_LENGTH))
    run = results["yes", "second"]
    potential = Curve("", run.time, run.potential, "potential")
    panels = (
        Panel("largest error of the energy so far", "time", "energy", tuple(curves), log="xy"),
        Panel("second, compensated", "time", "potential energy", (potential,), log=""),
    )
    span = {"lowest": run.potential.min(), "highest": run.potential.max(), "steps": run.step[-1]}
    return Finding(measurements, pictures={"fine": panels}, context=span)
