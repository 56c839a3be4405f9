"""The memory of a large body: that of its atoms' data, as with fix rigid, at any time of a run."""

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
#: runs a program and prints the most memory that it had at a time, in kilobytes
WRAPPER = """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:]).returncode
print("\\nPEAK", resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(code)
"""
FIX, RIGID = "gear/quat single report no", "rigid single"
#: memory of the whole process relative to that with fix rigid
MOST = 1.35


@pytest.fixture
def peak(lmp_tree):
    """(fix, edge of the block in cells, ranks) -> largest memory of a process, bytes."""
    wrapper, measured = lmp_tree.folder / "wrapper.py", lmp_tree.folder / "measured"
    wrapper.write_text(WRAPPER)
    measured.write_text(f'#!/bin/sh\nexec {sys.executable} {wrapper} {lmp_tree.executable} "$@"\n')
    measured.chmod(0o755)
    lmp = replace(lmp_tree, executable=measured)

    def measure(style, cells, ranks=1, run=RUN):
        result = lmp.succeed(WALL.format(style=style, cells=cells, run=run), ranks=ranks)
        peaks = re.findall(r"^PEAK (\d+)", result.stdout, re.MULTILINE)
        assert len(peaks) == ranks
        return 1024 * max(map(int, peaks))

    return measure


@pytest.mark.parametrize("ranks", [1, 2])
def test_beside_fix_rigid(peak, ranks):
    """A quarter of a million atoms; a message with each of them would take 800 bytes an atom."""
    assert peak(FIX, 40, ranks) < MOST * peak(RIGID, 40, ranks)


def test_reported(lmp_tree):
    """LAMMPS' sum has the data of the atoms and the copies that the start makes of them for a while."""
    per_atom = {}
    for style in (FIX, RIGID):
        log = lmp_tree.succeed(WALL.format(style=style, cells=20, run="run 1\nrun 0")).log
        found = re.findall(r"^Per MPI rank memory .* = (\S+) \|", log, re.MULTILINE)
        per_atom[style] = float(found[-1]) * 2**20 / (4 * 20**3)
    assert 9 * 8 < per_atom[FIX] - per_atom[RIGID] < 300
