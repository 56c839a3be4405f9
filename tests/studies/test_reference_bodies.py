"""Bodies, equations and cage of the reference solution compared with simpler results, in long double."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.reference import FreeField, Problem, bodies_from_sites, paper_problem
from benchmarks.reference import quaternion as qt
from benchmarks.reference.equations import principal_axes

LONG = np.longdouble
MARGIN = 4e-18  # of the size of a result: some 40 roundings of a long double


def random(*shape):
    return np.random.default_rng(7).normal(size=shape).astype(LONG)


def random_rotations(count):
    return qt.rotation_space_body(qt.normalised(random(count, 4)))


def test_rotation_matrix_is_that_of_scipy():
    q = qt.normalised(random(4))
    assert np.abs(qt.rotation_space_body(q) - Rotation.from_quat(q.astype(float)).as_matrix()).max() < 1e-15
    assert np.abs(qt.rotation_space_body(3 * q) - qt.rotation_space_body(q)).max() < MARGIN


@pytest.mark.parametrize("angle", [1e-12, 0.3, 3.0])
def test_angle_between_orientations(angle):
    half, q = LONG(angle) / 2, qt.normalised(random(4))
    turned = qt.product(q, np.array([0, np.sin(half), 0, np.cos(half)]))
    for sign in (1, -1):
        assert abs(qt.angle_between(sign * turned, q) / LONG(angle) - 1) < 1e-6


def test_principal_axes_to_the_last_digits():
    """Tensors of known moments, which may be equal or widely different."""
    moments = [[3, 2, 1], [2, 2, 1], [2, 1, 1], [1, 1, 1], [1e6, 1, 1e-2]]
    moments, turns = np.array(moments, dtype=LONG), random_rotations(5)
    tensors = np.einsum("bij,bj,bkj->bik", turns, moments, turns)
    found, axes = principal_axes((tensors + np.swapaxes(tensors, 1, 2)) / 2)
    error = np.abs(found - moments).max(axis=1) / moments.max(axis=1)
    assert (error < MARGIN).all()
    again = np.einsum("bij,bj,bkj->bik", axes, found, axes)
    assert (np.abs(again - tensors).max(axis=(1, 2)) < MARGIN * moments.max(axis=1)).all()
    assert np.abs(np.linalg.det(axes.astype(float)) - 1).max() < 1e-14


def test_bodies_from_sites_give_the_sites_back():
    masses, body = np.array([16, 1, 1, 5, 4, 3, 2.0]), np.array([0, 0, 0, 1, 1, 1, 1])
    positions, omega, drift = random(7, 3), random(2, 3), random(2, 3)
    velocities = drift[body] + qt.cross(omega[body], positions)
    bodies, start = bodies_from_sites(masses, positions, velocities, body)
    problem = Problem("two bodies", bodies, FreeField(), start)
    assert np.abs(problem.site_positions(start) - positions).max() < 4 * MARGIN
    rotation = qt.rotation_space_body(start.q)
    omega_space = (rotation * start.omega_body[:, None, :]).sum(axis=2)
    assert np.abs(omega_space - omega).max() < 20 * MARGIN
    energy = sum(problem.energies(start))
    assert energy == pytest.approx(0.5 * (masses[:, None] * velocities**2).sum(), rel=1e-17)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_points_and_lines_are_refused(count):
    sites = np.outer(range(count), [1, 2, 3])
    with pytest.raises(ValueError, match="body 0 is a point or a line: every body needs three"):
        bodies_from_sites(np.ones(count), sites, 0 * sites, np.zeros(count, dtype=int))


def test_moments_are_those_the_paper_prints():
    moments = paper_problem(1).bodies.moments[0].astype(float)
    assert moments == pytest.approx([1635, 1625.70868293, 81.29131707], abs=1e-8)


@pytest.mark.parametrize("case, energy", [(1, -0.72360304004821), (2, -0.72360304), (3, 3.99270832)])
def test_initial_energy(case, energy):
    """The values agree with the notes on the paper."""
    problem = paper_problem(case)
    found = float(sum(problem.energies(problem.start)))
    assert found == pytest.approx(energy, abs=1e-13 if case == 1 else 5e-9)


def test_forces_are_the_gradient_of_the_energy():
    problem = paper_problem(1)
    positions, h = problem.site_positions(problem.start), LONG(1e-4)
    _, forces = problem.field.energy_and_forces(positions)
    slope = np.zeros_like(forces)
    for index in np.ndindex(forces.shape):
        for steps, twelfths in ((1, -8), (-1, 8), (2, 1), (-2, -1)):
            moved = positions.copy()
            moved[index] += steps * h
            slope[index] += twelfths * problem.field.energy_and_forces(moved)[0] / (12 * h)
    assert np.abs(slope - forces).max() < 1e-13
