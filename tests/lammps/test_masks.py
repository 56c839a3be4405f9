"""Keywords force and torque: components that do not act on a body, as in fix rigid."""

import numpy as np
import pytest
from support.scenes import frames, last_frame, one_after_the_other, placed, water, water_data
from scipy.special import ellipj, ellipk

PRESSURE = 68568.415  # kcal/mol/Angstrom^3 in atm, LAMMPS' value in real units

# A rotor of six atoms whose principal axes are the axes of the box, the z axis with the largest moment, and a constant force on one atom:
# about z it is a pendulum.
PULL_OF_ONE = """
group end id 1
fix pull end addforce 0.9 0.0 0.5
fix_modify pull energy yes
"""
START, MOMENT, FORCE = 1.2, 4.0, 0.9  # angle of atom 1 from the force; moment about z
HELD = "force 1 off off off torque 1 off off on"


def rotor(lmp, formulation="second", masks=HELD, dt=0.01, style="", ranks=1):
    """Positions and velocities at the end, shape (6, 6), and the thermo table."""
    fix = f"gear/quat single {f'formulation {formulation}' if formulation else ''} {masks}"
    sites = held_rotor(0.0)[:, :3]
    settings = dict(before=PULL_OF_ONE, after=style, dt=dt, steps=round(4.0 / dt))
    deck = placed([sites], fix=fix, **settings)
    table = lmp.succeed(deck, ranks=ranks).thermo[0]
    return last_frame(lmp.folder / "poses.dump")[:, 1:], table


def pendulum(time):
    """Angle and rate of theta'' = -(FORCE/MOMENT) sin theta from rest at START."""
    k2, w = np.sin(START / 2) ** 2, np.sqrt(FORCE / MOMENT)
    sn, cn, dn, _ = ellipj(w * time + ellipk(k2), k2)
    return 2 * np.arcsin(np.sqrt(k2) * sn), 2 * w * np.sqrt(k2) * cn


def held_rotor(time):
    """Positions and velocities of the atoms, shape (6, 6), of the rotor that rotates only about z."""
    angle, rate = pendulum(time)
    c, s = np.cos(angle), np.sin(angle)
    x = np.array([(c, s, 0), (-c, -s, 0), (-s, c, 0), (s, -c, 0), (0, 0, 0.4), (0, 0, -0.4)])
    return np.hstack([x, np.cross([0, 0, rate], x)])


def test_a_held_body_spins_as_a_pendulum(lmp_tree, formulation):
    exact = held_rotor(4.0)
    end, table = rotor(lmp_tree, formulation)
    assert np.abs(end - exact).max() < 1e-11
    # masked components are constant to rounding of the atoms' positions
    assert np.abs(end[4:, :3] - exact[4:, :3]).max() < 1e-15 and np.abs(end[:4, 2]).max() < 1e-15
    assert table["TotEng"][-1] == pytest.approx(table["TotEng"][0], abs=1e-12)
    free, _ = rotor(lmp_tree, formulation, masks="")
    assert np.abs(free - exact).max() > 0.1


def test_with_a_step_that_follows_the_error(lmp_tree):
    end, table = rotor(lmp_tree, None, f"{HELD} tolerance 1e-13")
    time = table["Time"][-1]
    assert time > 2 * 4.0  # the step has grown
    assert np.abs(end - held_rotor(time)).max() < 1e-10


# --- selection of bodies ----------------------------------------------------------------------

# Five dumbbells whose IDs have gaps, and a constant force on every atom: x(t) = x + a t^2/2 is exact, also with velocity Verlet. They are
# distributed over the ranks, and cross boundaries.
IDS = (20, 3, 11, 7, 2)  # in the order of the atoms
PULL = np.array([0.6, 0.8, -0.7])


def dumbbells(name, fix, **settings):
    x = 4.0 * np.arange(len(IDS)) - 9.5
    bodies = [[(c, c, 0), (c + 1, c, 0)] for c in x]
    marks = [f"group g{ID} molecule {ID}\nset mol {ID} i_body {ID - 50}" for ID in IDS]
    marks.insert(0, "fix number all property/atom i_body")
    marks.append("fix pull all addforce 0.6 0.8 -0.7")
    box = dict(box="-10 10 -10 10 -10 10", boundary="p p p", dump=f"{name}.dump")
    settings = box | dict(dt=0.1, steps=50, before="\n".join(marks)) | settings
    return placed(bodies, molecules=IDS, fix=fix, **settings)


def which_moved(folder, name):
    """Per body, in the order of IDS: displacement relative to the effect of the force, per component."""
    first, last = frames(folder / f"{name}.dump").values()
    shift = (last - first)[:, 1:4] / (0.5 * PULL * 5.0**2)
    assert np.abs(shift[::2] - shift[1::2]).max() < 1e-10
    return np.round(shift[::2], 10)


