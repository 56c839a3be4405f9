"""A restart is the same run: formulations, numbers of values, ranks, and both commands that write.

A case of the paper and a box of water with bodies across its boundaries run 60 steps: uninterrupted, with `restart`
writing files during the run, and in two halves with `write_restart` in between.  Runs continue from the files, on as many
ranks or on others.  Steps are long, so that the histories matter.  All keywords are in test_restart_state.py.
"""

from itertools import product

import pytest
from support.running import EXAMPLES
from support.scenes import assigned, difference, last_frame, one_after_the_other, restarted, water, water_data, whole_deck

SCENES = {"case1": 0.5, "water": 1.0}  # with their time steps
WORDS = {
    "first-3": dict(formulation="first", values=3, corrector="gear"),
    "first-6-compensated": dict(formulation="first", values=6, passes=1, compensate="yes"),
    "momentum-9": dict(values=9),
    "second-12": dict(formulation="second", values=12, corrector="gear"),
    "second-8-compensated": dict(formulation="second", values=8, passes=2, compensate="yes"),
}
RANKS = [(1, 1), (2, 2), (1, 2), (4, 2)]
STEPS, PERIOD, HALF = 60, 20, 30
WRITERS = {"restart": PERIOD, "write_restart": HALF}  # the step at which a file was written


def deck_of(scene, words, commands, end):
    """A deck that runs `commands` and writes positions and velocities to a file `end`."""
    group = "all" if scene == "water" else "body"
    commands += f"\nwrite_dump {group} custom {end}.end id xu yu zu vx vy vz modify sort id format float %.17g"
    if scene == "water":
        fix = "gear/quat molecule " + " ".join(f"{key} {value}" for key, value in words.items())
        return water("data.water", fix, dt=SCENES[scene], steps=STEPS, run=commands)
    known = dict(formulation="default", corrector="default", passes=0, compensate="no")  # after other decks
    known |= words | dict(dt=SCENES[scene], every=STEPS, out="none")
    text = whole_deck(EXAMPLES / scene / f"in.{scene}").replace("run ${steps}", commands)
    return f"{assigned(known)}processors * * *\n{text}"


def writing_decks(scene, ranks):
    for name, words in WORDS.items():
        name = f"{name}@{ranks}"
        yield deck_of(scene, words, f"run {STEPS}", name)
        yield deck_of(scene, words, f"restart {PERIOD} {name}.restart.*\nrun {STEPS}", f"{name}-restart")
        halves = f"run {HALF}\nwrite_restart {name}.write_restart.*\nrun {STEPS - HALF}"
        yield deck_of(scene, words, halves, f"{name}-write_restart")


def reading_decks(scene, before, after):
    for (name, words), writer in product(WORDS.items(), WRITERS):
        end, file = f"{name}@{before}-{writer}@{after}", f"{name}@{before}.{writer}.{WRITERS[writer]}"
        rest = f"run {STEPS - WRITERS[writer]}"
        if writer == "restart":  # this also determines the steps with new neighbor lists
            rest = f"restart {PERIOD} {end}.restart.*\n{rest}"
        yield restarted(deck_of(scene, words, rest, end), file)


def run_all(lmp, decks, ranks):
    decks = list(decks)
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    reading = sum("read_restart" in deck for deck in decks)
    assert result.stdout.count("Resetting peratom fix info") == reading
    assert result.stdout.count("start of order") == len(decks) - reading


@pytest.mark.parametrize("scene", SCENES)
def test_a_restart_goes_on_as_the_run_that_wrote_it(lmp_tree, scene):
    water_data(lmp_tree.folder / "data.water")
    for ranks in (1, 2, 4):
        run_all(lmp_tree, writing_decks(scene, ranks), ranks)
    for before, after in RANKS:
        run_all(lmp_tree, reading_decks(scene, before, after), after)
        for name, writer in product(WORDS, WRITERS):
            whole, wrote = f"{name}@{before}", f"{name}@{before}-{writer}"
            ends = [lmp_tree.folder / f"{end}.end" for end in (whole, wrote, f"{wrote}@{after}")]
            # water builds its lists when a file is written; on two ranks sites of the body then change ranks
            same = ends if scene == "case1" and before == after == 1 else ends[1:] if before == after else ends[:1]
            assert len({end.read_text() for end in same}) == 1, ends
            assert all(difference(last_frame(ends[0]), last_frame(end)) < 1e-12 for end in ends[1:]), ends
