"""Changes between two runs, and evaluations of forces that must not disturb anything."""

import numpy as np
import pytest
from support.scenes import last_frame, one_after_the_other, placed, restarted, two_molecules, water, water_data

ANEW = "forces have changed since the last step; histories are rebuilt"
FALLBACK = "start with known forces only (order 2), because"
SPRING = "fix spring all spring/self 1.0\nfix_modify spring energy yes"

PAIRS = """
pair_style lj/charmm/coul/charmm {} {}
pair_coeff 1 1 {} 3.166
pair_coeff 2 2 0.0 1.0
pair_coeff 1 2 0.0 1.0
"""

CHANGES = {
    "pair_coeff": "pair_coeff 1 1 0.5 3.166",
    "pair_style": PAIRS.format(3.0, 4.2, 0.1553),
    "charge": "set type 1 charge -0.84\nset type 2 charge 0.42",
    "a new field": "fix add all addforce 0.5 0.0 0.0",
    "a field less": "unfix spring",
    "deleted neighbors": "group gone molecule 5\ndelete_atoms group gone compress no",
    "excluded neighbors": "group a molecule 1\ngroup b molecule 2:27\nneigh_modify exclude group a b",
    "box": "change_box all z final 0 10.2 units box",
}
FIXES = {
    "momentum": "",
    "second": "formulation second",
    "first": "formulation first",
    "isokinetic": "formulation first isokinetic total",
    "masks": "force 1*5 on off off torque 3* off off on",
    "zero": "start zero corrector gear",  # histories with tuned coefficients contain more of this start after 60 steps
    "tolerance": "tolerance 1.0e-8",
}


@pytest.fixture
def data(lmp_tree):
    return water_data(lmp_tree.folder / "data.water", shift=1.65)


def deck(data, fix="", between="", run="run 60\n{}\nrun 20", pair=("", ""), **settings):
    common = {"dt": 0.5, "thermo": 20, "after": SPRING, "run": run.format(between)}
    return water(data, f"gear/quat molecule {fix}", **common | settings).replace(*pair)


def anew(fix):
    return f"\nunfix move\nfix move all gear/quat molecule {fix}\nfix_modify move energy yes"


def energies(result, run=-1):
    return np.array(result.thermo[run]["TotEng"])


@pytest.mark.parametrize("fix", FIXES)
def test_forces_changed_between_runs(lmp_tree, data, fix):
    """The following motion is the same as if the fix had been defined at that point.

    The step is 0.25 fs because the switching function of the forces has kinks. At 0.5 fs the errors from kinks in every
    step would exceed the smallest of these changes, since errors from kinks decay more slowly with tuned coefficients.
    """
    changes = CHANGES if fix == "momentum" else {"pair_coeff": CHANGES["pair_coeff"]}
    words = FIXES[fix]
    decks = [
        deck(data, words, change + end, dt=0.25) for change in changes.values() for end in ("", anew(words))
    ]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert result.stdout.count(ANEW) == len(changes)
    for n, name in enumerate(changes):
        kept, fresh = energies(result, 4 * n + 1), energies(result, 4 * n + 3)
        assert kept == pytest.approx(fresh, abs=1e-8), name


@pytest.mark.parametrize("ranks", [1, 2])
def test_forces_changed_with_a_restart(lmp_tree, data, ranks):
    def after_restart(coefficient, name="move"):
        text = restarted(deck(data, run="run 20", after="", dt=0.25), "half")
        text = text.replace("neighbor ", PAIRS.format(2.7, 3.9, coefficient) + "neighbor ", 1)
        return text.replace("fix move", f"fix {name}").replace("fix_modify move", f"fix_modify {name}")

    whole = deck(data, run="run 60\nwrite_restart half\nrun 20", after="", dt=0.25)
    first = lmp_tree.succeed(whole, ranks=ranks)
    decks = [after_restart("0.2"), after_restart("0.2", "another"), after_restart("0.1553")]
    result = lmp_tree.succeed(one_after_the_other(decks), ranks=ranks)
    assert result.stdout.count(ANEW) == 1
    assert energies(result, 0) == pytest.approx(energies(result, 1), abs=1e-8)
    assert energies(result, 2)[-1] == pytest.approx(energies(first)[-1], abs=1e-9)


UNCHANGED = [
    *FIXES.values(),
    "formulation first corrector gear values 5 passes 1 momentum predicted project no start zero",
    "values 4 corrector gear",
    "values 10 corrector gear compensate yes",
]
# long steps, a plain cutoff, PPPM, a thermostat, r-RESPA, a field that depends on time
PPPM = "lj/charmm/coul/long 2.7 3.9 4.2\nkspace_style pppm 1e-4"
SURROUNDINGS = [
    dict(dt=2.0),
    dict(dt=2.0, pair=("lj/charmm/coul/charmm 2.7", "lj/cut/coul/cut")),
    dict(dt=2.0, pair=("lj/charmm/coul/charmm 2.7 3.9", PPPM)),
    dict(fix="values 5 corrector gear", after="fix l all langevin 300 300 100 4711"),
    dict(before="run_style respa 2 1 pair 2"),
    dict(after="variable f equal cos(0.1*time)\nfix a all addforce v_f 0.0 0.0"),
]


def test_unchanged_runs_go_on(lmp_tree, data):
    """No history starts again in 15 runs of each of these simulations."""
    scenes = [*({"fix": fix} for fix in UNCHANGED), *SURROUNDINGS]
    decks = [deck(data, run="run 7\n" * 15, **settings) for settings in scenes]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert len(result.thermo) == 15 * len(decks)
    assert "anew" not in result.stdout


# --- the time step between runs ------------------------------------------------------------------


