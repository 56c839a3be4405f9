"""Scenes that are hard to integrate, each with an exact or independent answer: doc/theory.md lists all of them."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.running import EXAMPLES, SCENES
from support.scenes import FORMULATIONS, frames, last_frame, one_after_the_other, placed, water, write_data
from support.step_control import off, tables

from benchmarks.engine.sites import read_sites
from benchmarks.reference import FreeField, Problem, bodies_from_sites
from benchmarks.reference.free_top import exact_state

NO_PAIRS = "pair_style zero 8.0\npair_coeff * *"


def body_deck(data, formulation, words="", boundary="f f f", **settings):
    """The deck of rigid water with another data file, whose molecules 1 and 2 are bodies; the rest is a cage."""
    settings = dict(units="lj", pair=NO_PAIRS, skin=1.0) | settings
    text = water(data, f"gear/quat molecule formulation {formulation} {words}", **settings)
    text = text.replace("atom_style full", f"atom_style full\nboundary {boundary}")
    return text.replace("fix move all", "group bodies molecule 1 2\nfix move bodies")


def rows(molecule, kinds, charges, places):
    """Lines of the section Atoms, in the first image of the box."""
    return [[molecule, kind, charge, *place, 0, 0, 0] for kind, charge, place in zip(kinds, charges, places)]


# --- small steps --------------------------------------------------------------------------------


def test_the_papers_small_step_leaves_rounding_only(lmp_wheel, formulation):
    """Test case 1 at a step of 0.0001; without projection the length of q performs a random walk."""
    deck, settings = SCENES / "in.case1", dict(formulation=formulation, out="none")

    def run(**more):
        return tables(lmp_wheel.succeed(deck, settings | more))[0]

    small = dict(dt=1e-4, steps=500_000, every=5_000)
    compensated, plain = (run(keywords=f"compensate {word}", **small) for word in ("yes", "no"))
    assert off(compensated) < 1e-12 < off(plain) < 2e-10
    assert max(compensated["v_qerror"].max(), plain["v_qerror"].max()) < 2e-12
    if formulation != "momentum":  # which has no such keyword
        free = run(dt=1e-3, steps=20_000, every=200, keywords="project no start zero")
        assert free["v_qerror"].max() > 2e-12


# --- poles --------------------------------------------------------------------------------------

# Six charged sites among six fixed charges. In "passing" all is symmetric in y, so that theta goes
# through 0 and pi exactly, again and again.
SITES = np.array([(0, 0, 1), (0, 0, -1.5), (0.7, 0, 0), (-0.7, 0, 0), (0, 0.4, 0), (0, -0.4, 0)])
KINDS, CHARGES = (1, 2, 3, 3, 3, 3), (1.0, -1.0, 0.3, -0.3, 0.0, 0.0)
CAGE = np.array([(4.5, 2, 0.5), (4.5, -2, 0.5), (-4, 2.5, 1), (-4, -2.5, 1), (0.5, 0, 5), (-0.5, 0, -5)])
CAGE_CHARGES = (1.0, 1.0, -1.0, -1.0, -1.5, 1.5)
POLES = "pair_style lj/cut/coul/cut 40.0\npair_coeff * * 0.2 1.5\npair_coeff 4 4 1.0 2.0"
# axes of the body in space, angular velocity, velocity
POSES = {
    "theta = 0": (np.eye(3), (0.7, -0.4, 0.3), (0.1, 0.05, -0.1)),
    "theta = pi": (np.diag([1, -1, -1]), (0.7, -0.4, 0.3), (0.1, 0.05, -0.1)),
    "passing": (np.array([(0.6, 0, 0.8), (0, 1, 0), (-0.8, 0, 0.6)]), (0, 1.5, 0), (0, 0, 0)),
}
# the rotation of the quaternion (4, 1, 2, 3), scalar first
TURN = np.array([(4, -20, 22), (28, 10, 4), (-10, 20, 20)]) / 30


def in_the_cage(lmp, pose, formulation, turn, words="", dt=0.005):
    """Positions of the body at all frames up to t = 20, (F, 6, 3), of the scene turned as a whole."""
    axes, omega, velocity = POSES[pose]
    arms = SITES @ axes.T
    speeds = np.cross(omega, arms) + velocity
    atoms = rows(1, KINDS, CHARGES, arms @ turn.T) + rows(0, [4] * 6, CAGE_CHARGES, CAGE @ turn.T)
    box = [f"-100 100 {axis}lo {axis}hi" for axis in "xyz"]
    data = lmp.folder / "data.poles"
    write_data(data, box, (3.0, 2.0, 1.0, 1.0), atoms, [*(speeds @ turn.T), *np.zeros((6, 3))])
    steps = round(20 / dt)
    deck = body_deck(data, formulation, words, dt=dt, steps=steps, pair=POLES)
    lmp.succeed(deck.replace(f"all custom {steps}", f"bodies custom {steps // 200}"))
    return np.array([frame[:, 1:4] for frame in frames(lmp.folder / "poses.dump").values()])


@pytest.mark.parametrize("pose, formulation", list(zip(POSES, FORMULATIONS)))
def test_no_frame_is_preferred(lmp_wheel, formulation, pose):
    """Euler angles are singular at theta = 0 and pi; the trajectory agrees with the turned scene."""
    words = "compensate yes"
    straight = in_the_cage(lmp_wheel, pose, formulation, np.eye(3), words)
    assert np.ptp(straight, axis=0).max() > 1.0
    assert np.abs(in_the_cage(lmp_wheel, pose, formulation, TURN, words) @ TURN - straight).max() < 1e-12


# --- spins --------------------------------------------------------------------------------------


@pytest.mark.parametrize("formulation, values", [("second", 10), ("first", 8)])
def test_a_top_turns_over_as_jacobis_functions_say(lmp_wheel, formulation, values):
    """Near its intermediate axis for 400 000 steps; the last digits of its energy decide when it turns over."""

    def missed(compensate):
        settings = dict(formulation=formulation, keywords=f"values {values} compensate {compensate}", dt=0.01, steps=400_000)
        settings |= dict(every=80_000, dump=80_000, out=lmp_wheel.folder / "top")
        lmp_wheel.succeed(SCENES / "in.top", settings)
        sites = read_sites(lmp_wheel.folder / "top.dump")
        bodies, start = bodies_from_sites(sites.masses, sites.positions[0], sites.velocities[0], np.zeros(6, int))
        top = Problem("top", bodies, FreeField(), start)
        exact = [top.site_positions(exact_state(top, np.longdouble("0.01") * step)) for step in sites.step]
        return np.abs(np.array(exact) - sites.positions).max()

    assert missed("yes") < 1e-9 < missed("no")


WALL = """
change_box all z final -10.0 50.0
variable vx atom "{w}*z-0.7*{w}*y"
variable vy atom "0.7*{w}*x-0.8*{w}*z"
variable vz atom "0.8*{w}*y-{w}*x+({v})"
velocity all set v_vx v_vy v_vz
displace_atoms all move 0.0 0.0 5.0
fix wall all wall/lj126 zlo 0.0 1.0 1.0 45.0
fix_modify wall energy yes
"""
MASS = 9.0
ESTIMATES = [f"f_move[{k}]" for k in (5, 7)] + [f"f_move[1][{k}]" for k in (4, 5, 6, 23, 24, 25)]


@pytest.mark.parametrize("event", [dict(w=0.0, v=-5.0), dict(w=36.0, v=0.0)], ids=["wall", "spin"])
def test_estimates_tell_the_error_of_fast_events(lmp_wheel, event):
    """A top hits a wall with 75 kT, or rotates with ten thousand times the energy that heat would give it.

    An error dx of a position made in a step is worth |p| dx/dt in energy, one of an orientation
    |L| da/dt; the error of the energy is a small multiple of their largest sum.
    """
    data, steps = EXAMPLES / "top" / "data.top", (0.004, 0.002, 0.001, 0.0005)
    settings = dict(before=WALL.format(**event), thermo=1, columns=" ".join(ESTIMATES))
    decks = [body_deck(data, "momentum", dt=dt, steps=round(2 / dt), **settings) for dt in steps]
    errors = []
    for dt, run in zip(steps, tables(lmp_wheel.succeed(one_after_the_other(decks)))):
        values = [run[name] for name in ESTIMATES]
        momentum, spin = MASS * np.linalg.norm(values[2:5], axis=0), np.linalg.norm(values[5:], axis=0)
        worth = (momentum * values[0] + spin * values[1]).max() / dt
        errors.append(off(run, "TotEng"))
        assert errors[-1] < 100 * worth
    assert run["PotEng"].max() > 50 or event["w"]
    assert errors[-1] < 1e-8 and errors[-1] < 0.01 * errors[0]


# --- inertia ------------------------------------------------------------------------------------


def pairs(x, y, z, masses=(1.0, 1.0, 1.0)):
    """Masses and places of two sites on each axis."""
    places = np.concatenate([sign * np.diag([x, y, z]) for sign in (1, -1)])
    return (*masses, *masses), places


def thin(ratio):
    """A body whose smallest moment is ``ratio`` times the largest; light sites are near its long axis."""
    wide = np.sqrt(20.0 * ratio)
    return pairs(0.84 * wide, 0.54 * wide, 1.0, (0.05, 0.05, 1.0))


# masses and places along the principal axes, and angular velocity
BODIES = {
    "I_min/I_max = 1e-3": (*thin(1e-3), (0.7, 0.6, 0.7 / 1e-3**0.5)),
    "I_min/I_max = 1e-6": (*thin(1e-6), (0.7, 0.6, 0.7 / 1e-6**0.5)),
    "two sites": ((1, 1), np.outer([0.8, -0.8], [0, 0, 1]), (0.9, 0, 0)),
    "three sites in a line": ((1, 1, 1), np.outer([0.9, 0.1, -1.0], [0, 0, 1]), (0.9, 0, 0)),
    "one site": ((1,), np.zeros((1, 3)), (0, 0, 0)),
    "spherical": (*pairs(1, 1, 1), (0.7, 0.6, 0.5)),
    "prolate": (*pairs(0.5, 0.5, 1), (0.7, 0.6, 0.5)),
    "oblate": (*pairs(1, 1, 0.4), (0.7, 0.6, 0.5)),
    "planar": ((2, 1, 1, 1), np.array([(0.5, 0, 0), (-1, 0.8, 0), (-1, -0.8, 0), (1, 0, 0)]), (0.7, 0.6, 0.5)),
}


def on_springs(masses, sites, velocities, time):
    """Places at ``time`` of a rigid body whose sites are on springs to where they started.

    ``sites`` (n, 3) are along the principal axes, which TURN turns into space, where ``velocities`` are.
    """
    anchors, whole = sites @ TURN.T, sum(masses)
    moments = masses @ ((sites**2).sum(axis=1, keepdims=True) - sites**2)
    inverse = np.divide(1.0, moments, out=np.zeros(3), where=moments > 0)

    def rates(_, y):
        turn = y[9:].reshape(3, 3)
        arms = sites @ turn.T
        forces = anchors - y[:3] - arms
        spin, torque = y[6:9], np.cross(sites, forces @ turn).sum(axis=0)
        change = inverse * (torque - np.cross(spin, moments * spin))
        return [*y[3:6], *(forces.sum(axis=0) / whole), *change, *np.cross(turn @ spin, turn.T).T.ravel()]

    omega = inverse * (masses @ np.cross(sites, velocities @ TURN))
    start = [*np.zeros(3), *(masses @ velocities / whole), *omega, *TURN.ravel()]
    end = solve_ivp(rates, (0, time), start, "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
    return end[:3] + sites @ end[9:].reshape(3, 3).T


def parts(masses, places):
    """Center of mass, and the directions of the sites from it; a single site has no direction."""
    center = masses @ places / sum(masses)
    arms = places - center
    return center, arms / np.linalg.norm(arms, axis=1, keepdims=True) if len(arms) > 1 else 0 * arms


@pytest.mark.parametrize("name", BODIES)
def test_any_inertia_has_the_full_order_where_the_estimates_are_small(lmp_wheel, name):
    """20 radians of the fastest rotation; the estimates of all steps add up to at most 1e-3."""
    masses, sites, omega = BODIES[name]
    time, counts = 20 / max(1.0, omega[2]), (40, 80, 160, 320, 640)
    light, heavy = min(masses), max(masses)
    settings = dict(thermo=1, columns="f_move[5] f_move[7]", fix="gear/quat molecule")
    settings |= dict(kinds=[1 + (mass > light) for mass in masses], masses=f"mass 1 {light}\nmass 2 {heavy}")
    settings["before"] = "fix springs all spring/self 1.0\nfix_modify springs energy yes"
    speeds = np.cross(omega, sites) @ TURN.T + [0.3, -0.2, 0.1]
    decks = [
        placed([sites @ TURN.T], speeds, dt=f"{time / n:.17g}", steps=n, dump=f"{n}.dump", **settings)
        for n in counts
    ]
    runs = tables(lmp_wheel.succeed(one_after_the_other(decks)))
    # the rounding of a small moment changes the spin that the fix finds
    speeds = frames(lmp_wheel.folder / "40.dump")[0][:, 4:7]
    exact, found = parts(masses, on_springs(masses, sites, speeds, time)), []
    for n, run in zip(counts, runs):
        ends = parts(masses, last_frame(lmp_wheel.folder / f"{n}.dump")[:, 1:4])
        errors = [np.linalg.norm(end - right) for end, right in zip(ends, exact)]
        trusted = max(run["f_move[5]"].sum(), run["f_move[7]"].sum()) <= 1e-3
        assert not trusted or max(errors) < 1e-2
        found.append((trusted, *errors))
    # a thin body hardly moves while it spins so fast, and a single site has no orientation
    for part in {"one site": [1]}.get(name, [2] if "I_min" in name else [1, 2]):
        assert found[-1][part] < 1e-9
        above = [(a, b) for a, b in zip(found, found[1:]) if a[0] and b[part] > 1e-13]  # rounding
        assert max(np.log2(a[part] / b[part]) for a, b in above) > 8 - 1.2  # the spin about the thin axis has the rounding of the moment


# --- boxes --------------------------------------------------------------------------------------

# Two bodies tied by a bond turn about the origin, a corner of the boxes with periods.
TIED = np.array([(0.4, 0.1, 0.2), (2, 0.3, -0.1), (1.1, 1.6, 0.1), (1.2, 0, 0.7), (1.2, 0.5, 0.25)])
BOXES = {
    "open": [f"-20000 20000 {axis}lo {axis}hi" for axis in "xyz"],
    "periodic": [f"0 10 {axis}lo {axis}hi" for axis in "xyz"],
    "triclinic": [*(f"0 10 {axis}lo {axis}hi" for axis in "xyz"), "3 2.5 -2 xy xz yz"],
}
CELLS = {"periodic": np.diag([10.0, 10, 10]), "triclinic": np.array([(10, 3, 2.5), (0, 10, -2), (0, 0, 10.0)])}
PLACES = {"corner": "", "edge": "displace_atoms all move 0 0 5", "flight": "velocity all set 19 23 -17 sum yes units box"}
BOND = """
bond_style harmonic
bond_coeff 1 2.0 2.4
special_bonds lj/coul 1 1 1
create_bonds single/bond 1 5 10
"""


def tied(lmp, box, place, formulation):
    """Unwrapped positions (F, 10, 3) to t = 40."""
    cell = CELLS.get(box, np.diag([40000.0] * 3))
    places = np.concatenate([TIED, -TIED])
    image = np.floor(places @ np.linalg.inv(cell).T) if box != "open" else np.zeros((10, 3))
    atoms = [[1 + k // 5, 1, 0, *(x - cell @ n), *n] for k, (x, n) in enumerate(zip(places, image))]
    velocities = np.cross([(0.3, 0.5, 1.0)] * 5 + [(0.2, 0.4, 1.0)] * 5, places)
    data = write_data(lmp.folder / f"data.{box}", BOXES[box], [1.0], atoms, velocities)
    settings = dict(pair="pair_style zero 3.0\npair_coeff * *\ncomm_modify cutoff 5.0", dt=0.01, steps=4000)
    settings |= dict(before=BOND + PLACES[place], boundary="f f f" if box == "open" else "p p p")
    deck = body_deck(f"{data} extra/bond/types 1 extra/bond/per/atom 1", formulation, "compensate yes", **settings)
    deck = deck.replace("1.0 bin", "1.0 nsq") if box == "open" else deck
    lmp.succeed(deck.replace("all custom 4000", "all custom 20"))
    return np.array([frame[:, 1:4] for frame in frames(lmp.folder / "poses.dump").values()])


@pytest.mark.parametrize("place, formulation", list(zip(PLACES, FORMULATIONS)))
def test_the_trajectory_is_that_in_an_open_box(lmp_wheel, formulation, place):
    """Bodies across a corner, across an edge, and in flight; test_image_flags.py exceeds the range of the flags."""
    here = tied(lmp_wheel, "open", place, formulation)
    for box, cell in CELLS.items():
        crossings = np.abs(np.diff(np.floor(here @ np.linalg.inv(cell).T), axis=0)).sum()
        assert crossings > 50
        assert np.abs(tied(lmp_wheel, box, place, formulation) - here).max() < 1e-10


# --- forces that jump ---------------------------------------------------------------------------


def test_water_with_a_plain_cutoff_is_not_lost(lmp_wheel):
    """At 2 fs, where energies jump by kcal/mol; with the same number of values, Gear's coefficients are unstable."""
    data, pair = EXAMPLES / "water" / "data.water", (EXAMPLES / "water" / "forces.plain").read_text()

    def deck(fix):
        return water(data, fix, dt=2.0, steps=200, thermo=10, pair=pair, before="velocity all create 300.0 4711")

    hot = {}
    for style in ("rigid/nve/small molecule", *(f"gear/quat molecule formulation {f}" for f in FORMULATIONS)):
        (run,) = tables(lmp_wheel.succeed(deck(style)))
        hot[style] = run["Temp"][10:].mean()
    rigid, *ours = hot.values()
    assert max(ours) < 1.25 * rigid
    for words in ("values 9", "values 8 formulation first"):
        lmp_wheel.refuse(deck(f"gear/quat molecule corrector gear {words}"), "blow-up")
