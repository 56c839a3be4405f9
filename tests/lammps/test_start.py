"""The start inside LAMMPS: what it follows, what it leaves alone, when it steps back."""

import numpy as np
import pytest
from scenes import last_frame, two_molecules, water, water_data

FORMULATIONS = ["first", "second"]
FALLBACK = "start with known forces only (order 2), because"

# A dumbbell and a triangle in a field that is smooth: harmonic springs, gravity, a wall.
FIELD = """
units lj
atom_style molecular
atom_modify map array sort 0 0.0
boundary f f f
region box block -10 10 -10 10 -10 10
create_box 2 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 2 single 0.0 1.2 0.1
create_atoms 1 single 3.0 3.0 3.0
create_atoms 2 single 4.0 3.2 3.1
mass 1 1.0
mass 2 2.0
set atom 1*3 mol 1
set atom 4*5 mol 2
velocity all set 0.3 0.2 -0.4
set atom 2 vz 0.5
set atom 4 vy -0.7
pair_style lj/cut 9.0
pair_coeff * * 1.0 1.5
pair_modify shift yes
neighbor {skin} bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
{before}
fix move all gear/quat molecule {fix}
{after}
timestep {dt}
thermo_style custom step pe ke etotal {columns}
thermo_modify norm no format float %.17g
thermo {every}
dump poses all custom {steps} {dump} id x y z vx vy vz
dump_modify poses sort id format float %.17g
run {steps}
"""


def field(
    lmp, dump, steps, dt, fix="", before="", after="", skin=2.0, ranks=1, every=None, columns=""
):
    deck = FIELD.format(
        dump=dump,
        steps=steps,
        dt=dt,
        fix=fix,
        before=before,
        after=after,
        skin=skin,
        every=every or steps,
        columns=columns,
    )
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return result, last_frame(lmp.folder / dump)[:, 1:4]


def slope(lmp, fix, before="", after=""):
    """Order of the error of positions at t = 2, against a run with steps eight times smaller."""
    runs = {n: field(lmp, f"n{n}", n, 2.0 / n, fix, before, after)[1] for n in (25, 50, 400)}
    errors = [np.abs(runs[n] - runs[400]).max() for n in (25, 50)]
    return np.log2(errors[0] / errors[1])


EXTERNAL = {
    "gravity": "fix g all gravity 0.5 vector 0 0.3 -1",
    "springs": "fix s all spring/self 2.0",
    "addforce": "fix a all addforce 0.1 0.2 -0.3",
    "efield-like pull": "fix p all spring tether 3.0 0 0 0 0.5",
    "wall": "fix w all wall/harmonic zlo -10 0.05 1.0 18.0",
    "linear variable of x": "variable fx atom -0.5*x\nfix a all addforce v_fx 0.0 0.0",
}


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("name", EXTERNAL)
@pytest.mark.parametrize("place", ["before", "after"])
def test_full_order_with_external_forces(lmp_tree, formulation, name, place):
    """Fixes defined before and after ours: the start knows both."""
    order = slope(lmp_tree, f"formulation {formulation}", **{place: EXTERNAL[name]})
    assert order > 4.5, order


def test_order_without_external_forces(lmp_tree):
    """Full with the default start, one with the paper's."""
    for formulation in FORMULATIONS:
        assert slope(lmp_tree, f"formulation {formulation}") > 4.5
        assert slope(lmp_tree, f"formulation {formulation} start zero") == pytest.approx(
            1.0, abs=0.3
        )


NOT_FOLLOWED = {
    "langevin": "fix l all langevin 1.0 1.0 10.0 4711",
    "time": "variable fx equal 0.1*cos(0.1*time)\nfix a all addforce v_fx 0.0 0.0",
}


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("name", NOT_FOLLOWED)
def test_what_cannot_be_followed_is_said(lmp_tree, name, ranks):
    result, _ = field(lmp_tree, "d", 10, 0.01, after=NOT_FOLLOWED[name], ranks=ranks)
    assert result.stdout.count(FALLBACK) == 1
    assert {"langevin": "fix l (langevin)", "time": "depends on time"}[name] in result.stdout
    assert ("use values 4 to 6 instead of 8" in result.stdout) == (name == "langevin")


