"""The cost of accuracy with solvers that control their steps, in force evaluations.

Every call of the right-hand side counts, for any purpose; LSODA chooses between Adams and BDF itself and gets no
Jacobian, so the calls for a Jacobian by differences are included.  It keeps room for a full Jacobian: 340 MB for 500
bodies.

DDEABM, the Adams method of variable step and order of L. F. Shampine and M. K. Gordon, is SWAG of the Python package
extensisq.  CVODE of SUNDIALS is there where the Python package
scikit-sundae is installed.  BDF is with Newton's method and a Jacobian of differences, Adams with functional iteration,
which needs none.
"""

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np
from scipy.integrate import solve_ivp

from . import quaternion as qt
from .equations import PARTS, State

METHODS = ("DOP853", "LSODA")
DDEABM = "DDEABM"
#: methods of CVODE: name here -> name there
CVODE = {"CVODE Adams": "Adams", "CVODE BDF": "BDF"}
#: SciPy raises a smaller relative tolerance to this value, with a warning
SMALLEST_TOLERANCE = 100 * np.finfo(float).eps


@dataclass(frozen=True)
class Errors:
    """``center`` (B,), distance of the centers of mass; ``angle`` (B,), radians, of the rotation
    between the orientations; ``energy``, change of the total energy from start to end."""

    center: np.ndarray
    angle: np.ndarray
    energy: float

    @property
    def rms_center(self):
        """Root mean square of ``center`` over the bodies."""
        return float(np.sqrt((self.center**2).mean()))

    @property
    def rms_angle(self):
        """Root mean square of ``angle`` over the bodies."""
        return float(np.sqrt((self.angle**2).mean()))


def state_errors(problem, reference, state):
    """Errors of a State of any float type, judged in the float type of the problem."""
    state, reference = state.astype(problem.dtype), reference.astype(problem.dtype)
    away = state.center - reference.center
    energy = sum(problem.energies(state)) - sum(problem.energies(problem.start))
    return Errors(
        np.sqrt((away * away).sum(axis=1)).astype(np.float64),
        qt.angle_between(state.q, reference.q).astype(np.float64),
        float(energy),
    )


def available():
    """METHODS, and the methods of CVODE if it is installed."""
    return METHODS + (tuple(CVODE) if find_spec("sksundae") else ())


def weights(length, angle, time):
    """Errors (13,) of a packed state that weigh the same: a length, an angle, and their rates over a time."""
    found = np.empty(13)
    for name, unit in zip(PARTS, (length, length / time, angle, angle / time)):
        found[PARTS[name]] = unit
    return found


def _of_cvode(rates, span, start, method, rtol, atol):
    """``solve_ivp`` with CVODE: (success, message, states at its own steps (n, size))."""
    from sksundae.cvode import CVODE as Solver

    def fill(t, y, found):
        found[:] = rates(t, y)

    def nothing(t, y, found, jacobian):
        jacobian[:] = 0.0

    # with a Jacobian of zeros, Newton's method, the only one of the binding, is functional iteration
    own = {"jacfn": nothing} if method == "Adams" else {}
    solver = Solver(fill, method=method, rtol=rtol, atol=atol, max_num_steps=10**6, **own)
    solution = solver.solve(np.array(span), start)
    return solution.success, solution.message, solution.y


def _of_scipy(rates, span, start, method, rtol, atol):
    """The same for SciPy's methods."""
    if method == DDEABM:
        from extensisq import SWAG as method
    # no times in between are requested, because dense output would call the right-hand side additionally
    solution = solve_ivp(rates, span, start, method, rtol=rtol, atol=atol)
    return solution.success, solution.message, solution.y.T


def _solution(problem, time, method, tolerance, weights=None, most=np.inf):
    """Packed states (n, B, 13) at the steps of a method in double precision, and the evaluations.

    ``tolerance`` is relative to each component and to the largest of its kind (position, velocity, quaternion, angular
    velocity), whichever is larger, or to the ``weights`` (13,) alone.  Raises RuntimeError if the method fails, or
    needs more than ``most`` evaluations.
    """
    if method not in (known := (*METHODS, DDEABM, *CVODE)):
        raise ValueError(f"the method is one of {', '.join(known)}, not {method}")
    if weights is None and not tolerance >= SMALLEST_TOLERANCE:
        raise ValueError(f"a tolerance of at least {SMALLEST_TOLERANCE:.2g} is required")
    double = problem.astype(np.float64)
    start = double.start.packed()
    evaluations = 0

    def rates(t, y):
        nonlocal evaluations
        evaluations += 1
        if evaluations > most:
            raise RuntimeError(f"{method} at tolerance {tolerance:g}: more than {most} evaluations")
        return double.rates(t, y.reshape(start.shape)).ravel()

    scale = double.scales(start) if weights is None else weights
    absolute = np.broadcast_to(tolerance * np.where(scale > 0, scale, 1), start.shape).ravel()
    relative = tolerance if weights is None else SMALLEST_TOLERANCE
    solver = _of_cvode if method in CVODE else _of_scipy
    task = (rates, (0.0, float(time)), start.ravel(), CVODE.get(method, method))
    success, message, states = solver(*task, rtol=relative, atol=absolute)
    if not success:
        raise RuntimeError(f"{method} at tolerance {tolerance:g}: {message}")
    return states.reshape(-1, *start.shape), evaluations


def solve(problem, time, method, tolerance, weights=None, most=np.inf):
    """State of a Problem at ``time`` by a method, and the evaluations; see ``_solution``."""
    steps, evaluations = _solution(problem, time, method, tolerance, weights, most)
    return State.of(steps[-1]), evaluations


def largest_energy_error(problem, time, method, tolerance):
    """(evaluations, largest deviation of the energy at the solver's own steps)."""
    steps, evaluations = _solution(problem, time, method, tolerance)
    double = problem.astype(np.float64)
    energies = [float(sum(double.energies(State.of(packed)))) for packed in steps]
    return evaluations, float(np.abs(np.array(energies) - energies[0]).max())
