"""The package in the form for LAMMPS: LAMMPS' own coding standard, format and lists."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from support.example_logs import copy_examples
from support.running import ROOT, TREE_BUILD, tree_source

PACKAGE = ROOT / "src" / "GEARQUAT"
SOURCES = sorted([*PACKAGE.glob("*.h"), *PACKAGE.glob("*.cpp")])


@pytest.fixture(scope="module")
def tree(tmp_path_factory) -> Path:
    """The files of this project in a LAMMPS tree with GEARQUAT, and LAMMPS' scripts."""
    tree = tmp_path_factory.mktemp("lammps")
    shutil.copytree(tree_source() / "tools" / "coding_standard", tree / "tools" / "coding_standard")
    shutil.copytree(PACKAGE, tree / "src" / "GEARQUAT")
    (tree / "doc" / "src").mkdir(parents=True)
    (manual,) = (ROOT / "doc").rglob("fix_gear_quat.rst")
    shutil.copy(manual, tree / "doc" / "src")
    tests = tree / "unittest" / "force-styles" / "tests"
    tests.mkdir(parents=True)
    for yaml in (ROOT / "tests" / "lammps").glob("fix-timestep-*.yaml"):
        shutil.copy(yaml, tests)
    copy_examples(tree)
    return tree


def standard(tree, check):
    """The complaints of one of LAMMPS' scripts; empty if there are none."""
    script = tree_source() / "tools" / "coding_standard" / f"{check}.py"
    done = subprocess.run([sys.executable, str(script), str(tree)], capture_output=True, text=True)
    told = done.stdout + done.stderr
    assert done.returncode in (0, 1) and (done.returncode == 0) == (told == ""), told
    return told


@pytest.mark.parametrize("check", ["whitespace", "homepage", "errordocs", "fmtlib", "permissions"])
def test_lammps_coding_standard(tree, check):
    assert standard(tree, check) == ""


def test_a_new_style_is_tagged(tree):
    """`versionadded:: TBD` in the manual: LAMMPS' script lists it at the next release."""
    assert "fix_gear_quat.rst" in standard(tree, "versiontags")


def test_lammps_format():
    tool = Path(sysconfig.get_path("scripts")) / "clang-format"
    rules = f"--style=file:{tree_source() / 'src' / '.clang-format'}"
    # all files at once, because the start of the tool takes longer than a file
    done = subprocess.run([tool, rules, "--dry-run", *SOURCES], capture_output=True, text=True, check=True)
    assert done.stderr == ""


# --- contents of the package ----------------------------------------------------------------------
README = (PACKAGE / "README").read_text()


def files_listed(readme):
    """Files that the README lists; a name without an ending denotes a header and a source file."""
    for name, ending in re.findall(r"^ +((?:fix_)?gear_quat\w*)(\.h|\.cpp)? +\S", readme, re.M):
        yield from [name + ending] if ending else [f"{name}.cpp", f"{name}.h"]


def test_readme_names_every_file_once():
    files = [path.name for path in SOURCES]
    assert sorted(files_listed(README)) == sorted(files)


def test_the_kernel_needs_the_standard_library_only():
    kernel = set(files_listed(README.partition("  The kernel")[2].partition("\n\n  The command")[0]))
    assert "gear_quat_integrator.h" in kernel and len(kernel) > 8
    for name in kernel:
        text = (PACKAGE / name).read_text()
        assert set(re.findall(r'#include "(.*)"', text)) <= kernel, name


def test_ranks_are_called_together_in_one_header_alone():
    """In test builds its calls compare what all ranks do; a run that differs ends instead of waiting for ever."""
    assert [path.name for path in SOURCES if "MPI_All" in path.read_text()] == ["gear_quat_ranks.h"]
    assert "GEARQUAT_CHECKS:BOOL=on" in (TREE_BUILD / "CMakeCache.txt").read_text()


def test_style_headers_include_their_base_class_only():
    text = (PACKAGE / "fix_gear_quat.h").read_text()
    assert "FixStyle(gear/quat,FixGearQuat);" in text and "LMP_FIX_GEAR_QUAT_H" in text
    ours = set(re.findall(r'#include "(.*)"', text)) - {path.name for path in SOURCES}
    assert ours == {"fix.h"}
