"""The paper's 50 million steps of 0.0001: nothing but rounding is left."""

import numpy as np

from benchmarks.engine import series
from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

#: asked of the energy, by ``compensate``, and of the squared length of q
ASKED = {"no": 2e-10, "yes": 1e-12}
NORM = 1e-14
SUMS = {"no": "plain", "yes": "compensated"}


def judge(results):
    """Rows; ``results``: (formulation, compensate) -> Series."""
    rows = []
    for compensate, word in SUMS.items():
        for formulation in FORMULATIONS:
            found = results[formulation, compensate]
            error = float(np.abs(found.total - found.total[0]).max())
            steps = f"{found.step[-1]:,.0f} steps".replace(",", " ")
            what = f"error of the energy, {steps}, {formulation} formulation, {word}"
            rows.append(at_most(what, ASKED[compensate], error))
    worst = max(float(found.q_error.max()) for found in results.values())
    rows.append(at_most("squared length of q less 1, all runs", NORM, worst))
    return tuple(rows)


def _curves(results):
    curves = []
    for (formulation, compensate), found in results.items():
        error = np.maximum.accumulate(np.abs(found.total - found.total[0]))
        line = "-" if compensate == "no" else "--"
        label = f"{formulation}, {SUMS[compensate]}"
        curves.append(Curve(label, found.time[1:], floor(error[1:]), formulation, line))
    return tuple(curves)


def panels(results):
    """Largest error of the energy so far, and how close the body comes: its potential energy."""
    found = results["second", "yes"]
    potential = Curve("", found.time, found.potential, "potential")
    return (
        Panel("largest error of the energy so far", "time", "energy", _curves(results), log="xy"),
        Panel("second, compensated", "time", "potential energy", (potential,), log=""),
    )


def measure(runs, steps=50_000_000, **options):
    """(formulation, compensate) -> Series; ``options``: variables of the deck."""
    variables = {
        f"{formulation}-{SUMS[compensate]}": {
            "formulation": formulation,
            "compensate": compensate,
            "steps": steps,
            "every": 10_000,
        }
        | options
        for formulation in FORMULATIONS
        for compensate in SUMS
    }
    found = runs.many("fine", variables)
    return {
        (v["formulation"], v["compensate"]): series.read_log(found[name].log)
        for name, v in variables.items()
    }


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    potential = results["second", "yes"].potential
    text = (
        "Consistent body, start of test case 1, defaults of the fix, energy sampled once per unit of "
        f"time. The potential energy stays between {potential.min():.1f} and {potential.max():.1f}: this "
        "trajectory meets no bare charge before its end. The charges of the cage are reconstructed."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "fine",
    "The paper's 50 million steps",
    "At a step of 0.0001 every error of the method is far below rounding, which grows with the "
    "number of steps.",
    100.0,
    run,
)
