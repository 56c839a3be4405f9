"""Keywords force and torque: components that do not act on a body, as fix rigid has them."""

import numpy as np
import pytest
from scenes import last_frame, one_after_the_other, restarted, water, water_data
from scipy.special import ellipj, ellipk

FORMULATIONS = ["first", "second"]
PRESSURE = 68568.415  # kcal/mol/Angstrom^3 in atm, LAMMPS' value in real units

# A rotor of six atoms whose principal axes are those of the box, the z axis with the largest moment,
# and a constant force on one atom: about z it is a pendulum.
ROTOR = """
units lj
atom_style molecular
atom_modify map array sort 0 0.0
boundary f f f
region box block -9 9 -9 9 -9 9
create_box 1 box
create_atoms 1 single  {c}  {s} 0
create_atoms 1 single -{c} -{s} 0
create_atoms 1 single -{s}  {c} 0
create_atoms 1 single  {s} -{c} 0
create_atoms 1 single 0 0  0.4
create_atoms 1 single 0 0 -0.4
mass 1 1.0
set group all mol 1
pair_style zero 2.0
pair_coeff * *
group end id 1
fix pull end addforce 0.9 0.0 0.5
fix_modify pull energy yes
fix move all gear/quat {bodystyle} formulation {formulation} {masks}
fix_modify move energy yes
timestep {dt}
{style}
thermo_style custom step time ke pe etotal f_move[1] f_move[2]
thermo_modify norm no format float %.17g
thermo {steps}
dump poses all custom {steps} {name}.dump id xu yu zu vx vy vz
dump_modify poses sort id format float %.17g
run {steps}
"""
START, MOMENT, FORCE = 1.2, 4.0, 0.9  # angle of atom 1 from the force; moment about z
HELD = "force 1 off off off torque 1 off off on"


def rotor(
    lmp, name, formulation="second", masks=HELD, dt=0.01, time=4.0, style="", ranks=1, **words
):
    deck = ROTOR.format(
        c=np.cos(START),
        s=np.sin(START),
        formulation=formulation,
        masks=masks,
        dt=dt,
        style=style,
        steps=round(time / dt),
        name=name,
        bodystyle=words.get("bodystyle", "single"),
    )
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return last_frame(lmp.folder / f"{name}.dump")[:, 1:], result


def pendulum(time):
    """Angle and rate of theta'' = -(FORCE/MOMENT) sin theta from rest at START."""
    k2, w = np.sin(START / 2) ** 2, np.sqrt(FORCE / MOMENT)
    sn, cn, dn, _ = ellipj(w * time + ellipk(k2), k2)
    return 2 * np.arcsin(np.sqrt(k2) * sn), 2 * w * np.sqrt(k2) * cn


def held_rotor(time):
    """Positions and velocities of the atoms, shape (6, 6), of the rotor that only spins about z."""
    angle, rate = pendulum(time)
    c, s = np.cos(angle), np.sin(angle)
    x = np.array([(c, s, 0), (-c, -s, 0), (-s, c, 0), (s, -c, 0), (0, 0, 0.4), (0, 0, -0.4)])
    return np.hstack([x, np.cross([0, 0, rate], x)])


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_held_body_spins_as_a_pendulum(lmp_tree, formulation):
    exact = held_rotor(4.0)
    end, result = rotor(lmp_tree, "held", formulation)
    assert np.abs(end - exact).max() < 1e-11
    assert np.abs(end - held_rotor(4.0 * 1.01)).max() > 1e-3
    # what is held is held to rounding of the atoms' places
    assert np.abs(end[4:, :3] - exact[4:, :3]).max() < 1e-15 and np.abs(end[:4, 2]).max() < 1e-15
    energy = result.thermo[0]["TotEng"]
    assert energy[-1] == pytest.approx(energy[0], abs=1e-12)
    free, _ = rotor(lmp_tree, "free", formulation, masks="")
    assert np.abs(free - exact).max() > 0.1


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_with_a_step_that_follows_the_error(lmp_tree, formulation):
    end, result = rotor(lmp_tree, "varied", formulation, f"{HELD} tolerance 1e-13")
    time = result.thermo[0]["Time"][-1]
    assert time > 2 * 4.0  # the step has grown
    assert np.abs(end - held_rotor(time)).max() < 1e-10
    assert np.abs(end - held_rotor(1.01 * time)).max() > 1e-3


@pytest.mark.parametrize("formulation, values, order", [("first", 5, 5), ("second", 6, 5)])
def test_the_order_is_that_of_the_method(lmp_tree, formulation, values, order):
    steps = [0.1, 0.05, 0.025]
    errors = [
        np.abs(
            rotor(lmp_tree, "slope", formulation, f"values {values} {HELD}", dt)[0]
            - held_rotor(4.0)
        ).max()
        for dt in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] > order - 0.5


