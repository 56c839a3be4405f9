"""The memory of a large body: the data of its atoms, as with fix rigid, at any time of a run."""

import re
import sys
from dataclasses import replace

import pytest

WALL = """
units lj
atom_style molecular
atom_modify map array
lattice fcc 0.9
region box block 0 {cells} 0 {cells} 0 {cells}
create_box 1 box
create_atoms 1 box
mass 1 1.0
set group all mol 1
velocity all set 0.01 0.02 0.0
pair_style lj/cut 1.2
pair_coeff * * 1.0 1.0
neighbor 0.1 bin
neigh_modify exclude molecule/intra all
comm_modify cutoff 1.4
fix move all {style}
timestep 0.001
thermo_style custom step temp
thermo 10
{run}
"""
RUN = "run 10"
#: runs a program and writes its peak memory, in kilobytes, to a separate file: output that a process prints after MPI_Finalize can be lost
#: by mpirun
WRAPPER = """
import os, pathlib, resource, subprocess, sys
folder, *command = sys.argv[1:]
code = subprocess.run(command).returncode
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
pathlib.Path(folder, str(os.getpid())).write_text(str(peak))
sys.exit(code)
"""
FIX, RIGID = "gear/quat single report no", "rigid single"
#: memory of the whole process relative to fix rigid
MOST = 1.35


@pytest.fixture
def peak(lmp_tree):
    """(fix, edge of the block in cells, ranks) -> largest memory of a process, bytes."""
    wrapper, measured = lmp_tree.folder / "wrapper.py", lmp_tree.folder / "measured"
    peaks = lmp_tree.folder / "peaks"
    peaks.mkdir()
    wrapper.write_text(WRAPPER)
    command = f"{sys.executable} {wrapper} {peaks} {lmp_tree.executable}"
    measured.write_text(f'#!/bin/sh\nexec {command} "$@"\n')
    measured.chmod(0o755)
    lmp = replace(lmp_tree, executable=measured, library=None)

    def measure(style, cells, ranks=1, run=RUN):
        lmp.succeed(WALL.format(style=style, cells=cells, run=run), ranks=ranks)
        files = list(peaks.iterdir())
        assert len(files) == ranks
        found = [int(file.read_text()) for file in files]
        for file in files:
            file.unlink()
        return 1024 * max(found)

    return measure


@pytest.mark.parametrize("ranks", [1, 2])
def test_beside_fix_rigid(peak, ranks):
    """A quarter of a million atoms; a message with each of them would take 800 bytes per atom."""
    assert peak(FIX, 40, ranks) < MOST * peak(RIGID, 40, ranks)


def test_reported(lmp_tree):
    """LAMMPS' sum includes the data of the atoms."""
    per_atom = {}
    for style in (FIX, RIGID):
        log = lmp_tree.succeed(WALL.format(style=style, cells=20, run="run 1\nrun 0")).log
        found = re.findall(r"^Per MPI rank memory .* = (\S+) \|", log, re.MULTILINE)
        per_atom[style] = float(found[-1]) * 2**20 / (4 * 20**3)
    assert 2 * 8 < per_atom[FIX] - per_atom[RIGID] < 300
