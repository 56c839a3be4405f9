"""Poses recovered from positions: synthetic ones, and dumps of the scenes read by MDAnalysis."""

import numpy as np
import oracle
import pytest

from lammps_gearquat import pose

MASSES = oracle.MASSES
SHAPE = oracle.Body().sites_body


def rotation(seed):
    rng = np.random.default_rng(seed)
    q = rng.normal(size=4)
    return oracle.rotation_space_body(q / np.linalg.norm(q))


@pytest.mark.parametrize("seed", range(5))
def test_superposition_finds_a_known_pose(seed):
    centre, turn = np.array([84.0, -3.0, 7.0]), rotation(seed)
    found = pose.superpose(MASSES, SHAPE + [5, 5, 5], centre + SHAPE @ turn.T)
    assert found.rotation == pytest.approx(turn, abs=1e-14)
    assert found.centre == pytest.approx(centre, abs=1e-13)
    assert found.residual < 1e-12
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)


def test_superposition_gives_no_mirror_image():
    planar = SHAPE * [1, 1, 0]
    found = pose.superpose(MASSES, planar, planar * [-1, 1, 1])
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)


@pytest.mark.parametrize("site", range(4))
def test_residual_sees_a_site_out_of_place(site):
    positions = SHAPE @ rotation(1).T
    positions[site] *= 1.01
    assert pose.superpose(MASSES, SHAPE, positions).residual > 1e-3


def test_rigid_motion_finds_a_known_motion():
    body = oracle.Body()
    turn, velocity, omega = rotation(2), np.array([0.2, 0.1, -0.3]), np.array([0.02, -0.04, 0.03])
    arms = SHAPE @ turn.T
    velocities = velocity + np.cross(turn @ omega, arms)
    found = pose.rigid_motion(MASSES, arms + 50.0, velocities)
    assert found.velocity == pytest.approx(velocity, abs=1e-15)
    assert found.omega_space == pytest.approx(turn @ omega, abs=1e-14)
    assert found.residual < 1e-13
    assert found.translation == pytest.approx(32.0 * velocity @ velocity, rel=1e-13)
    assert found.rotation == pytest.approx(0.5 * body.moments @ omega**2, rel=1e-12)
    velocities[0] *= 1.01
    assert pose.rigid_motion(MASSES, arms, velocities).residual > 1e-6


@pytest.fixture(params=["first", "second", "rigid"])
def dumped(request, run_case, tmp_path):
    """Thermo series and dumped body of the same steps of test case 1."""
    found = run_case(1, formulation=request.param, dt=0.01, steps=5000, every=1000, dump=1000)
    bodies = pose.read_bodies(tmp_path / "poses.dump")
    assert list(bodies) == [1]
    return found, bodies[1]


def test_dump_is_read_in_double_precision(dumped):
    values, body = dumped
    assert body.step.tolist() == values.step.tolist() == [0, 1000, 2000, 3000, 4000, 5000]
    assert body.masses.tolist() == MASSES.tolist()
    centre = pose.centre_of_mass(body.masses, body.positions)
    assert centre == pytest.approx(values.centre, abs=1e-12)


def test_dumped_body_is_rigid(dumped):
    _, body = dumped
    for positions in body.positions:
        assert pose.superpose(body.masses, body.positions[0], positions).residual < 1e-12
        # whatever the start was: the shape is that of the paper
        assert pose.superpose(body.masses, SHAPE, positions).residual < 1e-12
    bent = body.positions[-1] + [[0, 0, 0], [0, 0, 0], [0, 0, 0], [1e-10, 0, 0]]
    assert pose.superpose(body.masses, body.positions[0], bent).residual > 1e-12


def test_dumped_kinetic_energies_are_those_of_the_fix(dumped):
    values, body = dumped
    for k in range(len(body.step)):
        motion = pose.rigid_motion(body.masses, body.positions[k], body.velocities[k])
        assert motion.residual < 1e-12
        assert motion.translation == pytest.approx(values.translation[k], rel=1e-11)
        assert motion.rotation == pytest.approx(values.rotation[k], rel=1e-11)
        assert motion.rotation != pytest.approx(values.rotation[k] * 1.01, rel=1e-11)


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_energy_belongs_to_the_dumped_pose(run_case, tmp_path, formulation):
    """Potential energy of the dumped sites, computed anew, is the one that thermo prints."""
    steps = {"dt": 0.05, "steps": 1000, "every": 100, "dump": 100}
    values = run_case(1, formulation=formulation, **steps)
    body = pose.read_bodies(tmp_path / "poses.dump")[1]
    cage = oracle.Cage()
    for k, positions in enumerate(body.positions):
        energy, forces = cage.energy_and_forces(positions)
        # what is left is of second order in corrected - predicted
        assert values.potential[k] == pytest.approx(energy, abs=1e-8)
        turned = positions + [1e-4, 0, 0]
        assert values.potential[k] != pytest.approx(cage.energy_and_forces(turned)[0], abs=1e-8)


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_pose_is_that_of_the_oracle(run_case, tmp_path, formulation):
    """Recovered centre and rotation against the independent integrator."""
    run_case(1, formulation=formulation, dt=0.02, steps=5000, every=5000, dump=5000)
    body = pose.read_bodies(tmp_path / "poses.dump")[1]
    problem = oracle.Problem(oracle.Body(), oracle.Cage())
    state = problem.integrate(problem.start(1), [0.0, 100.0])[-1]
    found = pose.superpose(body.masses, SHAPE, body.positions[-1])
    assert found.centre == pytest.approx(state[:3], abs=1e-7)
    assert found.rotation == pytest.approx(oracle.rotation_space_body(state[6:10]), abs=1e-7)
