"""The smallest scene with a body, for tests of the ways to install GEARQUAT in LAMMPS.

No package of LAMMPS is needed.
"""

from __future__ import annotations

import pytest

from support.running import Result

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
