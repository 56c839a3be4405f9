"""The hard cases, made short: bounds hold for what the fix does, and are broken without the mend."""

import runpy

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
def lab(tmp_path):
    return Lab(tmp_path)


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


@pytest.mark.parametrize("name", ["poles", "inertia", "boundaries"])
def test_data_files_are_what_the_program_writes(examples, name):
    files = runpy.run_path(str(examples / "hard" / name / f"make_{name}.py"))["scene_files"]()
    assert set(files) == {
        f"hard/{name}/{p.name}" for p in (examples / "hard" / name).glob("data.*")
    }
    for path, text in files.items():
        assert (examples / path).read_text() == text
        assert (examples / path).read_text() != text.replace("1", "1.01", 1)


# --- cases --------------------------------------------------------------------------------------


def test_encounter(lab):
    results = encounter.measure(lab, ["0.02"])
    assert all(held(encounter.find(results)))
    fixed = f"step {encounter.STEP:g}, second"
    results["0.02", "tolerance, second"] = results["0.02", fixed]
    assert held(encounter.find(results)) == [False, True, True, True]


def test_long(lab, tmp_path):
    short = {"until": 200, "steps": 100_000}
    assert all(held(long.find(long.measure(lab, ["0e-9"], **short))))
    loose = long.measure(Lab(tmp_path / "loose"), ["0e-9"], **short, tolerance=1e-9)
    assert held(long.find(loose)) == [False, False, True] * 2


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


def test_fine_steps(lab, tmp_path):
    """Not as many: what compensated sums and projection do is seen in 20 000 steps."""
    short = {"dt": 0.001, "steps": 20_000, "every": 200}
    results = fine.measure(lab, **short)
    assert all(held(fine.find(results)))
    free = fine.measure(Lab(tmp_path / "free"), **short, project="no", start="zero")
    assert not held(fine.find(free))[-1]  # the length of q

    found = results["yes", "second"]
    found.total[-1] += 1.01e-12
    assert held(fine.find(results)) == [True, True, False, True, True]


def test_poles(lab, tmp_path):
    coarse = {"dt": 0.1, "steps": 200}
    assert held(poles.find(poles.measure(lab, ["passing"], **coarse))) == [True]
    free = poles.measure(Lab(tmp_path / "free"), ["passing"], **coarse, project="no")
    assert held(poles.find(free)) == [False]  # without projection the frame matters


def test_poles_see_a_small_turn():
    positions = np.random.default_rng(1).normal(size=(3, 6, 3))
    turn = poles.rotation()
    assert turn @ turn.T == pytest.approx(np.eye(3), abs=1e-15)
    assert poles.difference(positions, positions @ turn.T, turn).max() < 1e-14
    other = poles.rotation((4, 1, 2, 3.03))
    assert poles.difference(positions, positions @ other.T, turn).min() > 1e-4


def test_tumbling(lab, tmp_path):
    most = 1e-9
    results = tumbling.measure(lab, 400_000, 5)
    assert all(held(tumbling.find(results, most)))
    plain = tumbling.measure(Lab(tmp_path / "plain"), 400_000, 5, compensate="no")
    phases = [m for m in tumbling.find(plain, most).measurements if "phase" in m.what]
    assert len(phases) == 2 and not any(m.holds for m in phases)


def test_inertia(lab, tmp_path, monkeypatch):
    monkeypatch.setattr(inertia, "COARSEST", 80)
    monkeypatch.setattr(inertia, "HALVINGS", 3)
    assert all(held(inertia.find(inertia.measure(lab, ["thin3"]))))
    zero = inertia.measure(Lab(tmp_path / "zero"), ["thin3"], start="zero")
    assert not held(inertia.find(zero))[0]  # order 1


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
    assert rate != pytest.approx(1.01 * np.sqrt(0.81 - 2 * (1 - cosine)), rel=1e-3)


def test_collision(lab):
    found = fast.measure(lab, ["wall"], (0.002,))
    assert all(held(fast.find(found)))
    # an error of 0.02 % of the energy, of which the estimates know nothing
    wrong = {key: replace(one, error=one.error + 0.02) for key, one in found.items()}
    assert held(fast.find(wrong)) == [False, True]
    wrong = {key: replace(one, error=one.error + 0.2) for key, one in found.items()}
    assert held(fast.find(wrong)) == [False, False]


def test_new_step(lab, tmp_path):
    changes = ["double", "back"]  # rescaled, and started anew
    results = newstep.measure(lab, changes)
    assert all(held(newstep.find(results)))
    zero = newstep.measure(Lab(tmp_path / "zero"), changes, start="zero")
    for change in changes:
        for formulation in newstep.FORMULATIONS:  # as if the history were left out at the change
            results[change, formulation, "kept"] = zero[change, formulation, "anew"]
    assert not any(held(newstep.find(results)))


def test_life_cycle(lab):
    results = lifecycle.measure(lab, ["pieces", "restart", "continued", "refix"])
    assert all(held(lifecycle.find(results)))
    # the cut is in the middle of the collision
    assert results["whole", "second"].potential.max() > 50.0
    for formulation in lifecycle.FORMULATIONS:
        results["pieces", formulation] = results["refix", formulation]
    assert held(lifecycle.find(results)) == [False, True, True, True]


def test_boundaries(lab, tmp_path):
    results = boundaries.measure(lab, ["corner"], 2000)
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


def test_water_runs(lab):
    methods = (cutoff.RIGID, "first, N = 5")
    for water in cutoff.measure(lab, methods, 20).values():
        assert not water.lost and len(water.time) == 3
        assert water.temperature[0] == pytest.approx(300.0, abs=1.0)


def test_water_is_judged_by_temperature():
    time = 20.0 * np.arange(251)
    noise = np.random.default_rng(1).normal(size=251)

    def water(hot, lost=False):
        return cutoff.Water(time, 100 * noise, hot + noise, lost)

    def met(one):
        results = {cutoff.RIGID: water(500.0), "first, N = 5": one}
        return held(cutoff.find(results))

    assert met(water(600.0)) == [True]
    assert met(water(640.0)) == [False]
    assert met(water(500.0, lost=True)) == [False]
