"""Known rotations are found, for bodies of any kind; the principal frame depends only on the bodies."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.superposition import rotate, shortest_turn, superpose

RNG = np.random.default_rng(5)


def bodies_of(counts, stretch=(1, 1, 1), seed=2):
    """Bodies of random sites."""
    rng = np.random.default_rng(seed)
    numbers = np.repeat(np.arange(len(counts)) + 1, counts)
    bodies = Bodies(numbers, rng.uniform(1, 5, len(numbers)))
    bodies.set_shape(rng.normal(size=(len(numbers), 3)) * stretch)
    return bodies


def turned(bodies, rotation):
    return rotation[bodies.of].apply(bodies.shape)


def angle(q, rotation):
    """Angles between quaternions and rotations; q and -q are equal."""
    return (Rotation.from_quat(q, scalar_first=True) * rotation.inv()).magnitude()


@pytest.mark.parametrize(
    "stretch", [(1, 1, 1), (1, 1, 0), (0.05, 0.05, 1), (1, 0.05, 0), (3e-3, 3e-3, 1)]
)
def test_known_rotations_are_found(stretch):
    bodies = bodies_of(np.arange(300) % 5 + 4, stretch)
    rotation = Rotation.random(300, RNG)
    q, residual = superpose(bodies, turned(bodies, rotation))
    assert angle(q, rotation).max() < 1e-12
    assert residual.max() < 1e-13
    assert np.linalg.norm(q, axis=1) == pytest.approx(np.ones(300), abs=1e-14)
    assert q[:, 0].min() >= 0.0


@pytest.mark.parametrize("turn", [0.0, 1e-9, np.pi - 1e-9, np.pi])
def test_small_and_half_turns(turn):
    bodies = bodies_of([4] * 50)
    axes = RNG.normal(size=(50, 3))
    rotation = Rotation.from_rotvec(turn * axes / np.linalg.norm(axes, axis=1, keepdims=True))
    q, _ = superpose(bodies, turned(bodies, rotation))
    assert angle(q, rotation).max() < 1e-13


def test_the_rotation_is_the_best_one():
    """For sites that are not rigid: all small further rotations increase the weighted squares."""
    bodies = bodies_of([5] * 40)
    arms = turned(bodies, Rotation.random(40, RNG)) + 0.2 * RNG.normal(size=(200, 3))
    arms -= bodies.center(arms)[bodies.of]

    def squares(q):
        return bodies.sum(bodies.masses * ((arms - rotate(q[bodies.of], bodies.shape)) ** 2).sum(1))

    q, residual = superpose(bodies, arms)
    assert residual.min() > 1e-3
    for axis in np.vstack([np.eye(3), -np.eye(3)]):
        other = Rotation.from_rotvec(1e-3 * axis) * Rotation.from_quat(q, scalar_first=True)
        assert (squares(other.as_quat(scalar_first=True)) > squares(q)).all()
    # and it agrees with SciPy's different method, body by body
    for b in range(40):
        own = bodies.of == b
        best, _ = Rotation.align_vectors(arms[own], bodies.shape[own], bodies.masses[own])
        assert angle(q[b : b + 1], best).max() < 1e-12


def test_no_mirror_image():
    bodies = bodies_of([4] * 20)
    q, residual = superpose(bodies, bodies.shape * [-1, 1, 1])
    matrices = Rotation.from_quat(q, scalar_first=True).as_matrix()
    assert np.linalg.det(matrices) == pytest.approx(np.ones(20))
    assert residual.min() > 0.01


@pytest.mark.parametrize("site", range(4))
def test_residual_sees_a_site_out_of_place(site):
    bodies = bodies_of([4])
    arms = turned(bodies, Rotation.random(1, RNG))
    arms[site] *= 1.01
    arms -= bodies.center(arms)[bodies.of]
    assert superpose(bodies, arms)[1][0] > 1e-3


def test_linear_bodies_and_points():
    """For a linear body the axis is found, without a rotation about it; a point is not turned."""
    bodies = bodies_of([3, 1, 2, 5], (0, 0, 1))
    assert bodies.linear.tolist() == [True, False, True, True]
    assert bodies.point.tolist() == [False, True, False, False]
    rotation = Rotation.random(4, RNG)
    arms = turned(bodies, rotation)
    q, residual = superpose(bodies, arms)
    assert residual.max() < 1e-14
    assert rotate(q[bodies.of], bodies.shape) == pytest.approx(arms, abs=1e-14)
    assert q[1].tolist() == [1, 0, 0, 0]
    across = Rotation.from_quat(q, scalar_first=True).as_rotvec()[:, 2]
    assert across == pytest.approx(np.zeros(4), abs=1e-14)
    q, residual = superpose(bodies, -bodies.shape)
    assert residual.max() < 1e-14


def test_shortest_turn_of_opposite_directions():
    before = np.vstack([np.eye(3), [[0.6, 0.8, 0.0]]])
    q = shortest_turn(before, -before)
    assert rotate(q, before) == pytest.approx(-before, abs=1e-15)


def test_inertia_is_that_of_the_sites():
    """Compared with the direct sum, body by body."""
    bodies = bodies_of([3, 6, 4])
    bodies.set_shape(bodies.shape, principal=True)
    for b in range(3):
        own = bodies.of == b
        arms, masses = bodies.shape[own], bodies.masses[own]
        tensor = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, arms))
        assert tensor == pytest.approx(np.diag(bodies.moments[b]), abs=1e-13)
        assert tensor != pytest.approx(1.01 * np.diag(bodies.moments[b]), rel=1e-3)
        assert (np.diff(bodies.moments[b]) <= 0).all()


def test_principal_frame_does_not_depend_on_the_pose():
    bodies = bodies_of([4] * 30)
    again = bodies_of([4] * 30)
    bodies.set_shape(bodies.shape, principal=True)
    moved = turned(again, Rotation.random(30, RNG)) + 7.0
    again.set_shape(moved, principal=True)
    assert again.shape == pytest.approx(bodies.shape, abs=1e-12)


def test_bodies_of_atoms_in_any_order():
    bodies = Bodies([0, 2, 1, 2, 0, 1], [9.0, 1.0, 2.0, 3.0, 9.0, 4.0])
    assert bodies.ids.tolist() == [1, 2] and bodies.index.tolist() == [2, 5, 1, 3]
    assert bodies.mass.tolist() == [6.0, 4.0] and bodies.counts.tolist() == [2, 2]


@pytest.mark.parametrize(
    ("numbers", "masses", "text"),
    [([0, 0], [1, 1], "no atom is in a body"), ([1, 2], [1, 0], "body 2 has no mass")],
)
def test_impossible_bodies(numbers, masses, text):
    with pytest.raises(ValueError, match=text):
        Bodies(numbers, masses)