def test_respa_and_ranks_make_no_difference(lmp_tree):
    one, _ = rotor(lmp_tree, "one")
    respa, _ = rotor(lmp_tree, "respa", style="run_style respa 2 1 pair 1 kspace 2")
    two, _ = rotor(lmp_tree, "two", ranks=2)
    assert np.abs(respa - one).max() < 1e-13 and np.abs(two - one).max() < 1e-13


# --- which bodies -----------------------------------------------------------------------------

# Five dumbbells whose IDs have gaps, and a constant force on every atom: x(t) = x + a t^2/2 exactly,
# with velocity Verlet too.  They are spread over the ranks, and cross boundaries.
DUMBBELLS = """
units lj
atom_style molecular
atom_modify map array sort 0 0.0
boundary p p p
region box block -10 10 -10 10 -10 10
create_box 1 box
{atoms}
mass 1 1.0
pair_style zero 2.0
pair_coeff * *
{groups}
fix pull all addforce 0.6 0.8 -0.7
fix move all {fix}
timestep 0.1
dump poses all custom 50 {name}.dump id xu yu zu
dump_modify poses sort id format float %.17g
run 50
"""
IDS = (20, 3, 11, 7, 2)  # in the order of the atoms
PULL = np.array([0.6, 0.8, -0.7])


def dumbbells(name, fix):
    atoms, groups = "", "".join(f"group g{ID} molecule {ID}\n" for ID in IDS)
    for n, ID in enumerate(IDS):
        x = 4.0 * n - 9.5
        atoms += f"create_atoms 1 single {x} {x} 0\ncreate_atoms 1 single {x + 1} {x} 0\n"
        atoms += f"set atom {2 * n + 1}*{2 * n + 2} mol {ID}\n"
    atoms += "fix number all property/atom i_body\n"
    atoms += "".join(f"set mol {ID} i_body {ID - 50}\n" for ID in IDS)
    return DUMBBELLS.format(name=name, atoms=atoms, groups=groups, fix=fix)


def which_moved(folder, name):
    """Per body, in the order of IDS: displacement over what the force makes of it, per component."""
    frames = (folder / f"{name}.dump").read_text().split("ITEM: ATOMS")[1:]
    first, last = (np.loadtxt(f.splitlines()[1:11])[:, 1:] for f in (frames[0], frames[-1]))
    shift = (last - first) / (0.5 * PULL * 5.0**2)
    assert np.abs(shift[::2] - shift[1::2]).max() < 1e-10
    return np.round(shift[::2], 10)


OFF, NO_X, ALL = [0, 0, 0], [0, 1, 1], [1, 1, 1]
RANGES = {
    # words -> what acts on bodies 2, 3, 7, 11, 20: numbers 1 to 5
    "force * off off off": [OFF, OFF, OFF, OFF, OFF],
    "force 2 off off off": [ALL, OFF, ALL, ALL, ALL],
    "force *2 off on on": [NO_X, NO_X, ALL, ALL, ALL],
    "force 4* off on on": [ALL, ALL, ALL, NO_X, NO_X],
    "force 2*4 off on on force 3 on on on": [ALL, NO_X, ALL, NO_X, ALL],
    "torque * off off off force 5 off off off": [ALL, ALL, ALL, ALL, OFF],
}


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_bodies_are_numbered_by_their_ids(lmp_tree, ranks):
    decks = [
        dumbbells(f"range{n}", f"gear/quat molecule {words}") for n, words in enumerate(RANGES)
    ]
    decks += [
        dumbbells("custom", "gear/quat custom i_body force 2*3 off off off"),
        dumbbells("group", "gear/quat group 5 g20 g3 g11 g7 g2 force 1 off off off"),
    ]
    if ranks == 1:  # and fix rigid means the same
        decks += [
            dumbbells(f"rigid{n}", f"rigid molecule {words}") for n, words in enumerate(RANGES)
        ]
    result = lmp_tree.run(one_after_the_other(decks), ranks=ranks)
    assert result.returncode == 0, result.output
    order = np.argsort(IDS)
    for n, expected in enumerate(RANGES.values()):
        for kind in ("range", "rigid") if ranks == 1 else ("range",):
            assert which_moved(lmp_tree.folder, f"{kind}{n}")[order].tolist() == expected, (kind, n)
    assert which_moved(lmp_tree.folder, "custom")[order].tolist() == [ALL, OFF, OFF, ALL, ALL]
    assert which_moved(lmp_tree.folder, "group").tolist() == [OFF, ALL, ALL, ALL, ALL]


# --- the same motion as fix rigid -------------------------------------------------------------

