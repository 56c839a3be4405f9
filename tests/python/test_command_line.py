"""The command gearquat as a user meets it: help whose examples work, version, missing extra."""

import re
import shutil
import subprocess
import sys
from importlib import metadata

import pytest
from click.testing import CliRunner

from lammps_gearquat.cli import main
from lammps_gearquat.commands.common import ANALYSIS
from pages import paste
from running import EXAMPLES, ROOT

COMMANDS = ("cost", "horizon", "analyze", "scatter")


def examples_of(command):
    """Lines below "Examples" of a help page, as they are printed."""
    result = CliRunner().invoke(main, [command, "-h"])
    assert result.exit_code == 0, result.output
    return re.search(r"^Examples.*\n((?:  .*\n)+)", result.output, re.M)[1]


@pytest.mark.parametrize("command", COMMANDS)
def test_examples_of_the_help_can_be_pasted(command, tmp_path):
    for folder in ("common", "case1", "case2", "water", "collisions"):
        shutil.copytree(EXAMPLES / folder, tmp_path / "examples" / folder)
    done = paste(examples_of(command), tmp_path)
    assert list(tmp_path.rglob(f"gearquat-{command}/*.png"))
    # and no progress bar where nobody watches
    assert "%|" not in done.stderr


def test_version():
    result = CliRunner().invoke(main, ["--version"])
    assert result.output.strip() == metadata.version("lammps-gearquat")


MAIN = "from lammps_gearquat.cli import main; main()"


@pytest.mark.parametrize(
    ("code", "command"),
    [*((MAIN, name) for name in COMMANDS), ("from lammps_gearquat.analysis import Poses", "")],
)
def test_without_the_extra_it_is_named(code, command, tmp_path):
    code = f"import sys; sys.modules.update(dict.fromkeys({ANALYSIS})); {code}"
    done = subprocess.run(
        [sys.executable, "-c", code, command, str(ROOT / "README.md")],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1
    *before, message = done.stderr.splitlines()
    assert "which the extra [analysis] brings: run pip install" in message
    if command:
        assert message.startswith("Error: ") and not before
    assert not list(tmp_path.iterdir())


def test_the_extra_is_what_the_commands_import():
    """Every module that the package imports is in the standard library or is listed."""
    requirements = metadata.requires("lammps-gearquat")
    extra = {re.match(r"[\w-]+", line)[0] for line in requirements if "analysis" in line}
    assert extra >= set(ANALYSIS)
    sources = (ROOT / "src" / "lammps_gearquat").rglob("*.py")
    imported = {
        name
        for source in sources
        for name in re.findall(r"^\s*(?:import|from) (\w+)", source.read_text(), re.M)
    }
    known = {*ANALYSIS, *sys.stdlib_module_names, "cloup", "lammps", "lammps_gearquat"}
    assert imported <= known
