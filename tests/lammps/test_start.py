"""The start inside LAMMPS: forces it follows, data it must not change, reductions of the order."""


import numpy as np
import pytest
from support.scenes import FORMULATIONS, last_frame, placed, two_molecules, water

FALLBACK = "start with known forces only (order 2), because"

# A dumbbell and a triangle in a smooth field: harmonic springs, gravity, a wall.
BODIES = [[(0, 0, 0), (1, 0, 0), (0, 1.2, 0.1)], [(3, 3, 3), (4, 3.2, 3.1)]]
KINDS = [1, 1, 2, 1, 2]
VELOCITIES = np.full((5, 3), [0.3, 0.2, -0.4])
VELOCITIES[1, 2], VELOCITIES[3, 1] = 0.5, -0.7
SMOOTH = """
pair_style lj/cut 9.0
pair_coeff * * 1.0 1.5
pair_modify shift yes
neighbor {} bin
"""


def field(lmp, steps, dt, words="", before="", skin=2.0, ranks=1, **settings):
    """The result and the positions of the last step; settings: as in `placed`."""
    settings = dict(box="-10 10 -10 10 -10 10", masses="mass 1 1.0\nmass 2 2.0") | settings
    settings |= dict(steps=steps, dt=dt, before=SMOOTH.format(skin) + before)
    fix = f"gear/quat molecule {words}"
    result = lmp.succeed(placed(BODIES, VELOCITIES, KINDS, fix=fix, **settings), ranks=ranks)
    return result, last_frame(lmp.folder / "poses.dump")[:, 1:4]


def slope(run):
    """Order of the error of positions at t = 2, compared with steps eight times smaller."""
    ends = {n: run(n, 2.0 / n)[1] for n in (25, 50, 400)}
    errors = [np.abs(ends[n] - ends[400]).max() for n in (25, 50)]
    return np.log2(errors[0] / errors[1])


def order(lmp, fix="", **settings):
    return slope(lambda n, dt: field(lmp, n, dt, fix, **settings))


EXTERNAL = {
    "gravity": "fix g all gravity 0.5 vector 0 0.3 -1",
    "springs": "fix s all spring/self 2.0",
    "addforce": "fix a all addforce 0.1 0.2 -0.3",
    "efield-like pull": "fix p all spring tether 3.0 0 0 0 0.5",
    "wall": "fix w all wall/harmonic zlo -10 0.05 1.0 18.0",
    "linear variable of x": "variable fx atom -0.5*x\nfix a all addforce v_fx 0.0 0.0",
}


@pytest.mark.parametrize("number, name", list(enumerate(EXTERNAL)))
def test_full_order_with_external_forces(lmp_tree, number, name):
    """The start includes fixes defined before and after ours."""
    formulation, place = FORMULATIONS[number % 3], ("before", "after")[number % 2]
    assert order(lmp_tree, f"formulation {formulation}", **{place: EXTERNAL[name]}) > 4.5


def test_order_without_external_forces(lmp_tree, formulation):
    """The order is full with the default start, and one with the start of the paper."""
    fix = f"formulation {formulation}"
    assert order(lmp_tree, fix) > 4.5
    assert order(lmp_tree, f"{fix} start zero") == pytest.approx(1.0, abs=0.3)


