"""Malformed argument lines and files in process: a part here, all with `tests/run fuzz`."""

import os
import random

import pytest
from fuzz import arguments, campaign, infile

INPUTS = int(os.environ.get("GEARQUAT_FUZZ_INPUTS", 500))


@pytest.mark.parametrize("kind", ["arguments", "infile"])
def test_nothing_crashes_hangs_or_is_refused_without_a_message(tmp_path, kind):
    tally = campaign.run(kind, INPUTS, tmp_path)
    print(
        f"{kind}: {dict(tally.counts)}, {len(tally.faults)} faults, {tally.seconds:.0f} s, "
        f"at most {tally.megabytes:.0f} MB"
    )
    assert not tally.faults, "\n\n".join(
        f"{text[:600]}\n-> {fault}" for text, fault in tally.faults
    )
    assert tally.inputs == INPUTS
    # inputs of both kinds are there in numbers
    assert min(tally.counts["accepted"], tally.counts["refused"]) > INPUTS / 10


@pytest.mark.parametrize("module", [arguments, infile])
def test_inputs_are_repeatable_and_differ(module):
    one, again = ([module.draw(random.Random(seed)) for seed in range(50)] for _ in range(2))
    assert one == again
    assert len(set(map(str, one))) > 40
