"""Flights of ``gearquat scatter`` compared with DOP853 with its own forces, and the results of the study."""


import numpy as np
import pytest

from benchmarks.reference.encounters import CENTER, MOMENTUM, VELOCITY, Charges, Dispersion, Encounter
from benchmarks.studies.scatter import flown


# --- the reference --------------------------------------------------------------------------------
def encounter(random):
    """Two different bodies with sites of both kinds of forces, and a packed state of them."""
    sites = [random.normal(size=(n, 3)) for n in (3, 4)]
    masses = [random.uniform(1, 2, n) for n in (3, 4)]
    sites = [x - m @ x / m.sum() for x, m in zip(sites, masses)]
    charges = np.outer(random.normal(size=3), random.normal(size=4))
    forces = [Dispersion(np.ones((3, 4)), np.ones((3, 4)), 2.0, 5.0), Charges(charges, 0.3, 6.0)]
    y = random.normal(size=(2, 13))
    y[:, CENTER] = [[0, 0, 0], [2.0, 2.5, 1.0]]
    return Encounter(sites, masses, forces, factor=2.5), y


@pytest.mark.parametrize("seed", range(4))
def test_rates_keep_energy_momentum_and_angular_momentum(seed):
    """A torque or a force that is wrong by 1 % does not agree."""
    two, y = encounter(np.random.default_rng(seed))
    rates = two.rates(0.0, y.ravel()).reshape(2, 13)

    def change(rates, d=1e-5):
        return (two.energy((y + d * rates).ravel()) - two.energy((y - d * rates).ravel())) / (2 * d)

    size = 2.5 * np.abs(two.masses[:, None] * y[:, VELOCITY] * rates[:, VELOCITY]).sum()
    assert abs(change(rates)) < 2e-6 * size  # erfc has seven digits
    for part in (VELOCITY, MOMENTUM):
        wrong = rates.copy()
        wrong[0, part] *= 1.01
        assert abs(change(wrong)) > 1e-5 * size
    assert two.masses @ rates[:, VELOCITY] == pytest.approx(np.zeros(3), abs=1e-12 * size)
    orbital = np.cross(y[:, CENTER], two.masses[:, None] * rates[:, VELOCITY])
    assert (orbital + rates[:, MOMENTUM]).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * size)


@pytest.mark.parametrize("deck, temperature, largest", [("in.dumbbells", 2.0, 3.5), ("in.nitrogen", 300.0, 8.0)])
def test_flights_are_those_of_dop853(deck, temperature, largest):
    """Velocities and angular momenta after the encounter agree to 1e-8; reversed flights return."""
    rows = flown.beside_reference(deck, temperature, largest, 4, lambda: None)
    once = rows[rows[:, 2] <= 1]
    assert len(once) >= 3
    assert once[:, :2].max() < 1e-8 and once[:, 3].max() < 1e-7
