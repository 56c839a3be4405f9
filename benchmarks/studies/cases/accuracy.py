"""The cost of accuracy: error of the trajectory against the step, and of the energy over long runs.

All measurements are for the paper's scene with the consistent body.
"""

import functools

import numpy as np

from benchmarks.reference import paper_problem, reference_state

from . import divergence as dv
from .plan import ACCURACY_END, ACCURACY_STEPS, ACCURATE, AS_PRINTED, COARSE_STEPS

PAPER = AS_PRINTED[0]
DEFAULT = "fix gear/quat"
SECOND, FIRST = "fix gear/quat, second formulation", "fix gear/quat, first formulation"
PAPER_SECOND = "the paper's choices, second formulation"
PAPER_FIRST = "the paper's choices, first formulation"
RIGID = "fix rigid/nve/small"
#: label -> (row, formulation)
METHODS = {
    DEFAULT: (ACCURATE, "momentum"),
    SECOND: (ACCURATE, "second"),
    FIRST: (ACCURATE, "first"),
    PAPER_SECOND: (PAPER, "second"),
    PAPER_FIRST: (PAPER, "first"),
    RIGID: (ACCURATE, "rigid"),
}


@functools.cache
def reference():
    """Center of mass (3,) of test case 1, consistent body, at ACCURACY_END; in extended precision."""
    return reference_state(paper_problem(1, "consistent"), ACCURACY_END).double.center[0]


def position_errors(results):
    """Label -> distances of the center of mass from reference(), one for each of ACCURACY_STEPS."""
    errors = {}
    for label, method in METHODS.items():
        runs = [results.get(1, *method, dt) for dt in ACCURACY_STEPS]
        ends = [values.center[values.at(ACCURACY_END)] for values in runs]
        errors[label] = [float(np.linalg.norm(end - reference())) for end in ends]
    return errors


def energy_steps(results):
    """Steps of the long runs of the same motion: test cases 1 and 2, and two larger steps."""
    return (results.step[1], results.step[2], *COARSE_STEPS)


def energy_errors(results):
    """Label -> largest changes of the total energy since the start, one for each of energy_steps.

    There is one sample per unit of time.
    """

    def largest(method, dt):
        case = 2 if dt == results.step[2] else 1
        return float(np.abs(dv.energy_error(results.get(case, *method, dt))).max())

    steps = energy_steps(results)
    return {label: [largest(method, dt) for dt in steps] for label, method in METHODS.items()}
