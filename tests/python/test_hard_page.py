"""``benchmarks/run hard``: the list of cases, their folders and data files, table, page, pictures, command."""

import csv
import runpy

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.engine.checkout import END, PublishError
from benchmarks.commands.hard import hard as command
from benchmarks.studies.hard import figures, page
from benchmarks.studies.hard.case import Case, Curve, Finding, Panel, at_most
from benchmarks.studies.hard.cases import CASES
from benchmarks.studies.hard.runs import tables
from benchmarks.studies.cases.page import BEGIN


def made_up(measured=1e-12):
    curve = Curve("a line", np.array([1.0, 2.0]), np.array([1e-14, measured]), "first")
    panels = (Panel("left", "time", "error", (curve,), 1e-12), Panel("right", "x", "y", (curve,)))
    return Finding((at_most("an error", 1e-12, measured, "t = 5"),), panels, "How it was done.")


CASE = Case("poles", "Made up", "Because.", 1.0, lambda runs: made_up())


@pytest.fixture
def out(tmp_path):
    folder = tmp_path / "out"
    (folder / "logs").mkdir(parents=True)
    (folder / "logs" / "log.one").write_text("LAMMPS (made up)\n")
    return folder


# --- scenes -------------------------------------------------------------------------------------
def test_every_case_has_its_folder(examples):
    keys = [case.key for case in CASES]
    assert len(set(keys)) == len(keys)
    listed = (examples / "hard" / "README").read_text()
    for key in keys:
        folder = examples / "hard" / key
        assert (folder / "README").is_file() and (folder / f"in.{key}").is_file()
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


# --- logs ---------------------------------------------------------------------------------------
def test_tables_of_a_log_that_ends_early(tmp_path):
    log = tmp_path / "log"
    log.write_text(
        "   Step Time v_total\n 0 0.0 1.5\nWARNING: a word\n 10 0.1 nan\nLoop time of 1 on\n 5 5 5\n"
        "   Step PotEng\n 0 2.0\nERROR: lost\n"
    )
    first, second = tables(log)
    assert list(first) == ["Step", "Time", "v_total"]
    assert first["Step"].tolist() == [0, 10] and np.isnan(first["v_total"][1])
    assert second["PotEng"].tolist() == [2.0]


# --- page ---------------------------------------------------------------------------------------
def test_demands():
    assert at_most("x", 1e-12, 0.99e-12).met and not at_most("x", 1e-12, 1.01e-12).met
    assert not at_most("x", 1e-12, float("nan")).met
    assert at_most("x", 1e-12, 1e-13, "here").measured == "1.0e-13 (here)"


def test_page_and_table(out):
    findings = {CASE: made_up()}
    page.write(out, findings)
    text = (out / page.PAGE).read_text()
    assert "All 1 demands are met." in text and "| an error | ≤ 1e-12 |" in text
    assert "(figures/poles.png)" in text and "LAMMPS (made up)" in text
    rows = list(csv.reader((out / "hard.csv").open(encoding="utf-8")))
    assert rows[0] == list(page.HEADER) and rows[1][-1] == "met"
    page.write(out, {CASE: made_up(1.01e-12)})
    assert "Of 1 demands 0 are met, 1 not." in (out / page.PAGE).read_text()
    assert "MISSED an error" in page.console_text({CASE: made_up(1.01e-12)})


def test_pictures_and_publishing(out, tmp_path):
    figures.draw(out / "figures" / "poles.png", made_up())
    assert (out / "figures" / "poles.png").stat().st_size > 5000
    root = tmp_path / "root"
    for folder in ("src/GEARQUAT", "doc", "examples/hard/poles"):
        (root / folder).mkdir(parents=True)
    with pytest.raises(PublishError):
        page.publish(root, out, {CASE: made_up()})
    (root / "README.md").write_text(f"{BEGIN}\n{END}\n")
    page.publish(root, out, {CASE: made_up()})
    text = (root / "doc" / page.PAGE).read_text()
    assert "(../examples/hard/poles/poles.png)" in text
    assert (root / "examples" / "hard" / "poles" / "poles.png").is_file()


# --- the command --------------------------------------------------------------------------------
def test_command(tmp_path, monkeypatch):
    out = tmp_path / "out"
    (out / "logs").mkdir(parents=True)
    monkeypatch.setattr("benchmarks.studies.hard.cases.CASES", (CASE,))
    result = CliRunner().invoke(command, ["--only", "poles", "--out", str(out)])
    assert result.exit_code == 0, result.output
    assert "met    an error: 1.0e-12 (t = 5); asked: ≤ 1e-12" in result.output
    assert (out / "figures" / "poles.png").is_file() and (out / "hard.csv").is_file()


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--only", "nonsense"], "no case nonsense; there are encounter, long, fine, poles"),
        (["--only", "poles", "--publish", "."], "--publish needs all cases"),
    ],
)
def test_bad_options(tmp_path, arguments, words):
    result = CliRunner().invoke(command, [*arguments, "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert words in result.output
