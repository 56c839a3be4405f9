"""Keyword tolerance: the error follows eps, the time is right, everything else is told, restarts are exact.

The scene is test case 1, whose body passes a bare 1/r singularity again and again.
"""

import re

import numpy as np
import pytest
from running import EXAMPLES
from scenes import UNITS, one_after_the_other, two_molecules, water, water_data, whole_deck

COLUMNS = " ".join(f"f_move[{k}]" for k in range(9, 16))
NEXT, SMALLEST, MEAN, VALUES, MEAN_VALUES, LARGEST, HELD = (f"f_move[{k}]" for k in range(9, 16))


def case1(run="run ${steps}", before="", drop=(), **settings):
    """A deck; before: commands ahead of fix move."""
    known = dict(dt=0.1, every=1, out="none", more=COLUMNS, steps=1000, tolerance=1e-12) | settings
    variables = "".join(
        f'variable {key} delete\nvariable {key} index "{value}"\n' for key, value in known.items()
    )
    lines = whole_deck(EXAMPLES / "case1" / "in.case1").splitlines()
    lines = [line for line in lines if not line.startswith(tuple(drop) or "\0")]
    text = "\n".join(lines).replace("run ${steps}", run)
    return variables + text.replace("fix move body", f"{before}\nfix move body")


def table(lmp, deck, ranks=1):
    """The thermo table of each run of a deck, columns as arrays."""
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return [{key: np.array(column) for key, column in one.items()} for one in result.thermo], result


@pytest.mark.parametrize("formulation", ["second", "first"])
def test_the_energy_error_follows_eps(lmp_tree, formulation):
    eps = [1e-8, 1e-10, 1e-12]
    decks = [
        case1(tolerance=e, until=1000, steps=100000, formulation=formulation, every=1) for e in eps
    ]
    runs, _ = table(lmp_tree, one_after_the_other(decks))
    errors = [np.abs(run["v_total"] - run["v_total"][0]).max() for run in runs]
    slope = np.log(errors[0] / errors[-1]) / np.log(eps[0] / eps[-1])
    assert 0.7 < slope < 1.3
    for e, run in zip(eps, runs):
        assert 1000 <= run["Time"][-1] < 1001
        assert run[LARGEST][-1] < 40  # eps: no step had to be redone
        assert run[HELD][-1] == 0
    assert runs[-1][VALUES][-1] >= 8
    assert len(runs[0]["Step"]) < len(runs[2]["Step"])

    # without the mend, a fixed step as long as the mean one
    mean = runs[-1][MEAN][-1]
    deck = case1(tolerance=0, dt=mean, steps=int(1000 / mean), more="", formulation=formulation)
    fixed = table(lmp_tree, deck)[0][0]["v_total"]
    assert np.abs(fixed - fixed[0]).max() > 100 * errors[-1]


def test_outputs_are_those_of_the_steps(lmp):
    (run, _), _ = table(lmp, case1(steps=300, run="run 200\nrun 100"))
    second = table(lmp, case1(steps=300))[0][0]
    steps = np.diff(second["Time"])
    assert steps[0] == pytest.approx(0.1, rel=1e-12)
    assert steps[1:] == pytest.approx(second[NEXT][1:-1], rel=1e-11)
    assert second[SMALLEST][-1] == pytest.approx(steps.min(), rel=1e-11)
    assert second[MEAN][-1] == pytest.approx(steps.mean(), rel=1e-12)
    assert second[MEAN_VALUES][-1] == pytest.approx(np.append(10, second[VALUES][1:-1]).mean())
    assert steps.max() / steps.min() > 2
    assert (steps[1:] / steps[:-1]).max() < 1.0501
    assert run["v_total"].tolist() == second["v_total"][:201].tolist()  # run n twice is run 2n


