"""gearquat scatter: the choice of flights."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.units import UNITS
from lammps_gearquat.scatter import Plan
from lammps_gearquat.scatter.integrals import weights
from lammps_gearquat.scatter.sampling import REPLICAS, uniform

N = 4096


def made_up_pair():
    """An asymmetric body and a linear one, not along the axes of space."""
    shape = np.array([[1.0, 0.0, 0.3], [-0.5, 0.8, 0.0], [0.0, -0.7, -0.4], [2.0, 2.1, 2.2], [2.3, 2.0, 2.8]])
    bodies = Bodies([1, 1, 1, 2, 2], [1.0, 2.0, 3.0, 1.0, 4.0])
    bodies.set_shape(shape)
    mass = float(np.prod(bodies.mass) / bodies.mass.sum())
    return SimpleNamespace(bodies=bodies, reduced_mass=mass, units=UNITS["lj"], reach=9.0, freedoms=[3, 2])


@pytest.fixture(scope="module")
def drawn():
    pair = made_up_pair()
    return pair, Plan((3,), (2.0,), None, 0.5, 4.0).starts(pair, range(N))


def near(values, expected, digits=0.02):
    assert np.mean(values, axis=0) == pytest.approx(expected, abs=digits)


def test_a_flight_depends_on_its_number_only():
    every = uniform((5,), np.arange(300), 6)
    some = np.array([299, 7, 8, 150])
    assert (uniform((5,), some, 6) == every[some]).all()
    assert not (uniform((6,), some, 6) == every[some]).any()
    assert 0.0 < every.min() and every.max() < 1.0


@pytest.mark.parametrize("temperatures", [(2.0,), (1.0, 2.0, 3.0)])
def test_a_start_does_not_depend_on_those_beside_it(temperatures):
    """Starts agree to the last digit."""
    pair, plan = made_up_pair(), Plan((3,), temperatures, None, None, 4.0, 2.0, 3.0, 0.5)
    every = plan.starts(pair, range(40))
    for number in range(40):
        (b, energy, start), (own_b, own_energy, own) = every[number], plan.starts(pair, [number])[0]
        assert (b, energy) == (own_b, own_energy)
        for part in ("center", "velocity", "quaternion", "momentum"):
            assert (getattr(start, part) == getattr(own, part)).all(), part


def test_every_sequence_is_even():
    """Each of 16 intervals has one of 16 points, in every dimension of every sequence."""
    points = uniform((5,), np.arange(16 * REPLICAS), 6).reshape(16, REPLICAS, 6)
    assert (np.sort((points * 16).astype(int), axis=0) == np.arange(16)[:, None, None]).all()


def test_impact_parameters_and_energies(drawn):
    """Without pilots b is uniform over the area, and x has the density 0.2, 0.4 and 0.4 of x, x^2 and x^3 exp(-x)."""
    _, flights = drawn
    b, energy = np.array([flight[:2] for flight in flights]).T
    near((b / 4.0) ** 2, 1 / 2, 1e-3)
    near((b / 4.0) ** 4, 1 / 3, 1e-3)
    x = energy / 2.0
    near(np.column_stack([x, x**2]), [0.4 + 1.2 + 1.6, 1.2 + 4.8 + 8.0], 0.03)


def test_rotation_at_each_of_several_temperatures():
    """Every flight has a temperature of rotation, and weights make averages right at all temperatures."""
    pair, plan = made_up_pair(), Plan((3,), (1.0, 2.0), None, None, 4.0)
    facts = SimpleNamespace(style="lj", freedoms=[3, 2])
    flights = plan.starts(pair, range(N))
    b, energy = np.array([flight[:2] for flight in flights]).T
    momentum = np.array([flight[2].momentum for flight in flights])
    rotation = np.zeros((2, N))
    for k in range(2):
        turn = Rotation.from_quat([flight[2].quaternion[k] for flight in flights], scalar_first=True)
        along, inertia = turn.inv().apply(momentum[:, k]) @ pair.bodies.axes[k].T, pair.bodies.moments[k]
        rotation[k] = 0.5 * (along[:, inertia > 0.0] ** 2 / inertia[inertia > 0.0]).sum(axis=1)
    columns = {"b": b, "energy": energy, "rotation_1": rotation[0], "rotation_2": rotation[1]}
    for temperature in (1.0, 2.0):
        # of 1, x, and the rotation of both over the flux x exp(-x)
        area = weights(columns, plan, facts, temperature) / (16.0 * np.pi)
        wanted = np.column_stack([np.ones(N), energy / temperature, *(rotation / temperature)])
        near(area[:, None] * wanted, [1.0, 2.0, 1.5, 1.0], 0.03)
    # without the mixture of both temperatures they would be wrong
    wrong = weights(columns, replace(plan, rotation=1.0), facts, 2.0) / (16.0 * np.pi)
    assert abs(np.mean(wrong * rotation[0] / 2.0) - 1.5) > 0.1


def test_the_frame_is_that_of_the_center_of_mass(drawn):
    pair, flights = drawn
    for b, energy, start in flights[:50]:
        mass = pair.bodies.mass[:, None]
        assert np.abs((mass * start.center).sum(axis=0)).max() < 1e-14
        assert np.abs((mass * start.velocity).sum(axis=0)).max() < 1e-14
        away, relative = start.center[1] - start.center[0], start.velocity[1] - start.velocity[0]
        assert np.linalg.norm(away) == pytest.approx(9.0) and away[2] < 0.0 and away[0] == pytest.approx(b)
        assert relative[:2] == pytest.approx(0.0, abs=0.0)
        assert 0.5 * pair.reduced_mass * relative[2] ** 2 == pytest.approx(energy)


def test_orientations_and_rotation(drawn):
    """All directions are alike, and every axis with inertia has kT/2."""
    pair, flights = drawn
    q = np.array([flight[2].quaternion for flight in flights])
    momentum = np.array([flight[2].momentum for flight in flights])
    for k in range(2):
        turn = Rotation.from_quat(q[:, k], scalar_first=True)
        near(turn.as_matrix(), np.zeros((3, 3)))
        near(turn.as_matrix() ** 2, np.full((3, 3), 1 / 3), 0.01)
        along = turn.inv().apply(momentum[:, k]) @ pair.bodies.axes[k].T
        near(along**2, pair.bodies.moments[k] * 0.5, 0.02 * pair.bodies.moments.max())
        near(momentum[:, k], np.zeros(3), 0.1)


def test_no_rotation_and_one_energy():
    flights = Plan((1,), None, 3.0, 0.0, 4.0).starts(made_up_pair(), range(20))
    assert {energy for _, energy, _ in flights} == {3.0}
    assert not any(start.momentum.any() for _, _, start in flights)
