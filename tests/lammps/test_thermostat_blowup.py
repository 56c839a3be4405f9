"""A thermostat that is unstable is named before the bodies that it throws about, and both remedies help."""

import re

import pytest
from test_step_advice import deck

KEYWORDS = "temp 300 300 100"


def hot(lmp, keywords):
    """N2 at 100 K under a thermostat of 300 K."""
    text = deck(lmp, "n2", 4.0, 150)
    first, _, last = text.rpartition("report no")
    return f"{first}report no {keywords}{last}"


def test_the_thermostat_is_named(lmp_tree):
    words = lmp_tree.refuse(hot(lmp_tree, KEYWORDS), "Fix gear/quat: blow-up").words
    told = re.search(
        r"The thermostat became unstable first: its friction, (\S+), times the time step, 4, is (\S+)\. "
        r"Begin nearer to the target temperature, or use tchain 1 or a longer damping time",
        words,
    )
    assert told and float(told[2]) == pytest.approx(4 * float(told[1]), rel=1e-4)
    assert float(told[2]) > 0.5


@pytest.mark.parametrize("keywords", [f"{KEYWORDS} tchain 1", "temp 300 300 1000", "temp 110 110 100"])
def test_the_remedies(lmp_tree, keywords):
    table = lmp_tree.succeed(hot(lmp_tree, keywords)).thermo[-1]
    assert table["Step"][-1] == 150 and max(table["Temp"]) < 900