OFF, NO_X, ALL = [0, 0, 0], [0, 1, 1], [1, 1, 1]
RANGES = {
    # words -> components for bodies 2, 3, 7, 11, 20: numbers 1 to 5
    "force * off off off": [OFF, OFF, OFF, OFF, OFF],
    "force 2 off off off": [ALL, OFF, ALL, ALL, ALL],
    "force *2 off on on": [NO_X, NO_X, ALL, ALL, ALL],
    "force 4* off on on": [ALL, ALL, ALL, NO_X, NO_X],
    "force 2*4 off on on force 3 on on on": [ALL, NO_X, ALL, NO_X, ALL],
    "torque * off off off force 5 off off off": [ALL, ALL, ALL, ALL, OFF],
}


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_bodies_are_numbered_by_their_ids(lmp_tree, ranks):
    named = {
        "custom": "gear/quat custom i_body force 2*3 off off off",
        "group": "gear/quat group 5 g20 g3 g11 g7 g2 force 1 off off off",
    }
    styles = ("gear/quat", "rigid") if ranks == 1 else ("gear/quat",)  # with the same meaning
    expected = {}
    for style in styles:
        for n, (words, acting) in enumerate(RANGES.items()):
            name = f"{style.partition('/')[0]}{n}"
            named[name], expected[name] = f"{style} molecule {words}", acting
    decks = [dumbbells(name, fix) for name, fix in named.items()]
    lmp_tree.succeed(one_after_the_other(decks), ranks=ranks)
    order = np.argsort(IDS)
    expected["custom"] = [ALL, OFF, OFF, ALL, ALL]
    for name, acting in expected.items():
        assert which_moved(lmp_tree.folder, name)[order].tolist() == acting, named[name]
    assert which_moved(lmp_tree.folder, "group").tolist() == [OFF, ALL, ALL, ALL, ALL]


# --- the same motion as fix rigid -------------------------------------------------------------

SOME = "force 1*9 off on off torque 5*20 off off on force 27 off off off"


def test_fix_rigid_converges_to_the_same_motion(lmp_tree, data, fix):
    """Their difference is the error of velocity Verlet, of second order in the step."""
    steps = (0.2, 0.1, 0.05)
    decks = [water(data, fix, dump="free"), water(data, f"{fix} {SOME}", dump="ours")]
    decks += [
        water(data, f"rigid molecule {SOME}", dt, round(10 / dt), dump=f"rigid{dt}")
        for dt in steps
    ]
    lmp_tree.succeed(one_after_the_other(decks))
    ours = last_frame(lmp_tree.folder / "ours")

    def error(name):
        return np.abs(last_frame(lmp_tree.folder / name) - ours)[:, 1:4].max()

    errors = [error(f"rigid{dt}") for dt in steps]
    assert 1.9 < np.polyfit(np.log(steps), np.log(errors), 1)[0] < 2.1
    assert error("free") > 100 * errors[-1]


# --- restart ----------------------------------------------------------------------------------


def test_atoms_that_were_changed_keep_their_masks(lmp_tree):
    """Bodies are made again from the atoms; their masks are kept."""
    fix = "gear/quat molecule force 2*3 off off off"
    displaced = "run 1\ndisplace_atoms all move 0.1 0.0 0.0\nrun 0\nrun 50"
    deck = dumbbells("again", fix, run=displaced, after="run 0")
    result = lmp_tree.succeed(deck, ranks=2)
    assert "atoms were changed since the last run" in result.output
    first, *_, last = frames(lmp_tree.folder / "again.dump").values()
    moved = np.abs((last - first)[::2, 1:4] - [0.1, 0, 0]).max(axis=1) > 1e-6
    assert moved[np.argsort(IDS)].tolist() == [True, False, False, True, True]


# --- pressure and degrees of freedom ----------------------------------------------------------


def test_what_holds_a_body_is_outside_of_it(lmp_tree):
    """3 P V = 2 K + sum R.F with the full forces on molecules, for any masks."""
    data = water_data(lmp_tree.folder / "data.water", spacing=3.6, shift=1.8)
    columns = " ".join(f"f_move[{k}]" for k in range(1, 10))
    pressures = []
    for masks in ("", "force * off off on torque * off on off"):
        deck = water(
            data,
            f"gear/quat molecule {masks}",
            processors="* * *\nboundary f f f",
            columns="f_move[1] vol",
            run=f"dump rows all local 1 rows.dump {columns}\n"
            "dump_modify rows format float %.17g\nrun 0",
        )
        table = lmp_tree.succeed(deck).thermo[-1]
        thermo = {key: column[-1] for key, column in table.items()}
        rows = last_frame(lmp_tree.folder / "rows.dump")
        virial = (rows[:, :3] * rows[:, 6:9]).sum()
        expected = (2 * thermo["f_move[1]"] + virial) * PRESSURE / (3 * thermo["Volume"])
        assert thermo["Press"] == pytest.approx(expected, rel=1e-7)
        pressures.append(thermo["Press"])
    assert pressures[0] == pytest.approx(pressures[1], rel=1e-12)


def test_degrees_of_freedom_are_those_of_fix_rigid(lmp_tree, data):
    """Temperature computes do not account for masks; the user subtracts the degrees of freedom (see the manual)."""
    fixes = ("gear/quat molecule", f"gear/quat molecule {SOME}", f"rigid molecule {SOME}")
    decks = one_after_the_other(water(data, fix, run="run 0") for fix in fixes)
    temperatures = [table["Temp"][0] for table in lmp_tree.succeed(decks).thermo]
    assert temperatures == pytest.approx([temperatures[0]] * 3, rel=1e-9)
