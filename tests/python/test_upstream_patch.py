"""The patches for LAMMPS' core in doc/upstream: each applies to its release, and the fix detects exactly the members
that it adds. The newest release is tested where its sources are: `tests/run upstream` and `versions` fetch them."""

import contextlib
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from running import ROOT, source_trees

UPSTREAM = ROOT / "doc" / "upstream"
PATCHES = {
    "4 Feb 2025": UPSTREAM / "evaluate_forces_4Feb2025.patch",
    "4 Jul 2026": UPSTREAM / "evaluate_forces_4Jul2026.patch",
}

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


def sources() -> dict[str, Path]:
    """Release -> sources on this machine."""
    trees = [Path(folder) for folder in [os.environ.get("GEARQUAT_UPSTREAM")] if folder]
    with contextlib.suppress(AssertionError):
        trees += source_trees()
    found = {}
    for tree in trees:
        release = re.search(r'LAMMPS_VERSION "(.*)"', (tree / "src" / "version.h").read_text())[1]
        found.setdefault(release, tree)
    return found


SOURCES = sources()
OLDEST = "4 Feb 2025"


@pytest.fixture(scope="module", params=[release for release in PATCHES if release == OLDEST or release in SOURCES])
def release(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def source(release) -> Path:
    """The LAMMPS of the patch."""
    if release not in SOURCES:
        pytest.fail(f"no sources of LAMMPS {release}: run `tests/run build`")
    return SOURCES[release]


@pytest.fixture(scope="module")
def patch(release) -> Path:
    return PATCHES[release]


@pytest.fixture
def tree(source, patch, tmp_path) -> Path:
    """Those files of LAMMPS that the patch changes."""
    names = re.findall(r"^--- a/(\S+)$", patch.read_text(), re.M)
    assert len(names) > 30 and "src/verlet.cpp" in names
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source / name, tmp_path / name)
    return tmp_path


def apply(tree: Path, patch: Path) -> subprocess.CompletedProcess:
    words = ["git", "apply", "--whitespace=error", str(patch)]
    return subprocess.run(words, cwd=tree, capture_output=True, text=True)


def compiles(source: Path, include: list[Path], patched: bool) -> bool:
    folders = [*include, ROOT / "src" / "GEARQUAT", source / "src", source / "src" / "STUBS"]
    words = ["c++", "-std=c++17", "-fsyntax-only", "-x", "c++", f"-DPATCHED={str(patched).lower()}"]
    words += ["-DLAMMPS_SMALLBIG", *(f"-I{folder}" for folder in folders), "-"]
    return subprocess.run(words, input=FOUND, capture_output=True, text=True).returncode == 0


def test_it_applies(tree, patch):
    done = apply(tree, patch)
    assert done.returncode == 0, done.stderr
    assert "void Verlet::evaluate_forces" in (tree / "src" / "verlet.cpp").read_text()


def test_it_does_not_apply_to_another_line(tree, patch):
    text = (tree / "src" / "verlet.h").read_text()
    (tree / "src" / "verlet.h").write_text(text.replace("force_clear", "clear_forces"))
    assert apply(tree, patch).returncode != 0


def test_the_compiler_finds_what_it_adds(source, tree, patch):
    assert compiles(source, [], patched=False) and not compiles(source, [], patched=True)
    apply(tree, patch)
    patched = [tree / "src"]
    assert compiles(source, patched, patched=True) and not compiles(source, patched, patched=False)


def test_every_run_style_from_verlet_says_whether_it_has_it(source, tree, patch):
    """A run style that is derived from Verlet evaluates forces differently, and would inherit the flag."""
    apply(tree, patch)
    derived = [path for path in (source / "src").glob("*/*.h") if re.search(r": public Verlet\b", path.read_text())]
    assert len(derived) >= 3
    for path in derived:
        changed = tree / path.relative_to(source).with_suffix(".cpp")
        assert changed.exists() and "evaluate_forces_flag = 0;" in changed.read_text(), path.name