SOME = "force 1*9 off on off torque 5*20 off off on force 27 off off off"


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_fix_rigid_converges_to_the_same_motion(lmp_tree, formulation):
    """Their difference is the error of velocity Verlet, of second order in the step."""
    data = water_data(lmp_tree.folder / "data.water")
    masked = f"gear/quat molecule formulation {formulation} {SOME}"
    fixes = {"ours": masked, "free": f"gear/quat molecule formulation {formulation}"}
    steps = (0.2, 0.1, 0.05)
    decks = [water(data, fix, 0.1, 100, dump=f"{name}.dump") for name, fix in fixes.items()]
    decks += [
        water(data, f"rigid molecule {SOME}", dt, round(10 / dt), dump=f"rigid{dt}.dump")
        for dt in steps
    ]
    result = lmp_tree.run(one_after_the_other(decks))
    assert result.returncode == 0, result.output
    ours, free = (last_frame(lmp_tree.folder / f"{name}.dump") for name in fixes)
    errors = [
        np.abs(last_frame(lmp_tree.folder / f"rigid{dt}.dump") - ours)[:, 1:4].max() for dt in steps
    ]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert 1.9 < slope < 2.1
    assert np.abs(free - ours)[:, 1:4].max() > 100 * errors[-1]


# --- restart ----------------------------------------------------------------------------------


@pytest.mark.parametrize("ranks", [1, 2])
def test_masks_outlive_a_restart(lmp_tree, ranks):
    data = water_data(lmp_tree.folder / "data.water")
    words = f"gear/quat molecule {SOME}"
    half = "run 40\nwrite_restart half\nrun 40"
    whole = water(data, words, 0.5, 40, run=half, dump="whole.dump")
    again = restarted(water(data, words, 0.5, 40, run="run 40", dump="again.dump"), "half")
    other = restarted(
        water(data, "gear/quat molecule", 0.5, 40, run="run 40", dump="other.dump"), "half"
    )
    result = lmp_tree.run(one_after_the_other([whole, again, other]), ranks=ranks)
    assert result.returncode == 0, result.output
    frames = [last_frame(lmp_tree.folder / f"{name}.dump") for name in ("whole", "again", "other")]
    assert np.array_equal(frames[0], frames[1])
    # masks that are other ones are those of the command, and the histories begin anew
    assert result.output.count("turn off other components than in the run that wrote") == 1
    assert np.abs(frames[2] - frames[0]).max() > 1e-3


def test_atoms_that_were_changed_keep_their_masks(lmp_tree):
    """Bodies are made anew from the atoms; what holds them stays."""
    deck = dumbbells("again", "gear/quat molecule force 2*3 off off off")
    deck = deck.replace("run 50", "run 1\ndisplace_atoms all move 0.1 0.0 0.0\nrun 0\nrun 50")
    deck = deck.replace("dump poses all custom 50", "run 0\ndump poses all custom 51")
    result = lmp_tree.run(deck, ranks=2)
    assert result.returncode == 0, result.output
    assert "atoms were changed since the last run" in result.output
    frames = (lmp_tree.folder / "again.dump").read_text().split("ITEM: ATOMS")[1:]
    first, last = (np.loadtxt(f.splitlines()[1:11])[:, 1:] for f in (frames[0], frames[-1]))
    moved = np.abs(last - first - [0.1, 0, 0])[::2].max(axis=1) > 1e-6
    assert moved[np.argsort(IDS)].tolist() == [True, False, False, True, True]


# --- pressure and degrees of freedom ----------------------------------------------------------


def test_what_holds_a_body_is_outside_of_it(lmp_tree):
    """3 P V = 2 K + sum R.F with the forces that molecules met, whatever acts of them."""
    data = water_data(lmp_tree.folder / "data.water", spacing=3.6, shift=1.8)
    columns = " ".join(f"f_move[{k}]" for k in range(1, 10))
    pressures = []
    for masks in ("", "force * off off on torque * off on off"):
        deck = water(
            data,
            f"gear/quat molecule {masks}",
            processors="* * *\nboundary f f f",
            run=f"dump rows all local 1 rows.dump {columns}\n"
            "dump_modify rows format float %.17g\nrun 0",
        ).replace("custom step temp", "custom step f_move[1] vol temp")
        result = lmp_tree.run(deck)
        assert result.returncode == 0, result.output
        rows = np.loadtxt((lmp_tree.folder / "rows.dump").read_text().splitlines()[9:])
        thermo = {key: column[-1] for key, column in result.thermo[-1].items()}
        virial = (rows[:, :3] * rows[:, 6:9]).sum()
        expected = (2 * thermo["f_move[1]"] + virial) * PRESSURE / (3 * thermo["Volume"])
        assert thermo["Press"] == pytest.approx(expected, rel=1e-7)
        assert thermo["Press"] != pytest.approx(expected * 1.01, rel=1e-7)
        pressures.append(thermo["Press"])
    assert pressures[0] == pytest.approx(pressures[1], rel=1e-12)


def test_degrees_of_freedom_are_those_of_fix_rigid(lmp_tree):
    """Masks are not accounted for: the user subtracts them, see the manual."""
    data = water_data(lmp_tree.folder / "data.water")
    fixes = ("gear/quat molecule", f"gear/quat molecule {SOME}", f"rigid molecule {SOME}")
    result = lmp_tree.run(one_after_the_other(water(data, fix, run="run 0") for fix in fixes))
    assert result.returncode == 0, result.output
    temperatures = [table["Temp"][0] for table in result.thermo]
    assert temperatures == pytest.approx([temperatures[0]] * 3, rel=1e-9)
