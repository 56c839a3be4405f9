"""What accuracy costs: error of the trajectory against the step, and of the energy over long runs.

Everything is measured in the paper's scene with the consistent body.  One step is one evaluation of
the forces with every method, so equal steps are equal numbers of evaluations.
"""

import functools

import numpy as np

from benchmarks.engine import divergence as dv
from benchmarks.reference import paper_problem, reference_state
from .runs import ACCURACY_END, ACCURACY_STEPS, ACCURATE, COARSE_STEPS, STEP


@functools.cache
def reference():
    """Centre of mass (3,) of test case 1, consistent body, at ACCURACY_END; in extended precision."""
    return reference_state(paper_problem(1, "consistent"), ACCURACY_END).double.centre[0]


#: steps of the long runs of one and the same motion: test cases 1 and 2, and two larger ones
ENERGY_STEPS = (STEP[1], STEP[2], *COARSE_STEPS)

PAPER = "consistent-zero-free"
#: label -> (row, formulation)
METHODS = {
    "fix gear/quat, second formulation": (ACCURATE, "second"),
    "fix gear/quat, first formulation": (ACCURATE, "first"),
    "the paper's choices, second formulation": (PAPER, "second"),
    "the paper's choices, first formulation": (PAPER, "first"),
    "fix rigid/nve/small": (ACCURATE, "rigid"),
}


def position_errors(results):
    """Distance of the centre of mass from reference(): label -> list, one for each ACCURACY_STEPS."""
    errors = {}
    for label, (row, formulation) in METHODS.items():
        runs = [results.get(1, row, formulation, dt) for dt in ACCURACY_STEPS]
        ends = [values.centre[values.at(ACCURACY_END)] for values in runs]
        errors[label] = [float(np.linalg.norm(end - reference())) for end in ends]
    return errors


def energy_errors(results):
    """Largest deviation of the total energy from its start to t = 5000: label -> list.

    One number for each of ENERGY_STEPS, from samples once per unit of time.
    """

    def largest(row, formulation, dt):
        case = 2 if dt == STEP[2] else 1
        return float(np.abs(dv.energy_error(results.get(case, row, formulation, dt))).max())

    return {
        label: [largest(row, formulation, dt) for dt in ENERGY_STEPS]
        for label, (row, formulation) in METHODS.items()
    }


def step_costs(results):
    """Microseconds a step of the long run of case 1: label -> number."""
    return {
        label: 1e6 * results.seconds_per_step(1, row, formulation)
        for label, (row, formulation) in METHODS.items()
    }
