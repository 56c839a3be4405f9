"""gearquat scatter: its sampling density, and the validity of its stated errors, with flights by quadrature."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from support.atoms import ARGON, BOLTZMANN, IONS, Atoms, until
from lammps_gearquat.scatter import Plan, pilots
from lammps_gearquat.scatter.density import Density
from lammps_gearquat.scatter.integrals import weights
from lammps_gearquat.trials.script import DeckError

SEEDS = 200
ION, WARM = IONS[300.0], BOLTZMANN * 300.0 / 0.2
DENSITIES = {
    "argon": Density((2.0,), False, 0.57, 1.0, 1.0, 2.5),
    "slow flights only": Density((0.2,), False, 0.0, 13.0, 0.5, 5.3),
    "fast flights only": Density((1.0,), False, 0.7, 0.0, 1 / 3, 2.0),
    "inside of S": Density((1.0,), False, 9.0, 5.0, 1.0, 2.0),
    "three temperatures": Density((0.5, 1.2, 3.0), False, 0.5, 2.0, 1 / 2, 3.0),
    "in units si": Density((4e-21,), False, 6e-20, 1.3e-19, 1.0, 7.8e-10),
}


# --- the density ----------------------------------------------------------------------------------
@pytest.mark.parametrize("density", DENSITIES.values(), ids=DENSITIES)
def test_densities_integrate_to_one(density):
    unit = density.scales[0]

    def of_logarithm(y):
        energy = np.array([unit * np.exp(y)])
        return (density.density(energy) * energy)[0]

    assert quad(of_logarithm, -40.0, 6.0, limit=400, epsabs=1e-11)[0] == pytest.approx(1.0, abs=1e-9)
    for x in (0.01, 0.5, 4.0):
        # area is the inverse of the density of pi b^2
        square = np.geomspace(1e-8, 1.0, 20001) * density.largest**2
        inverse = 1.0 / density.area(np.sqrt(square), np.full(len(square), x * unit))
        assert np.pi * np.trapezoid(inverse, square) == pytest.approx(1.0, abs=2e-5)


@pytest.mark.parametrize("density", DENSITIES.values(), ids=DENSITIES)
def test_numbers_become_energies_and_impact_parameters(density):
    """The uniform number is the part of all energies, or of all impact parameters at an energy, below the drawn
    value."""
    u = np.concatenate([[2.0**-31, 1.0 - 2.0**-31], np.random.default_rng(1).random(2000)])
    energy = density.energies(u)
    assert np.abs(density.cumulative(energy) - u).max() < 1e-12
    # to the last digit, whatever other flights are drawn together with it
    assert [density.energies(u[k : k + 1])[0] for k in range(200)] == energy[:200].tolist()
    for x in (0.01, 1.0, 8.0):
        same = np.full(len(u), x * density.scales[0])
        b = density.impact(u, same)
        # d(pi b^2) = area du
        step = 1e-6
        inner = (u > 0.01) & (u < 0.99)
        far = density.impact(u[inner] + step, same[inner])
        near = density.impact(u[inner] - step, same[inner])
        slope = np.pi * (far**2 - near**2) / (2.0 * step)
        # except at the kink of the density
        assert np.mean(np.abs(slope / density.area(b[inner], same[inner]) - 1.0) < 1e-4) > 0.99
        assert b.max() <= density.largest


def test_one_energy():
    density = Density((2.0,), True, 0.5, 0.0, 1.0, 3.0)
    u = np.random.default_rng(1).random(100)
    energy = density.energies(u)
    assert (energy == 2.0).all() and np.median(density.impact(u, energy)) < 1.0


# --- averages -------------------------------------------------------------------------------------
def sampled(atoms, temperature, number, error, seeds=SEEDS, factors=(1.0, 1.0)):
    """Array (seeds, 2, 2): Omega(1,1)* and Omega(2,2)*, value and error, with s0 and s1 of the plan times ``factors``."""
    found = []
    for seed in range(1, seeds + 1):
        plan, farthest = atoms.plan(seed, (temperature,), error)
        plan = replace(plan, s0=factors[0] * plan.s0, s1=factors[1] * plan.s1)
        answer = atoms.results(plan, farthest, atoms.flights(plan, number), number).answers[0]
        rows = [answer.estimates[f"Omega({k},{k})*"] for k in (1, 2)]
        found.append([(row.value, row.error) for row in rows])
    return np.array(found)


def judged(found, exact):
    """(rms of deviations by errors, relative scatter, correlation of value and error)."""
    value, error = found.T
    deviation = (value - exact) / error
    return np.sqrt(np.mean(deviation**2)), np.std(value) / exact, np.corrcoef(value, error)[0, 1]


@pytest.fixture(scope="module")
def ions():
    return sampled(ION, WARM, 512, 0.01)


@pytest.mark.parametrize("order", [1, 2])
def test_errors_of_512_flights_of_an_ion(ions, order):
    exact = ION.exact(order, order, WARM)
    rms, spread, correlation = judged(ions[:, order - 1], exact)
    assert 0.85 < rms < 1.15 and spread < 0.012 and abs(correlation) < 0.3
    # errors that are too small by a third are detected
    wrong = ions[:, order - 1] * [1.0, 1 / 1.5]
    assert judged(wrong, exact)[0] > 1.15


def test_errors_of_4096_flights_include_what_is_left_out():
    """The reference includes all impact parameters."""
    found = sampled(ION, WARM, 4096, 0.01, seeds=24)[:, 0]
    exact = ION.exact(1, 1, WARM)
    assert np.pi * 2.8**2 * exact == pytest.approx(23.329, abs=0.002)
    deviation = (found[:, 0] - exact) / found[:, 1]
    assert np.abs(deviation).max() < 3.7 and 0.6 < np.sqrt(np.mean(deviation**2)) < 1.4


def test_4096_flights_of_argon():
    temperature = 300.0 / 119.8
    _, spread, _ = judged(sampled(ARGON, temperature, 4096, 0.01, seeds=24)[:, 0], ARGON.exact(1, 1, temperature))
    assert spread < 0.002


@pytest.mark.parametrize("factors", [(3.0, 3.0), (1 / 3, 1 / 3), (3.0, 1 / 3), (1 / 3, 3.0)])
def test_densities_that_are_wrong_by_three_leave_averages_unbiased(factors):
    every = sampled(ION, WARM, 512, 0.001, seeds=32, factors=factors)
    for order in (0, 1):
        found = every[:, order]
        exact = ION.exact(order + 1, order + 1, WARM)
        mean, error = found[:, 0].mean(), found[:, 0].std(ddof=1) / np.sqrt(len(found))
        assert abs(mean - exact) < 3.5 * error + 1e-3 * exact
        assert abs(mean - 1.02 * exact) > 3.5 * error + 1e-3 * exact


def test_errors_hold_where_the_command_stops():
    deviations = []
    for seed in range(1, 41):
        for error in (0.1, 0.01):
            _, answer = until(ION, WARM, seed, error)
            assert answer.relative <= error
            for k in (1, 2):
                estimate = answer.estimates[f"Omega({k},{k})*"]
                deviations.append((estimate.value - ION.exact(k, k, WARM)) / estimate.error)
    assert 0.85 < np.sqrt(np.mean(np.square(deviations))) < 1.15


def test_several_temperatures_from_the_same_flights():
    """Errors are correct at each temperature, and smaller than from the same number of flights at each temperature
    alone."""
    temperatures, found = (0.5, 1.2, 3.0), []
    for seed in range(1, 41):
        plan, farthest = ARGON.plan(seed, temperatures, 0.03)
        answers = ARGON.results(plan, farthest, ARGON.flights(plan, 1536), 1536).answers
        rows = [answer.estimates[f"Omega({k},{k})*"] for answer in answers for k in (1, 2)]
        found.append([(row.value, row.error) for row in rows])
    exact = [ARGON.exact(k, k, temperature) for temperature in temperatures for k in (1, 2)]
    deviations = (np.array(found)[..., 0] - exact) / np.array(found)[..., 1]
    assert 0.85 < np.sqrt(np.mean(deviations**2)) < 1.15
    assert (np.sqrt(np.mean(deviations**2, axis=0)) < 1.35).all()
    assert np.array(found)[:, 4:, 0].std(axis=0)[0] < 0.75 * sampled(ARGON, 3.0, 512, 0.03, seeds=40)[:, 0, 0].std()


def test_one_energy_has_errors_that_hold():
    """Cross sections at 0.4 of the depth of the well, where bodies orbit."""
    from benchmarks.reference.central import Scattering

    exact = Scattering(ARGON.potential, 0.4).cross_sections()
    exact = np.pi * np.array([exact[0], 2.0 / 3.0 * exact[1]])
    deviations = []
    for seed in range(1, 41):
        plan, farthest = ARGON.plan(seed, None, 0.01, energy=0.4)
        answer = ARGON.results(plan, farthest, ARGON.flights(plan, 1024), 1024).answers[0]
        for k in (1, 2):
            estimate = answer.estimates[f"Q({k})"]
            assert estimate.error < 0.05 * estimate.value
            deviations.append((estimate.value - exact[k - 1]) / estimate.error)
    assert 0.85 < np.sqrt(np.mean(np.square(deviations))) < 1.15


# --- the plan -------------------------------------------------------------------------------------
def test_the_plan_depends_on_pilots_only():
    """Flights of a smaller and of a larger --error, at the same largest impact parameter, are the same."""
    one, _ = ARGON.plan(3, (2.0,), 0.01)
    assert one == ARGON.plan(3, (2.0,), 0.01)[0] != ARGON.plan(4, (2.0,), 0.01)[0]
    assert [float(f"{x:.3g}") for x in (one.s0, one.s1)] == [one.s0, one.s1]
    first, all_of_them = ARGON.flights(one, 64), ARGON.flights(one, 512)
    assert (all_of_them["energy"][:64] == first["energy"]).all() and (all_of_them["b"][:64] == first["b"]).all()


def test_the_largest_impact_parameter_is_that_of_the_lowest_temperature():
    together, farthest = ARGON.plan(3, (0.5, 1.0, 3.0), 0.01)
    alone = [ARGON.plan(3, (temperature,), 0.01)[0].largest for temperature in (0.5, 3.0)]
    assert together.largest == pytest.approx(alone[0], rel=0.16) and together.largest > alone[1]
    left = [one["momentum"] for one in farthest.left]
    assert left == sorted(left, reverse=True) and left[0] <= 1e-3


def test_weights_of_one_temperature_do_not_depend_on_how_it_is_asked_for():
    """The mixture of a temperature with itself is that temperature."""
    plan, _ = ARGON.plan(3, (1.0,), 0.01)
    columns = ARGON.flights(plan, 64)
    doubled = replace(plan, temperature=(1.0, 1.0))
    assert weights(columns, doubled, ARGON.facts, 1.0) == pytest.approx(weights(columns, plan, ARGON.facts, 1.0))


def test_a_short_cutoff_is_noticed():
    short = Atoms(ARGON.potential, 2.5)
    with pytest.raises(Exception, match="cutoff"):
        short.plan(1, (1.0,), 0.001)


def test_pilots_that_have_not_parted():
    """Some unparted pilots far away make the largest impact parameter unknown; if most pilots are unparted, this is an
    error."""
    plan = Plan((1,), (1.0,), None, None, 0.0)
    places = pilots.cells(plan, ARGON.cutoff, 1.0, 6)
    columns, far = ARGON.columns(places.b.ravel(), places.energy.ravel()), places.b.ravel()
    columns["fate"] = np.where(far > 0.35 * ARGON.cutoff, "unparted", "parted")
    with pytest.raises(DeckError, match="have not parted within --steps.*the largest impact parameter cannot be found"):
        pilots.settle(plan, ARGON.facts, places, columns, 1.0, 1e-3)
    columns["fate"], columns["message"] = np.full(len(far), "lost"), np.full(len(far), "Lost atoms")
    with pytest.raises(DeckError, match=r"LAMMPS ended 768 of 768 pilot flights \(Lost atoms\)"):
        pilots.settle(plan, ARGON.facts, places, columns, 1.0, 1e-3)
