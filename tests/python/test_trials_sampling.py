"""gearquat cost where trajectories diverge: steps are judged by the drift of the energy and by temperatures."""

import math
import types

import numpy as np
import pytest
from support.clumps import FOR_GEAR

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.blocks import Estimate
from gearquat_analysis.units import UNITS
from lammps_gearquat.launch import LammpsError
from lammps_gearquat.trials import cost, doubt, drift, measure, methods, report, sampling
from lammps_gearquat.trials.drift import Drift
from lammps_gearquat.trials.measure import Deck

BODIES = 64
FREEDOMS = 3 * BODIES - 3, 3 * BODIES
BOLTZMANN = UNITS["real"].boltzmann
KELVIN = 300.0


class MadeUpLiquid:
    """A deck of many bodies whose trials have a simulated clock, and drift according to ``drifts``.

    ``drifts``: keywords, step -> kT per ns and degree of freedom; ``blown``: the step from which on a run ends with an
    error, after ``lasts`` fs; ``apart``: step -> T translation - T rotation; ``noise``: of the energy, in kT and degree of
    freedom; ``own``: keywords of the deck's fix gear/quat, None for another fix.
    """

    accurate, size, dt, end, notes = "values 9", 1.0, 2.0, 1e4, ()
    time_unit, length_unit, units = "fs", "Å", "real"
    partial, others, map_missing, freedoms = False, False, True, FREEDOMS
    path = types.SimpleNamespace(name="in.liquid")
    start = types.SimpleNamespace(steps=5000, checkpoints=False, commands=[])

    def __init__(self, drifts, seed=1, pace=1e-3, blown=6.0, lasts=500.0, apart=lambda dt: 0.0, noise=1e-5, own=None):
        self.drifts, self.pace, self.blown, self.lasts, self.apart = drifts, pace, blown, lasts, apart
        self.noise, self.own = noise, own
        self.random, self.now = np.random.default_rng(seed), 0.0
        ids = np.arange(1, BODIES + 1)
        self.scene = types.SimpleNamespace(bodies=Bodies(ids, np.ones(BODIES)), ids=ids)

    def monotonic(self):
        return self.now

    def takes(self, keywords):
        return True

    def fix_lines(self, keywords):
        return [f"fix move all {methods.named(self.own if keywords is None else keywords)}"]

    def work(self, steps, dt, timeout):
        seconds = 0.3 + steps * self.pace
        self.now += min(seconds, timeout)
        if seconds > timeout:
            raise LammpsError("not finished after a while")
        if dt >= self.blown and steps * dt > self.lasts:
            raise LammpsError("blow-up in step 7")
        return [steps * self.pace], [0.3]

    def run_to(self, keywords, end, steps, samples=1, timeout=None):
        seconds = self.work(steps, end / steps, timeout)
        time = end * np.arange(1, samples + 1) / samples
        error = 1e-9 * (end / steps) ** 4 * np.exp(time / 150.0)
        center = error[:, None, None] * np.ones((1, BODIES, 3))
        return measure.Trial(keywords, end / steps, steps, time, center.copy(), center, 1, *seconds)

    def run(self, keywords, segments, dt, timeout=None, energies=False):
        steps, n = sum(segments), len(segments)
        seconds, time = self.work(steps, dt, timeout), np.cumsum(segments) * dt
        kinetic = [0.5 * f * BOLTZMANN * (KELVIN + s * self.apart(dt) / 2) for f, s in zip(FREEDOMS, (1, -1))]
        parts = [k + 0.05 * k * self.random.normal(size=n) for k in kinetic]
        thermal = 2.0 * sum(kinetic)
        energy = thermal * (self.drifts(keywords, dt) * time * 1e-6 + self.noise * self.random.normal(size=n))
        values = np.column_stack([energy, sum(parts), *parts])
        return measure.Trial(keywords, dt, steps, time, None, None, 1, *seconds, energies=values)


#: keywords that permit longer steps than the default
LONGEST = "formulation second values 4"


def steep(keywords, dt):
    """As in water, the default permits longer steps, and the fix of the deck does not drift."""
    limit = {"": 4.1, LONGEST: 5.1}.get(keywords, 2.1)
    return -0.08 * (dt / limit) ** 9 if keywords is not None else 0.01


def answer_of(monkeypatch, deck, seconds=180.0, **options):
    monkeypatch.setattr(cost.clock, "monotonic", deck.monotonic)
    return cost.measure(deck, cost.Budget(seconds), **options)