def test_a_first_step_that_is_too_long_is_made_shorter(lmp_tree):
    (long,), result = table(lmp_tree, case1(dt=2.0, steps=50))
    assert "first step" in result.output and "instead of 2" in result.output
    assert long["Time"][1] < 1.0
    assert np.abs(long["v_total"] - long["v_total"][0]).max() < 1e-8
    assert long[LARGEST][-1] < 20

    (zero,), _ = table(lmp_tree, case1(start="zero", steps=100))
    assert zero[VALUES][1] == 4 and zero[VALUES][-1] > 5


def test_limits_of_the_step(lmp_tree):
    def limited(words):
        (run,), result = table(
            lmp_tree,
            case1(steps=400).replace("molecule formulation", "molecule " + words + " formulation"),
        )
        return run, result

    free, _ = limited("")
    run, result = limited("dtmax 0.07")
    assert run[NEXT].max() <= 0.1 and run[NEXT][1:].max() <= 0.07 < free[NEXT].max()
    assert "WARNING" not in result.output
    least = 1.5 * free[SMALLEST][-1]
    run, result = limited(f"dtmin {least}")
    assert run[SMALLEST][-1] == pytest.approx(least, rel=1e-12)
    assert result.stderr.count("dtmin keeps") + result.stdout.count("dtmin keeps") == 1
    assert run[HELD][-1] > 1


def encounter(run):
    """The step with the smallest time step, well inside of the run."""
    return int(np.argmin(run[NEXT][50:-50])) + 50


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_restart_goes_on_bit_for_bit(lmp_tree, ranks):
    """Also where the step is at its smallest; the timestep command of the script changes nothing."""
    total, grid = 500, "processors 2 1 1\n" if ranks == 2 else ""
    end = "\nwrite_dump body custom {}.end id xu yu zu vx vy vz modify sort id format float %.17g"
    whole = table(lmp_tree, grid + case1(run=f"run {total}" + end.format("whole")), ranks)[0][0]
    closest = encounter(whole)
    assert whole[NEXT][closest] < 0.5 * whole[NEXT].max()
    for half in (200, closest):
        run = f"run {half}\nwrite_restart half"
        table(lmp_tree, grid + case1(run=run), ranks)
        skip = ("atom_style", "boundary", "pair_style", "pair_coeff", "pair_modify")
        run = f"run {total - half}" + end.format(f"again{half}")
        deck = grid + case1(run=run, drop=skip).replace(
            "read_data ${data}.${body}", "read_restart half"
        )
        again = table(lmp_tree, deck, ranks)[0][0]
        for column in ("Time", "v_total", *COLUMNS.split()):
            assert again[column][1:].tolist() == whole[column][half + 1 :].tolist(), column
        ends = [(lmp_tree.folder / f"{name}.end").read_text() for name in ("whole", f"again{half}")]
        assert ends[0] == ends[1]

    # what the memory is for: without a history the run starts anew
    deck = (
        deck.replace("fix move", "fix other")
        .replace("f_move", "f_other")
        .replace("fix_modify move", "fix_modify other")
    )
    lost = table(lmp_tree, deck, ranks)[0][0]
    assert lost["v_total"][1:].tolist() != whole["v_total"][half + 1 :].tolist()


def test_ranks_agree_to_rounding(lmp_tree):
    """The step magnifies rounding: it follows high differences."""
    deck = case1(steps=100, tolerance=1e-8)
    one = table(lmp_tree, deck)[0][0]
    two = table(lmp_tree, "processors 1 2 1\n" + deck, ranks=2)[0][0]
    for column in ("Time", "c_centre[1]", "c_centre[2]", "c_centre[3]", "v_total"):
        assert two[column] == pytest.approx(one[column], rel=1e-7, abs=1e-7)


FALL = """
create_atoms 4 single {x} 0 0
group free subtract all body cage
fix drop free nve
fix pull free addforce 0.3 0.0 0.0
variable place equal xcm(free,x)
variable speed equal vcm(free,x)
"""