def test_flexible_neighbours_are_not_followed(lmp_tree):
    before = "group moving id 5\ngroup bodies id 1 2 3 4\nfix nve moving nve"
    deck = FIELD.replace("fix move all", "fix move bodies")
    text = deck.format(
        dump="d", steps=10, dt=0.01, fix="", before=before, after="", skin=2.0, every=10, columns=""
    )
    result = lmp_tree.run(text)
    assert result.returncode == 0, result.output
    assert FALLBACK + " fix nve (nve) moves atoms" in result.stdout


def test_a_start_with_known_forces_has_order_two(lmp_tree):
    """The fallback honours the order it names."""
    nothing = "variable tiny equal 1e-15*step\nfix a all addforce v_tiny 0.0 0.0"
    assert 1.7 < slope(lmp_tree, "", after=nothing) < 3.5


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_start_leaves_everything_else_alone(lmp_tree, formulation):
    """Thermo of step 0 and what other fixes report there are those of a run without it."""
    after = """
fix s all spring/self 2.0
fix a all addforce 0.1 0.2 -0.3
fix_modify s energy yes
"""
    rows = {}
    for start in ("bootstrap", "zero"):
        fix = f"formulation {formulation} start {start}"
        result, _ = field(
            lmp_tree, "d", 10, 0.01, fix, after=after, every=1, columns="f_s f_a f_a[1]"
        )
        rows[start] = result.thermo[0]
    for column in ("PotEng", "KinEng", "TotEng", "f_s", "f_a", "f_a[1]"):
        assert rows["bootstrap"][column][0] == rows["zero"][column][0]
    # and the second thermo row differs: the check can fail
    assert rows["bootstrap"]["PotEng"][2] != rows["zero"]["PotEng"][2]


def test_the_trajectory_after_the_start_is_that_without_observers(lmp_tree):
    """A first run of no steps, thermo, dumps: nothing of it changes the start."""
    _, plain = field(lmp_tree, "a", 50, 0.01)
    _, watched = field(
        lmp_tree, "b", 50, 0.01, after="run 0\ncompute p all pressure thermo_temp", every=1
    )
    assert (plain == watched).all()


@pytest.mark.parametrize("skin", [0.5, 0.1, 0.02])
def test_a_thin_skin_needs_nodes_close_together(lmp_tree, skin):
    _, wide = field(lmp_tree, "wide", 20, 0.02)
    result, thin = field(lmp_tree, "thin", 20, 0.02, skin=skin)
    assert FALLBACK not in result.stdout
    assert np.abs(thin - wide).max() < 1e-9


def test_any_start_time(lmp_tree):
    _, early = field(lmp_tree, "early", 50, 0.01)
    _, late = field(lmp_tree, "late", 50, 0.01, before="reset_timestep 1000000")
    assert (early == late).all()


def test_time_reversal(lmp_tree):
    """There with h and back with -h: the end of the way back is its beginning."""
    for formulation in FORMULATIONS:
        fix = f"formulation {formulation}"
        _, begin = field(lmp_tree, "begin", 1, 1e-9, fix)
        back = (
            "run 100\nunfix move\nfix move all gear/quat molecule "
            + fix
            + "\ntimestep -0.01\nrun 99"
        )
        _, end = field(lmp_tree, "end", 1, -0.01, fix, after="timestep 0.01\n" + back)
        assert np.abs(end - begin).max() < 2e-7


@pytest.mark.parametrize("ranks", [1, 4])
def test_water_with_kspace(lmp_tree, ranks):
    """Full order where forces come from pairs, bonds' exclusions and pppm."""
    data = water_data(lmp_tree.folder / "data.water")
    ends = []
    for n in (20, 40, 160):
        deck = water(data, steps=n, dt=40.0 / n, dump=f"n{n}").replace(
            "lj/charmm/coul/charmm 2.7 3.9",
            "lj/charmm/coul/long 2.7 3.9 4.2\npair_modify table 0\nkspace_style pppm 1e-6",
        )
        result = lmp_tree.run(deck, ranks=ranks)
        assert result.returncode == 0, result.output
        assert FALLBACK not in result.stdout
        ends.append(last_frame(lmp_tree.folder / f"n{n}")[:, 1:4])
    assert np.abs(ends[1] - ends[2]).max() < np.abs(ends[0] - ends[2]).max() / 2**3


