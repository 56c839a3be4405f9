"""Errors and prices of made-up trials with known answers."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.superposition import angles
from lammps_gearquat.trials import evaluate
from lammps_gearquat.trials.evaluate import Point, price

RNG = np.random.default_rng(3)
OF = np.array([0, 0, 0, 1, 1, 1, 1, 2, 2, 3])  # bodies of 3, 4, 2 and 1 sites
BODIES = Bodies(OF + 1, RNG.uniform(1, 3, 10))
SITES = RNG.normal(size=(10, 3))
LINE = SITES[7] - SITES[8]


def turned(vectors):
    """Sites with each body turned by a rotation vector, and shifted."""
    center = BODIES.center(SITES)
    moved = [
        Rotation.from_rotvec(vectors[b]).apply(x - center[b]) + center[b] + 7.0
        for b, x in zip(OF, SITES)
    ]
    return np.array(moved)


@pytest.mark.parametrize("angle", [0.0, 1e-10, 1e-3, 1.0, 3.0, np.pi])
def test_angle_of_a_known_turn(angle):
    """A body of two sites has only an axis: it is turned about one at a right angle to it."""
    across = np.cross(LINE, [1.0, 0.0, 0.0])
    axes = np.array([[1.0, 0, 0], [0, 0.6, 0.8], across / np.linalg.norm(across), [0, 1.0, 0]])
    measured = angles(BODIES, SITES, turned(angle * axes))
    assert measured[:3] == pytest.approx(angle, abs=2e-15 + 1e-12 * angle)
    assert measured[3] == 0.0


def test_a_turn_about_its_own_line_is_none():
    vectors = np.array([[0.2, 0, 0], [0, 0, 0.2], 0.5 * LINE / np.linalg.norm(LINE), [1, 0, 0]])
    measured = angles(BODIES, np.stack([SITES] * 2), np.stack([turned(vectors)] * 2))
    assert measured == pytest.approx(np.array([[0.2, 0.2, 0.0, 0.0]] * 2), abs=1e-12)


def test_parting_is_where_it_first_happens():
    """Approaching again does not undo a divergence, and a NaN is a divergence."""
    time = np.arange(5.0)
    distance = np.array([0.0, 1.0, 3.0, 0.5, np.nan])
    assert evaluate.parting_time(time, distance, 0.9) == 1.0
    assert evaluate.parting_time(time, distance, 2.9) == 2.0
    assert evaluate.parting_time(time, distance, 3.0) == 4.0
    assert math.isinf(evaluate.parting_time(time[:4], distance[:4], 3.1))


# --- prices -----------------------------------------------------------------------------------------
def curve(order, steps=(0.1, 0.05, 0.025), scale=1.0, floor=0.0, method="m"):
    return [Point(method, dt, 10 / dt, 1e-3 / dt, max(scale * dt**order, floor)) for dt in steps]


def test_price():
    """The coarsest trial that is accurate enough, if there is one."""
    assert price(curve(2), 0.06**2).dt == 0.05 and price(curve(2), 0.5).dt == 0.1 and price(curve(2), 1e-8) is None


def test_the_largest_step_below_which_all_are_good():
    """A coarse trial that is accurate by chance does not count; rounding at fine steps does no harm."""
    lucky = [*curve(2), Point("m", 0.2, 50, 5e-3, 1e-6)]
    assert price(lucky, 0.05**2 * 1.001).dt == pytest.approx(0.05, rel=1e-3)
    rounded = [Point("m", 0.001, 1e4, 1, 2e-3), *curve(2)]
    assert price(rounded, 1e-3).dt == 0.025
