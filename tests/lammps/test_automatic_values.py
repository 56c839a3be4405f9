"""`values auto`: the number of values chosen, new choices, and cases in which it is kept."""

import re

import numpy as np
import pytest
from support.scenes import last_frame, one_after_the_other, placed, restarted, water

CHOSEN = re.compile(r"Fix gear/quat move: (\d+) values(?: \(velocity Verlet\))?( and corrector gear)?, (.*)")
SHORT, LONG = 0.5, 3.0  # fs, on either side of the limit in these boxes of water


def chosen(result):
    """(values, whether corrector gear, reason) of every choice in the log."""
    return [(int(n), bool(gear), why) for n, gear, why in CHOSEN.findall(result.stdout)]


def numbers(result):
    return [n for n, _, _ in chosen(result)]


def run(lmp, data, words="", ranks=1, **settings):
    settings = dict(steps=4) | settings
    return lmp.succeed(water(data, f"gear/quat molecule {words}", **settings), ranks=ranks)


# --- the choice ----------------------------------------------------------------------------------
def test_the_step_decides(lmp_tree, data):
    for dt, expected in ((SHORT, 9), (LONG, 5)):
        choices = chosen(run(lmp_tree, data, dt=dt))
        assert [choice[:2] for choice in choices] == [(expected, False)]
        edge = float(re.match(r"for vibrations of ([\d.]+) radians", choices[0][2])[1])
        assert (edge > 0.25) == (expected == 5)


@pytest.mark.parametrize("words", ["", "corrector gear", "formulation first"])
def test_random_forces(lmp_tree, data, words):
    """They have velocity Verlet, or in formulation first, which has none, a warning."""
    after = "fix l all langevin 300 300 100 4711"
    result = run(lmp_tree, data, words, after=after, dt=SHORT)
    assert [choice[:2] for choice in chosen(result)] == [(3, False)]
    assert ("3 values (velocity Verlet), because forces of fix l (langevin) are random" in result.words) == ("first" not in words)
    told = "are random, and formulation first cannot follow them; leave out keywords formulation, values and corrector"
    assert (told in result.words) == ("first" in words)


def test_where_vibrations_are_not_known_there_are_five(lmp_tree, data):
    """Beside a fix that a start cannot follow."""
    after = "fix v all press/langevin iso 1 1 1e9 temp 300 300 4711"
    result = run(lmp_tree, data, after=after, dt=0.1)
    assert chosen(result)[0][0] == 5 and "because the motion is not known before it begins" in result.words


def test_beside_atoms_of_another_fix_there_are_five(lmp_tree, data):
    """For any loads at the beginning."""
    before = "group still molecule 1:5\ngroup rest subtract all still\nfix others still nve\n"
    for dt in (0.01 * SHORT, SHORT):
        deck = water(data, before=before, steps=4, dt=dt).replace("fix move all", "fix move rest")
        assert numbers(lmp_tree.succeed(deck)) == [5]


def test_drag_changes_no_number(lmp_tree, data):
    """It is smooth."""
    assert chosen(run(lmp_tree, data, after="fix v all viscous 1e-3", dt=0.1))[0][0] == 9


PLACES = 2.0 * np.stack(np.meshgrid(*3 * [np.arange(4)], indexing="ij"), axis=-1).reshape(-1, 3)


def gas_deck(words, part, dt=0.005, steps=2000):
    """Free triangles and fix langevin, which damps ``part`` of a momentum in a step."""
    triangle = np.array([[0.0, 0.0, 0.0], [0.9, 0.0, 0.0], [0.1, 0.8, 0.2]])
    langevin = f"velocity all create 1.2 4712 loop geom\nfix l all langevin 1.2 1.2 {dt / part} 4711"
    settings = dict(before=langevin, dt=dt, steps=steps, thermo=5, box="-4 8 -4 8 -4 8", boundary="p p p")
    text = placed([triangle + place for place in PLACES], fix=f"gear/quat molecule {words}", **settings)
    return text.replace("neigh_modify every 1 delay 0 check yes", "neigh_modify every 20 check no")


