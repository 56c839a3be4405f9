"""The energy drift of a run, and costs from noisy times."""

import types

import numpy as np
import pytest
from support.clumps import FIX, FOR_GEAR

from lammps_gearquat.trials import cost, drift, measure
from lammps_gearquat.trials.drift import Drift
from lammps_gearquat.trials.measure import Deck

TIME = np.linspace(0.1, 10.0, 100)
LJ, REAL = (types.SimpleNamespace(units=units, time_unit=name) for units, name in (("lj", ""), ("real", "fs")))


def trial_of(energy, kinetic=3.0):
    """A trial with a conserved energy (100,)."""
    energies = np.column_stack([energy, np.full(len(energy), kinetic)])
    return measure.Trial(None, 0.1, 100, TIME, None, None, 1, [1.0], [0.0], energies=energies)


# --- from energies ----------------------------------------------------------------------------------
def test_drift_is_the_slope_by_twice_the_kinetic_energy():
    """A run of 10 fs whose energy rises by 6e-6 per fs, or by 6 per ns, which is one kT for each degree of freedom."""
    found = drift.of_trial(trial_of(6e-6 * TIME - 40.0), drift.nanosecond(REAL))
    assert found.rate == pytest.approx(1.0)
    assert found.error < 1e-6 and found.time == TIME[-1] and found.drifts
    assert drift.nanosecond(LJ) == 1000.0


@pytest.mark.parametrize(("white", "walk"), [(1.0, 0.0), (0.0, 1.0), (1.0, 0.3)])
def test_error_of_a_drift_is_that_of_its_noise(white, walk):
    """Noise that is bounded, that is a random walk, and both: over many seeds the deviations have the stated errors."""
    random = np.random.default_rng(1)
    noise = 1e-6 * (white * random.normal(size=(300, 100)) + walk * random.normal(size=(300, 100)).cumsum(axis=1))
    found = [drift.of_trial(trial_of(6e-6 * TIME + one), drift.nanosecond(REAL)) for one in noise]
    z = np.array([(one.rate - 1.0) / one.error for one in found])
    # with white noise alone a random walk cannot be ruled out, so the error is too large; it is never much too small
    assert 0.45 < np.sqrt(np.mean(z**2)) < 1.4
    assert np.mean(z) == pytest.approx(0.0, abs=0.25)
    assert np.mean(np.abs(z) > drift.SURE) < 0.15

    naive = np.array([(np.polyfit(TIME, 6e-6 * TIME + one, 1)[0] - 6e-6) for one in noise]).std()
    assert np.mean([one.error for one in found]) * 6e-6 > 0.7 * naive


def test_bodies_at_rest_have_no_drift():
    assert drift.of_trial(trial_of(TIME, kinetic=0.0), 1.0).reason == "there is no kinetic energy"


@pytest.mark.parametrize(
    ("rate", "error", "drifts", "holds"),
    [(-5.8, 0.3, True, False), (0.02, 0.03, False, True), (-2.5, 3.0, False, False), (0.12, 0.02, False, False)],
)
def test_a_drift_is_judged_by_its_error(rate, error, drifts, holds):
    assert (Drift(rate, error).drifts, Drift(rate, error).holds) == (drifts, holds)
    assert not Drift().drifts and not Drift().holds


# --- in LAMMPS ----------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("keywords", "bound"),
    [("values 9", 1e-8), ("formulation first isokinetic total", 1e-8), ("temp 0.5 0.8 0.3", 1e-6)],
)
def test_what_is_conserved_with_each_keyword_is_watched(make_deck, keywords, bound):
    """The conserved energy includes the heat of a thermostat and the change from the predicted to the corrected
    pose."""
    with Deck(make_deck(**{FIX: f"{FIX} {keywords}"}, **FOR_GEAR), [("style", "gear/quat")]) as deck:
        trial = deck.run(None, [10] * 50, 0.001, energies=True)
    energy, kinetic = trial.energies.T[:2]
    assert np.ptp(energy) < bound * kinetic.mean()
    assert abs(drift.of_trial(trial, 1.0).rate) < bound


#: the sites are spheres that rotate with their bodies; a temperature, which lacks this rotation, ends the run, because
#: more degrees of freedom are subtracted than counted
SPHERES = {"atom_style atomic": "atom_style sphere\natom_modify map yes", "mass 1 1.0": "set group all diameter 1.0 mass 1.0"}
SPHERES |= {"fix average all ave/time 1 10 10 c_thermo_temp file average.txt": "", "custom step temp": "custom step"}


@pytest.mark.parametrize("style", ["rigid", "gear/quat"])
def test_rotation_of_sites_of_finite_size_is_watched(make_deck, style):
    """The kinetic energy of the atoms lacks this rotation, and would change."""
    with Deck(make_deck(**{**FOR_GEAR, **SPHERES}), [("style", style)]) as deck:
        assert deck.partial and not deck.others
        right = deck.run(None, [10] * 50, 0.001, energies=True).energies
        deck._situation.rotating = False
        wrong = deck.run(None, [10] * 50, 0.001, energies=True).energies
    spread = np.ptp(right[:, 0]) / right[:, 1].mean()
    assert spread < 1e-4 and np.ptp(wrong[:, 0]) / right[:, 1].mean() > 20 * spread
    assert np.all(right[:, 1] > wrong[:, 1])


# --- prices from noisy times --------------------------------------------------------------------------
def costs_from(seconds):
    """Costs of one method at steps 0.1, 0.05, 0.025 of order 6, with these lists of timings."""
    costs = cost.Costs(1.0, 1e-14, None, None, 0)
    for dt, timings in zip((0.1, 0.05, 0.025), seconds):
        trial = measure.Trial("a", dt, 1 / dt, None, None, None, 1, timings, [0.1] * len(timings))
        costs.trials.append((trial, (dt**6,) * 4))
    costs.rows = cost.rows_of(costs, [2e-6, 2e-8, 3e-10])
    return costs


def test_the_shortest_time_counts():
    """Other load on the machine makes no step cheaper."""
    rows = costs_from([[9.0, 1.0, 9.0], [2.0, 9.0, 9.0], [9.0, 9.0, 4.0]]).rows
    assert [row.best.seconds for row in rows] == [1.0, 2.0, 4.0]
    assert [row.best.dt for row in rows] == [0.1, 0.05, 0.025]


def test_a_larger_error_never_costs_more():
    """A step that is measured as cheaper and more accurate is taken."""
    rows = costs_from([[7.0], [6.0], [4.0]]).rows
    assert [row.best.seconds for row in rows] == [4.0] * 3 and {row.best.dt for row in rows} == {0.025}
    assert [row.error for row in rows] == [2e-6, 2e-8, 3e-10]
    rows = costs_from([[7.0], [3.0], [4.0]]).rows
    assert [row.best.dt for row in rows] == [0.05, 0.05, 0.025]
