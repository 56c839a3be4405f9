"""A single pass is unstable with 7, 9 and 11 tuned values in water, and with 5 values too without forces."""

import re

import pytest
from scenes import water

WARNED = re.compile(r"with passes 1 and (\d+) tuned values rotations can become unstable; .* use passes 2")


def change(result):
    """Largest change of the total energy in the run."""
    first, *_, last = result.thermo[-1]["TotEng"]
    return abs(last - first)


def told(result):
    return WARNED.findall(result.words)


@pytest.mark.parametrize("words", ["values 9", "values 7", "values 11", "values 9 project yes", "values 7 project yes"])
def test_unstable_numbers_are_warned_of(lmp_wheel, data, words):
    """The run fails, or its energy changes much more than with the keywords of the message."""
    result = lmp_wheel.run(water(data, f"gear/quat molecule {words} passes 1", dt=1.0, steps=1500, thermo=1500))
    assert told(result) == [re.search(r"values (\d+)", words)[1]]
    stable = lmp_wheel.succeed(water(data, f"gear/quat molecule {words} passes 2", dt=1.0, steps=1500, thermo=1500))
    assert told(stable) == []
    assert result.returncode != 0 or not change(result) < 100 * change(stable)


def test_a_stable_number_is_not_warned_of(lmp_wheel, data):
    decks = (water(data, f"gear/quat molecule values 8 passes {n}", dt=1.0, steps=1500, thermo=1500) for n in (1, 2))
    one, two = (lmp_wheel.succeed(deck) for deck in decks)
    assert told(one) == [] and change(one) < 100 * change(two)


TOPS = """
units lj
atom_style molecular
region box block 0 9 0 9 0 9
create_box 1 box
molecule top top.mol
mass 1 1
pair_style zero 2.0
pair_coeff * *
lattice sc 0.04
create_atoms 0 box mol top 4711
velocity all create 3.0 4711 loop geom
fix move all gear/quat molecule {words}
timestep 0.01
thermo 400
thermo_modify norm no
run 400
"""
TOP = "top\n\n3 atoms\n\nCoords\n\n1 0 0 0\n2 0.9 0 0\n3 0.2 0.8 0\n\nTypes\n\n1 1\n2 1\n3 1\n"


@pytest.mark.parametrize("words, stable", [("values 5 passes 1", False), ("values 7 passes 1", False), ("values 7 passes 2", True)])
def test_free_tops(lmp_wheel, words, stable):
    (lmp_wheel.folder / "top.mol").write_text(TOP)
    result = lmp_wheel.run(TOPS.format(words=words))
    assert (told(result) == []) == (result.returncode == 0) == stable


def test_the_error_message_names_the_keyword(lmp_wheel):
    """Its remedy is not a shorter time step, which would not help."""
    (lmp_wheel.folder / "top.mol").write_text(TOP)
    result = lmp_wheel.refuse(TOPS.format(words="values 7 passes 1"), "blow-up")
    remedy = "Leave out keyword passes, or use passes 2: with passes 1 and 7 tuned values rotations can become unstable"
    assert result.words.partition("ERROR")[2].count(remedy) == 1 and "time step" not in result.words.partition("ERROR")[2]