SCALED = """
variable same equal 1.0
variable factor {}
pair_style hybrid/scaled v_same lj/cut 9.0 v_factor born 9.0
pair_coeff * * lj/cut 1.0 1.5
pair_coeff * * born 1.0 0.3 1.0 0.0 0.0
"""
ON_TIME, OF_ENERGY = "forces depend on time", "forces depend on energies or pressures, which LAMMPS computes only in steps"
ADDED = "\nfix a all addforce v_f 0.0 0.0"
QUARTIC = """
bond_style quartic
bond_coeff 1 1200 -0.55 0.25 1.3 34.6878
special_bonds lj 1 1 1
create_bonds single/bond 1 1 4
"""
#: commands -> the reason why the start has order 2
NOT_FOLLOWED = {
    "fix l all langevin 1.0 1.0 10.0 4711": "fix l (langevin)",
    "variable f equal 0.1*cos(0.1*time)" + ADDED: ON_TIME,
    "variable f equal random(-1,1,4711)" + ADDED: ON_TIME,
    "fix a all addforce 0.1 0.0 0.0 every 10": ON_TIME,
    "variable f equal 1e-3*pe" + ADDED: OF_ENERGY,
    "compute p all pressure NULL virial\nvariable f equal 1e-6*c_p[1]" + ADDED: OF_ENERGY,
    "compute e all pe/atom\nvariable f atom 1e-3*c_e" + ADDED: OF_ENERGY,
    "compute s all stress/atom NULL\nvariable f atom 1e-6*c_s[1]" + ADDED: OF_ENERGY,
    QUARTIC: "bonds of style quartic may break",
    SCALED.format("equal 1+0.5*sin(0.05*step)"): ON_TIME,
    SCALED.format("atom 1+0.5*time*(x>0)"): ON_TIME,
    SCALED.format("equal ramp(1.0,2.0)"): ON_TIME,
    SCALED.format("equal 1+(step<1)"): ON_TIME,
    SCALED.format("equal random(0.5,1.5,4711)"): ON_TIME,
    SCALED.format("equal 1+0.001*pe"): OF_ENERGY,
}


