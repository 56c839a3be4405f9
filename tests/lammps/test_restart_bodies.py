"""Bodies of a restart file and of the command: equal bodies continue, others are created again."""

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
