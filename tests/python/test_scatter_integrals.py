"""gearquat scatter: cross sections, collision integrals and properties of a gas, in known cases."""

from types import SimpleNamespace

import numpy as np
import pytest

from lammps_gearquat.scatter import Plan, gas
from lammps_gearquat.scatter.integrals import Averages, Collisions
from lammps_gearquat.scatter.pilots import Cells, beyond, rounded, taken_away
from lammps_gearquat.scatter.results import results
from lammps_gearquat.scatter.sampling import uniform
from lammps_gearquat.trials.script import DeckError

BOLTZMANN, DALTON = 1.380649e-23, 1.66053907e-27
N = 16384


def facts(style="lj", mass=1.0, freedoms=(0, 0), charge=None):
    return SimpleNamespace(style=style, reduced_mass=mass / 2, freedoms=freedoms, charge=charge, identical=True, moments=[[0.0] * 3] * 2)


def flown(temperature=1.0, diameter=1.0, largest=1.5, boltzmann=1.0, n=N, **density):
    """(columns, Plan): rigid spheres, which turn the velocity by 2 arccos(b / diameter)."""
    plan = Plan((1,), (temperature,), None, None, largest, **density)
    b, energy = plan.drawn(uniform((1,), np.arange(n), 2), boltzmann)
    angle = 2.0 * np.arccos(np.minimum(b / diameter, 1.0))
    columns = {"flight": np.arange(n), "b": b, "energy": energy, "angle": angle, "energy_after": energy.copy()}
    columns |= {"fate": np.full(n, "parted"), "repeats": 0 * columns["flight"], "steps": columns["flight"]}
    columns |= {"turnings": 1 + columns["repeats"], "error_energy": 1e-6 * b, "error_momentum": b, "error_angular": b}
    return columns | {"message": np.full(n, "")}, plan


def agrees(estimate, exact):
    return abs(estimate.value - exact) < 3.0 * estimate.error


def test_rigid_spheres():
    found = results(*flown(), facts(), sigma=1.0).answers[0]
    for name in ("Omega(1,1)*", "Omega(2,2)*", "Omega(1,2)*", "A*", "C*"):
        assert agrees(found.estimates[name], 1.0), name
        assert found.estimates[name].error < 2e-3
    assert agrees(found.estimates["cross section"], np.pi)
    exact = 5.0 / 16.0 * np.sqrt(1.0 / np.pi)
    assert found.estimates["viscosity"].value == pytest.approx(exact, rel=5e-3)
    assert found.estimates["diffusion"].value == pytest.approx(3.0 / 8.0 * np.sqrt(1.0 / np.pi), rel=5e-3)


@pytest.mark.parametrize("density", [{"s0": 0.7}, {"s0": 0.3, "s1": 0.2}, {"s1": 2.0, "power": 0.5}])
def test_any_density_of_flights(density):
    """Spheres again, with flights that are drawn where they contribute, or where they do not."""
    estimates = results(*flown(**density), facts()).answers[0].estimates
    for name, exact in (("cross section", np.pi), ("A*", 1.0), ("C*", 1.0)):
        assert agrees(estimates[name], exact) and not agrees(estimates[name], 1.02 * exact)


def test_one_energy():
    columns, plan = flown()
    columns["energy"] = columns["energy_after"] = np.full(N, 2.0)
    found = results(columns, Plan((1,), None, 2.0, 0.0, plan.largest), facts()).answers[0]
    assert agrees(found.estimates["Q(1)"], np.pi) and agrees(found.estimates["Q(2)"], 2.0 / 3.0 * np.pi)


@pytest.mark.parametrize("style", ["real", "metal"])
def test_units(style):
    """Spheres of 3.64 A and 39.948 u at 300 K, computed in the SI."""
    boltzmann = {"real": 0.0019872067, "metal": 8.617343e-5}[style]
    columns, plan = flown(300.0, 3.64, 5.0, boltzmann)
    found = results(columns, plan, facts(style, 39.948, charge=(1.0, 0.0))).answers[0].estimates
    mass, sigma, thermal = 39.948 * DALTON, 3.64e-10, BOLTZMANN * 300.0
    viscosity = 5.0 / (16.0 * sigma**2) * np.sqrt(mass * thermal / np.pi)
    density = 101325.0 / thermal
    diffusion = 3.0 / (8.0 * density * sigma**2) * np.sqrt(thermal / (np.pi * mass))
    assert found["viscosity"].value == pytest.approx(viscosity * 1e6, rel=5e-3)
    assert found["diffusion"].value == pytest.approx(diffusion * 1e4, rel=5e-3)
    # K = q D / (k T), and K0 is K at 273.15 K and one atmosphere
    einstein = 1.602176634e-19 * diffusion / thermal * 273.15 / 300.0 * 1e4
    assert found["mobility"].value == pytest.approx(einstein, rel=5e-3)


