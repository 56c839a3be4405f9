"""The examples reproduce their reference logs."""

from __future__ import annotations

import re

import pytest

from support.example_logs import RANKS, copy_examples, date_of, decks, deviations, log_of, name_of, needs_wheel
from support.running import EXAMPLES, ROOT


@pytest.mark.parametrize("ranks", RANKS)
def test_the_examples_reproduce_their_logs(lmp, tmp_path, ranks):
    for deck in decks(copy_examples(tmp_path), ranks):
        if needs_wheel(deck) == (lmp.name == "wheel"):
            found = deviations(lmp, deck, ranks)
            assert len(found) >= 4 and max(found.values()) < 1.0, (deck.name, found)


@pytest.mark.parametrize("deck", decks(), ids=lambda deck: deck.name)
def test_the_logs_are_those_of_the_decks(deck):
    """LAMMPS echoes every line that it reads, up to a jump; a log does not say where it was made."""
    read = [deck, *(EXAMPLES / "common").glob("in.*")]
    text = deck.read_text()
    if "common/in.scene" not in text:
        read.remove(EXAMPLES / "common" / "in.scene")
        if "common/in.motion" not in text:
            read.remove(EXAMPLES / "common" / "in.motion")
    log = log_of(deck)
    told = log.read_text()
    assert log.name.split(".")[1] == date_of(told) and name_of(deck) in log.name
    assert str(ROOT) not in told and "/home/" not in told and "plugins from" not in told
    lines = set(told.splitlines())
    for path in read:
        # a continued line is echoed as one line
        echoed, jump, _ = re.sub(r"&\n", "", path.read_text()).partition("jump SELF")
        whole = echoed.splitlines()[: -1 if jump else None]
        missing = [line for line in whole if line not in lines]
        assert missing == [], f"{log.name}: tests/run logs"
