"""Data that other C++ code gets from the fix by name."""

import subprocess
from pathlib import Path

import pytest
from support.scenes import SPCE, WATER_MASSES, water, water_data

from support.running import ROOT, tree_source

N = 27


@pytest.fixture(scope="module")
def command() -> Path:
    """A plugin with a command that prints these data."""
    library = ROOT / "build" / "extract-test.so"
    source = ROOT / "tests" / "lammps" / "extract_plugin.cpp"
    words = "mpicxx.openmpi -std=c++17 -O1 -shared -fPIC -DLAMMPS_SMALLBIG -DOMPI_SKIP_MPICXX"
    include = [f"-I{tree_source() / 'src'}", f"-I{tree_source() / 'src' / 'PLUGIN'}"]
    subprocess.run([*words.split(), *include, str(source), "-o", str(library)], check=True)
    return library


@pytest.mark.parametrize("mol", ["", "mol spce"])
@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_what_is_extracted(lmp_tree, command, ranks, mol):
    data = water_data(lmp_tree.folder / "data.water")
    (lmp_tree.folder / "molecule.spce").write_text(SPCE)
    run = f"run 7\nplugin load {command}\nextract_test move {'spce' if mol else 'NULL'}"
    before = "molecule spce molecule.spce"
    fix = f"gear/quat molecule {mol}"
    result = lmp_tree.succeed(water(data, fix, dt=1.0, before=before, run=run), ranks=ranks)
    line = next(line for line in result.log.splitlines() if line.startswith("extracted"))
    *found, _ = (float(word) for word in line.split()[1:])
    right = [3 * N, 3 * N, 3 * N * WATER_MASSES.sum(), 1, 1]
    assert found == pytest.approx(right, rel=1e-9)


@pytest.mark.parametrize("ranks", [2, 4])
def test_only_bodies_across_a_border_are_known_to_other_ranks(lmp_tree, command, ranks):
    known = {}
    for shift in (1.65, 0.0):  # in the middle of their cells, and around the borders of the ranks
        data = water_data(lmp_tree.folder / "data.water", n=4, shift=shift)
        run = f"run 0\nplugin load {command}\nextract_test move NULL"
        result = lmp_tree.succeed(water(data, run=run), ranks=ranks)
        line = next(line for line in result.log.splitlines() if line.startswith("extracted"))
        known[shift] = int(line.split()[-1])
    assert known[1.65] == 4**3
    assert known[0.0] > 4**3