def mixed(seed, warm, n=400_000):
    """Gain of rotation in collisions of linear molecules that mix all energy at random, in units of kT.

    Energies of translation have the density x exp(-x), and energies of both rotations with ``warm`` times T, too.
    """
    random = np.random.default_rng(seed)
    x, rotation = random.gamma(2.0, size=n), warm * random.gamma(2.0, size=n)
    return x, x - (x + rotation) * random.beta(2.0, 2.0, n)


def test_relaxation_of_rotation():
    """The rate from the squared gain at equal temperatures equals the mean gain at different temperatures."""
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
    """With detailed balance both forms of the momentum flux have the same mean."""
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
    """The jackknife of a mean is the standard error over replicas, with the factor of Student's distribution."""
    deviations = []
    for trial in range(200):
        values = np.random.default_rng(trial).normal(1.0, 0.1, 160)
        averages = Averages(np.arange(160), {"a": (values,), "b": (values**2,)})
        value, error = averages.of(lambda means: means["a"])
        replicas = values.reshape(10, 16).mean(axis=0)
        student = np.sqrt(15.0 / 13.0)
        assert value == pytest.approx(values.mean()) and error == pytest.approx(student * replicas.std(ddof=1) / 4.0)
        value, error = averages.of(lambda means: means["b"] / means["a"])
        deviations.append((value - 1.01) / error)
    assert np.std(deviations) == pytest.approx(1.0, abs=0.1)


def test_flights_that_have_not_parted_are_counted():
    """The contribution of these flights is included in the error."""
    columns, plan = flown()
    columns["fate"] = np.where(np.arange(N) < 120, "unparted", "parted")
    columns["angle"][:120] = columns["energy_after"][:120] = np.nan
    found = results(columns, plan, facts(), sigma=1.0)
    assert found.counts["unparted"] == 120 and found.unfinished["unparted"] == list(range(120))
    estimate = found.answers[0].estimates["Omega(1,1)*"]
    assert estimate.value == pytest.approx(1.0, abs=0.01)
    # they are taken as turned wherever they were in the whole area
    assert found.guessed == pytest.approx(1.5**2 * 120 / N, rel=0.05)
    assert found.guessed * estimate.value < estimate.error < 1.2 * found.guessed


def test_no_flight_has_parted():
    columns, plan = flown(n=64)
    columns["fate"] = np.full(64, "unparted")
    with pytest.raises(DeckError, match="none of the 64 flights has parted.*more --steps"):
        results(columns, plan, facts())
    columns["fate"], columns["message"] = np.full(64, "lost"), np.full(64, "Lost atoms")
    with pytest.raises(DeckError, match=r"LAMMPS ended them \(Lost atoms\)"):
        results(columns, plan, facts())


def test_what_is_left_out_is_in_the_error():
    """Each quantity includes its part beyond the largest impact parameter, and ratios include both parts."""
    columns, plan = flown()
    left = [{"momentum": 0.03, "viscosity": 0.01, "rotation": None}]
    own = results(columns, plan, facts()).answers[0].estimates
    found = results(columns, plan, facts(), left=left).answers[0].estimates
    for name, part in (("cross section", 0.03), ("Omega(2,2)", 0.01), ("A*", np.hypot(0.03, 0.01))):
        expected = np.hypot(own[name].error, part * own[name].value)
        assert found[name].error == pytest.approx(expected, rel=0.03) and found[name].value == own[name].value


def test_what_is_beyond_the_largest_impact_parameter():
    """With losses proportional to b^-6 the integrals are known, within and beyond the cutoff."""
    edges = np.concatenate([[0.0], 10.0 * np.geomspace(0.04, 1.0, 200)])
    b = np.sqrt(0.5 * (edges[1:] ** 2 + edges[:-1] ** 2))
    h = np.minimum(1.0, (b / 2.0) ** -6.0)
    exact, cells = 2.0 * np.pi * 2.0**6 / 4.0, b[:, None, None]
    places = Cells(edges, cells, np.ones_like(cells), 0.0, None)
    left = beyond(places, np.repeat(h, 3).reshape(200, 1, 1, 3), 1.0, 10.0)
    whole = np.pi * 4.0 + exact * 2.0**-4
    assert left[150] == pytest.approx(exact * edges[150] ** -4 / whole, rel=5e-3)
    assert left[-1] == pytest.approx(exact * 1e-4 / whole, rel=5e-3)
    assert taken_away(b, h[:, None], 10.0)[0] == pytest.approx(exact * 1e-4, rel=1e-6)
    assert rounded(3.0411) == 3.05 and rounded(0.0123) == 0.0123 and rounded(417.2) == 418.0


@pytest.mark.parametrize("wrong", [0.06, np.nan])
def test_flights_that_lose_energy_are_refused(wrong):
    columns = {"fate": np.array(["parted"] * 3), "flight": np.arange(3), "message": np.array([""] * 3)}
    columns |= {name: np.array([1e-9, wrong, 1e-8]) for name in ("error_energy", "error_momentum", "error_angular")}
    with pytest.raises(DeckError, match="use a smaller tolerance, or a shorter time step"):
        results(columns, None, None)
