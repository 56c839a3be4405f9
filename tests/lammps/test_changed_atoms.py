"""Atoms that commands move relative to their body, and molecule IDs that change after the fix was defined."""

import re

import pytest
from scenes import water

RESHAPED = re.compile(r"atoms of body (\d+) were moved relative to each other")
OVERWRITTEN = re.compile(r"atom (\d+) was moved away from its place in body (\d+), and with reinit no")
OTHER_IDS = re.compile(r"atom (\d+) of body (\d+) has another molecule ID")
GROUPS = "group one id 4\ngroup two molecule 2\n"
NOTHING = ("", "", "")


def told(lmp, data, change, words="", first="run 5\n", ranks=1):
    deck = water(data, f"gear/quat molecule {words}", run=f"{GROUPS}{first}{change}\nrun 5\nrun 5")
    output = lmp.succeed(deck, ranks=ranks).words
    found = []
    for message in (RESHAPED, OVERWRITTEN, OTHER_IDS):
        matches = message.findall(output)
        assert len(matches) <= 1  # also with two runs
        found.append(matches[0] if matches else "")
    return tuple(found)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("first", ["", "run 5\n"])
def test_a_displaced_atom(lmp_wheel, data, first, ranks):
    """The body gets another shape; with reinit no its atom is put back."""
    move = "displace_atoms one move 0.1 0.05 0"
    assert told(lmp_wheel, data, move, first=first, ranks=ranks) == ("2", "", "")
    if first:
        assert told(lmp_wheel, data, move, "reinit no", ranks=ranks) == ("", ("4", "2"), "")


@pytest.mark.parametrize("ranks", [1, 2])
def test_other_molecule_ids(lmp_wheel, data, ranks):
    assert told(lmp_wheel, data, "set atom 4 mol 1", ranks=ranks) == ("", "", ("4", "2"))


@pytest.mark.parametrize(
    "change",
    [
        "",
        "displace_atoms two move 0.02 0 0",
        "displace_atoms two rotate 0 0 0 0 0 1 1",
        "displace_atoms all move 20 20 20",
        "velocity two set 0.001 0 0",
        "change_box all x scale 1.01 remap",
        "min_style cg\nminimize 0 1 5 5",
    ],
)
def test_rigid_changes_are_not_warned_of(lmp_wheel, data, change):
    assert told(lmp_wheel, data, change) == NOTHING
