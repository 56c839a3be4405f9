"""The examples reproduce their reference logs, compared by LAMMPS' own regression tests."""

from __future__ import annotations

import re

import pytest

from support.example_logs import RANKS, copy_examples, date_of, decks, log_of, name_of, needs_wheel, run_tests
from support.running import EXAMPLES, ROOT


@pytest.mark.parametrize("ranks", RANKS)
def test_the_examples_pass_lammps_regression_tests(lmp, tmp_path, ranks):
    copied = copy_examples(tmp_path)
    wanted = [deck for deck in decks(copied, ranks) if needs_wheel(deck) == (lmp.name == "wheel")]
    assert wanted
    found = run_tests(lmp, wanted, ranks, tmp_path)
    assert set(found) == {deck.name for deck in wanted}
    # each deck has at least four columns that are compared, with two checks per column
    assert [how for how in found.values() if not (isinstance(how, int) and how >= 8)] == []


def test_a_wrong_reference_is_noticed(lmp_tree, tmp_path):
    """Makes one column of the last line wrong by 1e-4."""
    copied = copy_examples(tmp_path)
    log = log_of(copied / "top" / "in.top")
    head, loop, tail = log.read_text().rpartition("Loop time")
    *rows, last = head.splitlines()
    words = last.split()
    at = next(row for row in rows if row.lstrip().startswith("Step")).split().index("v_kerot")
    words[at] = f"{float(words[at]) * 1.0001:.17g}"
    log.write_text("\n".join([*rows, " ".join(words)]) + "\n" + loop + tail)
    (told,) = run_tests(lmp_tree, [copied / "top" / "in.top"], 1, tmp_path).values()
    assert "v_kerot" in str(told) and "failed" in str(told)


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
