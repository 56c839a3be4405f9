"""Random fix lines: the trials understand every line that LAMMPS accepts, and LAMMPS accepts the lines that they make
from it."""

import random
from collections import Counter
from pathlib import Path

import pytest
from fuzz import arguments

from lammps_gearquat.launch import open_library
from lammps_gearquat.trials import cost, measure, methods, script
from lammps_gearquat.trials.script import DeckError

LINES = 200
GEAR = "formulation second start zero corrector gear c0 velocity passes 1"
METHODS = (*measure.ACCURATE, *methods.METHODS, *methods.ISOKINETIC, *cost.CONFIRMATION, GEAR)
#: a field for the keyword gravity
SETUP = arguments.SETUP + "fix field all gravity 1.0 vector 0 0 -1 disable\n"


@pytest.fixture
def accepts(tmp_path, monkeypatch):
    """``accepts(command)``: whether LAMMPS accepts a fix with the ID move."""
    monkeypatch.chdir(tmp_path)
    for name, text in arguments.FILES.items():
        Path(name).write_text(text)
    lmp = open_library()
    lmp.commands_string(SETUP)

    def accepted(command):
        try:
            lmp.command(command)
        except Exception:  # the only class LAMMPS' module raises
            return False
        lmp.command("unfix move")
        return True

    yield accepted
    lmp.close()


def rigid(rng):
    """A line of a fix of the rigid family, mostly valid."""
    style = rng.choice(script.RIGID)
    small = "small" in style
    bodies = ["molecule", "custom i_which"] + ([] if small else ["single", "group 2 left right"])
    numbers = ("1", "*", "1*", "*1") + (() if small else ("2", "2*"))
    chain = []
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        flags = " ".join(rng.choice(("on", "off")) for _ in range(3))
        one = [f"reinit {rng.choice(('yes', 'no', 'on', 'off', 'true', 'false'))}", "infile bodies"]
        one += ["couple xyz", "dilate all", "dilate left", "gravity field", "langevin 1 1 1 4711"]
        one += (
            ["mol two"]
            if small
            else [f"{key} {rng.choice(numbers)} {flags}" for key in script.MASKS] * 3
        )
        chain.append(rng.choice(one))
    return " ".join([f"fix move all {style}", rng.choice(bodies), *chain])


def gear(rng):
    more = rng.choice(("", "", " formulation first", " formulation first isokinetic total"))
    return f"fix move all gear/quat {arguments.quoted(arguments.make(rng, faults=[0]))}{more}"


@pytest.mark.parametrize("make", [gear, rigid])
def test_trial_lines_are_lines_that_lammps_takes(accepts, make):
    rng = random.Random(make.__name__)
    seen = Counter()
    while sum(seen.values()) - seen["refused by LAMMPS"] - seen["of the other formulation"] < LINES:
        command = make(rng)
        if not accepts(command):
            seen["refused by LAMMPS"] += 1
            continue
        line = script.parse_fix(script.split(command))
        assert accepts(line.text()), (command, line.text())
        own = script.for_trials(line)[0].text()
        assert accepts(own), (command, own)
        try:
            base, _ = script.translate(line)
        except DeckError as error:
            assert any(
                word in str(error) for word in ("keyword langevin", "keyword gravity")
            ), error
            assert make is rigid or "langevin" in str(error)
            seen["refused"] += 1
            continue
        seen["translated"] += 1
        for method in rng.sample(METHODS, 4):
            if base.takes(method):
                trial = base.with_numerics(method).text()
                assert accepts(trial), (command, trial)
            else:
                words = script.replace(base, keywords=script.pairs(method) + base.keywords)
                assert not accepts(words.text()), (command, words.text())
                seen["of the other formulation"] += 1
    assert seen["translated"] > LINES / 2, seen
    assert seen["of the other formulation" if make is gear else "refused"] > LINES / 20, seen
