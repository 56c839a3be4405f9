"""The package in the form for LAMMPS: LAMMPS' own coding standard, format and lists."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from example_logs import copy_examples
from running import ROOT, own_environment, tree_source
from thrown import DECK

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
    for name, ending in re.findall(r"^ +((?:fix_)?gear_quat\w*)(\.h|\.cpp)?  ", readme, re.M):
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


def test_style_headers_include_their_base_class_only():
    text = (PACKAGE / "fix_gear_quat.h").read_text()
    assert "FixStyle(gear/quat,FixGearQuat);" in text and "LMP_FIX_GEAR_QUAT_H" in text
    ours = set(re.findall(r'#include "(.*)"', text)) - {path.name for path in SOURCES}
    assert ours == {"fix.h"}


# --- citations ------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "keywords, papers",
    {
        "": set(),
        "formulation first": {"Evans1977"},
        "formulation second": {"Rapaport1985"},
        "formulation first isokinetic total": {"Evans1977", "EvansGauss1983"},
        "temp 1.0 1.0 0.5": {"Martyna1992"},
    }.items(),
)
def test_papers_of_the_features_in_use(lmp_tree, keywords, papers, tmp_path):
    deck = DECK.format(load="").replace("gear/quat single", f"gear/quat single {keywords}")
    deck = deck[: deck.index("run 20")]
    command = [lmp_tree.executable, "-cite", "cite.bib", "-log", "none", "-screen", "none"]
    environment = {**own_environment(), **lmp_tree.environment}
    subprocess.run(command, input=deck, text=True, cwd=tmp_path, env=environment, timeout=60, check=True)
    asked = re.findall(r"^@\w+\{(\w+),", (tmp_path / "cite.bib").read_text(), re.M)
    ours = set(asked) - {"LAMMPS", "Thompson2022"}
    assert ours == {"Gear1971"} | papers and len(asked) == len(set(asked))
