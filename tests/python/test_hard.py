"""The hard cases, made short: bounds hold for what the fix does, and are broken without the mend."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.sites import Sites
from benchmarks.studies.hard import (
    CASES,
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


@pytest.fixture
def run(tmp_path):
    """``run(case, *which, **options)``: what ``measure`` of a case returns."""
    folders = (tmp_path / str(number) for number in itertools.count())
    return lambda case, *which, **options: case.measure(Lab(next(folders)), *which, **options)


def held(finding):
    """Of every measurement with bounds whether they hold."""
    return [m.holds for m in finding.measurements if m.bounds]


# --- scenes -------------------------------------------------------------------------------------
def test_every_case_has_its_folder(examples):
    listed = (examples / "hard" / "README").read_text()
    for key in CASES:
        folder = examples / "hard" / key
        assert (folder / f"in.{key}").is_file()
        assert f"\n    {key} " in listed
        assert "What must hold" in (folder / "README").read_text()


# --- cases --------------------------------------------------------------------------------------
#: case -> (what is run, options that make it short, options without the mend, bounds broken without)
SHORT = {
    long: ([["0e-9"]], {"until": 200, "steps": 100_000}, {"tolerance": 1e-6}, [0, 1, 3, 4]),
    poles: ([["passing"]], {"dt": 0.1, "steps": 200}, {"project": "no"}, [0]),
    inertia: ([["thin3"]], {}, {"start": "zero"}, [0]),
}


@pytest.mark.parametrize("case", SHORT)
def test_bounds_hold_with_the_mend_and_fail_without(run, case, monkeypatch):
    monkeypatch.setattr(inertia, "COARSEST", 80)
    monkeypatch.setattr(inertia, "HALVINGS", 3)
    which, short, spoilt, failing = SHORT[case]
    assert all(held(case.find(run(case, *which, **short))))
    wrong = held(case.find(run(case, *which, **short, **spoilt)))
    assert not any(wrong[k] for k in failing)


def test_encounter(run):
    results = run(encounter, ["0.02"])
    assert all(held(encounter.find(results)))
    fixed = f"step {encounter.STEP:g}, second"
    results["0.02", "tolerance, second"] = results["0.02", fixed]
    assert held(encounter.find(results)) == [False, True, True, True]


def test_the_worst_start_counts():
    good, bad = (
        long.read("evaluations 10, energy off by 1e-10 sampled, 2e-10 at every step\n"),
        long.Long(1_000_001, 1.01e-9, 1.01e-8),
    )
    assert (good.evaluations, good.sampled, good.every) == (10, 1e-10, 2e-10)
    assert held(long.find({("first", 0): good, ("first", 1): good})) == [True] * 3
    assert held(long.find({("first", 0): good, ("first", 1): bad})) == [False] * 3
    with pytest.raises(ValueError, match="last line"):
        long.read("Total wall time")


def test_fine_steps(run):
    """Not as many: what compensated sums and projection do is seen in 20 000 steps."""
    short = {"dt": 0.001, "steps": 20_000, "every": 200}
    results = run(fine, **short)
    assert all(held(fine.find(results)))
    free = run(fine, **short, project="no", start="zero")
    assert not held(fine.find(free))[-1]  # the length of q
    results["yes", "second"].total[-1] += 1.01e-12
    results["yes", "first"].q_error[-1] = 1.01 * fine.MOST_LENGTH
    assert held(fine.find(results)) == [True, True, False, True, False]


def test_poles_see_a_small_turn():
    positions = np.random.default_rng(1).normal(size=(3, 6, 3))
    turn = poles.rotation()
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-15)
    assert poles.difference(positions, positions @ turn.T, turn).max() < 1e-14
    other = poles.rotation((4, 1, 2, 3.03))
    assert poles.difference(positions, positions @ other.T, turn).min() > 1e-4


def test_tumbling(run):
    most = 1e-9
    assert all(held(tumbling.find(run(tumbling, 400_000, 5), most)))
    plain = tumbling.find(run(tumbling, 400_000, 5, compensate="no"), most)
    assert [m.holds for m in plain.measurements if "phase" in m.what] == [False, False]


def test_exact_pendulums():
    """The answers for linear bodies keep energy, shape, and small swings are harmonic."""
    arms = np.outer([0.9, 0.1, -1.0], [0.0, 0.6, 0.8])
    for speed in (1e-4, 0.9):
        spins = speed * np.outer([0.9, 0.1, -1.0], [1.0, 0.0, 0.0])
        sites = Sites(np.array([0]), np.ones(3), arms[None], spins[None] + 0.2)
        then = inertia.exact("three", sites, 0.7)
        center = then.mean(axis=0)
        assert center == pytest.approx(np.full(3, 0.2 * np.sin(0.7)), abs=1e-15)
        assert np.linalg.norm(then - center, axis=1) == pytest.approx([0.9, 0.1, 1.0])
        angle = (then - center)[0, 0] / 0.9
        assert (angle == pytest.approx(speed * np.sin(0.7), rel=1e-6)) == (speed < 0.1)
    # its derivative is the speed that energy leaves
    swings = [inertia.exact("three", sites, t)[0] - 0.2 * np.sin(t) for t in (0.6995, 0.7, 0.7005)]
    rate = np.linalg.norm(swings[2] - swings[0]) / 1e-3 / 0.9
    cosine = swings[1] @ arms[0] / 0.81
    assert rate == pytest.approx(np.sqrt(0.81 - 2 * (1 - cosine)), rel=1e-6)


def test_collision(run):
    results = run(fast, ["wall"], (0.002,))
    assert all(held(fast.find(results)))
    # an error of 0.02 % of the energy, which the estimates do not include
    for error, expected in ((0.02, [False, True]), (0.2, [False, False])):
        wrong = {key: replace(one, error=one.error + error) for key, one in results.items()}
        assert held(fast.find(wrong)) == expected


def test_new_step(run):
    changes = ["double", "back"]  # rescaled, and started anew
    results = run(newstep, changes)
    assert all(held(newstep.find(results)))
    # as if the history were left out at the change
    zero = run(newstep, changes, start="zero")
    lost = {key: zero[*key[:2], "anew"] for key in results if key[2] == "kept"}
    assert not any(held(newstep.find(results | lost)))


def test_life_cycle(run):
    results = run(lifecycle, ["pieces", "restart", "continued", "refix"])
    assert all(held(lifecycle.find(results)))
    # the cut is in the middle of the collision
    assert results["whole", "second"].potential.max() > 50.0
    for formulation in lifecycle.FORMULATIONS:
        results["pieces", formulation] = results["refix", formulation]
    assert held(lifecycle.find(results)) == [False, True, True, True]


def test_boundaries(run):
    results = run(boundaries, ["corner"], 2000)
    assert all(held(boundaries.find(results)))
    assert min(count for *_, count in results.values()) > 20
    time, off, count = results["corner", "periodic", "first"]
    results["corner", "periodic", "first"] = time, off + 1.01e-10, count
    assert held(boundaries.find(results)) == [False, True]


def test_boundaries_leave_out_turns_of_the_flags_only():
    here = np.random.default_rng(1).normal(size=(3, 4, 3))
    for cell in boundaries.CELLS.values():
        turned = here + 1024 * cell @ [1, -2, 0]
        assert boundaries.difference(turned, here, cell).max() < 1e-10
        assert boundaries.difference(here + cell @ [1, 0, 0], here, cell).min() > 9.0
        assert boundaries.difference(here + 2e-10, here, cell).min() > boundaries.MOST
    positions = np.array([[[9.9, 5.0, 5.0]], [[10.1, 5.0, 5.0]], [[10.2, 5.0, -0.1]]])
    assert boundaries.crossings(positions, boundaries.CELLS["periodic"]) == 2


def test_water_runs(run):
    for water in run(cutoff, (cutoff.RIGID, "first, N = 6"), 20).values():
        assert not water.lost and len(water.time) == 3
        assert water.temperature[0] == pytest.approx(300.0, abs=1.0)


@pytest.mark.parametrize(
    "hot, lost, holds", [(600.0, False, True), (640.0, False, False), (500.0, True, False)]
)
def test_water_is_judged_by_temperature(hot, lost, holds):
    time, noise = 20.0 * np.arange(251), np.random.default_rng(1).normal(size=251)
    rigid = cutoff.Water(time, 100 * noise, 500.0 + noise, False)
    other = replace(rigid, temperature=hot + noise, lost=lost)
    assert held(cutoff.find({cutoff.RIGID: rigid, "first, N = 6": other})) == [holds]
