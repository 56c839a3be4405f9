"""Keyword tolerance: a step that fails is made again, and nothing else in LAMMPS can tell."""

import numpy as np
import pytest
from scenes import frames, one_after_the_other, placed, water, water_data
from test_tolerance import (
    ENERGY,
    HELD,
    INSERTED,
    LARGEST,
    LENGTH,
    MEAN,
    NEXT,
    REPEATED,
    SMALLEST,
    TWO,
    VALUES,
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
    """Two molecules out of free flight; tolerance: its values."""
    more = f"{NEXT} {VALUES} {LARGEST} {REPEATED} {LENGTH} {ENERGY} {columns}"
    deck = meeting(tolerance, pair, UNTIL.format(until), **settings)
    return deck.replace(f"{NEXT} {VALUES} {LARGEST}", more).replace(
        "fix_modify move energy yes", f"fix_modify move energy yes\n{after}"
    )


def test_energies_virials_and_random_numbers_are_those_of_the_step(lmp):
    columns = "press c_sums[1] v_virial v_draw"
    (run,) = tables(lmp.succeed(scene("1e-10 energy", SUMS, columns=columns)))
    again = np.flatnonzero(np.diff(run[REPEATED])) + 1
    assert len(again) > 10 and run[LARGEST][-1] <= 1
    # the failed try was at another place, with another energy: F v h, 1e6 times what is seen here
    assert off(run, "TotEng") < 1e-7
    pairs = run["c_sums[1]"] - run["PotEng"]  # energy yes moves the total to the corrected pose
    assert np.abs(pairs).max() < 1e-7
    assert run["v_virial"] == pytest.approx(run["Press"], rel=1e-9, abs=1e-12)
    mean = np.loadtxt(lmp.folder / "mean")[:, 1]
    assert mean == pytest.approx(run["Press"][-len(mean) :], rel=1e-5)
    # random numbers: as many as steps, though some steps were made twice
    (plain,) = tables(lmp.succeed(scene("1e-3", SUMS, columns="v_draw", until=1.0)))
    n = min(len(plain["v_draw"]), len(run["v_draw"]))
    assert plain["v_draw"][:n].tolist() == run["v_draw"][:n].tolist()


def test_an_energy_is_an_energy(lmp_tree):
    eps = [1e-6, 1e-8, 1e-10]
    runs = tables(lmp_tree.succeed(one_after_the_other([scene(f"{e:g} energy") for e in eps])))
    for e, run in zip(eps, runs):
        assert run[LARGEST][-1] <= 1 and run[ENERGY].max() <= e * (1 + 1e-9)
        assert off(run, "TotEng") < 30 * e * np.sqrt(len(run["Step"]))
    # and a length a length
    (run,) = tables(lmp_tree.succeed(scene("1e-9")))
    assert run[LENGTH].max() == pytest.approx(1e-9 * run[LARGEST][-1], rel=1e-6)
    assert run[ENERGY].max() > 1e-9


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_forces_that_jump(lmp_tree, formulation):
    """At a cutoff without a shift the energy jumps, and comes back when the bodies part."""
    run = tables(
        lmp_tree.succeed(scene("1e-9 energy", pair="lj/cut 2.5", until=12.5, words=f"formulation {formulation}"))
    )[0]
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
    deck = scene("1e-8", before=before).replace("fix move all", "fix move ones")
    result = lmp_tree.succeed(deck)
    assert result.output.count("no step is repeated, because") == 1
    assert UNFOLLOWED[command] in result.output
    (run,) = tables(result)
    assert run[REPEATED][-1] == 0 and run["PotEng"].min() < -1
    assert off(run, "TotEng") < 1e-3  # the limit of the motion alone


def test_steps_end_at_even_times(lmp_tree):
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


def argon(units, eps, dt):
    """A deck with two atoms that fall towards each other."""
    # length, mass, time, energy: of Angstrom, g/mol, ps and eV in these units
    length, mass, time, energy = {
        "metal": (1.0, 1.0, 1.0, 1.0),
        "si": (1e-10, 1.66053907e-27, 1e-12, 1.602176634e-19),
    }[units]
    sigma, depth = 3.4 * length, 0.0104 * energy
    return f"""
units {units}
atom_style molecular
atom_modify map array
boundary f f f
region box block {-50 * length} {50 * length} {-50 * length} {50 * length} {-50 * length} {50 * length}
create_box 1 box
create_atoms 1 single {-15 * length} 0 0
create_atoms 1 single {15 * length} {length} 0
set atom 1 mol 1
set atom 2 mol 2
mass 1 {39.95 * mass}
velocity all set 0 0 0
set atom 1 vx {3.0 * length / time}
set atom 2 vx {-3.0 * length / time}
neighbor {dict(metal=2.0, si=0.001)[units]} nsq
pair_style lj/cut {12 * length}
pair_modify shift yes
pair_coeff 1 1 {depth} {sigma}
timestep {dt * time}
fix move all gear/quat molecule tolerance {eps}
fix_modify move energy yes
thermo_style custom step time pe ke etotal {NEXT} {VALUES} {LARGEST} {REPEATED}
thermo_modify norm no format float %.17g
thermo 1
{UNTIL.format(10 * time)}
"""


def test_two_atoms_in_units_of_the_laboratory(lmp_tree):
    """Also where the neighbor skin is a millimeter, as it is in units si by default."""
    decks = [argon("metal", "1e-8", 0.01), argon("si", "1e-18", 0.01)]
    decks += [argon("metal", "1e-9 energy", 0.01), argon("si", "1.602176634e-28 energy", 0.01)]
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    for metal, si in (runs[:2], runs[2:]):
        for run in (metal, si):
            assert off(run, "TotEng") < 1e-4 * -run["PotEng"].min() and run["PotEng"].min() < 0
            assert run[LARGEST][-1] <= 1
        assert si["TotEng"][-1] / 1.602176634e-19 == pytest.approx(metal["TotEng"][-1], rel=1e-5)


def test_free_flight_for_a_million(lmp_tree):
    """Nothing acts, and a wide skin lets a body fly far in a step."""
    settings = dict(box="-5e5 5e5 -20 20 -20 20", boundary="p p p", thermo=1)
    bodies, velocities = [TWO[0]], [(0.01, 0, 0)] * 3
    deck = placed(
        bodies,
        velocities,
        fix="gear/quat molecule tolerance 1e-10",
        before="neighbor 20.0 bin\npair_style lj/cut 8.0\npair_coeff * * 1 1",
        columns=f"{NEXT} {VALUES} v_x",
        run=UNTIL.format(1e6),
        after="variable x equal xcm(all,x)",
        **settings,
    )
    (run,) = tables(lmp_tree.succeed(deck))
    assert run["Time"][-1] >= 1e6 and run["Step"][-1] < 10000
    assert run["v_x"][-1] - run["v_x"][0] == pytest.approx(0.01 * run["Time"][-1], rel=1e-9)


def test_bodies_that_come_into_the_way(lmp_tree):
    """Inserted bodies meet others, and no step is wrong by more than eps."""
    molecule = "two\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n"
    (lmp_tree.folder / "molecule.two").write_text(molecule)
    template = dict(before="molecule two molecule.two", words="mol two")
    run = INSERTED.replace("deposit 3 0 200", "deposit 8 0 60").replace("run 700", "run 3000")
    deck = meeting("1e-8", SMOOTH, run, [], [], **template)
    deck = deck.replace(LARGEST, f"{LARGEST} {REPEATED} atoms")
    _, run = tables(lmp_tree.succeed(deck))
    assert run["Atoms"][-1] == 16 and run[REPEATED][-1] > 0
    assert run[LARGEST][-1] <= 1
    settled = run["Step"] > 1000
    total = run["PotEng"] + run["f_move[1]"] + run["f_move[2]"]  # ke counts freedoms of atoms
    assert np.ptp(total[settled]) < 1e-4
    assert (run[VALUES][settled] > 5).any()


@pytest.mark.parametrize("words", ["1e-12", "1e-9 energy"])
def test_ranks_agree(lmp_tree, words):
    """At the same time, for rounding moves the steps."""
    data = water_data(lmp_tree.folder / "data")
    deck = water(data, f"gear/quat molecule tolerance {words}", dt=0.5, steps=120)
    deck = deck.replace("dump poses all custom 120", "dump poses all custom 1")
    deck = deck.replace("dump_modify poses", "dump_modify poses every/time 0.5")
    found = []
    for ranks in (1, 2, 4):
        lmp_tree.succeed(deck.replace("poses.dump", f"{ranks}.dump"), ranks=ranks)
        found.append(list(frames(lmp_tree.folder / f"{ranks}.dump").values()))
    assert len(found[0]) > 2
    for other in found[1:]:
        for frame, same in zip(found[0], other):
            assert same == pytest.approx(frame, rel=1e-10, abs=1e-10)


def test_where_it_does_not_pay_the_log_says_so(lmp_tree):
    data = water_data(lmp_tree.folder / "data")
    deck = water(data, "gear/quat molecule tolerance 1e-6", dt=1.0, steps=500)
    assert "the control does not pay here" in lmp_tree.succeed(deck).output
    assert "the control does not pay" not in lmp_tree.succeed(scene("1e-8")).output


def test_a_longest_step_beyond_the_motion(lmp_tree):
    result = lmp_tree.succeed(scene("1e-8", words="dtmax 10", until=1.0))
    assert result.output.count("dtmax 10 is longer than the 0.0375") == 1
    result = lmp_tree.succeed(scene("1e-8", words="dtmax 0.03", until=1.0))
    assert "is longer than" not in result.output


def test_a_shortest_step_is_not_made_again(lmp_tree):
    deck = scene("1e-10", words="dtmin 0.004").replace(LARGEST, f"{LARGEST} {HELD} {SMALLEST} {MEAN}")
    result = lmp_tree.succeed(deck)
    (run,) = tables(result)
    assert run[SMALLEST][-1] == pytest.approx(0.004) and run[HELD][-1] >= 1
    assert result.output.count("dtmin keeps") == 1
    assert run[LARGEST][-1] > 1 and run["Time"][-1] >= 8.0
