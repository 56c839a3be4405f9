"""Keyword tolerance: the error follows eps, the time is correct, other styles are notified, restarts are exact.

The simulation is test case 1, whose body repeatedly passes a bare 1/r singularity.
"""

import re

import numpy as np
import pytest
from support.running import SCENES
from support.scenes import TWO_SITES, UNITS, assigned, one_after_the_other, restarted, two_molecules, water, water_data, whole_deck
from support.step_control import (
    ELEMENTS,
    HELD,
    INSERTED,
    LARGEST,
    LOADS,
    MEAN,
    MEAN_LOADS,
    NEXT,
    REPEATED,
    SMALLEST,
    meeting,
    off,
    tables,
)

COLUMNS = " ".join(ELEMENTS)


def case1(run="run ${steps}", before="", **settings):
    """A deck; before: commands before fix move."""
    known = dict(dt=0.1, every=1, out="none", more=COLUMNS, steps=1000, tolerance=1e-12) | settings
    text = whole_deck(SCENES / "in.case1").replace("run ${steps}", run)
    return assigned(known) + text.replace("fix move body", f"{before}\nfix move body")


def test_the_energy_error_follows_eps(lmp_tree):
    eps = [1e-8, 1e-10, 1e-12]
    settings = dict(until=1000, steps=100000)
    decks = [case1(tolerance=e, **settings) for e in eps]
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    errors = [off(run) for run in runs]
    slope = np.log(errors[0] / errors[-1]) / np.log(eps[0] / eps[-1])
    assert 0.7 < slope < 1.3
    for e, run in zip(eps, runs):
        assert 1000 <= run["Time"][-1] < 1001
        assert run[LARGEST][-1] <= 1  # eps
        assert 0 < run[REPEATED][-1] < 0.1 * len(run["Step"])
        assert run[HELD][-1] == 0
    assert runs[-1][LOADS][-1] >= 8
    assert len(runs[0]["Step"]) < len(runs[2]["Step"])

    # without step control, a fixed step of the mean length
    mean = runs[-1][MEAN][-1]
    deck = case1(tolerance=0, dt=mean, steps=int(1000 / mean), more="")
    assert off(tables(lmp_tree.succeed(deck))[0]) > 100 * errors[-1]


def test_outputs_are_those_of_the_steps(lmp_tree):
    (whole,) = tables(lmp_tree.succeed(case1(steps=300)))
    steps = np.diff(whole["Time"])
    again = np.diff(whole[REPEATED])[1:] > 0
    assert steps[1:][~again] == pytest.approx(whole[NEXT][1:-1][~again], rel=1e-11)
    assert (steps[1:][again] < 0.95 * whole[NEXT][1:-1][again]).all() and again.any()
    assert whole[SMALLEST][-1] == pytest.approx(steps.min(), rel=1e-11)
    assert whole[MEAN][-1] == pytest.approx(steps.mean(), rel=1e-12)
    assert whole[LOADS][0] == 1 and whole[LOADS].max() >= 12
    assert whole[MEAN_LOADS][-1] == pytest.approx(whole[LOADS][:-1].mean(), rel=0.01)
    assert steps.max() / steps.min() > 2
    assert 1.25 < (steps[20:] / steps[19:-1]).max() < 1.3 * (1 + 1e-9)
    # the same in two runs
    first, second = tables(lmp_tree.succeed(case1(run="run 200\nrun 100")))
    halves = [*first["v_total"], *second["v_total"][1:]]
    assert halves == whole["v_total"].tolist()


def test_a_first_step_that_is_too_long_is_made_shorter(lmp_tree):
    result = lmp_tree.succeed(case1(dt=2.0, steps=50))
    assert "first step" in result.output and "instead of 2" in result.output
    (long,) = tables(result)
    assert long["Time"][1] < 1.0
    assert off(long) < 1e-8
    assert long[LARGEST][-1] <= 1


