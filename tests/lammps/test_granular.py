"""Granular contacts damp with the mass of the body, as with fix rigid, for walls and pairs.

A flat clump of n = 3 spheres hits a wall, or another clump, with all spheres at once. The contact
is a damped oscillator with w^2 = k n/M and 2 z w = g n, where M is the reduced mass of the bodies.
The clump rebounds with exp(-pi z/sqrt(1 - z^2)) of its velocity. With the masses of atoms the damping
would be a third of this.
"""

import math

import pytest
from test_memory import OLD, on_a_bed

STIFF = 1.0e4
DAMPING = 24.733  # of the mass

DECK = """
units lj
atom_style sphere
atom_modify map array
boundary p p f
comm_modify vel yes
newton {newton}
processors {grid}
region box block -3 3 -3 3 -0.5 8
create_box 2 box
{atoms}
set group all diameter 1.0
set group all density {density}
group low type 1
group high type 2
velocity high set 0 0 -1 units box
velocity low set 0 0 0 units box
neighbor 0.3 bin
pair_style {pair}
pair_coeff * * {coeff}
{wall}
timestep {dt}
{fixes}
compute speed high reduce ave vz
compute lows low reduce ave vz
thermo_style custom step c_speed c_lows
thermo_modify format float %.17g norm no lost error
run {steps}
"""

CLUMP = """
create_atoms {kind} single 0.0 0.0 {z}
create_atoms {kind} single 1.1 0.0 {z}
create_atoms {kind} single 0.55 $(sqrt(3)/2*1.1) {z}
"""

STYLES = {
    "gran/hooke": (f"gran/hooke {STIFF} NULL {DAMPING} NULL 0.0 0", ""),
    "granular": ("granular", f"hooke {STIFF} {DAMPING} tangential linear_nohistory 0.0 0.0 damping mass_velocity"),
    "zero": ("zero 1.2", ""),
}
WALL = f"fix wall all wall/gran hooke {STIFF} NULL {DAMPING} NULL 0.0 0 zplane 0.5 NULL"


def expected(mass):
    """Three contacts with a reduced mass."""
    omega = math.sqrt(3 * STIFF / mass)
    zeta = 3 * DAMPING / (2 * omega)
    return math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))


def deck(fixes, dt, wall, low=True, style="gran/hooke", ranks=1, newton="off", steps=None, gap=0.002):
    """Clump high moves down, towards a wall or clump low, if present."""
    pair, coeff = STYLES[style]
    return DECK.format(
        atoms=CLUMP.format(kind=2, z=1.0 + gap) + (CLUMP.format(kind=1, z=0.0) if low else ""),
        newton=newton,
        grid="* * *" if ranks == 1 else "2 1 1",
        density=6 / math.pi,  # a mass of 1
        pair=pair,
        coeff=coeff,
        wall=WALL if wall else "",
        dt=dt,
        fixes=fixes,
        steps=steps or round(0.045 / dt),
    )


@pytest.mark.parametrize("fix", ["gear/quat single", "gear/quat single formulation first"])
def test_rebound_from_a_wall(lmp_wheel, fix):
    """The test uses two steps; fix rigid has the same error at one of them."""
    exact = expected(3.0)
    assert exact == pytest.approx(0.285, abs=1e-3)
    for style, dt in ((fix, 1e-4), (fix, 5e-5), ("rigid single", 2.5e-5)):
        thermo = lmp_wheel.succeed(deck(f"fix move all {style}", dt, wall=True, low=False)).thermo
        assert thermo[-1]["c_speed"][-1] == pytest.approx(exact, abs=2e-3)


@pytest.mark.parametrize("style", ["gran/hooke", "granular"])
@pytest.mark.parametrize("ranks, newton", [(1, "off"), (2, "on")])
def test_rebound_of_two_clumps(lmp_wheel, style, ranks, newton):
    """Contacts across the boundaries of ranks: ghosts must have the masses of their bodies."""
    exact = expected(1.5)
    fix = "fix move all gear/quat group 2 low high"
    text = deck(fix, 5e-5, wall=False, style=style, ranks=ranks, newton=newton)
    thermo = lmp_wheel.succeed(text, ranks=ranks).thermo[-1]
    rebound = thermo["c_speed"][-1] - thermo["c_lows"][-1]
    assert rebound == pytest.approx(exact, abs=2e-3)


