"""The patch for LAMMPS' core in doc/upstream: it applies, and the fix finds what it adds, and no more than that."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from running import ROOT, source_trees

PATCH = ROOT / "doc" / "upstream" / "evaluate_forces.patch"
RELEASE = "4 Feb 2025"

FOUND = """
#include "gear_quat_declared.h"

#include "bond.h"
#include "fix.h"
#include "integrate.h"
#include "pair.h"

#include <type_traits>

using namespace LAMMPS_NS;

template <typename Style, typename = void> struct Declares : std::false_type {};
template <typename Style>
struct Declares<Style, std::void_t<decltype(Style::repeatable), decltype(Style::no_net_force)>> : std::true_type {};
template <typename Run, typename = void> struct Evaluates : std::false_type {};
template <typename Run>
struct Evaluates<Run, std::void_t<decltype(std::declval<Run *>()->evaluate_forces(0, 0)),
                                  decltype(Run::evaluate_forces_flag)>> : std::true_type {};

static_assert(Declares<Pair>::value == PATCHED);
static_assert(Declares<Bond>::value == PATCHED);
static_assert(Declares<Fix>::value == PATCHED);
static_assert(Evaluates<Integrate>::value == PATCHED);

int declared(Pair *pair, Bond *bond, Fix *fix, Integrate *run)
{
  using namespace GearQuat;
  return evaluated_by(run, 0, 0) + declared_repeatable(pair) + declared_repeatable(bond) +
      declared_repeatable(fix) + declared_no_net_force(pair);
}
"""


@pytest.fixture(scope="module")
def source() -> Path:
    """LAMMPS as the patch knows it."""
    for tree in source_trees():
        if f'"{RELEASE}"' in (tree / "src" / "version.h").read_text():
            return tree
    pytest.fail(f"no sources of LAMMPS {RELEASE}: run `tests/run build`")


@pytest.fixture
def tree(source, tmp_path) -> Path:
    """Those files of LAMMPS that the patch changes."""
    names = re.findall(r"^--- a/(\S+)$", PATCH.read_text(), re.M)
    assert len(names) > 30 and "src/verlet.cpp" in names
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source / name, tmp_path / name)
    return tmp_path


def apply(tree: Path) -> subprocess.CompletedProcess:
    words = ["git", "apply", "--whitespace=error", str(PATCH)]
    return subprocess.run(words, cwd=tree, capture_output=True, text=True)


def compiles(source: Path, include: list[Path], patched: bool) -> bool:
    folders = [*include, ROOT / "src" / "GEARQUAT", source / "src", source / "src" / "STUBS"]
    words = ["c++", "-std=c++17", "-fsyntax-only", "-x", "c++", f"-DPATCHED={str(patched).lower()}"]
    words += ["-DLAMMPS_SMALLBIG", *(f"-I{folder}" for folder in folders), "-"]
    return subprocess.run(words, input=FOUND, capture_output=True, text=True).returncode == 0


def test_it_applies(tree):
    done = apply(tree)
    assert done.returncode == 0, done.stderr
    assert "void Verlet::evaluate_forces" in (tree / "src" / "verlet.cpp").read_text()


def test_it_does_not_apply_to_another_line(tree):
    text = (tree / "src" / "verlet.h").read_text()
    (tree / "src" / "verlet.h").write_text(text.replace("force_clear", "clear_forces"))
    assert apply(tree).returncode != 0


def test_the_compiler_finds_what_it_adds(source, tree):
    assert compiles(source, [], patched=False) and not compiles(source, [], patched=True)
    apply(tree)
    patched = [tree / "src"]
    assert compiles(source, patched, patched=True) and not compiles(source, patched, patched=False)
