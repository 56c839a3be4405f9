"""The command gearquat for users: help with working examples, version, missing extra."""

import re
import subprocess
import sys
from importlib import metadata

import numpy as np
import pytest
from click.testing import CliRunner

from lammps_gearquat.cli import main
from support.dumps import Motion, write
from support.pages import paste, unpack
from support.running import ROOT

COMMANDS = ("cost", "analyze", "scatter")


def examples_of(command):
    """Lines below "Examples" of a help page, as they are printed."""
    result = CliRunner().invoke(main, [*command.split(), "-h"])
    assert result.exit_code == 0, result.output
    return re.search(r"^Examples.*\n((?:  .*\n)+)", result.output, re.M)[1]


@pytest.mark.parametrize("command", COMMANDS)
def test_examples_of_the_help_can_be_pasted(command, tmp_path):
    examples = examples_of(command)
    for long, short in (("--budget 30", "--budget 15"), ("--error 0.1", "--error 0.3"), (" 200", " 50")):
        examples = examples.replace(long, short)
    done = paste(examples, unpack(tmp_path))
    assert list(tmp_path.rglob(f"gearquat-{command}/*.png"))
    # and no progress bar if the output is not a terminal
    assert "%|" not in done.stderr


def test_first_examples_are_those_of_commands():
    every = "".join(map(examples_of, COMMANDS))
    assert all(line in every for line in examples_of("").splitlines())


def test_version():
    result = CliRunner().invoke(main, ["--version"])
    assert result.output.strip() == metadata.version("lammps-gearquat")


PACKAGES = {"lammps-gearquat": ROOT / "src" / "lammps_gearquat", "gearquat-analysis": ROOT / "src" / "analysis" / "gearquat_analysis"}


def imported(distribution):
    """Names of the modules that a package imports, in lower case, without the standard library and its own."""
    folder = PACKAGES[distribution]
    sources = "\n".join(source.read_text() for source in folder.rglob("*.py"))
    names = set(re.findall(r"^\s*(?:import (?=[\w.]+(?: as \w+)?$)|from (?=[\w.]+ import))(\w+)", sources, re.M))
    return {name.lower() for name in names - {*sys.stdlib_module_names, folder.name}}


def required(distribution):
    """The same of the modules that pip installs with it, also with its extra [analysis] if it has one."""
    lines = [line for line in metadata.requires(distribution) if "extra" not in line or "analysis" in line.split(";")[1]]
    return {re.match(r"[\w-]+", line)[0].replace("-", "_").lower() for line in lines}


@pytest.mark.parametrize("distribution", PACKAGES)
def test_what_is_imported_is_required(distribution):
    assert imported(distribution) == required(distribution)


def test_licenses_go_together():
    """MDAnalysis is under the LGPL 3 or later, which code under the GPL 2 alone may not use."""
    assert "mdanalysis" not in imported("lammps-gearquat")
    assert not {"lammps", "lammps_gearquat", "benchmarks"} & imported("gearquat-analysis")


def test_gearquat_analyze_runs_apart_from_the_rest(tmp_path):
    """MDAnalysis is in another process, whose status becomes the status of the command."""
    write(tmp_path / "made.dump", Motion([3]), np.arange(4))
    code = "import sys; sys.modules['MDAnalysis'] = None; from lammps_gearquat.cli import main; main()"

    def status(*words):
        return subprocess.run([sys.executable, "-c", code, "analyze", *words], cwd=tmp_path, capture_output=True).returncode

    assert status("made.dump") == 0
    assert (tmp_path / "gearquat-analyze" / "poses.npy").is_file()
    assert status("made.dump", "--frames", "99:") == 1
    assert status("made.dump", "--unknown") == 2


@pytest.mark.parametrize("distribution", PACKAGES)
def test_links_of_its_page_on_pypi_lead_out_of_the_repository(distribution):
    page = metadata.metadata(distribution).json["description"]
    links = re.findall(r"\]\(([^)]*)\)", page)
    assert links and all(link.startswith("https://") for link in links)


def test_without_the_extra_it_is_named():
    code = "import sys; sys.modules['gearquat_analysis'] = None; import lammps_gearquat.cli"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 1 and not done.stdout
    assert done.stderr.startswith("Error: gearquat needs gearquat_analysis") and done.stderr.count("\n") == 1
    assert "the extra [analysis] brings: run pip install" in done.stderr


def test_without_lammps_dumps_are_analyzed(tmp_path):
    path = write(tmp_path / "x.dump", Motion([3, 4]), np.arange(5.0))
    forbidden = dict.fromkeys(("lammps", "lammps_gearquat"))
    code = f"import runpy, sys; sys.modules.update({forbidden}); runpy.run_module('gearquat_analysis', run_name='__main__')"
    done = subprocess.run([sys.executable, "-c", code, path], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "5 frames of 2 bodies were read" in done.stdout
    assert (tmp_path / "gearquat-analyze" / "poses.npy").is_file()
