"""The fixtures themselves: the results for a test, and the end of all processes after a time-out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from support.running import processes_that_mention

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


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_wrong_expectation_fails(lmp, ranks):
    wrong = DECK.replace("pair_style zero", "pair_style nonsense")
    result = lmp.refuse(wrong, "Unrecognized pair style 'nonsense'", ranks=ranks)
    assert "Unrecognized pair style 'nonsense'" in result.errors[0]
    with pytest.raises(AssertionError):
        lmp.succeed(wrong, ranks=ranks)
    with pytest.raises(AssertionError):
        lmp.refuse(wrong, "another message", ranks=ranks)
    with pytest.raises(AssertionError):
        lmp.refuse(DECK, "", variables={"steps": 1}, ranks=ranks)


@pytest.mark.parametrize("own", [False, True])
def test_a_time_out_ends_every_process(lmp, own):
    """Those of earlier runs, and those of this run alone."""
    lmp = replace(lmp, library=None) if own else lmp
    with pytest.raises(TimeoutError, match="still running after 1"):
        lmp.run(DECK, {"steps": 2_000_000_000}, ranks=2, timeout=1.0)
    assert processes_that_mention(str(lmp.folder)) == []
