"""Keyword tolerance: a failed step is repeated, without any effect on the rest of LAMMPS."""

import numpy as np
import pytest
from support.scenes import TWO_SITES, one_after_the_other, placed, water, water_data
from support.step_control import (
    HELD,
    INSERTED,
    LARGEST,
    LAST,
    LOADS,
    MEAN,
    NEXT,
    REPEATED,
    SMALLEST,
    TWO,
    agree_on_ranks,
    meeting,
    off,
    tables,
)

SMOOTH = "lj/charmm/coul/charmm 4.0 6.0"
UNTIL = """
variable now equal time
fix stop all halt 1 v_now >= {} error continue
run 100000
"""
SUMS = """
compute pe all pe/atom
compute stress all stress/atom NULL pair fix
compute ke all stress/atom NULL ke
compute sums all reduce sum c_pe c_stress[1] c_stress[2] c_stress[3] c_ke[1] c_ke[2] c_ke[3]
variable virial equal -(c_sums[2]+c_sums[3]+c_sums[4]+c_sums[5]+c_sums[6]+c_sums[7])/(3*vol)
variable draw equal random(0.0,1.0,4711)
fix mean all ave/time 1 1 1 c_thermo_press file mean
fix_modify move virial yes
"""


def scene(tolerance, after="", until=8.0, pair=SMOOTH, columns="", **settings):
    """Two molecules that collide after free flight; tolerance: its values."""
    more = f"{NEXT} {LOADS} {LARGEST} {REPEATED} {LAST} {columns}"
    deck = meeting(tolerance, pair, UNTIL.format(until), **settings)
    return deck.replace(f"{NEXT} {LOADS} {LARGEST}", more).replace(
        "fix_modify move energy yes", f"fix_modify move energy yes\n{after}"
    )


def test_energies_virials_and_random_numbers_are_those_of_the_step(lmp_tree):
    columns = "press c_sums[1] v_virial v_draw"
    (run,) = tables(lmp_tree.succeed(scene("1e-10 energy", SUMS, columns=columns)))
    again = np.flatnonzero(np.diff(run[REPEATED])) + 1
    assert len(again) > 10 and run[LARGEST][-1] <= 1
    # the failed try was at another position, with another energy: F v h, 1e6 times the difference here
    assert off(run, "TotEng") < 1e-7
    pairs = run["c_sums[1]"] - run["PotEng"]  # energy yes moves the total to the corrected pose
    assert np.abs(pairs).max() < 1e-7
    assert run["v_virial"] == pytest.approx(run["Press"], rel=1e-9, abs=1e-12)
    mean = np.loadtxt(lmp_tree.folder / "mean")[:, 1]
    assert mean == pytest.approx(run["Press"][-len(mean) :], rel=1e-5)
    # random numbers: as many as steps, though some steps were repeated
    (plain,) = tables(lmp_tree.succeed(scene("1e-3", SUMS, columns="v_draw", until=1.0)))
    n = min(len(plain["v_draw"]), len(run["v_draw"]))
    assert plain["v_draw"][:n].tolist() == run["v_draw"][:n].tolist()


def test_an_energy_is_an_energy(lmp_tree):
    eps = [1e-6, 1e-8, 1e-10]
    runs = tables(lmp_tree.succeed(one_after_the_other([scene(f"{e:g} energy") for e in eps])))
    for e, run in zip(eps, runs):
        assert run[LARGEST][-1] <= 1 and run[LAST].max() <= e * (1 + 1e-9)
        assert off(run, "TotEng") < 30 * e * np.sqrt(len(run["Step"]))
    # and a length follows a length
    (run,) = tables(lmp_tree.succeed(scene("1e-9")))
    assert run[LAST].max() == pytest.approx(1e-9 * run[LARGEST][-1], rel=1e-6)


def test_forces_that_jump(lmp_tree):
    """At a cutoff without a shift the energy jumps, and is restored when the bodies separate."""
    (run,) = tables(lmp_tree.succeed(scene("1e-9 energy", pair="lj/cut 2.5", until=12.5)))
    apart = run["PotEng"] == 0
    assert apart[0] and run["PotEng"].min() < -1 and abs(run["PotEng"][-1]) < 1e-6
    assert run[LARGEST][-1] <= 1
    assert run["TotEng"][-1] == pytest.approx(run["TotEng"][0], abs=1e-6)


UNFOLLOWED = {
    "fix other others nve": "moves atoms",
    "fix other others langevin 1.0 1.0 1.0 4711": "acts on forces in a way that cannot be followed",
}


@pytest.mark.parametrize("command", UNFOLLOWED)
def test_where_steps_are_not_repeated_the_log_says_so(lmp_tree, command):
    before = f"create_atoms 2 single 0 -9 9\ngroup others type 2\ngroup ones type 1\n{command}"
    result = lmp_tree.succeed(scene("1e-8", before=before).replace("fix move all", "fix move ones"))
    assert result.output.count("no step is repeated, because") == 1
    assert UNFOLLOWED[command] in result.output
    (run,) = tables(result)
    assert run[REPEATED][-1] == 0 and run["PotEng"].min() < -1
    assert off(run, "TotEng") < 1e-3  # only the limit of the motion


def test_steps_end_at_times_of_a_dump(lmp_tree):
    dump = "dump even all custom 1 even.dump id xu\ndump_modify even every/time 1.0 sort id time yes"
    plain, even = tables(
        lmp_tree.succeed(one_after_the_other([scene("1e-10"), scene("1e-10", dump)]))
    )
    text = (lmp_tree.folder / "even.dump").read_text().split("ITEM: TIME\n")[1:]
    times = np.array([float(part.split()[0]) for part in text])
    assert times == pytest.approx(np.arange(len(times)), abs=1e-9) and len(times) > 8
    assert set(np.round(times, 9)) <= set(np.round(even["Time"], 9))
    tries = [len(run["Step"]) + run[REPEATED][-1] for run in (plain, even)]
    assert tries[1] < 1.15 * tries[0]
    assert even[LARGEST][-1] <= 1


