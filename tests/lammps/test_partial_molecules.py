"""The temperature of a group with parts of bodies."""

import re

import pytest
from support.scenes import water, water_data

GROUPS = "group oxygens type 1\ngroup hydrogens type 2\n"
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
def test_temperature_of_parts(lmp_tree, ranks):
    """One warning for each group with parts of bodies, also in several runs; none for groups of whole bodies."""
    text = water(water_data(lmp_tree.folder / "data.water"), "gear/quat molecule", steps=1, before=GROUPS)
    text = text.replace("fix_modify move energy yes\n", TEMPERATURES)
    told = lmp_tree.succeed(text + "\nrun 1", ranks=ranks).words
    found = re.findall(r"temperature of group (\w+), which has only some atoms of bodies such as \d+", told)
    assert sorted(found) == ["hydrogens", "oxygens"]