@pytest.mark.parametrize("start", ["bootstrap", "zero"])
def test_forces_that_are_no_numbers_do_not_pass_for_converged(lmp_tree, start):
    """A force that is infinite off the very start: the start steps back and says so."""
    after = """
group first id 1
variable wall atom exp(1000*(abs(x)>1e-9))*(abs(x)>1e-9)
fix wall first addforce 0 0 v_wall
run 1
"""
    result = lmp_tree.run(two_molecules(f"molecule start {start}", after=after))
    assert (FALLBACK in result.stdout) == (start == "bootstrap"), result.output
    assert "blow-up in step 1, time 0.01: body 1 meets a force that is not" in result.output


# --- several fixes -------------------------------------------------------------------------------

TWO = "group left molecule 1\ngroup right molecule 2\nfix other left gear/quat molecule {}\n"


def two_fixes(lmp, dump, steps, dt, first, second, after="", ranks=1):
    deck = FIELD.replace("fix move all", "fix move right").format(
        dump=dump, steps=steps, dt=dt, fix=second, before=TWO.format(first), after=after, skin=2.0,
        every=steps, columns="",
    )
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return result, last_frame(lmp.folder / dump)[:, 1:4]


PAIRS = {
    "alike": ("", "", "order 9"),
    "of two formulations": ("formulation first", "values 8", "order 7 and 9"),
    "of other numbers": ("values 9", "values 7", "order 9 and 7"),
}


@pytest.mark.parametrize("name", PAIRS)
def test_two_fixes_start_together(lmp_tree, name):
    """With full order, and where both are alike as one fix with all bodies does."""
    first, second, orders = PAIRS[name]
    runs = {}
    for n in (25, 50, 400):
        result, runs[n] = two_fixes(lmp_tree, f"n{n}", n, 2.0 / n, first, second)
        assert FALLBACK not in result.stdout
        assert f"Fix gear/quat other and move: start of {orders} from" in result.stdout
    errors = [np.abs(runs[n] - runs[400]).max() for n in (25, 50)]
    assert np.log2(errors[0] / errors[1]) > 4.5
    if name == "alike":
        _, one = field(lmp_tree, "one", 50, 0.04)
        assert np.abs(one - runs[50]).max() < 1e-12


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_fix_that_is_defined_anew_beside_another(lmp_tree, ranks):
    """Both begin anew, with full order; where forces cannot be followed the other one goes on."""
    again = "run 10\nunfix move\nfix move right gear/quat molecule\n"
    result, _ = two_fixes(lmp_tree, "d", 10, 0.02, "", "", "timestep 0.02\n" + again, ranks)
    said = "Fix gear/quat other and move: start of order 9 from"
    assert result.stdout.count(said) == 2 and FALLBACK not in result.stdout
    noise = "fix noise all langevin 0.1 0.1 10.0 4711\ntimestep 0.02\n"
    result, _ = two_fixes(lmp_tree, "d", 10, 0.02, "values 5", "values 5", noise + again, ranks)
    assert result.stdout.count(FALLBACK) == 3
    assert result.stdout.count(f"Fix gear/quat other: {FALLBACK}") == 1


def test_a_fix_that_goes(lmp_tree):
    """Its bodies stop, which the derivatives of the forces on the others do not know."""
    after = "timestep 0.02\nfix_modify move energy yes\nthermo 10\nrun 20\nunfix other\nrun 20\n"
    result, _ = two_fixes(lmp_tree, "d", 10, 0.02, "", "", after)
    assert "Fix gear/quat move: other fixes move atoms than in the last steps" in result.stdout
    assert result.stdout.count("start of order 9 from") == 2


def test_tolerance_beside_another_fix(lmp_tree):
    """The first step is made shorter before either has begun it."""
    result, _ = two_fixes(lmp_tree, "d", 10, 0.5, "", "tolerance 1e-9")
    assert "first step" in result.stdout and "WARNING" not in result.output
    assert "start of order 9 and 11 from" in result.stdout