@pytest.mark.parametrize("interval", [7.3, 0.1])
def test_steps_end_at_multiples_of_a_time(lmp_tree, interval):
    """Fix halt, first or last, ends the run at one of them."""
    often = scene("1e-9", until=7.3, words=f"every/time {interval}")
    halt, run = UNTIL.format(7.3).split("run")
    first = often.replace(halt, "\n").replace("fix move all", f"{halt}fix move all")
    assert first != often
    all_steps, halted_first, free = tables(
        lmp_tree.succeed(one_after_the_other([often, first, scene("1e-9", until=7.3)]))
    )
    expected = np.arange(round(7.3 / interval)) * interval
    assert set(expected.tolist()) <= set(all_steps["Time"].tolist())
    assert all_steps["Time"][-1] == pytest.approx(7.3, abs=1e-14)
    assert {key: a.tolist() for key, a in halted_first.items()} == {
        key: a.tolist() for key, a in all_steps.items()
    }
    assert all_steps["Time"][-1] < free["Time"][-1]
    tries = [len(run["Step"]) + run[REPEATED][-1] for run in (free, all_steps)]
    assert tries[1] < 1.15 * tries[0]  # steps without this condition are up to 0.1 long


def test_a_first_step_ends_at_a_multiple(lmp_tree):
    (run,) = tables(lmp_tree.succeed(scene("1e-4", words="every/time 0.003", until=0.03)))
    assert run["Step"].tolist() == list(range(11))
    assert run["Time"] == pytest.approx(0.003 * np.arange(11), rel=1e-14)


def test_free_flight_for_a_million(lmp_tree):
    """There are no forces, and a wide skin lets a body move far in a step."""
    settings = dict(box="-5e5 5e5 -20 20 -20 20", boundary="p p p", thermo=1)
    bodies, velocities = [TWO[0]], [(0.01, 0, 0)] * 3
    deck = placed(
        bodies,
        velocities,
        fix="gear/quat molecule tolerance 1e-10",
        before="neighbor 20.0 bin\npair_style lj/cut 8.0\npair_coeff * * 1 1",
        columns=f"{NEXT} {LOADS} v_x",
        run=UNTIL.format(1e6),
        after="variable x equal xcm(all,x)",
        **settings,
    )
    (run,) = tables(lmp_tree.succeed(deck))
    assert run["Time"][-1] >= 1e6 and run["Step"][-1] < 10000
    assert run["v_x"][-1] - run["v_x"][0] == pytest.approx(0.01 * run["Time"][-1], rel=1e-9)


def test_bodies_that_come_into_the_way(lmp_tree):
    """Inserted bodies collide with others, and no step has an error above eps."""
    (lmp_tree.folder / "molecule.two").write_text(TWO_SITES)
    template = dict(before="molecule two molecule.two", words="mol two")
    run = INSERTED.replace("deposit 3 0 200", "deposit 8 0 60").replace("run 700", "run 3000")
    deck = meeting("1e-8", SMOOTH, run, [], [], **template)
    deck = deck.replace(LARGEST, f"{LARGEST} {REPEATED} atoms")
    _, run = tables(lmp_tree.succeed(deck))
    assert run["Atoms"][-1] == 16 and run[REPEATED][-1] > 0
    assert run[LARGEST][-1] <= 1
    settled = run["Step"] > 1000
    total = run["PotEng"] + run["f_move[1]"] + run["f_move[2]"]  # ke includes freedoms of atoms
    assert np.ptp(total[settled]) < 1e-4
    assert (run[LOADS][settled] > 5).any()


@pytest.mark.parametrize("words", ["1e-12", "1e-9 energy", "1e-12 temp 300 300 20"])
def test_ranks_agree(lmp_tree, words):
    """Results are compared at the same time, because rounding changes the steps."""
    data = water_data(lmp_tree.folder / "data")
    deck = water(data, f"gear/quat molecule tolerance {words}", dt=0.5, steps=120)
    deck = deck.replace("fix_modify move energy yes", "") if "temp" in words else deck
    agree_on_ranks(lmp_tree, deck)


def test_a_tolerance_far_below_rounding(lmp_tree):
    """Round-off errors shorten no step."""
    (run,) = tables(lmp_tree.succeed(scene("1e-200 energy", until=1.0)))
    assert run["Time"][-1] >= 1.0 and off(run, "TotEng") < 1e-12


def test_a_tolerance_that_anything_meets(lmp_tree):
    """Only the limit of the motion determines the step, and bodies still repel each other."""
    (run,) = tables(lmp_tree.succeed(scene("1e30", until=8.0)))
    assert run["PotEng"].min() < -0.5 and run[REPEATED][-1] == 0 and run["Time"][-1] >= 8.0
    assert run[NEXT].max() < 0.25 * 0.3 / 2.0 * 1.5  # a quarter of the skin at a speed of 2


def test_a_shortest_step_is_not_made_again(lmp_tree):
    deck = scene("1e-10", words="dtmin 0.004").replace(LARGEST, f"{LARGEST} {HELD} {SMALLEST} {MEAN}")
    result = lmp_tree.succeed(deck)
    (run,) = tables(result)
    assert run[SMALLEST][-1] == pytest.approx(0.004) and run[HELD][-1] >= 1
    assert result.output.count("dtmin keeps") == 1
    assert run[LARGEST][-1] > 1 and run["Time"][-1] >= 8.0