@pytest.mark.parametrize("first", [True, False])
def test_other_integrators_follow(lmp_tree, first):
    """Under a constant force velocity Verlet is exact whatever its steps, if it is told of each in time."""
    fall = FALL.format(x=5000)
    deck = case1(steps=300, more=COLUMNS + " v_place v_speed", dt=0.05)
    if first:
        deck = deck.replace("fix move body", fall + "\nfix move body")
    else:
        deck = deck.replace("# --- the outputs", fall + "\n# --- the outputs")
    (run,), _ = table(lmp_tree, deck)
    t, x, v = run["Time"], run["v_place"], run["v_speed"]
    # mass 1; the cage is neutral from afar, its force is far below the one of the fix
    assert v == pytest.approx(0.3 * t, rel=1e-5, abs=1e-6)
    assert x - 5000 == pytest.approx(0.15 * t**2, rel=1e-5, abs=1e-6)
    steps = np.diff(t)
    assert steps.max() / steps.min() > 2
    # had it kept its first step, its place would be far off
    assert abs(0.15 * (0.05 * 300) ** 2 - (x[-1] - 5000)) > 1.0


def test_two_controls_are_refused(lmp_tree):
    text = two_molecules(
        fix="molecule",
        before="group a id 1 2 3\ngroup b id 4 5 6\nfix one a gear/quat molecule tolerance 1e-8",
    )
    both = text.replace(
        "fix move all gear/quat molecule", "fix move b gear/quat molecule tolerance 1e-8"
    )
    result = lmp_tree.run(both)
    assert any("fix move (gear/quat) changes the time step too" in e for e in result.errors)
    alone = text.replace("fix move all gear/quat", "fix move b gear/quat")
    assert lmp_tree.run(alone).returncode == 0
    other = two_molecules(
        fix="molecule tolerance 1e-8", before="fix dt all dt/reset 1 NULL 0.1 0.1"
    )
    result = lmp_tree.run(other)
    assert any("fix dt (dt/reset) changes the time step too" in e for e in result.errors)
    respa = two_molecules(fix="molecule tolerance 1e-8", before="run_style respa 2 1 pair 2")
    result = lmp_tree.run(respa)
    assert any("tolerance cannot be used with run_style respa" in e for e in result.errors)


@pytest.mark.parametrize("formulation", ["second", "first"])
@pytest.mark.parametrize("distance", [0.02, 0.002])
def test_a_near_singular_encounter_keeps_the_energy(lmp_tree, distance, formulation):
    def run(**settings):
        deck = EXAMPLES / "hard" / "encounter" / "in.encounter"
        words = dict(distance=distance, formulation=formulation) | settings
        result = lmp_tree.run(deck, variables=words)
        assert result.returncode == 0, result.output
        return {key: np.array(column) for key, column in result.thermo[0].items()}

    met = run()
    depth = -met["c_potential"].min()
    assert depth == pytest.approx(0.5 / distance, rel=0.4)
    assert np.abs(met["v_total"] - met["v_total"][0]).max() < 1e-8 * depth
    assert met[LARGEST][-1] < 10
    fixed = run(tolerance=0, dt=0.001, steps=8000, more="")
    assert np.abs(fixed["v_total"] - fixed["v_total"][0]).max() > 1e-8 * depth


@pytest.mark.parametrize("formulation", ["second", "first"])
def test_case_1_for_long(lmp_tree, formulation):
    deck = EXAMPLES / "hard" / "long" / "in.long"
    variables = dict(formulation=formulation, shift="3e-9", until=2500)
    result = lmp_tree.run(deck, variables=variables)
    assert result.returncode == 0, result.output
    line = re.findall(
        r"^evaluations (\S+), energy off by (\S+) sampled, (\S+) at", result.log, re.M
    )
    evaluations, sampled, every_step = map(float, line[-1])
    assert 2500 / evaluations > 50000 / 1e6
    assert sampled < 1e-10 and every_step < 1e-9
    assert sampled > 0