def test_a_restart_goes_on_bit_for_bit(lmp_tree):
    """This is true also where the step is smallest; the timestep command of the script changes nothing.

    With the restart command LAMMPS builds neighbor lists at that step, as it does when it reads the
    file: the owner rank of an atom, and the order in which its forces are added, are then the same.
    """
    total, ranks, grid = 500, 2, "processors 2 1 1\n"
    end = "\nwrite_dump body custom {}.end id xu yu zu vx vy vz modify sort id format float %.17g"

    def run(deck):
        return tables(lmp_tree.succeed(grid + deck, ranks=ranks))[0]

    whole = run(case1(f"run {total}"))
    closest = int(np.argmin(whole[NEXT][50:-50])) + 50  # well inside the run
    assert whole[NEXT][closest] < 0.5 * whole[NEXT].max()
    for half in (200, closest):
        runs = f"restart {half} at.*\nrun {{}}{end}"
        whole = run(case1(runs.format(total, "whole")))
        deck = restarted(case1(runs.format(total - half, "again")), f"at.{half}")
        again = run(deck)
        for column in ("Time", "v_total", *COLUMNS.split()):
            assert again[column][1:].tolist() == whole[column][half + 1 :].tolist(), column
        ends = [(lmp_tree.folder / f"{name}.end").read_text() for name in ("whole", "again")]
        assert ends[0] == ends[1]

    # effect of the history: without it the run starts again
    lost = run(re.sub("fix move|fix_modify move|f_move", lambda m: m[0][:-4] + "other", deck))
    assert lost["v_total"][1:].tolist() != whole["v_total"][half + 1 :].tolist()


FALL = """
create_atoms 4 single 5000 0 0
group free subtract all body cage
fix drop free nve
fix pull free addforce 0.3 0.0 0.0
variable place equal xcm(free,x)
variable speed equal vcm(free,x)
"""


@pytest.mark.parametrize("place", ["fix move body", "# --- the outputs"])
def test_other_integrators_follow(lmp_tree, place):
    """Under a constant force velocity Verlet is exact for any steps, if it is notified of each step in time."""
    deck = case1(steps=300, more=COLUMNS + " v_place v_speed", dt=0.05)
    (run,) = tables(lmp_tree.succeed(deck.replace(place, FALL + place)))
    t, x, v = run["Time"], run["v_place"], run["v_speed"]
    # mass 1; the far field of the neutral cage is much smaller than the force of the fix
    assert v == pytest.approx(0.3 * t, rel=1e-5, abs=1e-6)
    assert x - 5000 == pytest.approx(0.15 * t**2, rel=1e-5, abs=1e-6)
    steps = np.diff(t)
    assert steps.max() / steps.min() > 2
    # with its first step its position would be wrong
    assert abs(0.15 * (0.05 * 300) ** 2 - (x[-1] - 5000)) > 1.0


def test_two_controls_are_refused(lmp_tree):
    one = "group a id 1 2 3\ngroup b id 4 5 6\nfix one a gear/quat molecule tolerance 1e-8"
    beside = two_molecules(before=one).replace("fix move all", "fix move b")
    both = beside.replace("move b gear/quat molecule", "move b gear/quat molecule tolerance 1e-8")
    for deck in (beside, both):
        lmp_tree.refuse(deck, "tolerance cannot be used with fix move (gear/quat)")
    for before, message in (
        ("fix dt all dt/reset 1 NULL 0.1 0.1", "tolerance cannot be used with fix dt (dt/reset)"),
        ("run_style respa 2 1 pair 2", "tolerance cannot be used with run_style respa"),
    ):
        lmp_tree.refuse(two_molecules("molecule tolerance 1e-8", before), message)


@pytest.mark.parametrize("eps", ["1e-15 length", "1e-9 energy"])
@pytest.mark.parametrize("distance", [0.02, 0.002])
def test_a_near_singular_encounter_keeps_the_energy(lmp_tree, distance, eps):
    tolerance, measure = eps.split()

    def run(**settings):
        words = dict(distance=distance, tolerance=tolerance)
        deck = SCENES / "in.encounter"
        words["measure"] = measure
        return tables(lmp_tree.succeed(deck, words | settings))[0]

    met = run()
    depth = -met["c_potential"].min()
    assert depth == pytest.approx(0.5 / distance, rel=0.4)
    assert off(met) < 1e-8 * depth
    assert met[LARGEST][-1] <= 1
    assert off(run(tolerance=0, dt=0.001, steps=8000, more="")) > 1e-8 * depth


@pytest.mark.parametrize("eps", ["", "1.5e-11"])
def test_case_1_for_long(lmp_tree, eps):
    variables = dict(shift="3e-9", until=2500)
    if eps:
        variables["tolerance"] = eps
    deck = SCENES / "in.long"
    result = lmp_tree.succeed(deck, variables)
    line = r"^evaluations (\S+), energy off by (\S+) sampled, (\S+) at"
    evaluations, sampled, every_step = map(float, re.findall(line, result.log, re.M)[-1])
    assert 2500 / evaluations > 50000 / (0.5e6 if eps else 1e6)
    assert 0 < sampled < 1e-9 and every_step < 1e-9


