"""The extended-precision integrator: exactness, the known trajectories."""

import functools

import numpy as np
import pytest

from benchmarks.reference import integrators, paper_problem
from benchmarks.reference.integrators import GraggBulirschStoer, NotReached, integrate

LONG = np.longdouble


def plain(rates, tolerance=1e-17):
    """Integrator of a system of any shape."""
    return GraggBulirschStoer(rates, np.abs, tolerance, LONG)


def oscillator(_t, y):
    return np.array([y[1], -y[0]])


@pytest.mark.parametrize("columns", [3, 5, 7])
def test_weights_are_exact(columns):
    counts = [2 * (k + 1) for k in range(columns)]
    weights = integrators.extrapolation_weights(counts)
    assert sum(weights) == 1
    for power in range(1, columns):
        assert sum(w / n ** (2 * power) for w, n in zip(weights, counts)) == 0
    assert sum(w / n ** (2 * columns) for w, n in zip(weights, counts)) != 0


def test_error_follows_the_tolerance():
    errors = []
    for tolerance, most in ((1e-10, 1e-8), (1e-14, 1e-12), (1e-17, 2e-16)):
        solver = plain(oscillator, tolerance=tolerance)
        end = solver.advance(np.array([LONG(1), LONG(0)]), [LONG(0), LONG(100)])[-1]
        errors.append(abs(end[0] - np.cos(LONG(100))))
        assert errors[-1] < most
    assert errors[0] > 100 * errors[-1]


def test_a_jump_is_not_integrated_in_silence():
    def jumping(_t, y):
        return np.array([y[1], -np.sign(y[0]) - y[0]])

    start, times = np.array([LONG(1), LONG(0)]), [LONG(0), LONG(10)]
    with pytest.raises(NotReached, match="a tolerance above 1e-17 is required, or forces without"):
        plain(jumping).advance(start, times)


TABLE = [  # from the notes on the paper: extended precision, correct except for the last digit
    (1, "consistent", 100, ("85.43010788464767", "-1.784299103660877", "1.14360193088973")),
    (1, "consistent", 200, ("85.56573248988141", "-6.06135624295223", "6.86227956266460")),
    (1, "consistent", 500, ("108.10226076975", "0.45545437335", "9.35574500753")),
    (1, "unrotated", 100, ("86.693409428", "-1.437897239", "0.844779738")),
    (1, "unrotated", 200, ("84.82167549249749", "-5.03225661408319", "7.72730548267065")),
    (3, "consistent", 200, ("74.503045115", "0.054749072", "0.083234521")),
    (3, "consistent", 500, ("104.5646400316667", "10.1693278629597", "-0.98795392679928")),
]


@functools.cache
def states(case, body, times=(100, 200, 500), **accuracy):
    """Problem and its States at ``times``; computed once."""
    problem = paper_problem(case, body)
    return problem, integrate(problem, times, **accuracy)


@pytest.mark.parametrize("case, body, time, center", TABLE)
def test_reference_table(case, body, time, center):
    _, known = states(case, body)
    found = known[(100, 200, 500).index(time)].center[0]
    for value, printed in zip(found, center):
        last_but_one = LONG(10) ** (1 - len(printed.split(".")[1]))
        assert abs(value - LONG(printed)) < last_but_one, f"{value} is not {printed}"


@pytest.mark.parametrize("case, body", [(1, "consistent"), (1, "unrotated"), (3, "consistent")])
def test_another_order_and_tolerance_agree(case, body):
    problem, some = states(case, body)
    _, others = states(case, body, (100, 200), columns=6, tolerance=1e-18)
    for state, other, limit in zip(some, others, (1e-14, 2e-14)):
        assert np.abs(state.packed() - other.packed()).max() < limit
        start, end = (sum(problem.energies(s)) for s in (problem.start, state))
        assert abs(end - start) < 2e-15
        assert abs((state.q**2).sum() - 1) < 1e-16
