"""Every row of the table in doc/howto/from_rigid.md, tried."""

import re

import pytest
from running import ROOT
from scenes import one_after_the_other, two_molecules

PAGE = ROOT / "doc/howto/from_rigid.md"

# the words of a row -> commands before the fix, its words, commands after it, and what LAMMPS says
# where the row says "not there"; None for a row that other tests are about, with their file
TRIED = {
    "single": ("", "single", "run 1", ""),
    "custom i_name": (
        "fix which all property/atom i_which\nset atom 1*3 i_which 1\nset atom 4*6 i_which 2",
        "custom i_which",
        "run 1",
        "",
    ),
    "fix poems": ("", "file bodies.dat", "", "Unknown fix gear/quat bodystyle: file"),
    "infile": "test_infile_out.py",
    "reinit": ("", "molecule reinit no", "run 1\nrun 1", ""),
    "mol": "test_coming_and_going.py",
    "force": ("", "molecule force 1 off off off torque 2* off off on", "run 1", ""),
    "langevin": ("", "molecule langevin 1 1 1 4711", "", "define fix langevin on the same group"),
    "temp": ("", "molecule {word} 1 1 1", "", "define fix temp/csvr or temp/berendsen"),
    "iso": ("", "molecule {word} 1 1 1", "", "there is no barostat"),
    "gravity": ("", "molecule gravity pull", "", "leave out its keyword disable"),
    "fix_modify bodyforces late": ("", "molecule", "fix_modify move bodyforces late\nrun 1", ""),
    "fix_modify bodyforces early": (
        "",
        "molecule",
        "fix_modify move bodyforces early",
        "has no fix_modify bodyforces early",
    ),
    "fix_modify temp": (
        "",
        "molecule",
        "fix_modify move {word} thermo_temp",
        "Fix gear/quat has no fix_modify",
    ),
    "fix_modify energy yes": "test_physics.py",
    "fix_modify virial no": ("", "molecule", "fix_modify move virial no\nrun 1", ""),
    "f_move": "test_outputs.py",
    "f_move[i][1]": (
        "",
        "molecule",
        "thermo_style custom step f_move[1][15] f_move[2][28]\nrun 1",
        "",
    ),
    "f_move[i]": ("", "molecule", "thermo_style custom step f_move f_move[8]\nrun 1", ""),
    "compute temp": "test_outputs.py",
    "compute stress/atom": "test_outputs.py",
    "compute ke/rigid": ("", "molecule", "compute k all {word} move\nrun 1", "ompute"),
    "compute erotate/rigid": ("", "molecule", "compute k all {word} move\nrun 1", "ompute"),
    "compute rigid/local": ("", "molecule", "compute k all {word} move mol x\nrun 1", "ompute"),
    "velocity ... rigid": (
        "",
        "molecule",
        "velocity all zero linear rigid move",
        "rigid",
    ),
    "fix deposit": "test_coming_and_going.py",
    "fix hmc": "test_neighbors.py",
    "neigh_modify exclude molecule/intra": "test_report.py",
    "read_restart": "test_restart_matrix.py",
    "fix momentum": "test_neighbors.py",
    "molecule ID 0": "test_bad_input.py",
    "large steps, long sampling": "test_accuracy_words.py",
}


def rows():
    """First words of a row -> (all words of it, whether it works)."""
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
    decks = []
    for cell, (words, says) in rows().items():
        trial = tried(words, cell)
        if not isinstance(trial, str) and says != "not there":
            decks.append(two_molecules(trial[1], before=trial[0], after=trial[2]))
    result = lmp_wheel.run(one_after_the_other(decks))
    assert result.returncode == 0, result.output


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
    result = lmp_wheel.run(deck, ranks=2)
    assert result.returncode != 0, result.output
    assert message in " ".join(result.output.split()), result.output
    assert len(set(result.errors)) == 1
