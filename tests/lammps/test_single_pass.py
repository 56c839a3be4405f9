"""A single pass is unstable in water with 7, 9 and 11 tuned values."""

import re

import pytest
from scenes import water

WARNED = re.compile(r"with passes 1 and (\d+) tuned values rotations are unstable in liquids .* use passes 2")


def told(result):
    return WARNED.findall(result.words)


@pytest.mark.parametrize("words", ["values 9", "values 7", "values 11", "values 9 project yes", "values 7 project yes"])
def test_unstable_numbers_are_warned_of(lmp_wheel, data, words):
    """The run does not reach its end with the energy that it has with the keywords of the message."""
    result = lmp_wheel.run(water(data, f"gear/quat molecule {words} passes 1", dt=1.0, steps=1500, thermo=1500))
    assert told(result) == [re.search(r"values (\d+)", words)[1]]
    stable = lmp_wheel.succeed(water(data, f"gear/quat molecule {words} passes 2", dt=1.0, steps=1500, thermo=1500))
    assert told(stable) == []
