"""The fixtures themselves: what a test gets back, and that nothing keeps running after a time-out."""

from __future__ import annotations

from pathlib import Path

import pytest

DECK = """
units lj
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 single 1 1 1
create_atoms 1 single 3 3 3
mass 1 1.0
pair_style zero 1.0
pair_coeff * *
velocity all set 0.5 0 0
thermo_modify norm no
thermo 0
run ${steps}
run 0
"""


def processes_that_mention(text: str) -> list[str]:
    found = []
    for command in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = command.read_text().replace("\0", " ")
        except OSError:
            continue
        if text in words:
            found.append(words)
    return found


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_a_run_gives_its_thermo(lmp, ranks):
    result = lmp.run(DECK, variables={"steps": 7}, ranks=ranks)
    assert result.returncode == 0, result.output
    assert f"on {ranks} procs" in result.log
    assert [table["Step"] for table in result.thermo] == [[0, 7], [7]]
    assert result.thermo[0]["TotEng"] == pytest.approx([0.25, 0.25])
    assert result.errors == []


@pytest.mark.parametrize("ranks", [1, 2])
def test_an_error_is_found_with_its_text(lmp, ranks):
    result = lmp.run(
        DECK.replace("pair_style zero", "pair_style nonsense"), {"steps": 1}, ranks=ranks
    )
    assert result.returncode != 0, result.output
    assert any(
        "Unrecognized pair style 'nonsense'" in error for error in result.errors
    ), result.output


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_time_out_ends_every_process(lmp, ranks):
    with pytest.raises(TimeoutError, match="still running after 3"):
        lmp.run(DECK, {"steps": 2_000_000_000}, ranks=ranks, timeout=3.0)
    assert processes_that_mention(str(lmp.folder)) == []
