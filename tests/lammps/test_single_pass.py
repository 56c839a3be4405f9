"""A single pass is unstable in water with 7, 9 and 11 tuned values."""

import re

import pytest
from scenes import water

WARNED = re.compile(r"with passes 1 and (\d+) tuned values rotations are unstable in liquids .* use passes 2")


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
