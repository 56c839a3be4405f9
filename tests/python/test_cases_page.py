"""What `benchmarks/run cases --publish` writes into a checkout, and what is committed of it."""

import pytest
from click.testing import CliRunner

from benchmarks.commands.cases import cases as main
from benchmarks.studies.cases import accuracy, claims
from benchmarks.studies.cases import page
from benchmarks.studies.cases import runs as cases
from benchmarks.studies.cases.claims import REPRODUCED
from running import ROOT


@pytest.fixture
def folder(tmp_path):
    """A checkout as far as publishing looks at it."""
    (tmp_path / "src" / "GEARQUAT").mkdir(parents=True)
    (tmp_path / "README.md").write_text("# Title\n")
    return tmp_path


@pytest.fixture
def out(tmp_path):
    """What a run leaves."""
    path = tmp_path / "out"
    for name in ("figures", "logs"):
        (path / name).mkdir(parents=True)
    for name in page.FIGURES:
        (path / "figures" / name).write_bytes(name.encode())
    (path / "logs" / "log.one").write_text("LAMMPS (1 Jan 2030)\nrun\n")
    return path


def test_everything_is_written(folder, out, results):
    found = claims.all_claims(results)
    page.publish(folder, out, found, results)
    text = (folder / "doc" / "results.md").read_text()
    for words in ("LAMMPS (1 Jan 2030)", "do not edit", "reconstructed", "Table 7", "µs a step"):
        assert words in text
    assert all(claim.paper in text and claim.rule in text for claim in found)
    assert text.count("reproduced |") >= sum(claim.verdict == REPRODUCED for claim in found)
    for name in page.FIGURES:
        assert (folder / "doc" / "figures" / name).read_bytes() == name.encode()
        assert f"(figures/{name})" in text


def test_sentences_follow_the_numbers(results, monkeypatch):
    errors = {label: [1e-3] * 4 for label in accuracy.METHODS}
    errors[page.GEAR_FIRST], errors[page.GEAR_SECOND] = [1e-5] * 4, [1e-6] * 4
    monkeypatch.setattr(accuracy, "position_errors", lambda _: errors)
    monkeypatch.setattr(accuracy, "energy_errors", lambda _: errors)
    sentence = page.accuracy_sentence(results)
    assert "100 times closer" in sentence and "the second 1 000 times" in sentence
    assert "worse" not in page.energy_sentence(results)
    errors[page.GEAR_SECOND][3] = 1.0
    assert "worse at 1: Gear's method is not symplectic" in page.energy_sentence(results)


def test_errors_are_measured_against_the_reference(results):
    exact = cases.Results()
    for run, values in results.runs.items():
        values.centre[values.at(cases.ACCURACY_END)] = accuracy.reference()
        exact.add(run, values, seconds=2e-6 * run.steps)
    assert set(map(tuple, accuracy.position_errors(exact).values())) == {(0.0,) * 4}
    assert list(accuracy.step_costs(exact).values()) == pytest.approx([2.0] * 5)
    for run, values in exact.runs.items():
        values.centre[values.at(cases.ACCURACY_END)] *= 1.01
    assert min(min(row) for row in accuracy.position_errors(exact).values()) > 0.5


def test_another_folder_is_refused_before_anything_runs(tmp_path):
    arguments = ["--publish", str(tmp_path), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(main, arguments)
    assert result.exit_code != 0 and "is not a checkout of GEARQUAT" in result.output
    assert not (tmp_path / "out").exists()


def test_what_is_committed():
    """The pictures are those that the page shows, and small."""
    sizes = {path.name: path.stat().st_size for path in (ROOT / "doc" / "figures").iterdir()}
    assert set(sizes) == set(page.FIGURES)
    assert sizes["overview.png"] < 200_000 and sum(sizes.values()) < 1_000_000
