"""Splittings with exact free rotation and a symmetric multistep method: orders by slope, the exact top, counts."""

import numpy as np
import pytest

from benchmarks.reference import (
    FreeField,
    Problem,
    RigidBodies,
    State,
    multistep,
    reference_state,
)
from benchmarks.reference.fields import LennardJonesUnits
from benchmarks.reference.free_top import exact_state
from benchmarks.reference.solvers import state_errors
from benchmarks.reference.splittings import SPLITTINGS, Motion, states

LONG = np.longdouble
LABELS = [splitting.label for splitting in SPLITTINGS]
EVERY = pytest.mark.parametrize("splitting", SPLITTINGS, ids=LABELS)


# --- order ----------------------------------------------------------------------------------------
def oscillator(splitting, steps, end=4):
    """x and v of x'' = -x - x^2/2 - x^3 after this number of steps, in extended precision."""
    x, v, h = LONG(1) / 2, LONG(1), LONG(end) / steps
    for _ in range(steps):
        for is_kick, part in splitting.parts:
            if is_kick:
                v -= part * h * (x + x * x / 2 + x * x * x)
            else:
                x += part * h * v
    return np.array([x, v])


def slopes(errors, counts):
    """Orders between one count of steps and the next."""
    return -np.diff(np.log(np.array(errors, dtype=float))) / np.diff(np.log(counts))


