"""The examples reproduce their reference logs."""

from __future__ import annotations

import re

import pytest

from support.example_logs import copy_examples, date_of, decks, deviations, log_of, name_of
from support.running import ROOT


def test_the_examples_reproduce_their_logs(lmp_wheel, tmp_path):
    for deck in decks(copy_examples(tmp_path)):
        found = deviations(lmp_wheel, deck)
        assert len(found) >= 4 and max(found.values()) < 1.0, (deck.name, found)


@pytest.mark.parametrize("deck", decks(), ids=lambda deck: deck.name)
def test_the_logs_are_those_of_the_decks(deck):
    """LAMMPS echoes every line that it reads, up to a jump; a log does not say where it was made."""
    log = log_of(deck)
    told = log.read_text()
    assert log.name.split(".")[1] == date_of(told) and name_of(deck) in log.name
    assert str(ROOT) not in told and "/home/" not in told and "plugins from" not in told
    # a continued line is echoed as one line
    echoed, jump, _ = re.sub(r"&\n", "", deck.read_text()).partition("jump SELF")
    whole = echoed.splitlines()[: -1 if jump else None]
    assert [line for line in whole if line not in told.splitlines()] == [], f"{log.name}: tests/run logs"