UNTIL = """
variable now equal time
fix stop all halt 1 v_now >= 12.5 error continue
run 100000
"""


def test_a_collision_out_of_free_flight(lmp_tree):
    """The step has stayed below the limit for forces that set in within a step, and N has not decreased."""
    eps = [1e-8, 1e-10, 1e-13]
    decks = [
        meeting(e, pair, UNTIL)
        # with forces that decay smoothly, or jump
        for pair in ("lj/charmm/coul/charmm 4.0 6.0", "lj/cut 2.5")
        for e in eps
    ]
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    for e, run in zip(eps, runs):
        steps = np.diff(run["Time"])
        assert run["PotEng"].min() < -1 and run["Time"][-1] >= 12.5  # they have collided
        # force times eps in each step, and the kink of the force where it sets in
        assert off(run, "TotEng") < 50 * e * len(steps) + 1e-6
        assert 2.0 * steps.max() < 0.25 * 0.3 * 1.001  # a quarter of the skin
        assert run[LARGEST][-1] <= 1
    for run in runs[3:]:  # a jump of force and energy causes an error of its size
        assert run["Time"][-1] >= 12.5
        assert abs(run["TotEng"][-1] - run["TotEng"][0]) < 0.02


LATE = ("every 10 delay 20 check yes", "delay 10", "every 100 check no")


@pytest.mark.parametrize("often", LATE)
def test_neighbor_lists_that_are_looked_at_late(lmp_tree, often):
    """No site has moved by more than half the skin when LAMMPS tests its neighbor lists."""
    deck = meeting(1e-9, "lj/charmm/coul/charmm 4.0 6.0", f"neigh_modify {often}\n{UNTIL}")
    (run,) = tables(lmp_tree.succeed(deck))
    assert run["PotEng"].min() < -1 and off(run, "TotEng") < 1e-5


@pytest.mark.parametrize("words, shortest, longest", [
    ("", 0, 0.0375), ("dtmax 0.02", 0, 0.02), ("dtmin 0.01 dtmax 0.02", 0.01, 0.02)
])  # fmt: skip
@pytest.mark.parametrize("given", [0.001, 10.0])
def test_the_first_step_is_within_the_limits(lmp_tree, words, shortest, longest, given):
    """For any time step of the script."""
    deck = meeting(1e-8, "lj/charmm/coul/charmm 4.0 6.0", f"timestep {given}\nrun 20", words=words)
    (run,) = tables(lmp_tree.succeed(deck))
    steps = np.diff(run["Time"])
    assert (steps >= 0.999 * shortest).all() and (steps <= 1.001 * longest).all()
    assert off(run, "TotEng") < 1e-12


def test_a_shortest_step_that_is_too_long_is_named(lmp_tree):
    deck = meeting(1e-8, "lj/charmm/coul/charmm 4.0 6.0", "run 10", words="dtmin 1e6")
    lmp_tree.refuse(deck, "and no dtmin")


def test_no_bodies_yet(lmp_tree):
    """The step does not grow as long as its limit is unknown."""
    (lmp_tree.folder / "molecule.two").write_text(TWO_SITES)
    template = dict(before="molecule two molecule.two", words="mol two")
    deck = meeting(1e-8, "lj/cut 2.5", INSERTED, [], [], **template)
    empty, run = tables(lmp_tree.succeed(deck))
    assert np.diff(empty["Time"]) == pytest.approx([0.005] * 100, rel=1e-9)
    assert 0.005 < np.diff(run["Time"]).max() < 0.25 * 0.3 * 1.001  # they are inserted with a speed of 1


#: in terms of the units of length and energy
EPS = ["{0:g}", "{1:g} energy"]


@pytest.mark.parametrize("words", EPS)
def test_eps_in_all_units(lmp_tree, words):
    """A length or an energy: the same steps everywhere."""
    times = {}
    for units in ("real", "metal", "si", "cgs", "nano"):
        scale = UNITS[units]
        data = water_data(lmp_tree.folder / f"data.{units}", units=units)
        eps = words.format(1e-7 * scale["length"], 1e-4 * scale["energy"])
        deck = water(data, f"gear/quat molecule tolerance {eps}", dt=0.5, steps=60, units=units, columns=f"time {MEAN_LOADS}")
        (run,) = tables(lmp_tree.succeed(deck))
        times[units] = run["Time"][-1] / scale["time"]
        assert run[MEAN_LOADS][-1] > 3
    assert times["real"] > 20.0
    for units, time in times.items():
        assert time == pytest.approx(times["real"], rel=1e-3), times