@pytest.mark.parametrize("tries", [(), ("formulation second values 9",), (LONGEST,)])
@pytest.mark.parametrize("noise", [1e-5, 1e-4])
@pytest.mark.parametrize("seed", range(5))
def test_a_method_that_drifts_is_never_recommended(monkeypatch, seed, noise, tries):
    """The method that works at the longest step is within the budget after a run of 100 ps, although short runs show little."""
    only = lambda keywords, dt: 5.0 if keywords is None else steep(keywords, dt)
    deck = MadeUpLiquid(only, seed, noise=noise)
    found = answer_of(monkeypatch, deck, tries=tries)
    keywords, dt = found.recommended
    assert abs(only(keywords, dt)) < found.bound and found.choice.drift.holds
    assert (keywords, dt) == ((LONGEST, 5.0) if LONGEST in tries else ("", 4.0))
    assert deck.now < 180.0
    for run in found.rows:  # each step is judged by its drift
        true = only(run.keywords, run.dt)
        assert abs(run.drift.rate - true) < 5.0 * run.drift.error + 0.01 * abs(true) or run.drift.fails
        assert not (run.drift.holds and abs(true) > found.bound)


def test_the_bound_is_the_users(monkeypatch):
    tight, loose = (answer_of(monkeypatch, MadeUpLiquid(steep, blown=1e9), bound=bound) for bound in (0.02, 1.0))
    assert abs(steep(*tight.recommended)) < 0.02 < abs(steep(*loose.recommended)) < 1.0
    assert tight.recommended[1] < loose.recommended[1]


def test_what_the_script_has_already_is_not_tried_again(monkeypatch):
    """For a script with the fix and its defaults, a longer step is recommended; further trials are made only at the
    user's request."""
    found = answer_of(monkeypatch, MadeUpLiquid(lambda keywords, dt: steep(keywords or "", dt), own=""))
    assert {run.keywords for run in found.runs} == {None} and found.recommended == (None, 4.0)
    found = answer_of(monkeypatch, MadeUpLiquid(steep), tries=[LONGEST])
    assert {run.keywords for run in found.runs} == {None, "", LONGEST}


def test_where_nothing_holds_that_is_said_with_the_smallest_drift(monkeypatch):
    found = answer_of(monkeypatch, MadeUpLiquid(lambda keywords, dt: 0.7 + 0.1 * dt + (keywords != "")))
    assert found.recommended is None and found.choice is None
    text = report.drift_text(MadeUpLiquid(steep), found)
    assert "Nothing is recommended: no step is known to keep the drift below 0.1 kT/ns/dof" in text
    assert found.least.keywords == "" and f"timestep {found.least.dt:g}" in text.split("The smallest drift seen is")[1]
    assert abs(found.least.drift.rate - 0.7 - 0.1 * found.least.dt) < 5 * found.least.drift.error


def test_temperatures_that_differ_are_no_equilibrium(monkeypatch):
    """By 4.2 K at 2 fs and by the square of the step, as with fix rigid/nve/small."""
    deck = MadeUpLiquid(lambda keywords, dt: 0.0, apart=lambda dt: 1.05 * dt**2, blown=1e9)
    found = answer_of(monkeypatch, deck)
    choice = found.choice.drift
    assert deck.apart(found.choice.dt) < drift.BALANCE * KELVIN + 5.0 * choice.difference.error < 12.0
    wrong = [run for run in found.rows if run.drift.unbalanced]
    assert wrong and all(report.verdict(run) == "temperatures differ" for run in wrong)


def test_a_step_that_fails_only_in_a_long_run_is_not_recommended(monkeypatch):
    deck = MadeUpLiquid(lambda keywords, dt: 0.0 if keywords == "" else 5.0, blown=4.0, lasts=30e3)
    found = answer_of(monkeypatch, deck)
    assert found.recommended == ("", 3.0)
    assert found.row("", 4.0).drift.fails
    text = report.drift_text(deck, found)
    assert "ended with an error:\n    blow-up" in text and "atom_modify map yes" in text


@pytest.mark.parametrize("pace", [1e-4, 0.02, 0.3])
def test_the_budget_is_kept(monkeypatch, pace):
    deck = MadeUpLiquid(steep, pace=pace)
    found = answer_of(monkeypatch, deck)
    assert deck.now < 180.0
    assert found.recommended is None or found.choice.drift.holds
    header, rows = report.drift_tables(found)["cost"]
    rows = [dict(zip(header, row)) for row in rows]
    assert len(rows) == len(found.rows) and sum(row["recommended"] == "yes" for row in rows) == bool(found.recommended)
    assert all(row["drift"] != "" or row["verdict"] in ("not known", "ends with an error") for row in rows)
    assert found.own.keywords is None


def test_errors_that_are_asked_for_are_those_of_a_trajectory(monkeypatch):
    assert isinstance(answer_of(monkeypatch, MadeUpLiquid(steep), errors=[1e-3], time=100.0), cost.Costs)


def test_a_regular_motion_does_not_diverge():
    time = np.linspace(1.0, 20.0, 20)
    assert doubt.chaotic(time, 1e-12 * np.exp(time), 200.0, 1e-3) and not doubt.chaotic(time, 1e-12 * np.exp(time), 21.0, 1e-1)
    assert not doubt.chaotic(time, 1e-6 * time, 20.0, 1e-3)


