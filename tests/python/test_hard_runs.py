"""Each hard case, made short: its judge accepts what the fix does, and refuses it without the mend."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.studies.hard import (
    boundaries,
    cutoff,
    encounter,
    fast,
    fine,
    inertia,
    lifecycle,
    long,
    newstep,
    poles,
    tumbling,
)
from benchmarks.studies.hard.runs import Runs
from benchmarks.studies.hard.sites import Sites


@pytest.fixture
def runs(tmp_path):
    return Runs(tmp_path)


def verdicts(rows):
    return [row.met for row in rows]


def test_encounter(runs):
    results = encounter.measure(runs, ["0.02"])
    assert all(verdicts(encounter.judge(results)))
    fixed = f"step {encounter.STEP:g}, second"
    results["0.02", "tolerance, second"] = results["0.02", fixed]
    assert verdicts(encounter.judge(results)) == [False, True, True]


def test_long(runs, tmp_path):
    short = {"until": 200, "steps": 100_000}
    assert all(verdicts(long.judge(long.measure(runs, ["0e-9"], **short))))
    loose = long.measure(Runs(tmp_path / "loose"), ["0e-9"], **short, tolerance=1e-9)
    assert verdicts(long.judge(loose)) == [False, False, True] * 2


def test_the_worst_start_counts():
    good, bad = long.told(
        "evaluations 10, energy off by 1e-10 sampled, 2e-10 at every step\n"
    ), long.Long(1_000_001, 1.01e-9, 1.01e-8)
    assert (good.evaluations, good.sampled, good.every) == (10, 1e-10, 2e-10)
    assert verdicts(long.judge({"first": [good, good]})) == [True] * 3
    assert verdicts(long.judge({"first": [good, bad]})) == [False] * 3
    with pytest.raises(ValueError, match="last line"):
        long.told("Total wall time")


def test_fine_steps(runs, tmp_path):
    """Not as many: what compensated sums and projection do is seen in 20 000 steps."""
    short = {"dt": 0.001, "steps": 20_000, "every": 200}
    results = fine.measure(runs, **short)
    assert all(verdicts(fine.judge(results)))
    free = fine.measure(Runs(tmp_path / "free"), **short, project="no", start="zero")
    assert not verdicts(fine.judge(free))[-1]  # the length of q

    found = results["second", "yes"]
    found.total[-1] += 1.01e-12
    assert verdicts(fine.judge(results)) == [True, True, False, True, True]


def test_poles(runs, tmp_path):
    coarse = {"dt": 0.1, "steps": 200}
    assert verdicts(poles.judge(poles.measure(runs, ["passing"], **coarse))) == [True]
    free = poles.measure(Runs(tmp_path / "free"), ["passing"], **coarse, project="no")
    assert verdicts(poles.judge(free)) == [False]  # without projection the frame matters


def test_poles_see_a_small_turn():
    positions = np.random.default_rng(1).normal(size=(3, 6, 3))
    turn = poles.rotation()
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-15)
    assert poles.difference(positions, positions @ turn.T, turn).max() < 1e-14
    other = poles.rotation((4, 1, 2, 3.03))
    assert poles.difference(positions, positions @ other.T, turn).min() > 1e-4


def test_tumbling(runs, tmp_path):
    asked = 1e-9
    results = tumbling.measure(runs, 400_000, 5)
    assert all(verdicts(tumbling.judge(results, asked)))
    plain = tumbling.measure(Runs(tmp_path / "plain"), 400_000, 5, compensate="no")
    met = dict(
        zip([row.what for row in tumbling.judge(plain, asked)], tumbling.judge(plain, asked))
    )
    assert not any(row.met for what, row in met.items() if "phase" in what)


def test_inertia(runs, tmp_path, monkeypatch):
    monkeypatch.setattr(inertia, "COARSEST", 80)
    monkeypatch.setattr(inertia, "HALVINGS", 3)
    assert all(verdicts(inertia.judge(inertia.measure(runs, ["thin3"]))))
    zero = inertia.measure(Runs(tmp_path / "zero"), ["thin3"], start="zero")
    assert not verdicts(inertia.judge(zero))[0]  # order 1


def test_exact_pendulums():
    """The answers for linear bodies keep energy, shape, and small swings are harmonic."""
    arms = np.outer([0.9, 0.1, -1.0], [0.0, 0.6, 0.8])
    for speed in (1e-4, 0.9):
        spins = speed * np.outer([0.9, 0.1, -1.0], [1.0, 0.0, 0.0])
        sites = Sites(np.array([0]), np.ones(3), arms[None], spins[None] + 0.2)
        then = inertia.exact("three", sites, 0.7)
        centre = then.mean(axis=0)
        assert centre == pytest.approx(np.full(3, 0.2 * np.sin(0.7)), abs=1e-15)
        assert np.linalg.norm(then - centre, axis=1) == pytest.approx([0.9, 0.1, 1.0])
        angle = (then - centre)[0, 0] / 0.9
        assert (angle == pytest.approx(speed * np.sin(0.7), rel=1e-6)) == (speed < 0.1)
    # its derivative is the speed that energy leaves
    swings = [inertia.exact("three", sites, t)[0] - 0.2 * np.sin(t) for t in (0.6995, 0.7, 0.7005)]
    rate = np.linalg.norm(swings[2] - swings[0]) / 1e-3 / 0.9
    cosine = swings[1] @ arms[0] / 0.81
    assert rate == pytest.approx(np.sqrt(0.81 - 2 * (1 - cosine)), rel=1e-6)
    assert rate != pytest.approx(1.01 * np.sqrt(0.81 - 2 * (1 - cosine)), rel=1e-3)


def test_collision(runs):
    found = fast.measure(runs, ["wall"], (0.002,))
    assert all(verdicts(fast.judge(found)))
    # an error of 0.02 % of the energy, of which the estimates know nothing
    wrong = {key: replace(one, error=one.error + 0.02) for key, one in found.items()}
    assert verdicts(fast.judge(wrong)) == [False, True]
    wrong = {key: replace(one, error=one.error + 0.2) for key, one in found.items()}
    assert verdicts(fast.judge(wrong)) == [False, False]


def test_new_step(runs, tmp_path):
    changes = ["double", "back"]  # rescaled, and started anew
    results = newstep.measure(runs, changes)
    assert all(verdicts(newstep.judge(results)))
    zero = newstep.measure(Runs(tmp_path / "zero"), changes, start="zero")
    for change in changes:
        for formulation in newstep.FORMULATIONS:  # as if the history were left out at the change
            results[change, formulation, "kept"] = zero[change, formulation, "anew"]
    assert not any(verdicts(newstep.judge(results)))


def test_life_cycle(runs):
    results, whole = lifecycle.measure(runs, ["pieces", "restart", "continued", "refix"])
    assert all(verdicts(lifecycle.judge(results)))
    assert whole["c_potential"].max() > 50.0  # the cut is in the middle of the collision
    for formulation in lifecycle.FORMULATIONS:
        results["pieces", formulation] = results["refix", formulation]
    assert verdicts(lifecycle.judge(results)) == [False, True, True, True]


def test_boundaries(runs, tmp_path):
    results = boundaries.measure(runs, ["corner"], 2000)
    assert all(verdicts(boundaries.judge(results)))
    assert min(count for *_, count in results.values()) > 20


def test_boundaries_leave_out_turns_of_the_flags_only():
    here = np.random.default_rng(1).normal(size=(3, 4, 3))
    for cell in boundaries.CELLS.values():
        turned = here + 1024 * cell @ [1, -2, 0]
        assert boundaries.difference(turned, here, cell).max() < 1e-10
        assert boundaries.difference(here + cell @ [1, 0, 0], here, cell).min() > 9.0
        assert boundaries.difference(here + 2e-10, here, cell).min() > boundaries.ASKED
    positions = np.array([[[9.9, 5.0, 5.0]], [[10.1, 5.0, 5.0]], [[10.2, 5.0, -0.1]]])
    assert boundaries.crossings(positions, boundaries.CELLS["periodic"]) == 2


def test_water_runs(runs):
    methods = (cutoff.RIGID, "first, N = 5")
    for water in cutoff.measure(runs, methods, 20).values():
        assert not water.lost and len(water.time) == 3
        assert water.temperature[0] == pytest.approx(300.0, abs=1.0)


def test_water_is_judged_by_temperature():
    time = 20.0 * np.arange(251)
    noise = np.random.default_rng(1).normal(size=251)

    def water(hot, lost=False):
        return cutoff.Water(time, 100 * noise, hot + noise, lost)

    def met(one):
        results = {cutoff.RIGID: water(500.0), "first, N = 5": one}
        return verdicts(cutoff.judge(results))

    assert met(water(600.0)) == [True]
    assert met(water(640.0)) == [False]
    assert met(water(500.0, lost=True)) == [False]
