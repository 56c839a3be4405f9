"""The engine of the benchmarks: logs, many runs, stored data, publishing, the command."""

import time
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import __main__ as command
from benchmarks.engine import Curve, Finding, Job, Lab, LammpsError, Measurement, Panel
from benchmarks.engine import Study, Table, conduct, publish, runner
from benchmarks.engine.costs import Cost
from benchmarks.engine.store import read_data, write_data
from lammps_gearquat.logs import Log

PROGRAM = """#!/bin/sh
# stands in for lmp: -in DECK -log LOG -nocite; the deck is a shell script
echo "LAMMPS (made up)" > "$4"
. ./$2
"""


@pytest.fixture
def fake(tmp_path):
    """A Lab whose LAMMPS runs its deck as a shell script, and a maker of decks."""
    program = tmp_path / "lmp"
    program.write_text(PROGRAM)
    program.chmod(0o755)

    def deck(name, script):
        (tmp_path / name).write_text(script)
        return tmp_path / name

    return Lab(tmp_path / "out", str(program), jobs=2), deck


# --- logs ---------------------------------------------------------------------------------------
def test_tables_of_a_log_that_ends_early(tmp_path):
    log = tmp_path / "log"
    log.write_text(
        "   Step Time v_total\n 0 0.0 1.5\nWARNING: a word\n 10 0.1 -nan\n"
        "Loop time of 1.5 on 2 procs for 10 steps\n 5 5 5\n"
        "Modify  | 0.1        | 0.2        | 0.3        |   0.0 | 24.69\n"
        "Other   |            | 0.4        |            |       |  4.37\nNlocal: 1\n"
        "   Step PotEng\n 0 2.0\nERROR: lost\n"
    )
    first, second = Log(log).tables
    assert list(first) == ["Step", "Time", "v_total"]
    assert first["Step"].tolist() == [0, 10] and first["v_total"].tolist() == [1.5, np.inf]
    assert second["PotEng"].tolist() == [2.0]
    assert Log(log).timers == [{"Loop": 1.5, "Ranks": 2, "Modify": 0.3, "Other": 0.4}]
    log.write_text("LAMMPS\nERROR: nothing was run\n")
    with pytest.raises(ValueError, match="no thermo output"):
        Log(log).thermo
    with pytest.raises(ValueError, match="no loop time"):
        Log(log).seconds


# --- one run ------------------------------------------------------------------------------------
def gone(pid):
    """True if a process ends within two seconds."""
    for _ in range(100):
        status = Path(f"/proc/{pid}/stat")
        if not status.exists() or status.read_text().split()[2] == "Z":
            return True
        time.sleep(0.02)
    return False


def test_error_is_told_with_the_last_lines_and_ends_the_whole_group(fake, tmp_path):
    lab, deck = fake
    child = f"sleep 60 > /dev/null 2>&1 &\necho $! > {tmp_path}/child\n"
    bad = deck("bad", child + "echo ERROR: no such fix\nexit 3\n")
    with pytest.raises(LammpsError, match="(?s)log.bad: exit code 3.*ERROR: no such fix"):
        runner.run(bad, tmp_path / "log.bad", {}, lab.lmp)
    assert gone(int((tmp_path / "child").read_text()))


# --- many runs ----------------------------------------------------------------------------------
def test_an_error_ends_all_runs_unless_it_is_a_result(fake):
    lab, deck = fake
    endless = Job(deck("in.endless", "while true; do echo 1 1 1; sleep 0.05; done\n"), {}, 1000)
    bad = Job(deck("in.bad", "echo ERROR: lost atoms\nexit 1\n"), {})
    begin = time.monotonic()
    with pytest.raises(LammpsError, match="exit code 1"):
        lab.many({"endless": endless, "bad": bad})
    assert time.monotonic() - begin < 10
    assert "lost atoms" in lab.many({"bad": bad}, may_fail=lambda text: "lost atoms" in text)["bad"].error
    with pytest.raises(LammpsError, match="lost atoms"):
        lab.many({"bad": bad}, may_fail=lambda text: "other" in text)


