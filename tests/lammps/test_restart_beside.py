"""A restart together with other fixes that store data of atoms in the same file.

In a restart file the data of an atom are one block after another, one for each fix; a fix skips the
blocks before its own by the number at the beginning of each.
"""

import pytest
from support.scenes import restarted, water

# Fixes that each store numbers of atoms: springs, initial positions, marks and velocities.
KEEPERS = """
fix spring all spring/self 0.5
fix_modify spring energy yes
compute msd all msd
fix marks all property/atom d_mark
{marks}
fix kept all store/state 0 vx
variable marked atom d_mark
compute marks all reduce sum v_marked
compute kept all reduce sumsq f_kept
"""
COLUMNS = ["f_spring", "c_msd[4]", "c_marks", "c_kept", "PotEng", "KinEng"]
SHOW = "thermo_style custom step f_spring c_msd[4] c_marks c_kept pe ke\n"


def keeping(data, order, commands, restart=None):
    mark = "" if restart else "variable mark atom id*id\nset group all d_mark v_mark"
    where = {order: KEEPERS.format(marks=mark)}
    run = f"{SHOW}thermo_modify norm no format float %.17g\nthermo 50\n{commands}"
    deck = water(data, "gear/quat molecule values 9", dt=1.0, run=run, **where)
    return restarted(deck, restart) if restart else deck


@pytest.mark.parametrize("order", ["before", "after"])
@pytest.mark.parametrize("ranks", [1, 4])
def test_other_fixes_find_their_data(lmp_tree, data, order, ranks):
    runs = "run 50\nwrite_restart half\nrun 50"
    whole = lmp_tree.succeed(keeping(data, order, runs), ranks=ranks)
    again = lmp_tree.succeed(keeping(data, order, "run 50", "half"), ranks=ranks)
    for column in COLUMNS:
        right, found = whole.thermo[-1][column], again.thermo[-1][column]
        assert found == pytest.approx(right, rel=1e-11)
    assert whole.thermo[-1]["f_spring"][-1] > 0.1
