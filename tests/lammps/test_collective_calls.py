"""In test builds a run ends if ranks make different collective calls; without this check it would never end."""

import subprocess
from pathlib import Path

import pytest

from support.running import ROOT, TREE_BUILD, tree_source


@pytest.fixture(scope="module")
def command() -> Path:
    """A plugin with a command that makes calls, compiled as the tests compile the package."""
    library = ROOT / "build" / "calls-test.so"
    source = ROOT / "tests" / "lammps" / "calls_plugin.cpp"
    words = "mpicxx.openmpi -std=c++17 -O1 -shared -fPIC -DLAMMPS_SMALLBIG -DOMPI_SKIP_MPICXX -DGEARQUAT_CHECKS"
    folders = [ROOT / "src" / "GEARQUAT", tree_source() / "src", tree_source() / "src" / "PLUGIN"]
    subprocess.run([*words.split(), *(f"-I{one}" for one in folders), str(source), "-o", str(library)], check=True)
    return library


@pytest.mark.parametrize("calls", ["missing", "order"])
@pytest.mark.parametrize("ranks", [2, 3])
def test_different_calls_end_a_run(lmp_tree, command, ranks, calls):
    deck = f"plugin load {command}\ncalls_test equal\ncalls_test {calls}"
    result = lmp_tree.refuse(deck, "ranks make different collective calls; one is at", ranks=ranks)
    assert result.stdout.count("equal calls") == 1
    assert "calls_plugin.cpp" in result.output


@pytest.mark.parametrize("ranks", [1, 2])
def test_equal_calls_do_not(lmp_tree, command, ranks):
    assert "equal calls" in lmp_tree.succeed(f"plugin load {command}\ncalls_test equal", ranks=ranks).stdout


def test_the_package_has_no_other_collective_calls():
    for path in sorted((ROOT / "src" / "GEARQUAT").glob("*.[ch]*")):
        if path.name != "gear_quat_ranks.h":
            assert "MPI_All" not in path.read_text(), path.name


def test_the_build_for_tests_has_the_check():
    options = (TREE_BUILD / "CMakeCache.txt").read_text()
    assert "GEARQUAT_CHECKS:BOOL=on" in options
