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
    assert "group oxygens include molecule" in found[0][1]


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
