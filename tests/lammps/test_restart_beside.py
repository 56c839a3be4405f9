"""A restart together with other fixes that store data of atoms in the same file, and files of other releases.

In a restart file the data of an atom are one block after another, one for each fix; a fix skips the
blocks before its own by the number at the beginning of each.
"""

import struct

import pytest
from scenes import restarted, water

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
        assert right[-1] != pytest.approx(1.01 * right[-1], rel=1e-11)
    assert whole.thermo[-1]["f_spring"][-1] > 0.1


MAGIC = struct.pack("d", float(int.from_bytes(b"gearquat", "big")))


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize(
    "number, other, whose",
    [(0, 1.0, "an older (0.2.0 or before)"), (1, 99.0, "a newer"), (1, 5.0, "an unpublished")],
)
def test_files_of_other_releases_are_refused(lmp_tree, data, ranks, number, other, whose):
    """Files of 0.2.0 begin with the formulation, 0 or 1; current files with a magic number."""
    file = lmp_tree.folder / "file.restart"
    lmp_tree.succeed(water(data, run=f"run 1\nwrite_restart {file}"))
    content = file.read_bytes()
    assert content.count(MAGIC) == 1
    at = content.index(MAGIC) + 8 * number
    file.write_bytes(content[:at] + struct.pack("d", other) + content[at + 8 :])
    message = f"written by {whose} release of GEARQUAT"
    result = lmp_tree.refuse(restarted(water(data, run="run 1"), file), message, ranks=ranks)
    assert len(set(result.errors)) == 1
    assert "fix move" in result.errors[0] and "write_data" in result.errors[0]
