"""The study accuracy in real LAMMPS: single runs, their errors, one scene as a whole."""

import numpy as np
import pytest

from benchmarks.engine import Lab, LammpsError, session
from benchmarks.studies import accuracy as study
from benchmarks.studies.accuracy import plan, runs
from benchmarks.studies.cases import accuracy

SCENE = plan.scenes(True)["case1"]


@pytest.fixture
def lammps(tmp_path):
    with session.Session(tmp_path / "logs") as running:
        yield running


def test_errors_of_a_run_and_its_repetition(lammps, tmp_path):
    run = plan.Run(SCENE, plan.setting("second", 6), 10240)
    outcome, errors = runs.judged(lammps, run, runs.reference_of(SCENE, tmp_path, lammps))
    body, masses = outcome.molecules == 1, outcome.masses
    center = masses[body] @ outcome.after[body] / masses[body].sum()
    known = np.linalg.norm(center - accuracy.reference())
    assert errors.position == pytest.approx(known, abs=2e-13) and known < 1e-10
    assert errors.orientation < 1e-10 and errors.energy < 1e-8
    assert errors.norm < 1e-14 and errors.tangency < 1e-14
    assert outcome.start > 0 and len(outcome.thermo["Time"]) == SCENE.samples + 1
    assert 0 < runs.timed(lammps, run, outcome) < 10
    outcome.after[0, 0] *= 1 + 1e-15
    with pytest.raises(LammpsError, match="does not repeat"):
        runs.timed(lammps, run, outcome)
    timed = run.perform(lammps, timers=True)
    assert 0 < timed.modify < timed.seconds


def test_defaults_are_those_of_the_fix(lammps):
    """Giving the keywords that plan.py takes for defaults changes nothing, to the bit."""
    for formulation, method in plan.DEFAULTS.items():
        given = {} if method == plan.DEFAULT else {"formulation": formulation}
        bare = plan.Run(SCENE, method, 320).variables(False)
        bare = {k: v for k, v in bare.items() if k not in method.variables} | given
        told = plan.Run(SCENE, method, 320).perform(lammps)
        untold = lammps.run(SCENE.deck, bare, "bare")
        assert np.array_equal(told.after, untold.after), f"{method.label}: not the defaults"


def test_usable_steps(lammps):
    method = plan.setting("second", 8)
    step = runs.largest_step(lammps, SCENE, method)
    assert 0.3 < step < 2.0
    assert runs.is_usable(lammps, plan.Run(SCENE, method, round(200 / step)))
    assert not runs.is_usable(lammps, plan.Run(SCENE, method, 60))


def test_a_run_that_hangs_is_ended(lammps, monkeypatch):
    monkeypatch.setattr(session, "PATIENCE", 1e-3)
    with pytest.raises(session.RunError, match="not finished"):
        plan.Run(SCENE, plan.RIGID_NVE, 1_000_000).perform(lammps)
    monkeypatch.setattr(session, "PATIENCE", 60.0)
    assert plan.Run(SCENE, plan.RIGID_NVE, 640).perform(lammps).seconds > 0  # it starts anew


def test_a_deck_that_fails_is_refused(lammps, tmp_path):
    (tmp_path / "in.bad").write_text("units nonsense\n")
    with pytest.raises(LammpsError, match="nonsense"):
        lammps.run(tmp_path / "in.bad", {"steps": 1}, "bad")


def test_a_quick_scene_as_a_whole(tmp_path):
    done = []
    results = runs.measure(Lab(tmp_path, quick=True, parts=("top",), advance=done.append))
    assert sum(done) == pytest.approx(1.0)
    finding = study.find(results)
    assert min(point.orientation for point in results.runs) < 1e-9
    assert all(0.1 < step < 5 for step in results.limits.values())
    assert len(finding.tables["runs"].rows) == len(results.runs)