# --- data, page, publishing -----------------------------------------------------------------------
def test_data_come_back_as_they_were(tmp_path):
    """Also views of arrays, keys that are tuples, and numbers that are not finite."""
    data = {
        ("pose", 0.1): (np.array([1.0, np.inf, 1e-300]), "text", None),
        "cost": Cost(float("inf"), "at most"),
        3: [np.float64(0.1), True, float("nan")],
    }
    whole = np.random.default_rng(1).normal(size=(30, 4, 3))
    data |= {"part": whole[:, 0], "turned": np.swapaxes(whole, 1, 2), "column": whole[:, :, 1].T}
    data |= {"whole": whole, "every": whole[::2], "bytes": whole.astype(">f8")[1:]}
    write_data(tmp_path / "data.json", data)
    np.testing.assert_equal(read_data(tmp_path / "data.json"), data)


def made_up(value=1e-13, **of_study):
    """A study that runs nothing."""
    x = np.array([1.0, 2.0])

    def find(data):
        panels = (
            Panel("left", "time", "error", (Curve("a line", x, data["x"], "first"),)),
            Panel("right", "", "ns", (Curve("", x, x, "second", error=x),)),
        )
        table = Table(("a", "b|c"), [(1, "x|y")])
        measurements = [Measurement("an error", value, 1e-14, most=1e-12)]
        return Finding(measurements, {"both": table}, {"both": panels}, {"length": 1234567})

    settings = {"blocks": {"README.md": "block.md.j2"}} | of_study
    return Study("made", "Made up", 1.0, lambda lab: {"x": x}, find, **settings)


@pytest.fixture
def templates(tmp_path, monkeypatch):
    folder = tmp_path / "templates"
    folder.mkdir()
    (folder / "block.md.j2").write_text(
        "{{ provenance }}\n{{ table('both') }}\n"
        "{{ picture('both', 'Both.') }}\n{{ length | grouped }}\n"
    )
    monkeypatch.setattr("benchmarks.engine.page.TEMPLATES", folder)
    return folder


def test_publishing_writes_blocks_and_pictures(templates, tmp_path, monkeypatch):
    root, out = tmp_path / "root", tmp_path / "out"
    root.mkdir()
    readme, study = root / "README.md", made_up()
    mark = publish.begin("benchmarks/run made --publish")
    finding = conduct.conduct(study, out)
    for text in ("", mark, f"{mark}\n{publish.END}\n" * 2, f"{publish.END}\n{mark}"):
        readme.write_text(text)
        with pytest.raises(publish.PublishError, match="README.md needs one"):
            publish.check_places(study, root)
    readme.write_text(f"before\n{mark}\nold\n{publish.END}\nafter\n")
    (out / "made" / "other.png").touch()
    publish.publish(study, finding, "Somewhere.", out, root)
    assert [path.name for path in (root / "doc" / "made").iterdir()] == ["both.png"]
    block = "Somewhere.\n| a | b\\|c |\n|---|---|\n| 1 | x\\|y |\n"
    block += "![Both.](made/both.png)\n\n*Both.*\n1 234 567"
    assert readme.read_text() == f"before\n{mark}\n{block}\n{publish.END}\nafter\n"


# --- the command --------------------------------------------------------------------------------
@pytest.fixture
def run(templates, tmp_path, monkeypatch):
    def call(*words, **of_study):
        study = made_up(**({"blocks": {}} | of_study))
        monkeypatch.setattr(command, "all_studies", lambda: {"made": study})
        return CliRunner().invoke(command.main, [*words, "--out", str(tmp_path / "out")])

    return call


def test_check_refuses_what_is_out_of_bounds(run):
    done = run("made", "--check")
    assert done.exit_code == 0 and "1 of 1 bounds hold" in done.output
    done = run("made", "--check", value=1.01e-12)
    assert done.exit_code == 1 and "FAILED an error: 1.0e-12" in done.output
    assert run("made", value=1.01e-12).exit_code == 0