@pytest.mark.parametrize(
    ("dt", "longer", "shorter"), [(2.0, 2.5, 1.5), (1.7, 2.0, 1.5), (8.0, 10.0, 6.0), (1.0, 1.2, 0.8), (1e-3, 1.2e-3, 8e-4)]
)
def test_steps_that_people_write(dt, longer, shorter):
    assert (sampling.neighbor(dt, 1), sampling.shorter(dt)) == (longer, shorter)


# --- what is measured -----------------------------------------------------------------------------------
def test_difference_of_temperatures_and_its_error():
    """Over many seeds a difference of 3 K is found within its error."""
    z = []
    for seed in range(200):
        deck = MadeUpLiquid(steep, seed, apart=lambda dt: 3.0)
        found = drift.of_trial(deck.run("", [10] * 400, 2.0, timeout=99.0), 1e6, FREEDOMS, BOLTZMANN)
        z.append((found.difference.value - 3.0) / found.difference.error)
    assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=0.15) and abs(np.mean(z)) < 0.25
    # the run begins with other temperatures, whose mean is the same
    kelvin = np.repeat([[330.0, 270.0], [301.5, 298.5]], 50, axis=0)
    energies = np.column_stack([np.zeros(100), np.ones(100), 0.5 * np.array(FREEDOMS) * BOLTZMANN * kelvin])
    trial = types.SimpleNamespace(time=np.arange(1.0, 101.0), energies=energies)
    exact = drift.of_trial(trial, 1e6, FREEDOMS, BOLTZMANN)
    assert exact.difference.value == pytest.approx(3.0)
    assert exact.temperature == pytest.approx(300.0)
    assert Drift(0.0, 0.01, difference=Estimate(4.0, 0.4), temperature=300.0).unbalanced
    assert Drift(0.0, 0.01, difference=Estimate(4.0, 0.4), temperature=500.0).holds
    assert Drift(0.0, 0.01, difference=Estimate(4.0, math.nan), temperature=300.0).holds


UNITS_OF_FRICTION = {"lj": (1.0, 1000.0), "metal": (1.0 / UNITS["metal"].energy, 1000.0), "real": (1.0 / UNITS["real"].energy, 1e6)}


@pytest.mark.parametrize("units", UNITS_OF_FRICTION)
def test_a_friction_is_the_drift_that_it_is_in_all_units(make_deck, units):
    """A friction -gamma v takes gamma/m of the energy per unit of time, in kT and degree of freedom."""
    force, ns = UNITS_OF_FRICTION[units]
    gamma, changes = 0.01 / force, {**FOR_GEAR, "units lj": f"units {units}"}
    if units == "metal":  # forces of eV would be strong in these units
        changes |= {"pair_coeff 1 1 1.0 1.0": "pair_coeff 1 1 1e-4 1.0"}
    with Deck(make_deck(f"fix drag all viscous {gamma}", **changes), [("style", "gear/quat")]) as deck:
        found = drift.of_trial(deck.run(None, [2] * 50, 1e-3, energies=True), drift.nanosecond(deck))
    assert found.rate == pytest.approx(-0.01 * ns, rel=2e-3)


PERIODIC = {"boundary f f f": "boundary p p f"}


def test_bodies_that_keep_their_angular_momentum_are_in_no_equilibrium_of_temperatures(make_deck):
    """Eight molecules that do not turn as a whole have 18 freedoms of translation and not 21."""
    for changes, known in ((PERIODIC, True), ({"boundary f f f": "boundary f f p"}, False), ({}, False)):
        with Deck(make_deck(**FOR_GEAR, **changes), [("style", "gear/quat")]) as deck:
            assert (deck.freedoms is not None) == known


@pytest.mark.parametrize("style", ["rigid", "gear/quat"])
def test_translation_and_rotation_are_those_of_the_bodies(make_deck, style):
    """Their sum is the kinetic energy without the total momentum; three bodies of three sites have 6 and 9 degrees of freedom."""
    push = "velocity all set 0.3 0.0 0.0 sum yes units box"
    with Deck(make_deck(push, **FOR_GEAR, **PERIODIC), [("style", style)]) as deck:
        assert deck.freedoms == (6, 9) and deck.scene.ranges == ["1:9"]
        trial = deck.run(None, [2] * 20, 1e-3, energies=True)
        path = deck.run(None, [1, 1, 1], 1e-4)
    _, kinetic, translation, rotation = trial.energies.T
    drifted = np.gradient(path.center, path.time, axis=0)[1].mean(axis=0)
    assert kinetic == pytest.approx(translation + rotation + 4.5 * drifted @ drifted, rel=1e-5)
    assert drifted[0] > 0.2 and trial.positions.shape[0] == 1
