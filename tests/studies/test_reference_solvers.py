"""Work and precision of solvers that control their steps: every call counted, errors judged by the reference."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reference import Cage, FreeField, paper_problem, reference_state
from benchmarks.reference import quaternion as qt
from benchmarks.reference.solvers import DDEABM, solve, state_errors, weights

LONG = np.longdouble


class Counting(Cage):
    """A cage that counts its calls, in any float type."""

    calls = 0

    def energy_and_forces(self, positions):
        Counting.calls += 1
        return super().energy_and_forces(positions)

    def astype(self, dtype):
        return Counting(dtype)


@pytest.mark.parametrize("method", ["DOP853", "LSODA", DDEABM])
def test_every_call_is_counted(method):
    problem = paper_problem(1).with_field(Counting())
    before = Counting.calls
    state, evaluations = solve(problem, 20.0, method, 1e-8)
    assert Counting.calls - before == evaluations > 50
    assert state.center.dtype == np.float64


@pytest.mark.parametrize("method, floor", [("DOP853", 1e-9), ("LSODA", 1e-8), (DDEABM, 1e-8)])
def test_errors_fall_with_the_tolerance(method, floor):
    problem = paper_problem(1)
    end = reference_state(problem, 100.0)
    states, work = zip(*(solve(problem, 100.0, method, tolerance) for tolerance in (1e-5, 1e-8, 1e-11)))
    found = [state_errors(problem, end, state) for state in states]
    for get in (lambda e: e.rms_center, lambda e: e.rms_angle, lambda e: abs(e.energy)):
        errors = list(map(get, found))
        assert errors[0] > 20 * errors[1] > 400 * errors[2] and errors[2] < floor
    assert work[0] < work[1] < work[2]


def test_errors_of_a_free_top_follow_weights():
    """The exact solution is known: the error is proportional to the weight of an angle, for few more evaluations."""
    top = paper_problem(1).with_field(FreeField())
    exact, found = reference_state(top, 200.0), []
    for angle in (1e-4, 1e-6, 1e-8, 1e-10):
        state, evaluations = solve(top, 200.0, DDEABM, 1.0, weights(1.0, angle, 10.0))
        found.append((state_errors(top, exact, state).rms_angle / angle, evaluations))
    ratios, work = np.transpose(found)
    assert 0.1 < ratios.min() and ratios.max() < 100
    assert (1.1 * work[:-1] < work[1:]).all() and (work[1:] < 2.5 * work[:-1]).all()


def test_errors_are_distances_angles_and_energies():
    problem = paper_problem(1)
    start, half = problem.start, LONG("5e-13")
    turned = qt.product(start.q, np.array([[np.sin(half), 0, 0, np.cos(half)]]))
    moved = start.center + np.array([3e-12, 0, 4e-12], dtype=LONG)
    errors = state_errors(problem, start, replace(start, center=moved, q=turned))
    assert errors.rms_center == pytest.approx(5e-12, rel=1e-5, abs=0)
    assert errors.rms_angle == pytest.approx(1e-12, rel=1e-5, abs=0)
    faster = start.velocity + np.array([1e-12, 0, 0], dtype=LONG)
    errors = state_errors(problem, start, replace(start, velocity=faster, q=-start.q))
    assert errors.energy == pytest.approx(64 * 0.2 * 1e-12, rel=1e-3, abs=0)
    assert errors.rms_center == errors.rms_angle == 0
