"""The exact free top: conserved quantities, special motions, composition, the integrator."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reference import FreeField, Problem, paper_problem
from benchmarks.reference import quaternion as qt
from benchmarks.reference.free_top import FreeTop, exact_state
from benchmarks.reference.integrators import integrate

LONG = np.longdouble
OMEGAS = [  # about the largest and the smallest moment, either way; near a pure spin; slow
    (0.4, 0.02, 0.01),
    (-0.4, 0.02, -0.01),
    (0.02, 0.04, 0.3),
    (0.02, -0.04, -0.3),
    (1e-9, 1e-9, 0.3),
    (0.02, -0.04, 0.02),
]


def top(omega, moments=None):
    """The paper's body, free, with this spin."""
    problem = paper_problem(1)
    bodies, start = problem.bodies, replace(problem.start, omega_body=np.array([omega], dtype=LONG))
    if moments is not None:
        bodies = replace(bodies, moments=np.array([moments], dtype=LONG))
    return Problem("top", bodies, FreeField(), start)


@pytest.mark.parametrize("omega", OMEGAS)
def test_agrees_with_the_integrator(omega):
    problem = top(omega)
    state, exact = integrate(problem, (40,))[0], exact_state(problem, 40)
    assert qt.angle_between(exact.q, state.q).max() < 1e-15
    assert np.abs(exact.center - state.center).max() < 1e-16
    assert np.abs(exact.omega_body - state.omega_body).max() < 1e-16


@pytest.mark.parametrize("omega", OMEGAS)
@pytest.mark.parametrize("time", [1e3, 1e6])
def test_energy_and_angular_momentum_are_kept(omega, time):
    problem = top(omega)
    start, end = problem.start, exact_state(problem, time)
    assert sum(problem.energies(end)) == pytest.approx(sum(problem.energies(start)), rel=1e-18)
    momentum = problem.angular_momentum_space(start)
    error = np.abs(problem.angular_momentum_space(end) - momentum).max()
    assert error < 3e-17 * np.abs(momentum).max()


@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_names_of_the_axes_do_not_matter(order):
    """Axes permuted, and one turned over where that is needed to stay right-handed."""
    order = list(order)
    moments, omega = np.array([3, 2, 1], dtype=LONG), np.array([0.3, 0.2, -0.9], dtype=LONG)
    sign = np.ones(3, dtype=LONG)
    sign[2] = np.round(np.linalg.det(np.eye(3)[order]))
    frame = (np.eye(3, dtype=LONG)[order]).T * sign  # old body <- new body
    q = np.array([0, 0, 0, 1], dtype=LONG)
    old_q, old_omega = FreeTop(moments, omega, q).at(30)
    new_q, new_omega = FreeTop(moments[order], omega @ frame, qt.of_rotation(frame)).at(30)
    assert qt.angle_between(new_q, qt.product(old_q, qt.of_rotation(frame))) < 1e-17
    assert np.abs(new_omega - old_omega @ frame).max() < 1e-17


@pytest.mark.parametrize("moments, rate", [((2, 2, 1), 0.5), ((1, 1, 2), -1.0)])
def test_symmetric_top_precesses_at_its_rate(moments, rate):
    """omega_x' = rate omega_z omega_y, omega_y' = -rate omega_z omega_x."""
    problem, time = top((0.3, 0, 0.8), moments), LONG(20)
    angle = LONG(rate) * problem.start.omega_body[0, 2] * time
    expected = np.array([LONG(0.3) * np.cos(angle), -LONG(0.3) * np.sin(angle), LONG(0.8)])
    found = exact_state(problem, time).omega_body[0]
    assert np.abs(found - expected).max() < 1e-18


@pytest.mark.parametrize(
    "moments, omega",
    [((3, 2, 1), (0, 0.1, 0)), ((1, 1, 1), (0.06, 0, 0.08)), ((3, 2, 1), (0, 0, 0))],
)
def test_uniform_spin(moments, omega):
    problem = top(omega, moments)
    end = exact_state(problem, 10)
    speed = np.linalg.norm(omega)
    assert (end.omega_body == problem.start.omega_body).all()
    assert qt.angle_between(end.q, problem.start.q)[0] == pytest.approx(10 * speed, abs=1e-15)
    half = 5 * problem.start.omega_body[0]
    size = np.sqrt((half * half).sum())
    turn = np.append(half * np.sinc(size / LONG("3.14159265358979323846")), np.cos(size))
    assert qt.angle_between(end.q, qt.product(problem.start.q, turn))[0] < 1e-15


def test_separatrix_is_refused():
    """Moments 3, 2, 1/2: 2 T I_2 = L^2 where omega_3 = 2 omega_1, exactly."""
    moments, still = np.array([3, 2, 0.5], dtype=LONG), np.array([0, 0, 0, 1], dtype=LONG)
    with pytest.raises(ValueError, match="a motion off the separatrix is required"):
        FreeTop(moments, np.array([1, 0.5, 2], dtype=LONG), still)
    FreeTop(moments, np.array([1, 0.5, 2.001], dtype=LONG), still)
