"""What other C++ code gets from the fix by name."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from scenes import water, water_data
from test_coming_and_going import SPCE
from test_plugin import tree_source

from running import ROOT

N = 27
MASSES = np.array([15.9994, 1.008, 1.008])


@pytest.fixture(scope="module")
def command() -> Path:
    """A plugin with a command that prints it."""
    library = ROOT / "build" / "extract-test.so"
    source = ROOT / "tests" / "lammps" / "extract_plugin.cpp"
    words = "mpicxx.openmpi -std=c++17 -O1 -shared -fPIC -DLAMMPS_SMALLBIG -DOMPI_SKIP_MPICXX"
    include = [f"-I{tree_source() / 'src'}", f"-I{tree_source() / 'src' / 'PLUGIN'}"]
    subprocess.run([*words.split(), *include, str(source), "-o", str(library)], check=True)
    return library


def moments():
    half = np.deg2rad(109.47 / 2)
    site = np.array([[0, 0, 0], [np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]])
    site -= MASSES @ site / MASSES.sum()
    square = np.einsum("i,ij,ik->jk", MASSES, site, site)
    return np.sort(np.linalg.eigvalsh(np.trace(square) * np.eye(3) - square))[::-1]


@pytest.mark.parametrize("mol", ["", "mol spce"])
@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_what_is_extracted(lmp_tree, command, ranks, mol):
    data = water_data(lmp_tree.folder / "data.water")
    (lmp_tree.folder / "molecule.spce").write_text(SPCE)
    run = (
        "thermo_style custom step f_move[1] f_move[2]\nthermo_modify norm no format float %.17g\n"
        f"run 7\nplugin load {command}\nextract_test move {'spce' if mol else 'NULL'}"
    )
    before = "molecule spce molecule.spce"
    fix = f"gear/quat molecule {mol}"
    result = lmp_tree.run(water(data, fix, dt=1.0, before=before, run=run), ranks=ranks)
    assert result.returncode == 0, result.output
    line = next(line for line in result.log.splitlines() if line.startswith("extracted"))
    found = [float(word) for word in line.split()[1:]]
    thermo = result.thermo[-1]
    right = [3 * N, 3 * N, 3 * N * MASSES.sum(), *(3 * N * moments())]
    right += [thermo["f_move[1]"][-1], thermo["f_move[2]"][-1], 1, 1]
    assert found == pytest.approx(right, rel=1e-9)
    assert found[6] == pytest.approx(right[6], rel=1e-13) and found[6] > 0.1
    assert 1.01 * np.array(found[:8]) != pytest.approx(right[:8], rel=1e-3)