@pytest.mark.parametrize("number, commands", list(enumerate(NOT_FOLLOWED)))
def test_what_cannot_be_followed_is_said(lmp_tree, number, commands):
    """The energy, for example, is available only at steps; LAMMPS' requirements for such a field are fulfilled."""
    settings = {("before", "after")[number % 2 and "pair" not in commands]: commands, "ranks": 1 + number // 2 % 2, "thermo": 1}
    settings |= dict(room="bond/types 1 extra/bond/per/atom 1") if "bond" in commands else {}
    result, _ = field(lmp_tree, 3, 0.01, **settings)
    assert result.stdout.count(FALLBACK) == 1 and f"{FALLBACK} {NOT_FOLLOWED[commands]}" in result.stdout


@pytest.mark.parametrize("factor", ["equal 0.5", "equal 1+0.01*xcm(all,x)", "atom 1+0.0*x"])
def test_factors_of_positions_are_followed(lmp_tree, factor):
    result, _ = field(lmp_tree, 3, 0.01, before=SCALED.format(factor))
    assert "start of order 8 from" in result.stdout


def test_flexible_neighbours_are_not_followed(lmp_tree):
    before = "group moving id 5\ngroup bodies id 1 2 3 4\nfix nve moving nve"
    result, _ = field(lmp_tree, 10, 0.01, group="bodies", before=before)
    assert FALLBACK + " fix nve (nve) moves atoms" in result.stdout


def test_a_start_with_known_forces_has_order_two(lmp_tree):
    """The start with known forces has the order in its message."""
    nothing = "variable tiny equal 1e-15*step\nfix a all addforce v_tiny 0.0 0.0"
    assert 1.7 < order(lmp_tree, after=nothing) < 3.5


def test_the_start_leaves_everything_else_alone(lmp_tree, formulation):
    """Thermo output of step 0 and other fixes' output are the same as without a start."""
    after = """
fix s all spring/self 2.0
fix a all addforce 0.1 0.2 -0.3
fix_modify s energy yes
"""
    settings = dict(after=after, thermo=1, columns="f_s f_a f_a[1]")
    fixes = (f"formulation {formulation} start {start}" for start in ("bootstrap", "zero"))
    results = [field(lmp_tree, 10, 0.01, fix, **settings)[0] for fix in fixes]
    with_start, without = (result.thermo[0] for result in results)
    for column in ("PotEng", "KinEng", "TotEng", "f_s", "f_a", "f_a[1]"):
        assert with_start[column][0] == without[column][0]
    assert with_start["PotEng"][2] != without["PotEng"][2]  # the check can fail


@pytest.mark.parametrize("skin", [0.5, 0.1, 0.02])
def test_a_thin_skin_needs_nodes_close_together(lmp_tree, skin):
    _, wide = field(lmp_tree, 20, 0.02)
    result, thin = field(lmp_tree, 20, 0.02, skin=skin)
    assert FALLBACK not in result.stdout
    assert np.abs(thin - wide).max() < 1e-9


def test_time_reversal(lmp_tree, formulation):
    """Forwards with h and backwards with -h: the motion returns to its beginning."""
    fix = f"formulation {formulation}"
    _, begin = field(lmp_tree, 1, 1e-9, fix)
    again = f"unfix move\nfix move all gear/quat molecule {fix}"
    back = f"timestep 0.01\nrun 100\n{again}\ntimestep -0.01\nrun 99"
    _, end = field(lmp_tree, 1, -0.01, fix, after=back)
    assert np.abs(end - begin).max() < 2e-7


LONG = "lj/charmm/coul/long 2.7 3.9 4.2\npair_modify table 0\nkspace_style pppm 1e-6"


@pytest.mark.parametrize("ranks", [1, 4])
def test_water_with_kspace(lmp_tree, data, ranks):
    """Full order with forces from pairs, exclusions of bonds and pppm."""
    ends = []
    for n in (20, 40, 160):
        deck = water(data, steps=n, dt=40.0 / n).replace("lj/charmm/coul/charmm 2.7 3.9", LONG)
        assert FALLBACK not in lmp_tree.succeed(deck, ranks=ranks).stdout
        ends.append(last_frame(lmp_tree.folder / "poses.dump")[:, 1:4])
    assert np.abs(ends[1] - ends[2]).max() < np.abs(ends[0] - ends[2]).max() / 2**3


@pytest.mark.parametrize("start", ["bootstrap", "zero"])
def test_forces_that_are_no_numbers_do_not_pass_for_converged(lmp_tree, start):
    """With a force that is infinite except at the start, the order of the start is reduced, with a message."""
    after = """
group first id 1
variable wall atom exp(1000*(abs(x)>1e-9))*(abs(x)>1e-9)
fix wall first addforce 0 0 v_wall
run 1
"""
    result = lmp_tree.run(two_molecules(f"molecule start {start}", after=after))
    assert (FALLBACK in result.stdout) == (start == "bootstrap"), result.output
    assert "blow-up in step 1, time 0.01: body 1 meets a force or torque that is not" in result.output


# --- several fixes -------------------------------------------------------------------------------

TWO = "group left molecule 1\ngroup right molecule 2\nfix other left gear/quat molecule {}\n"


def two_fixes(lmp, steps, dt, first="", second="", **settings):
    return field(lmp, steps, dt, second, before=TWO.format(first), group="right", **settings)


PAIRS = {
    "alike": ("", "", (8, 8)),
    "of two formulations": ("formulation first", "values 8 corrector gear", (7, 9)),
    "of other numbers": ("values 9 corrector gear", "values 7 corrector gear", (9, 7)),
}


@pytest.mark.parametrize("name", PAIRS)
def test_two_fixes_start_together(lmp_tree, name):
    """Both fixes start with full order; if they are alike, the result is the same as with one fix for all bodies."""
    first, second, orders = PAIRS[name]

    def run(n, dt):
        result, end = two_fixes(lmp_tree, n, dt, first, second)
        assert FALLBACK not in result.stdout
        for fix, order in zip(("other", "move"), orders, strict=True):
            assert f"Fix gear/quat {fix}: start of order {order} from" in result.stdout
        return result, end

    assert slope(run) > 4.5
    if name == "alike":
        _, one = field(lmp_tree, 50, 0.04)
        assert np.abs(one - run(50, 0.04)[1]).max() < 1e-12


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_fix_that_is_defined_anew_beside_another(lmp_tree, ranks):
    """Both start again, with the same order."""
    again = "timestep 0.02\nrun 10\nunfix move\nfix move right gear/quat molecule\n"
    result, _ = two_fixes(lmp_tree, 10, 0.02, after=again, ranks=ranks)
    assert result.stdout.count("start of order 8 from") == 4 and FALLBACK not in result.stdout
    few = "values 5 corrector gear"
    noisy = "fix noise all langevin 0.1 0.1 10.0 4711\n" + again
    result, _ = two_fixes(lmp_tree, 10, 0.02, few, few, after=noisy, ranks=ranks)
    assert result.stdout.count(FALLBACK) == 4
