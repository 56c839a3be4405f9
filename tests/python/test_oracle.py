"""The oracle against simpler truths: free motion, conservation, energies the paper prints."""

import numpy as np
import oracle
import pytest

FREE = oracle.Problem(oracle.Body(), oracle.FreeSpace())


def scene(kind):
    return oracle.Problem(oracle.Body(kind), oracle.Cage())


def space_momentum(problem, state):
    """Angular momentum in space axes."""
    return oracle.rotation_space_body(state[6:10]) @ (problem.body.moments * state[10:13])


def test_moments_are_those_of_the_paper():
    moments = oracle.Body().moments
    assert moments == pytest.approx([1635, 1625.70868293, 81.29131707], abs=1e-8)
    assert moments != pytest.approx([1635, 1625.70868293 * 1.01, 81.29131707], abs=1e-8)


def test_rotation_matrix_is_eq_8_as_corrected():
    q = np.array([0.1, -0.3, 0.5, 0.8])
    q1, q2, q3, q4 = q / np.linalg.norm(q)
    space_to_body = 2 * np.array(
        [
            [q1**2 + q4**2 - 0.5, q1 * q2 + q3 * q4, q1 * q3 - q2 * q4],
            [q1 * q2 - q3 * q4, q2**2 + q4**2 - 0.5, q2 * q3 + q1 * q4],
            [q1 * q3 + q2 * q4, q2 * q3 - q1 * q4, q3**2 + q4**2 - 0.5],
        ]
    )
    found = oracle.rotation_space_body(q / np.linalg.norm(q)).T
    assert found == pytest.approx(space_to_body, abs=1e-15)


def test_forces_are_the_gradient_of_the_energy():
    cage, problem = oracle.Cage(), scene("consistent")
    positions = problem.site_positions(problem.start(1))
    _, forces = cage.energy_and_forces(positions)
    h = 1e-5
    for site in range(4):
        for axis in range(3):
            energy = []
            for sign in (1, -1):
                moved = positions.copy()
                moved[site, axis] += sign * h
                energy.append(cage.energy_and_forces(moved)[0])
            slope = -(energy[0] - energy[1]) / (2 * h)
            assert slope == pytest.approx(forces[site, axis], rel=1e-6, abs=1e-9)


def test_cage_is_neutral_and_odd():
    cage = oracle.Cage()
    assert cage.charges.sum() == 0 and len(cage.charges) == 26
    for position, charge in zip(cage.positions, cage.charges):
        mirror = (cage.positions == -position).all(axis=1)
        assert cage.charges[mirror] == -charge


@pytest.mark.parametrize("kind", ["consistent", "unrotated"])
@pytest.mark.parametrize("case, energy", [(1, -0.72360304), (3, 3.99270832)])
def test_initial_energy(kind, case, energy):
    problem = scene(kind)
    assert sum(problem.energies(problem.start(case))) == pytest.approx(energy, abs=5e-9)


def test_free_top_keeps_energy_and_momentum():
    start = FREE.start(1)
    times = [0.0, 100.0, 400.0]
    for time, state in zip(times, FREE.integrate(start, times)):
        assert sum(FREE.energies(state)) == pytest.approx(sum(FREE.energies(start)), rel=1e-10)
        found, expected = space_momentum(FREE, state), space_momentum(FREE, start)
        assert found == pytest.approx(expected, rel=1e-9)
        assert state[:3] == pytest.approx(start[:3] + start[3:6] * time)


def test_spin_about_a_principal_axis_is_uniform():
    state = FREE.start(1)
    state[6:10], state[10:13] = [0, 0, 0, 1], [0, 0, 0.1]
    end = FREE.integrate(state, [0.0, 10.0])[-1]
    assert end[6:10] == pytest.approx([0, 0, np.sin(0.5), np.cos(0.5)], abs=1e-11)
    assert end[6:10] != pytest.approx([0, 0, np.sin(0.505), np.cos(0.505)], abs=1e-11)


def test_symmetric_top_precesses_at_its_rate():
    body = oracle.Body()
    body.moments = np.array([2.0, 2.0, 1.0])
    top = oracle.Problem(body, oracle.FreeSpace())
    state = top.start(1)
    state[10:13] = [0.3, 0.0, 0.8]
    end = top.integrate(state, [0.0, 20.0])[-1]
    rate = (2.0 - 1.0) / 2.0 * 0.8  # omega_x' = +rate omega_y, omega_y' = -rate omega_x
    expected = [0.3 * np.cos(rate * 20), -0.3 * np.sin(rate * 20), 0.8]
    assert end[10:13] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize("kind", ["consistent", "unrotated"])
def test_energy_in_the_cage(kind):
    problem = scene(kind)
    states = problem.integrate(problem.start(1), [0.0, 100.0, 200.0])
    for state in states:
        assert sum(problem.energies(state)) == pytest.approx(-0.72360304004821, abs=1e-10)


REFERENCE = [  # extended precision, from the notes on the paper
    (1, "consistent", 100, (85.43010788464767, -1.784299103660877, 1.14360193088973)),
    (1, "consistent", 200, (85.56573248988141, -6.06135624295223, 6.86227956266460)),
    (1, "unrotated", 100, (86.693409428, -1.437897239, 0.844779738)),
    (1, "unrotated", 200, (84.82167549249749, -5.03225661408319, 7.72730548267065)),
    (3, "consistent", 200, (74.503045115, 0.054749072, 0.083234521)),
]


@pytest.mark.parametrize("case, kind, time, centre", REFERENCE)
def test_reference_trajectory(case, kind, time, centre):
    problem = scene(kind)
    end = problem.integrate(problem.start(case), [0.0, float(time)])[-1]
    assert np.linalg.norm(end[:3] - centre) < 1e-9
    wrong = problem.start(case)
    wrong[10] *= 1.01
    assert np.linalg.norm(problem.integrate(wrong, [0.0, float(time)])[-1][:3] - centre) > 1e-9
