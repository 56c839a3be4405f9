"""Bodies of a restart file and of the command: equal bodies continue, others are created again; other fixes find their data."""

import numpy as np
import pytest
from support.scenes import last_frame, restarted, water, water_data

STEPS = 40
WARNING = "the bodies of this command do not consist of the same atoms as in the restart file"
START = "start of order"


class Halves:
    """Water that writes a restart file `half` in the middle, and decks that continue from it."""

    def __init__(self, lmp, spacing):
        self.lmp = lmp
        self.data = water_data(lmp.folder / "data.water", spacing=spacing)

    def frame(self, deck, dump, ranks):
        result = self.lmp.succeed(deck, ranks=ranks)
        return last_frame(self.lmp.folder / dump)[:, :7], result.output

    def write(self, fix="gear/quat molecule", ranks=1, before="", between=""):
        run = f"run {STEPS}\nwrite_restart half\n{between}\nrun {STEPS}"
        deck = water(self.data, fix, dt=1.0, before=before, run=run, dump="whole", steps=STEPS)
        return self.frame(deck, "whole", ranks)[0]

    def read(self, fix="gear/quat molecule", ranks=1, before="", name="move", group="all"):
        deck = water(self.data, fix, dt=1.0, steps=STEPS, before=before, dump="rest")
        deck = restarted(deck, "half").replace("fix move all", f"fix {name} {group}")
        return self.frame(deck.replace("fix_modify move", f"fix_modify {name}"), "rest", ranks)


@pytest.fixture
def halves(lmp_tree):
    return Halves(lmp_tree, 3.3)


def close(a, b, tolerance=1e-11):
    assert a.shape == b.shape
    scale = np.abs(b).max(axis=0)
    assert (np.abs(a - b) < tolerance * scale).all()


# bodies of two molecules each; the first 13 molecules; the same, and an atom of the next
OTHERS = """
variable pair atom ceil(mol/2)
fix pairs all property/atom i_pair
set group all i_pair v_pair
group few id <= 39
group cut id <= 40
comm_modify cutoff 9.8
"""


@pytest.mark.parametrize(
    "fix, group, ranks",
    [
        ("gear/quat single", "all", 1),
        ("gear/quat custom i_pair", "all", 2),
        ("gear/quat molecule", "cut", 2),
        ("gear/quat molecule", "few", 1),
    ],
)
def test_other_bodies_begin_anew(halves, fix, group, ranks):
    """The run is as if the file contained no fix of that ID."""
    halves.write()
    found, said = halves.read(fix, ranks, OTHERS, group=group)
    right, silent = halves.read(fix, ranks, OTHERS, name="other", group=group)
    assert WARNING in said and WARNING not in silent and START in said
    close(found, right)


# with other numbers; molecule 5 is removed, or molecule 1
NUMBERED = """
variable number atom mol+10
fix numbers all property/atom i_number
{set}
"""
GO = "group gone molecule {}\ndelete_atoms group gone compress no\n"


@pytest.mark.parametrize("style, gone, ranks", [("molecule", 5, 1), ("molecule", 1, 2), ("custom i_number", 1, 1)])
def test_bodies_that_are_left_begin_anew(lmp_tree, style, gone, ranks):
    """The run is as if the file contained no fix of that ID."""
    halves = Halves(lmp_tree, 8.0)
    halves.write(f"gear/quat {style}", before=NUMBERED.format(set="set group all i_number v_number"))
    before = NUMBERED.format(set="") + GO.format(gone)
    found, said = halves.read(f"gear/quat {style}", ranks, before)
    right, silent = halves.read(f"gear/quat {style}", ranks, before, name="other")
    assert WARNING in said and WARNING not in silent and START in said
    close(found, right)


def test_bodies_of_another_style_that_are_the_same_go_on(halves):
    mark = NUMBERED.format(set="set group all i_number v_number")
    whole = halves.write("gear/quat molecule values 9", before=mark)
    words = "gear/quat custom i_number values 9"
    found, said = halves.read(words, before=NUMBERED.format(set=""))
    assert WARNING not in said and START not in said
    close(found, whole)


# --- beside other fixes that store data of atoms in the same file ---------------------------------
# Data of an atom are one block after another, one for each fix; a fix skips the blocks before its own by the number at the beginning of each.
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