def gas(lmp, words, part, dt=0.005, steps=2000):
    """Its temperature relative to that of fix langevin; result."""
    result = lmp.succeed(gas_deck(words, part, dt, steps))
    kinetic = result.thermo[-1]["KinEng"][steps // 20 :]
    return np.mean(kinetic) / (3 * len(PLACES)) / 1.2, result


@pytest.mark.parametrize("part", [1 / 50, 1 / 8, 1 / 2, 3 / 2])
def test_bodies_have_the_temperature_of_random_forces(lmp_tree, part):
    """However strong the friction is; within three standard errors."""
    found, result = gas(lmp_tree, "", part)
    assert found == pytest.approx(1.0, abs=max(0.005 / part**0.5, 0.01))
    assert "cannot follow" not in result.words


@pytest.mark.parametrize(
    "style, forces", [("dpd 1.0 2.0 4711", "pair style dpd are random"), ("lj/cut 2.0", "fix l (langevin) are random")]
)
def test_the_style_decides(lmp_wheel, style, forces):
    pair = f"pair_style {style}\npair_coeff * * 1.0 1.0\nfix l all langevin 1.0 1.0 1.0 4711"
    bodies = [[(0, 0, 0), (1, 0, 0)], [(0, 1.5, 0), (1, 1.5, 0.1)]]
    settings = dict(before=pair, dt=0.005, run="run 1")
    text = placed(bodies, np.full((4, 3), 0.1), [1] * 4, fix="gear/quat molecule", **settings)
    result = lmp_wheel.succeed("comm_modify vel yes\n" + text)
    assert chosen(result) == [(3, False, f"because forces of {forces}")]


EDPD = """
units lj
atom_style hybrid edpd molecular
atom_modify map array
region box block 0 6 0 6 0 6
create_box 1 box
lattice sc 3.0
create_atoms 1 box
mass 1 1.0
set group all edpd/temp 1.0
set group all edpd/cv 1e5
region middle block 2.0 3.9 2.0 3.9 2.0 3.9 units box
group body region middle
group fluid subtract all body
set group fluid mol 0
set group body mol 1
pair_style edpd 1.58 4711
pair_coeff 1 1 18.75 4.5 0.41 1.58 1.42e-5 2.0 1.58
comm_modify vel yes
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes exclude group body body
velocity all create 1.0 5 loop geom
velocity body set 300.0 0 0
fix others fluid mvv/edpd
fix move body {fix}
timestep 0.01
variable speed equal vcm(body,x)
variable all equal vcm(all,x)
thermo_style custom step v_speed v_all
thermo_modify format float %.15g
thermo 1
run 5
run 5
"""


def test_a_body_in_a_dpd_fluid(lmp_wheel):
    """The fluid takes a third of a momentum in a step.  The body moves as with fix rigid, so it has the same
    temperature, and no momentum is lost, also between runs, which draw other random numbers."""
    decks = [EDPD.format(fix=fix) for fix in ("gear/quat single", "rigid single")]
    result = lmp_wheel.succeed(one_after_the_other(decks))
    ours, rigid = (
        [np.concatenate([table[column] for table in two]) for column in ("v_speed", "v_all")]
        for two in (result.thermo[:2], result.thermo[2:])
    )
    assert ours[0] == pytest.approx(rigid[0], rel=1e-4) and ours[0][-1] < 0.3 * ours[0][0]
    assert np.ptp(ours[1]) < 1e-12 * ours[1][0]


@pytest.mark.parametrize("words, dt", [("", 8.0), ("formulation first", 16.0)])
def test_a_step_too_long_for_any(lmp_tree, data, words, dt):
    """Both formulations judge vibrations and rotations."""
    result = run(lmp_tree, data, words, dt=dt, steps=1)
    step = re.search(r"the angle of vibrations is \S+ in a step, and the method follows \S+; use a time step of ([\d.]+)", result.words)
    assert 1.0 < float(step[1]) < dt
    assert "the angle of vibrations" not in run(lmp_tree, data, words, dt=float(step[1]), steps=1).stdout


# --- new choices ---------------------------------------------------------------------------------
def springs(lmp, dt, commands, words=""):
    """A dumbbell and a triangle that vibrate about their positions, with at most 1.42 radians per time."""
    bodies = [[(0, 0, 0), (1, 0, 0), (0, 1.2, 0.1)], [(3, 3, 3), (4, 3.2, 3.1)]]
    settings = dict(before="fix s all spring/self 2.0", dt=dt, run=commands, steps=3)
    fix = f"gear/quat molecule {words}"
    return lmp.succeed(placed(bodies, np.full((5, 3), 0.1), [1] * 5, fix=fix, **settings))


def test_a_run_in_another_range_begins_with_another_number(lmp_tree):
    result = springs(lmp_tree, 0.15, "run 9\ntimestep 0.26\nrun 9\ntimestep 0.13\nrun 9")
    assert numbers(result) == [9, 5, 9]
    assert result.stdout.count("the motion suits another number of values; histories are rebuilt") == 2


def test_without_setup_it_stays(lmp_tree):
    commands = "run 9\ntimestep 0.26\nrun 9 pre no"
    assert numbers(springs(lmp_tree, 0.15, commands)) == [9]
    assert numbers(springs(lmp_tree, 0.15, commands + "\nrun 9")) == [9, 5]


def test_random_forces_that_come_and_go(lmp_tree, data):
    text = "run 3\nfix l all langevin 300 300 100 4711\nrun 3\nunfix l\nrun 3"
    assert numbers(run(lmp_tree, data, dt=LONG, run=text)) == [5, 3, 5]


# --- restart files -------------------------------------------------------------------------------
@pytest.mark.parametrize("words", ["", "values 7", "corrector gear"])
def test_a_restart_goes_on_with_the_method_of_the_file(lmp_tree, data, words):
    settings = dict(dt=LONG, steps=20)
    lmp_tree.succeed(water(data, f"gear/quat molecule {words}", run="run 20\nwrite_restart half\nrun 20", **settings))
    whole = last_frame(lmp_tree.folder / "poses.dump")
    result = lmp_tree.succeed(restarted(water(data, dump="half.dump", **settings), "half"))
    half = last_frame(lmp_tree.folder / "half.dump")
    assert chosen(result) == [] and "are rebuilt" not in result.stdout
    assert np.array_equal(whole, half)


def test_a_restart_keeps_its_number_outside_of_its_range(lmp_tree, data):
    lmp_tree.succeed(water(data, dt=1.5, steps=20, run="run 20\nwrite_restart half"))
    deck = restarted(water(data, dt=2.8, steps=5), "half")
    result = lmp_tree.succeed(deck)
    assert chosen(result) == [] and "are rebuilt" not in result.stdout
