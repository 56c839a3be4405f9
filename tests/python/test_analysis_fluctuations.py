"""Compressibility, dielectric constant, and the rotation about body axes, of motions whose answers are known."""

from types import SimpleNamespace

from support import dumps
import numpy as np
import pytest
from scipy.constants import Boltzmann
from scipy.spatial.transform import Rotation

from gearquat_analysis import Poses, correlations, open_dump
from gearquat_analysis.bodies import Bodies
from gearquat_analysis.fluctuations import compressibility, dielectric_constant

FRAMES = 4000


def volumes(rng, mean, kappa, temperature):
    """Volumes in cubic Angstrom with the fluctuations of a compressibility in 1/GPa."""
    variance = kappa * 1e-9 * Boltzmann * temperature * mean * 1e-30
    return mean + np.sqrt(variance) * 1e30 * rng.normal(size=FRAMES)


def test_compressibility_and_its_error():
    """For water, from 100 runs: the errors agree with the scatter, and 10 % are detected."""
    poses, found = SimpleNamespace(units="real"), []
    for seed in range(100):
        found.append(compressibility(poses, volumes(np.random.default_rng(seed), 6500.0, 0.45, 298.0), 298.0))
    values, errors = np.array([(one.value, one.error) for one in found]).T
    assert values.mean() == pytest.approx(0.45, rel=0.01)
    assert 0.85 < np.sqrt(np.mean(((values - 0.45) / errors) ** 2)) < 1.2
    assert np.sqrt(np.mean(((values - 0.495) / errors) ** 2)) > 3.0


def test_a_volume_that_drifts_has_no_compressibility():
    volume = 6500.0 + np.linspace(0.0, 300.0, FRAMES)
    found = compressibility(SimpleNamespace(units=None), volume, 1.0)
    assert np.isnan(found.error) and found.why


def dipoles(rng, charges, number=40, length=30.0):
    """Finished poses of dumbbells of length 2 that turn at random in every frame."""
    made = Bodies(np.repeat(np.arange(number) + 1, 2), np.ones(2 * number))
    made.set_shape(np.tile([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]], (number, 1)))
    q = Rotation.random(FRAMES * number, random_state=rng).as_quat(scalar_first=True)
    cell = np.broadcast_to(np.vstack([np.zeros(3), length * np.eye(3)]), (FRAMES, 4, 3))
    results = SimpleNamespace(q=q.reshape(FRAMES, number, 4), cell=cell)
    atoms = SimpleNamespace(charges=np.tile(charges, number))
    return SimpleNamespace(units="real", bodies=made, results=results, atoms=atoms, periodic=np.ones(3, bool))


def test_dielectric_constant_of_independent_dipoles():
    """1 + 4 pi C N mu^2 / (3 V kT), as of an ideal gas."""
    expected = 1.0 + 4.0 * np.pi * 332.06371 * 40 * 0.5**2 * 4.0 / (3.0 * 30.0**3 * 0.0019872067 * 300.0)
    found = [dielectric_constant(dipoles(np.random.default_rng(seed), [0.5, -0.5]), 300.0) for seed in range(8)]
    values, errors = np.array([(one.value, one.error) for one in found]).T
    assert abs(values.mean() - expected) < 4.0 * errors.mean() / np.sqrt(8) < 0.02 * (expected - 1.0) * 4.0
    assert 0.4 < np.sqrt(np.mean(((values - expected) / errors) ** 2)) < 1.8


@pytest.mark.parametrize("charges, why", [([0.5, -0.4], "bodies have charges"), ([0.0, 0.0], "no charges")])
def test_ions_and_sites_without_charges_have_no_dielectric_constant(charges, why):
    assert why in dielectric_constant(dipoles(np.random.default_rng(1), charges), 300.0).why


def test_rotation_about_each_axis():
    """Two axes with equal moments have the mean of both; a rotation about the third axis affects only the third
    axis."""
    rng = np.random.default_rng(2)
    q = Rotation.random(500 * 20, random_state=rng).as_quat(scalar_first=True)
    body = rng.normal(size=(500, 20, 3)) * [1.0, 2.0, 3.0]
    omega = Rotation.from_quat(q, scalar_first=True).apply(body.reshape(-1, 3)).reshape(500, 20, 3)
    q, axes = q.reshape(500, 20, 4), np.broadcast_to(np.eye(3), (20, 3, 3))
    for group, expected in (((0,), 1.0), ((2,), 9.0), ((0, 1), 2.5)):
        function = correlations.axis_autocorrelation(omega, q, axes, group)
        assert function[0] == pytest.approx(expected, rel=0.04)
        assert np.abs(function[1:100]).max() < 0.1 * expected


def test_a_spectrum_has_its_line_and_its_sum():
    lag = 0.1 * np.arange(4000)
    frequency, spectrum = correlations.spectrum(lag, 3.0 * np.cos(2.0 * np.pi * 0.7 * lag))
    assert frequency[np.argmax(spectrum)] == pytest.approx(0.7, abs=0.01)
    assert np.trapezoid(spectrum, frequency) == pytest.approx(3.0, rel=1e-3)


def test_a_dump_gives_its_charges(tmp_path):
    """Column q becomes charges of the universe."""
    motion = dumps.Motion([3, 3])
    path = dumps.write(tmp_path / "q.dump", motion, [0.0, 1.0], lambda _, rows: np.column_stack([rows, np.tile([-1.0, 0.5, 0.5], 2)]), columns=f"{dumps.COLUMNS} q")
    atoms = open_dump(path).atoms
    assert atoms.charges == pytest.approx(np.tile([-1.0, 0.5, 0.5], 2))
    assert Poses(atoms).run().bodies.sum(atoms.charges) == pytest.approx([0.0, 0.0])
