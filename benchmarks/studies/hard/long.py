"""Test case 1 to t = 50 000: ten starts in both formulations, of which the worst counts."""

import re
from dataclasses import dataclass

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck

TITLE, SECONDS = "Case 1 to t = 50 000", 100.0
#: energy sampled about every 10, at every step, and evaluations of the forces
MOST_SAMPLED, MOST_EVERY_STEP, MOST_EVALUATIONS = 1e-9, 1e-8, 500_000
SHIFTS = tuple(f"{k}e-9" for k in range(10))
_LAST_LINE = re.compile(
    r"^evaluations (\d+), energy off by (\S+) sampled, (\S+) at every step$", re.MULTILINE
)


@dataclass(frozen=True)
class Long:
    """One run: ``evaluations``, largest errors of the energy, ``sampled`` and at ``every`` step."""

    evaluations: int
    sampled: float
    every: float


def read(text):
    """Long of the text of a log.  Raises ValueError if the deck's last line is not in it."""
    match = _LAST_LINE.search(text)
    if not match:
        raise ValueError("the last line of in.long, with evaluations and errors, is not in the log")
    return Long(int(match[1]), float(match[2]), float(match[3]))


def measure(lab, shifts=SHIFTS, **options):
    """(formulation, shift) -> Long."""
    axes = {"formulation": FORMULATIONS, "shift": shifts}
    settings = {"steps": 5_000_000} | options
    return lab.sweep("long", deck("hard/long"), axes, lambda run: read(run.log.text), settings)


def find(results):
    """Finding of what ``measure`` returns."""
    measurements, errors, counts = [], [], []
    for formulation in dict.fromkeys(formulation for formulation, _ in results):
        runs = [run for (of, _), run in results.items() if of == formulation]
        name = f"{formulation} formulation, worst of {len(runs)} starts"
        sampled, every = (
            np.array([getattr(run, of) for run in runs]) for of in ("sampled", "every")
        )
        evaluations = np.array([run.evaluations for run in runs])
        energy = f"{name}: error of the energy"
        measurements += [
            Measurement(f"{energy}, sampled every 10", sampled.max(), most=MOST_SAMPLED),
            Measurement(f"{energy} at every step", every.max(), most=MOST_EVERY_STEP),
            Measurement(f"{name}: evaluations of the forces", int(evaluations.max()), spec=",",
                        most=MOST_EVALUATIONS),
        ]  # fmt: skip
        x = np.arange(len(runs))
        errors.append(Curve(f"{formulation}, at every step", x, every, formulation, "", "x"))
        errors.append(Curve(f"{formulation}, sampled", x, sampled, formulation, "", "o"))
        counts.append(Curve(formulation, x, evaluations / 1e6, formulation, "", "o"))
    panels = (
        Panel("worst in each start", "start", "error of the energy", tuple(errors)),
        Panel("force evaluations", "start", "million", tuple(counts), log=""),
    )
    context = {"starts": len(SHIFTS), "shift": SHIFTS[-1]}
    return Finding(measurements, pictures={"long": panels}, context=context)
