"""Collisions compared with other solvers: forces of the scenes, correct counts, and the arithmetic of the ratios."""

import numpy as np
import pytest

from benchmarks.reference.equations import PARTS, State
from benchmarks.studies import collisions as study
from benchmarks.studies.collisions.scene import Scene


# --- the scenes -------------------------------------------------------------------------------------
def near(scene, random):
    """A packed state with the bodies at a distance of 3, at random velocities and unit quaternions."""
    y = random.normal(size=(2, 13))
    y[:, PARTS["q"]] /= np.linalg.norm(y[:, PARTS["q"]], axis=1, keepdims=True)
    y[:, PARTS["center"]] = [[1.5, 0.3, 0.0], [-1.5, 0.0, 0.2]]
    return y


def power(scene, y, rates, d=1e-5):
    """Rate of change of the energy by differences, and of its potential part alone."""
    there, back = (scene.energies(State.of(y + s * d * rates)) for s in (1, -1))
    change = (there - back) / (2 * d)
    return change.sum(), abs(change[0])


@pytest.mark.parametrize("which", [0, 1, 4, 7])
def test_forces_are_those_of_the_energy(which):
    scene, random = Scene(which), np.random.default_rng(which)
    for _ in range(6):
        y = near(scene, random)
        change, size = power(scene, y, scene.rates(0.0, y))
        assert abs(change) < 1e-6 * size


# --- counts -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("energy", study.OURS.values())
def test_every_evaluation_under_a_tolerance_is_counted(energy):
    scene = Scene(6)
    met = scene.follow(1e-6, energy)
    assert met.evaluations == 1 + met.steps + met.repeated
    # the energy after a step is the other call of the forces, which no run needs
    assert scene.calls == met.evaluations + met.steps
    assert met.repeated > 0
    finer = scene.follow(1e-8, energy)
    assert finer.error < met.error / 5 and finer.evaluations > met.evaluations


# --- ratios -----------------------------------------------------------------------------------------
def curve(work, order=8, errors=10.0 ** np.arange(-3, -13, -2.0)):
    """Points of a method of an ``order`` that needs ``work`` evaluations for an error of 1."""
    return np.stack([work * errors ** (-1 / order), errors], axis=-1)


def test_evaluations_are_interpolated_between_the_best_points():
    exact = 100 * study.LEVELS ** (-1 / 8)
    points = curve(100.0)
    assert study.evaluations(points) == pytest.approx(exact, rel=1e-12)
    worse = [[1e6, 1e-5], [5e3, np.nan], [3e2, 4.0]]
    assert study.evaluations(np.concatenate([worse, points[::-1]])) == pytest.approx(exact, rel=1e-12)
    assert study.evaluations(curve(101.0)) == pytest.approx(1.01 * exact, rel=1e-12)
    short = study.evaluations(points[:3])  # to 1e-7 only
    assert np.isfinite(short[:2]).all() and np.isinf(short[2:]).all()
    assert study.evaluations(points, np.array([1.0])) == pytest.approx(points[0, 0])
    assert np.isinf(study.evaluations(np.full((4, 2), np.nan))).all()
