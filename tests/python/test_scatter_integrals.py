"""gearquat scatter: cross sections, collision integrals and what they say of a gas, where they are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from lammps_gearquat.scatter import Plan, gas
from lammps_gearquat.scatter.integrals import Averages, Collisions
from lammps_gearquat.scatter.largest import beyond, rounded, taken_away
from lammps_gearquat.scatter.results import results
from lammps_gearquat.scatter.sampling import uniform
from scipy.special import gammaincinv

BOLTZMANN, DALTON = 1.380649e-23, 1.66053907e-27
N = 16384


def facts(style="lj", mass=1.0, freedoms=(0, 0), charge=None):
    return SimpleNamespace(style=style, reduced_mass=mass / 2, freedoms=freedoms, charge=charge, identical=True, moments=[[0.0] * 3] * 2)


def flown(temperature=1.0, diameter=1.0, largest=1.5, boltzmann=1.0, n=N):
    """(columns, Plan): rigid spheres, which turn the velocity by 2 arccos(b / diameter)."""
    u = uniform((1,), np.arange(n), 2)
    b, x = largest * np.sqrt(u[:, 0]), gammaincinv(3.0, u[:, 1])
    energy = x * boltzmann * temperature
    angle = 2.0 * np.arccos(np.minimum(b / diameter, 1.0))
    columns = {"flight": np.arange(n), "b": b, "energy": energy, "angle": angle, "energy_after": energy.copy()}
    columns |= {"fate": np.full(n, "parted"), "repeats": 0 * columns["flight"], "steps": columns["flight"]}
    columns |= {"turnings": 1 + columns["repeats"], "error_energy": b, "error_momentum": b, "error_angular": b}
    return columns, Plan((1,), temperature, None, 0.0, largest)


def agrees(estimate, exact):
    return abs(estimate.value - exact) < 3.0 * estimate.error


def test_rigid_spheres():
    found = results(*flown(), facts(), sigma=1.0)
    for name in ("Omega(1,1)*", "Omega(2,2)*", "Omega(1,2)*", "A*", "C*"):
        assert agrees(found.estimates[name], 1.0), name
        # and an error of a percent is noticed
        assert found.estimates[name].error < 2e-3 and not agrees(found.estimates[name], 1.01)
    assert agrees(found.estimates["cross section"], np.pi)
    exact = 5.0 / 16.0 * np.sqrt(1.0 / np.pi)
    assert found.estimates["viscosity"].value == pytest.approx(exact, rel=5e-3)
    assert found.estimates["diffusion"].value == pytest.approx(3.0 / 8.0 * np.sqrt(1.0 / np.pi), rel=5e-3)


def test_what_is_within_the_core():
    """Spheres again, with three quarters of the flights within 1.1 diameters."""
    columns, plan = flown()
    within = Plan((1,), 1.0, None, 0.0, 1.5, core=1.1)
    columns["b"] = within._impact((columns["b"] / 1.5) ** 2)
    columns["angle"] = 2.0 * np.arccos(np.minimum(columns["b"], 1.0))
    for name, exact in (("cross section", np.pi), ("A*", 1.0)):
        assert agrees(results(columns, within, facts()).estimates[name], exact)


def test_one_energy():
    columns, plan = flown()
    columns["energy"] = columns["energy_after"] = np.full(N, 2.0)
    found = results(columns, Plan((1,), None, 2.0, 0.0, plan.largest), facts())
    assert agrees(found.estimates["Q(1)"], np.pi) and agrees(found.estimates["Q(2)"], 2.0 / 3.0 * np.pi)


@pytest.mark.parametrize("style", ["real", "metal"])
def test_units(style):
    """Spheres of 3.64 A and 39.948 u at 300 K, computed in the SI."""
    boltzmann = {"real": 0.0019872067, "metal": 8.617343e-5}[style]
    columns, plan = flown(300.0, 3.64, 5.0, boltzmann)
    found = results(columns, plan, facts(style, 39.948, charge=(1.0, 0.0))).estimates
    mass, sigma, thermal = 39.948 * DALTON, 3.64e-10, BOLTZMANN * 300.0
    viscosity = 5.0 / (16.0 * sigma**2) * np.sqrt(mass * thermal / np.pi)
    density = 101325.0 / thermal
    diffusion = 3.0 / (8.0 * density * sigma**2) * np.sqrt(thermal / (np.pi * mass))
    assert found["viscosity"].value == pytest.approx(viscosity * 1e6, rel=5e-3)
    assert found["diffusion"].value == pytest.approx(diffusion * 1e4, rel=5e-3)
    # K = q D / (k T), and K0 is that at 273.15 K and one atmosphere
    einstein = 1.602176634e-19 * diffusion / thermal * 273.15 / 300.0 * 1e4
    assert found["mobility"].value == pytest.approx(einstein, rel=5e-3)


def mixed(seed, warm, n=400_000):
    """Gain of rotation in collisions of linear molecules that mix all energy at random, in units of kT.

    Energies of translation have the density x exp(-x), as those of both rotations have with ``warm`` times T.
    """
    random = np.random.default_rng(seed)
    x, rotation = random.gamma(2.0, size=n), warm * random.gamma(2.0, size=n)
    return x, x - (x + rotation) * random.beta(2.0, 2.0, n)


def test_relaxation_of_rotation():
    """The rate from the squared gain at equal temperatures is that of the mean gain at different ones."""
    x, gain = mixed(1, 1.0)
    difference = 0.1
    _, net = mixed(2, 1.0 + difference)
    # a gas of density 1, in which each molecule has c = 1 and half of the collisions of a pair are its own
    rate = gas.relaxation(facts(freedoms=(2, 2)), 1.0)({"transfer": np.mean(gain**2)})
    collisions = 4.0 * np.sqrt(1.0 / np.pi)
    lost = -net.mean() * collisions / 2.0 / difference
    assert gain.mean() == pytest.approx(0.0, abs=0.01)
    assert rate == pytest.approx(lost, rel=0.06)


def test_the_form_of_monchick_yun_and_mason():
    """With detailed balance both forms of the momentum flux have one mean."""
    x, gain = mixed(3, 1.0)
    sine2 = np.random.default_rng(4).random(len(x))
    pairs = Collisions(x, x - gain, np.sqrt(1.0 - sine2), sine2, balanced=True)
    other = x**2 * sine2 + gain**2 / 3.0 - gain**2 * sine2 / 2.0
    assert pairs.f22.mean() == pytest.approx(other.mean(), rel=0.01)


def test_detailed_balance_changes_errors_only():
    """Means are the same with and without it; here velocities turn by any angle."""
    x, gain = mixed(5, 1.0)
    cosine = 2.0 * np.random.default_rng(6).random(len(x)) ** (1 / 3) - 1.0
    direct, both = (Collisions(x, x - gain, cosine, 1.0 - cosine**2, balanced) for balanced in (False, True))
    for some in (lambda pairs: pairs.change(0), lambda pairs: pairs.change(1), lambda pairs: pairs.f22):
        assert some(both).mean() == pytest.approx(some(direct).mean(), rel=0.02)
        assert np.std(some(both)) < np.std(some(direct))


def test_standard_errors():
    """The jackknife of a mean is the standard error over replicas, and errors are as large as deviations."""
    deviations = []
    for trial in range(200):
        values = np.random.default_rng(trial).normal(1.0, 0.1, 160)
        averages = Averages(np.arange(160), {"a": (values,), "b": (values**2,)})
        value, error = averages.of(lambda means: means["a"])
        replicas = values.reshape(10, 16).mean(axis=0)
        assert value == pytest.approx(values.mean()) and error == pytest.approx(replicas.std(ddof=1) / 4.0)
        value, error = averages.of(lambda means: means["b"] / means["a"])
        deviations.append((value - 1.01) / error)
    assert np.std(deviations) == pytest.approx(1.0, abs=0.2)


def test_flights_that_have_not_parted_are_counted():
    columns, plan = flown()
    columns["fate"] = np.where(np.arange(N) < 12, "unparted", "parted")
    columns["angle"][:12] = columns["energy_after"][:12] = np.nan
    found = results(columns, plan, facts(), sigma=1.0)
    assert found.counts["unparted"] == 12 and found.unfinished["unparted"] == list(range(12))
    assert found.estimates["Omega(1,1)*"].value == pytest.approx(1.0, abs=0.01)


def test_what_is_beyond_the_largest_impact_parameter():
    """Losses of b^-6: integrals are known, within and beyond the cutoff."""
    b = 10.0 * np.geomspace(0.04, 1.0, 200)
    h = np.minimum(1.0, (b / 2.0) ** -6.0)[:, None]
    exact = 2.0 * np.pi * 2.0**6 / 4.0
    assert beyond(b, h)[100, 0] == pytest.approx(exact * (b[100] ** -4 - 1e-4), rel=5e-3)
    assert taken_away(b, h, 10.0)[0] == pytest.approx(exact * 1e-4, rel=1e-6)
    assert rounded(3.0411) == 3.05 and rounded(0.0123) == 0.0123 and rounded(417.2) == 418.0
