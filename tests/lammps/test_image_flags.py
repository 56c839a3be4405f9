"""More periodic boxes than LAMMPS' image flags can count, which is 512 in each direction."""

import numpy as np
import pytest
from support.scenes import two_molecules

# both molecules move by 9.5 boxes in a hundred steps; the flags wrap around after 5384 steps in x
FLIGHT = """
group first molecule 1
group second molecule 2
velocity first zero linear
velocity second zero linear
velocity all set 190.0 -125.0 55.0 sum yes units box
neigh_modify every 1 delay 0 check yes
thermo_style custom step f_move[1] f_move[2] f_move[1][1] f_move[1][2] f_move[1][3] &
  f_move[1][13] f_move[1][14] f_move[1][15]
thermo_modify norm no format float %.17g
thermo 2000
"""
LENGTH = 20.0
#: of the rotational energy: at this speed starts are of order 2, each with an error of 1e-6
STARTS = 1e-4


def run(lmp, fix, after, ranks=1):
    return lmp.succeed(two_molecules(fix, after=FLIGHT + after), ranks=ranks)


def flight(tables):
    """Steps (n,) of all runs, and the unwrapped center of the first molecule, (n, 3)."""
    columns = [f"f_move[1][{k}]" for k in range(1, 16)]
    step = np.concatenate([table["Step"] for table in tables])
    rows = np.concatenate([np.transpose([t[c] for c in columns if c in t]) for t in tables])
    return step, rows[:, :3] + LENGTH * rows[:, 3:]


def test_a_body_flies_on(lmp_tree):
    result = run(lmp_tree, "molecule", "run 6500", ranks=2)
    step, centre = flight(result.thermo)
    velocity = (centre[1] - centre[0]) / (0.01 * step[1])
    assert centre[-1, 0] > 600 * LENGTH  # the flags of its atoms are negative again
    assert centre == pytest.approx(centre[0] + 0.01 * step[:, None] * velocity, abs=1e-6)
    spin = result.thermo[0]["f_move[2]"]
    assert spin == pytest.approx([spin[0]] * len(spin), rel=STARTS)


def test_a_body_is_made_anew_where_the_flags_turn(lmp_tree):
    """Sites of one body have flags at both ends of their range during the overflow."""
    slowly = "velocity all set -170.0 125.0 -55.0 sum yes units box\n"
    anew = "unfix move\nfix move all gear/quat molecule\nrun 2\n" * 30
    result = run(lmp_tree, "molecule", "run 5380\n" + slowly + anew)
    x = [value for table in result.thermo for value in table["f_move[1][1]"]]
    assert max(x[2:]) > 9.5 and min(x[2:]) < -9.5  # it has passed, in small steps
    spin = [value for table in result.thermo for value in table["f_move[2]"]]
    assert spin == pytest.approx([spin[0]] * len(spin), rel=STARTS)


def test_a_restart_beyond(lmp_tree):
    whole = run(lmp_tree, "molecule", "run 6000\nwrite_restart far.restart\nrun 500")
    deck = two_molecules(after=FLIGHT[FLIGHT.index("neigh_modify") :] + "run 500")
    begin = "units lj\natom_modify map array\nread_restart far.restart\n"
    result = lmp_tree.succeed(begin + deck[deck.index("pair_style") :])
    for column, values in whole.thermo[-1].items():
        assert result.thermo[-1][column] == pytest.approx(values, rel=1e-12, abs=1e-12), column
