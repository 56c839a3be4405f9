"""Work and precision of SciPy's solvers: every call counted, errors judged by the reference."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reference import Cage, paper_problem, reference_state
from benchmarks.reference import quaternion as qt
from benchmarks.reference.solvers import solve, state_errors, work_precision

LONG = np.longdouble


class Counting(Cage):
    """A cage that counts its calls, in any float type."""

    calls = 0

    def energy_and_forces(self, positions):
        Counting.calls += 1
        return super().energy_and_forces(positions)

    def astype(self, dtype):
        return Counting(dtype)


@pytest.mark.parametrize("method", ["DOP853", "LSODA"])
def test_every_call_is_counted(method):
    problem = paper_problem(1).with_field(Counting())
    before = Counting.calls
    state, evaluations = solve(problem, 20.0, method, 1e-8)
    assert Counting.calls - before == evaluations > 50
    assert state.center.dtype == np.float64


@pytest.mark.parametrize("method, floor", [("DOP853", 1e-9), ("LSODA", 1e-8)])
def test_errors_fall_with_the_tolerance(method, floor):
    problem = paper_problem(1)
    end = reference_state(problem, 100.0)
    points = work_precision(problem, 100.0, end, method, (1e-5, 1e-8, 1e-11))
    for get in (lambda e: e.rms_center, lambda e: e.rms_angle, lambda e: abs(e.energy)):
        errors = [get(point.errors) for point in points]
        assert errors[0] > 20 * errors[1] > 400 * errors[2] and errors[2] < floor
    work = [point.evaluations for point in points]
    assert work[0] < work[1] < work[2]


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
