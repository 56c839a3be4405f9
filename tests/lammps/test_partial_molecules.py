"""Molecules that are only partly in bodies: a warning names one and a remedy."""

import re

import pytest
from scenes import water, water_data

WARNING = re.compile(
    r"WARNING: Fix gear/quat: molecules such as (\d+) are only partly in bodies, and no fix moves the rest; "
    r"if all of these atoms are to move as rigid molecules, (.*?) \("
)
GROUPS = "group oxygens type 1\ngroup hydrogens type 2\nvariable body atom mol\n"


def deck(folder, style, before="", after=""):
    text = water(water_data(folder / "data.water"), f"gear/quat {style}", steps=1, before=GROUPS + before)
    text = text.replace("fix_modify move energy yes\n", after)
    return text.replace("fix move all", "fix move oxygens")


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("style", ["molecule", "single", "group 1 oxygens", "custom v_body"])
def test_only_the_oxygens(lmp_tree, style, ranks):
    result = lmp_tree.succeed(deck(lmp_tree.folder, style), ranks=ranks)
    found = WARNING.findall(result.words)
    assert [one[0] for one in found] == ["1"], result.output
    assert ("custom" in style) == ("the same value of v_body" in found[0][1])
    assert ("custom" in style) != ("include molecule" in found[0][1])


TEMPERATURES = """
group some molecule 1:13
compute all all temp
compute o oxygens temp
compute h hydrogens temp
compute some some temp
thermo_style custom step c_all c_o c_h c_some
thermo_modify norm no
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_temperature_of_parts(lmp, ranks):
    """One warning for each group with parts of bodies, also in several runs; none for groups of whole bodies."""
    text = water(water_data(lmp.folder / "data.water"), "gear/quat molecule", steps=1, before=GROUPS)
    text = text.replace("fix_modify move energy yes\n", TEMPERATURES)
    told = lmp.succeed(text + "\nrun 1", ranks=ranks).words
    found = re.findall(r"temperature of group (\w+), which has only some atoms of bodies such as \d+", told)
    assert sorted(found) == ["hydrogens", "oxygens"]


@pytest.mark.parametrize("style", ["molecule", "group 1 oxygens", "custom v_body"])
def test_the_advice(lmp_tree, style):
    """With the suggested command the molecules are whole."""
    text = deck(lmp_tree.folder, style, before="group oxygens include molecule\n")
    result = lmp_tree.succeed(text)
    assert not WARNING.search(result.words)
    assert "rigid bodies with 81 atoms" in result.words


def test_one_molecule(lmp_tree):
    """One of many molecules, whose atoms are on several ranks."""
    text = deck(lmp_tree.folder, "molecule", before="group oxygens include molecule\n")
    text = text.replace("fix move oxygens", "group one id 41\ngroup most subtract all one\nfix move most")
    found = WARNING.findall(lmp_tree.succeed(text, ranks=4).words)
    assert found and found[0][0] == "14" and "group most include" in found[0][1]


@pytest.mark.parametrize("rest", ["nve", "gear/quat molecule"])
def test_another_fix_moves_the_rest(lmp_tree, rest):
    """No warning for flexible chains on rigid cores or for rigid parts connected by other bonds, which are intended."""
    result = lmp_tree.succeed(deck(lmp_tree.folder, "molecule", after=f"fix rest hydrogens {rest}\n"))
    assert not WARNING.search(result.words)
# --- molecules of different shapes ----------------------------------------------------------------

OTHER_SHAPES = re.compile(r"WARNING: Fix gear/quat: bodies (\d+) and (\d+) have the same atoms, and their shapes "
                          r"differ by (\S+) % of their size")
BENT = """
units real
atom_style full
atom_modify map array
bond_style harmonic
angle_style harmonic
read_data {data} extra/bond/types 1 extra/angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 2
pair_style lj/cut/coul/cut 4.5
pair_coeff * * 0.0 1.0
pair_coeff 1 1 0.1553 3.166
{bonds}
bond_coeff 1 600.0 1.0
angle_coeff 1 75.0 109.47
special_bonds lj/coul 0.0 0.0 0.0
timestep 1.0
{commands}
"""
SHAKE = "fix s all shake 1e-6 100 0 b 1 a 1\nfix m all nve\nrun 1\nunfix m\nunfix s\n"
MOVE = "fix move all gear/quat molecule\n"


def bent(folder, commands):
    """27 water molecules with bonds and angles."""
    bonds = [
        f"create_bonds single/bond 1 {k} {k + 1} special no\ncreate_bonds single/bond 1 {k} {k + 2} special no\n"
        f"create_bonds single/angle 1 {k + 1} {k} {k + 2} special {'yes' if k == 79 else 'no'}"
        for k in range(1, 82, 3)
    ]
    return BENT.format(data=water_data(folder / "data.water"), bonds="\n".join(bonds), commands=commands)


@pytest.mark.parametrize("ranks", [1, 2])
def test_molecules_that_were_flexible(lmp_tree, ranks):
    """The two remedies of the message make equal molecules."""
    minimize = "minimize 1e-4 1e-4 20 100\nreset_timestep 0\n"
    rigid = MOVE + minimize.replace("minimize", "min_style cg\nminimize")
    for commands, count in ((minimize + MOVE, 1), (rigid, 0), (minimize + SHAKE + MOVE, 0), (MOVE, 0)):
        result = lmp_tree.succeed(bent(lmp_tree.folder, commands + "run 2\nrun 2\n"), ranks=ranks)
        found = OTHER_SHAPES.findall(result.words)
        assert len(found) == count, commands
        assert not found or (found[0][0] != found[0][1] and 0.5 < float(found[0][2]) < 30.0)


def test_few_digits_are_no_other_shape(lmp_tree):
    """A data file with three decimals, and bodies with other atoms."""
    data = water_data(lmp_tree.folder / "data.water")
    lines = data.read_text().splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Atoms"))
    for k, line in enumerate(lines[first + 2 : first + 2 + 81], first + 2):
        words = line.split()
        words[4:7] = [f"{float(word):.3f}" for word in words[4:7]]
        lines[k] = " ".join(words)
    data.write_text("\n".join(lines) + "\n")
    one = "displace_atoms one move 0 0 0.05 units box\n"
    deck = water(data, "gear/quat molecule", steps=1, before=f"group one id 1\n{{}}")
    for change, count in (("", 0), (one, 1), (f"{one}set atom 1 type 2\n", 0)):
        assert len(OTHER_SHAPES.findall(lmp_tree.succeed(deck.format(change)).words)) == count, change
