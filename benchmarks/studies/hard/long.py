"""Test case 1 to t = 50 000: ten starts in both formulations, of which the worst counts."""

import re
from dataclasses import dataclass

import numpy as np

from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most
from benchmarks.engine.tables import Row

#: energy sampled about every 10, at every step, and evaluations of the forces
SAMPLED, EVERY_STEP, EVALUATIONS = 1e-9, 1e-8, 1_000_000
SHIFTS = tuple(f"{k}e-9" for k in range(10))
_TOLD = re.compile(
    r"^evaluations (\d+), energy off by (\S+) sampled, (\S+) at every step$", re.MULTILINE
)


@dataclass(frozen=True)
class Long:
    """One run: ``evaluations``, largest errors of the energy, ``sampled`` and at ``every`` step."""

    evaluations: int
    sampled: float
    every: float


def told(text):
    """Long of the text of a log.  Raises ValueError if the deck's last line is not in it."""
    found = _TOLD.search(text)
    if not found:
        raise ValueError("the last line of in.long, with evaluations and errors, is not in the log")
    return Long(int(found[1]), float(found[2]), float(found[3]))


def judge(results):
    """Rows; ``results``: formulation -> list of Long."""
    rows = []
    for formulation, found in results.items():
        name = f"worst of {len(found)} starts, {formulation} formulation"
        worst = max(one.sampled for one in found)
        rows.append(at_most(f"{name}: error of the energy, sampled every 10", SAMPLED, worst))
        worst = max(one.every for one in found)
        rows.append(at_most(f"{name}: error of the energy at every step", EVERY_STEP, worst))
        most = max(one.evaluations for one in found)
        rows.append(
            Row(
                f"{name}: force evaluations",
                f"≤ {EVALUATIONS:,}".replace(",", " "),
                f"{most:,}".replace(",", " "),
                most <= EVALUATIONS,
            )
        )
    return tuple(rows)


def panels(results):
    """Errors and evaluations by start."""
    errors, counts = [], []
    for formulation, found in results.items():
        x = np.arange(len(found))
        for name, marker in (("every", "x"), ("sampled", "o")):
            label = f"{formulation}, {'at every step' if name == 'every' else 'sampled'}"
            y = np.array([getattr(one, name) for one in found])
            errors.append(Curve(label, x, y, formulation, "", marker))
        y = np.array([one.evaluations for one in found]) / 1e6
        counts.append(Curve(formulation, x, y, formulation, "", "o"))
    most = EVALUATIONS / 1e6
    return (
        Panel("worst in each start", "start", "error of the energy", tuple(errors), SAMPLED),
        Panel("force evaluations", "start", "million", tuple(counts), most, log=""),
    )


def measure(runs, shifts=SHIFTS, **options):
    """formulation -> list of Long."""
    variables = {
        f"{formulation}-{shift}": {"formulation": formulation, "shift": shift, "steps": 5_000_000}
        | options
        for formulation in FORMULATIONS
        for shift in shifts
    }
    found = runs.many("long", variables)
    results = {}
    for name, finished in found.items():
        one = told(finished.log.read_text(encoding="utf-8"))
        results.setdefault(variables[name]["formulation"], []).append(one)
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    text = (
        f"Starts moved by 0 to {SHIFTS[-1]} along x, `tolerance` as in the deck; the paper's step of "
        "0.0001 would take 500 million evaluations. The charges of the cage are reconstructed."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "long",
    "Case 1 to t = 50 000",
    "Chaotic, with encounters of bare charges down to 0.002 and less in every run.",
    100.0,
    run,
)