@pytest.mark.parametrize(
    "style, wall, source",
    [
        ("gran/hooke", False, "pair style gran/hooke"),
        ("granular", False, "pair style granular"),
        ("zero", True, "fix wall (wall/gran)"),
        ("zero", False, None),
    ],
)
@pytest.mark.parametrize("words, many", [("values 9", True), ("corrector gear values 4", False), ("", False)])
def test_contacts_suit_few_values(lmp_wheel, style, wall, source, words, many):
    fix = f"fix move all gear/quat group 2 low high {words}"
    result = lmp_wheel.succeed(deck(fix, 1e-5, wall=wall, style=style, steps=1))
    told = f"forces of {source} are dissipative, and 9 values cannot follow them; leave out keywords values and"
    assert (told in result.words) == (many and source is not None)
    chosen = f"4 values and corrector gear, because forces of {source} are dissipative"
    assert (chosen in result.words) == (words == "" and source is not None)


@pytest.mark.parametrize("wall", [True, False])
def test_contacts_of_few_steps_make_no_energy(lmp_wheel, wall):
    """With the number chosen by the fix, and with the number for smooth motion."""
    dt = 4e-3  # 8 in a contact, with a friction of 0.3 in each
    speeds = []
    for words in ("", "values 9"):
        fix = "single" if wall else "group 2 low high"
        text = deck(f"fix move all gear/quat {fix} {words}", dt, wall, low=not wall, steps=30)
        last = lmp_wheel.succeed(text).thermo[-1]
        speeds.append(abs(last["c_speed"][-1] - (0.0 if wall else last["c_lows"][-1])))
    assert speeds[0] < 0.45 < 1.0 < speeds[1]


BED = on_a_bed(f"gran/hooke/history {OLD}", z=1.0) + """
compute ke clump ke
compute center clump com
thermo_style custom step c_ke c_center[1] c_center[3]
thermo_modify format float %.17g norm no
thermo 1000
run 25000 every {piece} NULL
"""


@pytest.mark.parametrize("piece", [25000, 50])
def test_a_clump_comes_to_rest(lmp_wheel, piece):
    """It stays at rest where contacts hold it by friction, in one run and in many."""
    last = lmp_wheel.succeed(BED.format(piece=piece)).thermo[-1]
    assert last["c_ke"][-1] < 1e-20
    assert last["c_center[3]"][-1] == pytest.approx(0.9, abs=0.1)


ROLLING = """
units lj
atom_style sphere
atom_modify map array
boundary p p f
newton off
comm_modify vel yes
region box block -12 12 -3 3 -1 4
create_box 1 box
fix molecules all property/atom mol ghost yes
create_atoms 1 single -10 0 0.499
set group all diameter 1.0 density 1.0
set group all mol 1
pair_style zero 1.2
pair_coeff * *
velocity all set 1.0 0 0
fix move all gear/quat molecule report no
fix pull all gravity 1.0 vector 0 0 -1
fix wall all wall/gran hooke/history 20000 NULL 50 NULL 0.5 1 zplane 0.0 NULL
timestep {dt}
compute turn all property/atom omegay
compute turns all reduce sum c_turn
variable slip equal "vx[1] - 0.5*c_turns"
thermo_style custom step v_slip
thermo_modify format float %.17g
thermo 1000
run $(round(10.0/dt))
"""


def test_a_sphere_ends_rolling(lmp_wheel):
    for dt in (0.002, 0.001, 0.0005, 0.00025):
        slip = lmp_wheel.succeed(ROLLING.format(dt=dt)).thermo[-1]["v_slip"]
        assert slip[0] == 1.0
        assert abs(slip[-1]) < 5e-9
