"""A restart is the same run: formulations, numbers of values, ranks, and both commands that write.

The paper's cases and a box of water with bodies across its boundaries run 120 steps: uninterrupted,
with `restart` writing files during the run, and in two halves with `write_restart` in between.  Runs
continue from the files, on as many ranks or on others.  Steps are long, so that the histories matter.
"""

from itertools import product

import pytest
import scenes
from running import EXAMPLES, make_lmp_tree
from scenes import (
    assigned,
    last_frame,
    one_after_the_other,
    restarted,
    water,
    water_data,
    whole_deck,
)

pytestmark = pytest.mark.tree  # made in a fixture of the module

SCENES = {"case1": 0.5, "case3": 2.0, "water": 1.0}  # with their time steps
WORDS = {
    "first-3": dict(formulation="first", values=3, corrector="gear"),
    "first-6": dict(formulation="first", values=6),
    "first-8": dict(formulation="first", values=8, corrector="gear"),
    "first-6-compensated": dict(formulation="first", values=6, passes=1, compensate="yes"),
    "second-4": dict(formulation="second", values=4, corrector="gear"),
    "second-8": dict(formulation="second", values=8),
    "momentum-9": dict(values=9),
    "second-12": dict(formulation="second", values=12, corrector="gear"),
    "second-8-compensated": dict(formulation="second", values=8, passes=2, compensate="yes"),
}
RANKS = [(1, 1), (2, 2), (1, 2), (2, 1), (4, 2)]
STEPS, PERIOD, HALF = 120, 40, 60
WRITERS = {"restart": PERIOD, "write_restart": HALF}  # the step at which a file was written


def deck_of(scene, words, commands, end, stretch=1.0, grid="* * *"):
    """A deck that runs `commands` and writes positions and velocities to a file `end`."""
    dt = SCENES[scene] * stretch
    group = "all" if scene == "water" else "body"
    commands += f"\nwrite_dump {group} custom {end}.end id xu yu zu vx vy vz"
    commands += " modify sort id format float %.17g"
    if scene == "water":
        fix = "gear/quat molecule " + " ".join(f"{key} {value}" for key, value in words.items())
        return water("data.water", fix, dt=dt, steps=STEPS, run=commands)
    known = dict(formulation="default", corrector="default", passes=0, compensate="no")  # after other decks
    known |= words | dict(dt=dt, every=STEPS, out="none")
    text = whole_deck(EXAMPLES / scene / f"in.{scene}").replace("run ${steps}", commands)
    return f"{assigned(known)}processors {grid}\n{text}"


def writing_decks(scene, ranks, **settings):
    for name, words in WORDS.items():
        name = f"{name}@{ranks}"
        yield deck_of(scene, words, f"run {STEPS}", name, **settings)
        periodic = f"restart {PERIOD} {name}.restart.*\nrun {STEPS}"
        yield deck_of(scene, words, periodic, f"{name}-restart", **settings)
        halves = f"run {HALF}\nwrite_restart {name}.write_restart.*\nrun {STEPS - HALF}"
        yield deck_of(scene, words, halves, f"{name}-write_restart", **settings)


def reading_decks(scene, before, after, **settings):
    for (name, words), writer in product(WORDS.items(), WRITERS):
        written = WRITERS[writer]
        end, file = f"{name}@{before}-{writer}@{after}", f"{name}@{before}.{writer}.{written}"
        rest = f"run {STEPS - written}"
        if writer == "restart":  # this also determines the steps with new neighbor lists
            rest = f"restart {PERIOD} {end}.restart.*\n{rest}"
        yield restarted(deck_of(scene, words, rest, end, **settings), file)
        if before == after == 1:
            # errors that must be detected: a missing history, a step 1 % longer
            lost = deck_of(scene, words, rest, f"{end}-lost").replace(" move", " other")
            yield restarted(lost.replace("f_move", "f_other"), file)
            yield restarted(deck_of(scene, words, rest, f"{end}-longer", stretch=1.01), file)


def run_all(lmp, decks, ranks):
    decks = list(decks)
    result = lmp.succeed(one_after_the_other(decks), ranks=ranks)
    reading = sum("read_restart" in deck for deck in decks)
    lost = sum("fix other" in deck for deck in decks)
    assert result.stdout.count("Resetting peratom fix info") == reading - lost
    assert result.stdout.count("start of order") == len(decks) - (reading - lost)


@pytest.fixture(scope="module", params=SCENES)
def runs(request, tmp_path_factory):
    """The simulation and the folder with the final states of all its runs."""
    scene = request.param
    lmp = make_lmp_tree(tmp_path_factory.mktemp(scene))
    water_data(lmp.folder / "data.water")
    for ranks in (1, 2, 4):
        run_all(lmp, writing_decks(scene, ranks), ranks)
    for ranks in (1, 2):
        pairs = [pair for pair in RANKS if pair[1] == ranks]
        run_all(lmp, (deck for pair in pairs for deck in reading_decks(scene, *pair)), ranks)
    return scene, lmp.folder


def difference(folder, one, other):
    return scenes.difference(*(last_frame(folder / f"{name}.end") for name in (one, other)))


def every_digit(folder, *names):
    return len({(folder / f"{name}.end").read_text() for name in names}) == 1


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("before, after", RANKS)
@pytest.mark.parametrize("name", WORDS)
def test_a_restart_goes_on_as_the_run_that_wrote_it(runs, name, before, after, writer):
    scene, folder = runs
    whole, wrote = f"{name}@{before}", f"{name}@{before}-{writer}"
    again = f"{name}@{before}-{writer}@{after}"
    if before == after:
        assert every_digit(folder, wrote, again)
    if scene != "water" and before == after == 1:
        # water builds its lists when a file is written; on two ranks sites of the body then change ranks
        assert every_digit(folder, whole, wrote, again)
    assert difference(folder, whole, wrote) < 1e-12
    assert difference(folder, whole, again) < 1e-12


@pytest.mark.parametrize("scene", ["case1", "case3"])
def test_two_ranks_with_the_body_on_one_of_them(lmp_tree, scene):
    """Without migration or a change in the order of sums, not a single digit differs from the whole run."""
    run_all(lmp_tree, writing_decks(scene, 2, grid="2 1 1"), 2)
    run_all(lmp_tree, reading_decks(scene, 2, 2, grid="2 1 1"), 2)
    for name, writer in product(WORDS, WRITERS):
        whole, wrote, again = f"{name}@2", f"{name}@2-{writer}", f"{name}@2-{writer}@2"
        assert every_digit(lmp_tree.folder, whole, wrote, again)
    assert not every_digit(lmp_tree.folder, "first-6@2", "first-8@2")  # the digits are significant


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("name", WORDS)
def test_what_is_lost_is_noticed(runs, name, writer):
    _, folder = runs
    whole, again = f"{name}@1", f"{name}@1-{writer}@1"
    for other, least in (("longer", 1e-4), ("lost", 1e-12)):
        assert not every_digit(folder, whole, f"{again}-{other}")
        assert difference(folder, whole, f"{again}-{other}") > least