def test_a_time_step_that_a_run_is_not_set_up_for(lmp_tree, data):
    """The fix keeps the step of tolerance, and refuses another one with pre no."""
    columns = "time f_move[9] f_move[14]"
    text = deck(data, "tolerance 1e-9", run="run 60\n{}\nrun 40", columns=columns)
    changed = text.replace("\nrun 40", "\ntimestep 8.0\nrun 40")
    plain, other = lmp_tree.succeed(text), lmp_tree.succeed(changed)
    assert "keeping time step " in other.stdout
    assert other.thermo[-1]["f_move[14]"][-1] < 100
    for column in ("Time", "TotEng"):
        assert other.thermo[-1][column] == plain.thermo[-1][column]
    lmp_tree.refuse(changed.replace("run 40", "run 40 pre no"), "was changed before a run with pre no")


# --- first forces --------------------------------------------------------------------------------


def test_first_forces_with_respa(lmp_tree, data):
    """A fix that the start cannot follow acts from the first step on, with and without levels."""
    mean = "fix mean all aveforce 0.1 NULL NULL"
    ends = []
    for style in ("verlet", "respa 2 1 pair 2"):
        before = f"run_style {style}"
        result = lmp_tree.succeed(deck(data, after=mean, run="run 1", steps=1, before=before, dt=2.0))
        assert FALLBACK + " fix mean (aveforce)" in result.stdout
        ends.append(last_frame(lmp_tree.folder / "poses.dump"))
    assert np.abs(ends[0] - ends[1]).max() < 1e-12



# --- masses and image flags between runs --------------------------------------------------------------

SWAPS = {
    "center": "set atom 1 mass 3.0\nset atom 2 mass 1.0",
    # a symmetric change about the center changes only the moments
    "moments": "set atom 1 mass 1.0\nset atom 2*3 mass 2.0",
}


@pytest.mark.parametrize("swap", SWAPS)
@pytest.mark.parametrize("extended", [False, True])
def test_masses_that_go_from_atom_to_atom(lmp_tree, swap, extended):
    """The total mass is constant; the body has the current masses, as if the fix had been defined at that time."""
    masses = "set atom 1*3 diameter {} mass 1.0\nset atom 1 mass 3.0".format(0.5 if extended else 0.0)
    if swap == "center":
        masses = masses.replace("atom 1 mass 3.0", "atom 2 mass 3.0")
    settings = dict(style="hybrid molecular sphere", masses=masses, boundary="p p p", exclude="")
    settings |= dict(before="velocity all create 1.0 4711 loop geom", fix="gear/quat single", columns="f_move[1][1]", steps=1)
    again = "unfix move\nfix move all gear/quat single"
    runs = [f"run 1\n{SWAPS[swap]}\n{more}\nrun 1" for more in ("", again)]
    decks = [placed([[(0, 0, 0), (1, 0, 0), (-1, 0, 0)]], run=run, energies="", **settings) for run in runs]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert result.stdout.count("atoms were changed since the last run") == 1
    _, kept, _, fresh = result.thermo
    for column in kept:
        assert kept[column] == pytest.approx(fresh[column], rel=1e-9, abs=1e-12)


TORN = "body 1 has another shape than before"
ACROSS = "displace_atoms all move 9.5 0 0\nfix move all"


def across(after, tilt=False):
    """The first of two molecules crosses the face of the box."""
    text = two_molecules(after=after).replace("fix move all", ACROSS)
    if tilt:
        text = text.replace("block -10 10 -10 10 -10 10", "prism -10 10 -10 10 -10 10 3 2 1")
        text = text.replace("all move 9.5", "all move 12.0")
    return text


TEARS = {
    "set atom 2 image 0 0 0": TORN,
    "set group all image 3 -2 1": TORN,
    "change_box all x delta -0.5 0.5 units box": TORN,
}
WHOLE = [
    "displace_atoms all move 12 0 0",
    "displace_atoms all rotate 0 0 0 0 0 1 170",
]


@pytest.mark.parametrize("tilt, ranks", [(False, 1), (True, 1), (True, 2)])
def test_torn_bodies(lmp_tree, tilt, ranks):
    for change, said in TEARS.items():
        lmp_tree.refuse(across(f"run 2\n{change}\nrun 2", tilt), said, ranks=ranks)
    decks = [across(f"run 2\n{change}\nrun 2", tilt) for change in WHOLE]
    result = lmp_tree.succeed(one_after_the_other(decks), ranks=ranks)
    assert result.stdout.count("atoms were changed since the last run") == len(WHOLE)


def test_clumps_are_warned_of(lmp_tree):
    said = "WARNING: Fix gear/quat: parts of body 1 are more than half of a periodic box apart"
    assert said not in lmp_tree.succeed(across("run 2")).output
    flags = "set group all image 0 0 0\nfix move all"
    torn = lmp_tree.run(across("run 2").replace("fix move all", flags))
    assert said in torn.output
    # the remedy may also follow the fix
    lmp_tree.succeed(across("set atom 2 image 1 0 0\nrun 2").replace("fix move all", flags))
    # in a box without periods flags do not matter
    open_box = two_molecules("single", boundary="f f f")
    assert said not in lmp_tree.run(open_box).output


def test_rerun_without_image_flags(lmp_tree):
    """Atoms keep the flags of the end of the run, which do not match the first frame."""
    dump = (
        "velocity all set 10 0 0\ndump d all custom 1 frames id x y z {}vx vy vz\nrun 5\nundump d\n"
    )
    read = "rerun frames dump x y z {}vx vy vz box no"
    with_flags, without = (
        across(dump.format(flags) + read.format(flags)).replace("move 9.5", "move 8.7")
        for flags in ("ix iy iz ", "")
    )
    lmp_tree.succeed(with_flags)
    lmp_tree.refuse(without, TORN)
