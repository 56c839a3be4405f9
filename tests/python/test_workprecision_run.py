"""``benchmarks/run workprecision`` in real LAMMPS: one run, its errors, a small command."""

import csv
import math

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.engine import decks
from benchmarks.studies.cases import accuracy
from benchmarks.commands.workprecision import SCENES, workprecision
from benchmarks.studies.workprecision import conduct, measure, plan, worker
from benchmarks.studies.workprecision.references import reference_of

SCENE = plan.case1(quick=True)


@pytest.fixture
def session(tmp_path):
    with measure.Session(tmp_path / "logs") as running:
        yield running


def test_commands_of_a_deck_are_followed_up_to_its_run():
    commands, run = worker.deck_commands(decks.deck_of_case(1))
    first = {command.split()[0] for command in commands}
    assert run == "run ${steps}" and {"units", "read_data", "fix", "timestep"} <= first
    assert not first & {"run", "include", "#"} and not any(c.endswith("&") for c in commands)


def test_a_deck_without_a_run_is_refused(tmp_path):
    (tmp_path / "in.none").write_text("units lj\n# run 5\n")
    with pytest.raises(worker.DeckError, match="run command is needed"):
        worker.deck_commands(tmp_path / "in.none")
    with pytest.raises(worker.DeckError, match="cannot be read"):
        worker.deck_commands(tmp_path / "in.nowhere")


LOG = """\
Fix gear/quat move: start of order 7 from 24 force evaluations
Modify  | 0.0028613  | 0.0028613  | 0.0028613  |   0.0 | 23.92
"""


def test_what_a_log_tells():
    assert worker.start_evaluations(LOG) == 24 and worker.start_evaluations("") == 0
    assert worker.modify_seconds(LOG) == 0.0028613 and math.isnan(worker.modify_seconds(""))


def test_a_run_is_judged_and_repeats(session, tmp_path):
    run = plan.Run(SCENE, plan.gear("second", 6), 10240)
    reference = reference_of(SCENE, tmp_path / "reference", session)
    judged = conduct.judge(session, run, reference)
    body, masses = judged.outcome.molecules == 1, judged.outcome.masses
    centre = masses[body] @ judged.outcome.after[body] / masses[body].sum()
    known = np.linalg.norm(centre - accuracy.reference())
    assert judged.errors.position == pytest.approx(known, abs=2e-13) and known < 1e-10
    assert judged.errors.orientation < 1e-10 and judged.errors.energy < 1e-8
    assert judged.errors.norm < 1e-14 and judged.errors.tangency < 1e-14
    assert judged.outcome.start > 0
    assert 0 < conduct.timed(session, run, judged) < 10
    row = conduct.row_of(run, judged, None)
    assert row.evaluations == 1 + row.start + 10240 and math.isnan(row.seconds)


def test_a_timed_run_that_differs_is_refused(session, tmp_path):
    run = plan.Run(SCENE, plan.RIGID_NVE, 640)
    judged = conduct.judge(session, run, reference_of(SCENE, tmp_path, session))
    judged.outcome.after[0, 0] *= 1 + 1e-15
    with pytest.raises(worker.DeckError, match="does not repeat"):
        conduct.timed(session, run, judged)


def test_defaults_are_those_of_the_fix(session):
    """Giving the keywords that plan.py takes for defaults changes nothing, to the bit."""
    for formulation, method in plan.DEFAULTS.items():
        bare = () if method == plan.DEFAULT else (("formulation", formulation),)
        plain = plan.Method("bare", "", formulation, 0, 0, bare)
        told = session.run(plan.Run(SCENE, method, 320))
        untold = session.run(plan.Run(SCENE, plain, 320))
        assert np.array_equal(told.after, untold.after), f"{method.label}: not the defaults"


def test_usable_steps(session):
    found = conduct.largest_step(session, SCENE, plan.gear("second", 8))
    assert 0.3 < found.dt < 2.0
    assert conduct.is_usable(session, plan.Run(SCENE, plan.gear("second", 8), found.steps))
    assert not conduct.is_usable(session, plan.Run(SCENE, plan.gear("second", 8), 60))


def test_a_run_that_hangs_is_ended(session, monkeypatch):
    monkeypatch.setattr(measure, "PATIENCE", 1e-3)
    run = plan.Run(SCENE, plan.RIGID_NVE, 1_000_000)
    with pytest.raises(worker.RunError, match="not finished"):
        session.run(run)
    monkeypatch.setattr(measure, "PATIENCE", 20.0)
    assert session.run(plan.Run(SCENE, plan.RIGID_NVE, 640)).seconds > 0  # it starts anew


def test_a_small_run_of_everything(tmp_path):
    arguments = ["--quick", "--timings", "1", "--scene", "case1", "--scene", "top"]
    result = CliRunner().invoke(workprecision, [*arguments, "--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    with open(tmp_path / "runs.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["scene"] for row in rows} == {"case1", "top"}
    best = min(float(r["position"]) for r in rows if r["scene"] == "case1")
    assert best < 1e-10
    for name in ("case1", "top", "main"):
        assert (tmp_path / "figures" / f"{name}.png").stat().st_size > 10_000
    text = (tmp_path / "accuracy_cost.md").read_text()
    assert "What accuracy costs" in text and "figures/main.png" in text


def test_bad_options_are_refused(tmp_path):
    def refusal(*arguments):
        result = CliRunner().invoke(workprecision, [*arguments, "--out", str(tmp_path / "out")])
        assert result.exit_code != 0 and not (tmp_path / "out").exists()
        return result.output

    assert "is not a checkout" in refusal("--publish", str(tmp_path))
    assert "all scenes" in refusal("--publish", str(tmp_path), "--quick")
    assert "drift.md" in refusal("--drift", str(tmp_path))
    assert "'steam'" in refusal("--scene", "steam")
    assert set(SCENES) == set(plan.SCENES)
