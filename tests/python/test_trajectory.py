"""Trajectories and orders of all formulations inside LAMMPS, against extended precision."""

import numpy as np
import pytest

# center of mass, test case 1, found in extended precision (notes on the paper)
REFERENCE = {
    ("consistent", 100): (85.43010788464767, -1.784299103660877, 1.14360193088973),
    ("consistent", 200): (85.56573248988141, -6.06135624295223, 6.86227956266460),
    ("unrotated", 100): (86.693409428, -1.437897239, 0.844779738),
    ("unrotated", 200): (84.82167549249749, -5.03225661408319, 7.72730548267065),
}
LIMIT = {"momentum": 1e-9, "second": 1e-9, "first": 1e-7}


def order_of(steps, errors):
    """Slope of log(error) over log(step), least squares."""
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


def errors(run_case, times, dt, **variables):
    """Errors of the center of mass at ``times`` (multiples of 100)."""
    every = round(100 / dt)
    body = variables.setdefault("body", "consistent")
    found = run_case(1, dt=dt, steps=every * max(times) // 100, every=every, **variables)
    return [
        float(np.linalg.norm(found.center[time // 100] - REFERENCE[body, time])) for time in times
    ]


@pytest.mark.parametrize("body", ["consistent", "unrotated"])
@pytest.mark.parametrize("formulation", LIMIT)
def test_reference_trajectory(run_case, formulation, body):
    for error in errors(run_case, (100, 200), 0.02, formulation=formulation, body=body):
        assert error < LIMIT[formulation]


@pytest.mark.parametrize("formulation", LIMIT)
def test_reference_check_can_fail(run_case, formulation):
    """With a step that ends at 1 % less than t = 200."""
    found = run_case(1, formulation=formulation, dt=0.02 * 0.99, steps=10000, every=10000)
    assert np.linalg.norm(found.center[-1] - REFERENCE["consistent", 200]) > LIMIT[formulation]


@pytest.mark.parametrize(
    "formulation, values, order", [("momentum", 8, 7.6), ("second", 8, 7.6), ("first", 6, 5.6)]
)
def test_order(run_case, formulation, values, order):
    steps = (0.2, 0.1)
    found = [errors(run_case, (200,), dt, formulation=formulation, keywords=f"values {values}")[0] for dt in steps]
    assert order_of(steps, found) >= order


@pytest.mark.parametrize("formulation", LIMIT)
def test_zero_start_is_of_first_order(run_case, formulation):
    steps = (0.01, 0.005, 0.0025)
    found = [errors(run_case, (200,), dt, formulation=formulation, keywords="start zero")[0] for dt in steps]
    assert order_of(steps, found) == pytest.approx(1.0, abs=0.2)


def test_c0_velocity_costs_two_orders(run_case):
    """With the coefficient 3/16 of the paper instead of 3/20."""
    steps = (0.1, 0.05)
    found = [errors(run_case, (200,), dt, formulation="second", keywords="c0 velocity")[0] for dt in steps]
    assert 4.0 < order_of(steps, found) < 6.0


@pytest.mark.parametrize("formulation", LIMIT)
def test_the_yardstick_is_beaten(run_case, formulation):
    """At the same step, the number of force evaluations is the same."""
    ours = errors(run_case, (200,), 0.02, formulation=formulation)[0]
    yardstick = errors(run_case, (200,), 0.02, formulation="rigid")[0]
    assert ours < 1e-2 * yardstick


@pytest.mark.parametrize("formulation", ["second", "first"])
def test_quaternion_stays_of_length_one(run_case, formulation):
    projected = run_case(1, formulation=formulation, dt=0.1, steps=2000, every=100, keywords="project yes")
    assert projected.q_error.max() < 1e-14
    free = run_case(1, formulation=formulation, dt=0.1, steps=2000, every=100, keywords="project no")
    assert free.q_error.max() > 1e-14
