"""Mean squares and correlations of known motions, compared with direct sums."""

from support import dumps
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import directions
from gearquat_analysis import Poses, correlations, open_dump

RNG = np.random.default_rng(8)
FRAMES, BODIES = 40, 7


@pytest.fixture(params=[1_000_000, 100], ids=["at once", "in portions"])
def held(request, monkeypatch):
    monkeypatch.setattr(correlations, "HELD", request.param)


def directly(function, *arrays):
    """Mean over origins and bodies of function(x(t), x(t + lag))."""
    return np.array(
        [np.mean([function(a[: FRAMES - k], a[k:]) for a in arrays]) for k in range(FRAMES)]
    )


def square(a, b):
    return ((b - a) ** 2).sum(axis=-1)


def test_displacement_of_a_straight_motion(held):
    """The mean square is v^2 t^2, far from the origin."""
    velocity = RNG.normal(size=(BODIES, 3))
    time = 0.1 * np.arange(FRAMES)
    center = 1e4 + velocity * time[:, None, None]
    found = correlations.mean_square_displacement(center)
    expected = (velocity**2).sum(axis=1).mean() * time**2
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-10)


def test_displacement_of_any_motion(held):
    center = RNG.normal(size=(FRAMES, BODIES, 3)).cumsum(axis=0)
    found = correlations.mean_square_displacement(center)
    assert found == pytest.approx(directly(square, center), rel=1e-12, abs=1e-12)


def test_autocorrelation_of_any_motion(held):
    v = RNG.normal(size=(FRAMES, BODIES, 3)).cumsum(axis=0)
    expected = directly(lambda a, b: (a * b).sum(axis=-1), v)
    assert correlations.autocorrelation(v) == pytest.approx(expected, rel=1e-11, abs=1e-11)


def rotating(omega, angle=0.2):
    """Quaternions (F, B, 4) of even rotations from random orientations; and the angle per frame."""
    omega = omega / np.linalg.norm(omega, axis=1, keepdims=True) * angle
    start = Rotation.random(len(omega), RNG)
    turns = [Rotation.from_rotvec(k * omega) * start for k in range(FRAMES)]
    return np.array([turn.as_quat(scalar_first=True) for turn in turns]), start, omega


def test_rotation_is_not_bounded(held):
    """Even rotation: (omega t)^2, over several turns, whatever the signs of the quaternions."""
    q, _, _ = rotating(RNG.normal(size=(BODIES, 3)), 0.9)
    q[::3] *= -1.0
    found, largest = correlations.mean_square_rotation(q)
    expected = (0.9 * np.arange(FRAMES)) ** 2
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10)
    assert largest == pytest.approx(0.9, rel=1e-12)


@pytest.mark.parametrize(("moments", "first", "number"), [([3, 2, 2], 1, 3), ([3, 3, 1], 0, 3), ([2, 2, 2], 0, 6)])
def test_directions_stand_for_all(moments, first, number):
    """P1 and P2 of few directions agree with many directions in the plane (or space) of axes with equal moments."""
    q, _, _ = rotating(RNG.normal(size=(BODIES, 3)))
    few = directions(np.tile(moments, (BODIES, 1)), np.tile(np.eye(3), (BODIES, 1, 1)), first)
    assert few.shape == (number, BODIES, 3) and np.linalg.norm(few, axis=2) == pytest.approx(np.ones((number, BODIES)))
    azimuth = 2.0 * np.pi * np.arange(16) / 16
    circle = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    # in space: a rule of Gauss along the third axis, exact for polynomials of degree 15
    heights, weights = np.polynomial.legendre.leggauss(8) if number == 6 else ([0.0], [1.0])
    for order in (1, 2):
        found, expected = correlations.orientation_correlation(q, few, order), np.zeros(FRAMES)
        for z, weight in zip(heights, np.array(weights) / np.sum(weights)):
            for x, y in circle * np.sqrt(1.0 - z**2):
                u = np.roll([x, y, z], first)
                expected += weight / 16 * correlations.orientation_correlation(q, u, order)
        assert found == pytest.approx(expected, abs=1e-12)


def test_orientation_of_an_even_rotation(held):
    """About an axis at an angle a to u: cos = cos^2 a + sin^2 a cos(omega t)."""
    q, start, omega = rotating(RNG.normal(size=(BODIES, 3)))
    axis = np.array([0.3, -0.2, 2.0])
    u = start.apply(axis / np.linalg.norm(axis))
    along = (u * omega).sum(axis=1) ** 2 / (omega**2).sum(axis=1)
    cosine = along + (1.0 - along) * np.cos(0.2 * np.arange(FRAMES))[:, None]
    first, second = (correlations.orientation_correlation(q, axis, order) for order in (1, 2))
    assert first == pytest.approx(cosine.mean(axis=1), abs=1e-13)
    assert second == pytest.approx((1.5 * cosine**2 - 0.5).mean(axis=1), abs=1e-13)


def test_rotation_of_linear_bodies_is_that_of_their_axes(tmp_path):
    """A dumbbell that turns across its axis turns like any body; the axis of a point is never used."""
    motion = dumps.Motion([2, 2, 3], linear=[0, 1, 2])
    axis = motion.turns(0.0).apply([0, 0, 1])
    motion.omega -= axis * (axis * motion.omega).sum(axis=1, keepdims=True)
    motion.omega *= 0.5 / np.linalg.norm(motion.omega, axis=1, keepdims=True)
    path = dumps.write(tmp_path / "linear.dump", motion, np.arange(30.0))
    poses = Poses(open_dump(path).atoms).run()
    every = correlations.all_correlations(poses)
    assert every.kinds == ("(T1)2-1", "(T1)2-2", "(T1)3")
    assert every.largest_turn == pytest.approx(0.5, rel=1e-10)
    for found in map(every.of_kind, every.kinds):
        assert found["mean_square_rotation"] == pytest.approx((0.5 * np.arange(30)) ** 2, abs=1e-9)
        assert found["axis3_order1"] == pytest.approx(np.cos(0.5 * np.arange(30)), abs=1e-12)
        assert "axis1_order1" not in found


def test_what_cannot_be_correlated():
    with pytest.raises(ValueError, match="frames that are evenly spaced in time"):
        correlations.lags([0.0, 1.0, 3.0])
    assert correlations.lags([2.0, 2.5, 3.0]).tolist() == [0.0, 0.5, 1.0]
    q = np.tile([1.0, 0, 0, 0], (3, 1, 1))
    with pytest.raises(ValueError, match="order 3: 1 or 2 is required"):
        correlations.orientation_correlation(q, [0, 0, 1], 3)
    with pytest.raises(ValueError, match="an axis must not have zero length"):
        correlations.orientation_correlation(q, [0, 0, 0])


def test_times_of_frames():
    """Times of formats in single precision count as even; the message names a repeated frame."""
    single = (1e3 + 0.01 * np.arange(400)).astype(np.float32)
    assert correlations.lags(single)[-1] == pytest.approx(3.99, abs=1e-3)
    for time in ([0.0, 1.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 1.01, 2.0, 3.0, 4.0]):
        with pytest.raises(ValueError, match="after frame 1 at 1 is 1"):
            correlations.lags(time)
