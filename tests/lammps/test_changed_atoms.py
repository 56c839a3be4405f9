"""Atoms that commands move relative to their body."""

import pytest
from support.scenes import water

GROUPS = "group one id 4\ngroup two molecule 2\n"
REBUILT = "atoms were changed since the last run; bodies are rebuilt from them"


def said(lmp, data, change, words="", first="run 5\n", ranks=1):
    deck = water(data, f"gear/quat molecule {words}", run=f"{GROUPS}{first}{change}\nrun 5\nrun 5")
    return lmp.succeed(deck, ranks=ranks).words


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_displaced_atom(lmp_wheel, data, ranks):
    """The body gets another shape; with reinit no its atom is put back."""
    move = "displace_atoms one move 0.1 0.05 0"
    assert REBUILT in said(lmp_wheel, data, move, ranks=ranks)
    assert REBUILT not in said(lmp_wheel, data, move, "reinit no", ranks=ranks)


@pytest.mark.parametrize("first", ["", "run 5\n"])
def test_a_remapped_box(lmp_wheel, data, first):
    """Each atom is remapped by itself, which ends the next run; fix deform moves bodies as a whole."""
    remapped = water(data, run=f"{first}change_box all x scale 1.1 remap\nrun 5")
    lmp_wheel.refuse(remapped, "change_box with remap moves each atom by itself")
    said(lmp_wheel, data, "fix d all deform 1 x scale 1.1\nrun 5\nunfix d", first=first)
