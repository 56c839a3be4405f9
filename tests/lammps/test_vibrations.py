"""Vibrations that become faster during a run: trimers of a cold gas condense to a droplet."""

import re

import pytest
from support.scenes import template

TRIMER = template([(0, 0, 0), (0.9, 0, 0), (0.2, 0.8, 0)])
GAS = """
units lj
atom_style full
lattice sc 0.04
region box block 0 3 0 3 0 3
create_box 1 box
molecule body trimer.mol
mass 1 1
pair_style lj/smooth/linear 2.5
pair_coeff * * 1 1
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
create_atoms 0 box mol body 4711
velocity all create 1.0 4711 loop geom
timestep {dt}
thermo 500
thermo_style custom step temp pe etotal econserve
thermo_modify norm no format float %.17g
fix move all gear/quat molecule {words}
{run}
"""
COLD = "temp 0.3 0.3 0.5"
TOLD = re.compile(r"the angle of vibrations is (\S+) in a step, and the method follows (\S+); use a time step of (\S+) or shorter")


def condense(lmp, dt, run, words=COLD, ranks=1):
    (lmp.folder / "trimer.mol").write_text(TRIMER)
    return lmp.succeed(GAS.format(dt=dt, words=words, run=run), ranks=ranks)


@pytest.mark.parametrize(
    "dt, run, words",
    [
        (0.006, "run 3000", COLD),
        (0.025, "run 0", COLD),
        (0.02, "run 500", "tolerance 1e-5 " + COLD),
        (0.013, "fix l all langevin 0.5 0.5 1.0 4711\nrun 3000", ""),
    ],
)
def test_no_reason_to_warn(lmp_wheel, dt, run, words):
    assert not TOLD.search(condense(lmp_wheel, dt, run, words).words)


def test_the_motion_is_not_changed(lmp_wheel):
    """A choice and a measurement leave trajectories as they are."""
    automatic, stated = (condense(lmp_wheel, 0.013, "run 1000", words).thermo[0] for words in (COLD, "values 9 " + COLD))
    assert automatic["TotEng"] == stated["TotEng"]