def oscillator_order(splitting, evaluations=(600, 900)):
    """Order that the errors of the oscillator show at two numbers of evaluations."""
    counts = [n // splitting.stages for n in evaluations]
    exact = oscillator(SPLITTINGS[-1], 20_000)
    return slopes([np.abs(oscillator(splitting, n) - exact).max() for n in counts], counts)[0]


class Springs(LennardJonesUnits):
    """Every site is tied to a fixed place by a hardening spring: forces and torques."""

    PLACES = np.array([[3, 1, 0], [0, -2, 1], [1, 0, 4], [-1, 2, 0]])

    def energy_and_forces(self, positions):
        gap = positions - self.PLACES
        square = (gap * gap).sum(axis=1, keepdims=True)
        return (square / 2 + square**2 / 40).sum(), -gap * (1 + square / 10)

    def astype(self, _dtype):
        return self


def driven_top():
    """An asymmetric body of four sites in Springs."""
    sites = np.array([[2, 0, 0.5], [-1, 1, 0], [0, -2, 1], [0.5, 0, -1]], dtype=LONG)
    bodies = RigidBodies(np.zeros(4, int), LONG([5]), LONG([[7, 5, 3]]), sites)
    q = LONG([[0.5, -0.5, 0.5, 0.5]])
    spin, velocity = LONG([[0.7, -0.4, 0.9]]), LONG([[0.2, 0.1, -0.3]])
    return Problem("driven top", bodies, Springs(), State(LONG([[1, 0, 0]]), velocity, q, spin))


@EVERY
def test_order_on_a_driven_top(splitting):
    top, counts = driven_top(), [n // splitting.stages for n in (600, 1200)]
    exact = reference_state(top, 3.0)
    found = [state_errors(top, exact, states(top, 3.0, splitting, count)[0][0]) for count in counts]
    for get in (lambda e: e.rms_center, lambda e: e.rms_angle):
        errors = list(map(get, found))
        assert slopes(errors, counts)[0] == pytest.approx(splitting.order, abs=0.5)
        assert 1e-13 < errors[1] < 1e-3


def weak_order(splitting, counts):
    """Order of the change of x and v to first order in the force of x'' = -eps sin 2x."""
    end, errors = LONG(4), []
    exact = [(np.sin(2 * end + 1) - np.sin(LONG(1))) / 4 - end * np.cos(LONG(1)) / 2]
    exact.append((np.cos(2 * end + 1) - np.cos(LONG(1))) / 2)
    for steps in counts:
        x, dx, dv, h = LONG(1) / 2, LONG(0), LONG(0), end / steps
        for is_kick, part in steps * splitting.parts:
            if is_kick:
                dv -= part * h * np.sin(2 * x)
            else:
                x, dx = x + part * h, dx + part * h * dv
        errors.append(max(abs(dx - exact[0]), abs(dv - exact[1])))
    return slopes(errors, counts)[0]


@pytest.mark.parametrize("splitting, order", list(zip(SPLITTINGS, (8, 10))), ids=lambda x: getattr(x, "label", x))
def test_order_under_weak_forces(splitting, order):
    """The order of SABA4 is 8, and that of ABA(10,6,4) 10, in the limit of weak forces."""
    assert oscillator_order(splitting) == pytest.approx(splitting.order, abs=0.3)
    assert weak_order(splitting, (8, 12)) == pytest.approx(order, abs=0.5)


def multistep_order(counts=(300, 450)):
    """Orders of positions and orientations of the driven top."""
    top = driven_top()
    exact, errors = reference_state(top, 6.0), []
    for steps in counts:
        off = state_errors(top, exact, multistep.solve(top, 6.0, steps)[0])
        errors.append((off.rms_center, off.rms_angle, abs(off.energy)))
    return [slopes(own, counts)[0] for own in np.transpose(errors)]


def test_order_of_the_multistep_method():
    assert np.allclose(multistep_order(), 8, atol=0.7)
    weights = multistep.adams_moulton(9)
    assert [(weights * np.arange(-8.0, 1.0) ** k).sum() for k in range(9)] == pytest.approx(
        [-((-1) ** (k + 1)) / (k + 1) for k in range(9)], abs=1e-8
    )


# --- motion ---------------------------------------------------------------------------------------
TOPS = [  # round the largest, the smallest axis, near the middle one, and fast
    ((7, 5, 3), (2, 0.3, -0.1)),
    ((7, 5, 3), (0.2, 0.1, -1.5)),
    ((3, 7, 5), (0.1, -0.1, 1.2)),
    ((3, 7, 5), (-40, 30, 20)),
    ((5, 5, 3), (0.3, 1, 0.5)),
    ((3, 5, 5), (0.3, 1, -0.5)),
]


@pytest.mark.parametrize("moments, omega", TOPS)
@pytest.mark.parametrize("time", [-3.0, 1e-3, 0.4, 50.0])
def test_a_free_top_turns_exactly(moments, omega, time):
    sites = np.zeros((1, 3), dtype=LONG)
    q, still = LONG([[0.1, -0.7, 0.1, 0.7]]), np.zeros((1, 3), dtype=LONG)
    start = State(still, still, q, LONG([omega]))
    bodies = RigidBodies(np.zeros(1, int), LONG([1]), LONG([moments]), sites)
    free = Problem("top", bodies, FreeField(), start)
    exact, motion = exact_state(free, time), Motion(free)
    limit = 1e-13 * max(1, np.abs(omega).max() * abs(time))
    motion.drift(time)
    assert np.abs(motion.omega_body - exact.omega_body.astype(float)).max() < limit * np.abs(omega).max()
    assert state_errors(free, exact, motion.state).rms_angle < limit


# --- work -----------------------------------------------------------------------------------------
@EVERY
def test_every_evaluation_is_counted(splitting):
    calls = []

    class Counting(Springs):
        def energy_and_forces(self, positions):
            calls.append(1)
            return super().energy_and_forces(positions)

    found = states(driven_top().with_field(Counting()), 2.0, splitting, 6, every=2)
    assert [evaluations for _, evaluations in found][-1] == len(calls)
    # a step that begins with a kick needs one evaluation before it
    assert len(calls) == 6 * splitting.stages + (len(splitting.kicks) > len(splitting.drifts))
    assert splitting.stages == int(splitting.label.split()[-2])
    (end, _), *_ = states(driven_top(), 2.0, splitting, 6)
    assert (end.packed() == found[-1][0].packed()).all()


def test_the_multistep_method_evaluates_once_per_step(monkeypatch):
    calls, load = [], multistep._History.load
    monkeypatch.setattr(multistep._History, "load", lambda *args: calls.append(1) or load(*args))
    assert multistep.solve(driven_top(), 2.0, 40)[1] == len(calls) == 41