# Two molecules that meet out of free flight; from 6 on their forces fade away smoothly.
MEETING = """
units lj
atom_style full
atom_modify map array
region box block -30 30 -10 10 -10 10
create_box 1 box
create_atoms 1 single -15.0 0.0 0.0
create_atoms 1 single -14.0 0.0 0.0
create_atoms 1 single -15.0 1.2 0.1
create_atoms 1 single 15.0 0.3 0.2
create_atoms 1 single 16.0 0.3 0.2
create_atoms 1 single 15.0 1.5 0.3
mass 1 1.0
set atom 1*3 mol 1
set atom 4*6 mol 2
group left id 1:3
group right id 4:6
velocity left set 2.0 0 0
velocity right set -2.0 0 0
pair_style {pair}
pair_coeff * * 1.0 1.0
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
timestep 0.005
fix move all gear/quat molecule tolerance {eps}
fix_modify move energy yes
thermo_style custom step time dt pe etotal f_move[9] f_move[12] f_move[14]
thermo_modify norm no format float %.17g
thermo 1
variable now equal time
fix stop all halt 1 v_now >= 12.5 error continue
run 100000
"""


def test_a_collision_out_of_free_flight(lmp_tree):
    """The step has not grown beyond what forces that begin on the way allow, nor has N fallen."""
    smooth = "lj/charmm/coul/charmm 4.0 6.0"
    eps = [1e-8, 1e-10, 1e-13]
    decks = [MEETING.format(eps=e, pair=smooth) for e in eps]
    decks += [MEETING.format(eps=e, pair="lj/cut 2.5") for e in eps]
    runs, _ = table(lmp_tree, one_after_the_other(decks))
    for e, run in zip(eps, runs):
        energy, steps = run["TotEng"], np.diff(run["Time"])
        assert run["PotEng"].min() < -1 and run["Time"][-1] >= 12.5  # they have met
        # force times eps in each step, and the bend of the force where it begins
        assert np.abs(energy - energy[0]).max() < 50 * e * len(steps) + 1e-6
        assert 2.0 * steps.max() < 0.25 * 0.3 * 1.001  # a quarter of the skin
        assert run["f_move[12]"].min() >= 8
    for run in runs[3:]:  # a force and an energy that jump cost what they jump by
        assert run["Time"][-1] >= 12.5
        assert abs(run["TotEng"][-1] - run["TotEng"][0]) < 0.02


def test_no_bodies_yet(lmp_tree):
    """The step does not grow while there is nothing that says how far it may."""
    (lmp_tree.folder / "molecule.two").write_text(
        "two\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n"
    )
    text = MEETING.format(eps=1e-8, pair="lj/cut 2.5")
    start, end = text.index("create_atoms"), text.index("mass 1")
    text = text[:start] + text[end:]
    begin, finish = text.index("set atom"), text.index("pair_style")
    text = text[:begin] + "molecule two molecule.two\n" + text[finish:]
    text = text.replace("gear/quat molecule", "gear/quat molecule mol two").replace(
        "run 100000",
        "run 100\nregion in block -5 5 -5 5 -5 5\nfix in all deposit 3 0 200 4711 region in near 2.5 mol two "
        "rigid move vx 1 1\nrun 700",
    )
    (empty, run), _ = table(lmp_tree, text)
    assert np.diff(empty["Time"]) == pytest.approx([0.005] * 100, rel=1e-9)
    assert 0.005 < np.diff(run["Time"]).max() < 0.25 * 0.3 * 1.001  # they come with a speed of 1


def test_eps_is_a_length(lmp_tree):
    """The same error and so the same steps in all systems of units."""
    times = {}
    for units in ("real", "metal", "si", "cgs", "nano"):
        scale = UNITS[units]
        data = water_data(lmp_tree.folder / f"data.{units}", units=units)
        fix = f"gear/quat molecule tolerance {1e-7 * scale['length']:g}"
        deck = water(data, fix, dt=0.5, steps=60, units=units, run="run 60", dump=f"d.{units}")
        (run,), _ = table(lmp_tree, deck.replace("step temp", "step time f_move[12] temp"))
        times[units] = run["Time"][-1] / scale["time"]
        assert run["f_move[12]"][-1] > 4
    assert times["real"] > 30.0
    for units, time in times.items():
        assert time == pytest.approx(times["real"], rel=1e-3), times
