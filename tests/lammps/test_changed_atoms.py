"""Atoms that commands move relative to their body."""

import numpy as np
import pytest
from scenes import water

GROUPS = "group one id 4\ngroup two molecule 2\n"
REBUILT = "atoms were changed since the last run; bodies are rebuilt from them"


def said(lmp, data, change, words="", first="run 5\n", ranks=1):
    deck = water(data, f"gear/quat molecule {words}", run=f"{GROUPS}{first}{change}\nrun 5\nrun 5")
    return lmp.succeed(deck, ranks=ranks).words


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_displaced_atom(lmp_wheel, data, ranks):
    """The body gets another shape; with reinit no its atom is put back."""
    move = "displace_atoms one move 0.1 0.05 0"
    assert REBUILT in said(lmp_wheel, data, move, ranks=ranks)
    assert REBUILT not in said(lmp_wheel, data, move, "reinit no", ranks=ranks)


@pytest.mark.parametrize("first", ["", "run 5\n"])
def test_a_remapped_box(lmp_wheel, data, first):
    """Each atom is remapped by itself, which ends the next run; fix deform moves bodies as a whole."""
    remapped = water(data, run=f"{first}change_box all x scale 1.1 remap\nrun 5")
    lmp_wheel.refuse(remapped, "change_box with remap moves each atom by itself")
    said(lmp_wheel, data, "fix d all deform 1 x scale 1.1\nrun 5\nunfix d", first=first)


# --- axes of symmetric bodies are arbitrary ------------------------------------------------------

CUBE = """
units lj
atom_style molecular
atom_modify map yes
region box block -9 9 -9 9 -9 9
create_box 1 box
mass 1 1.0
{atoms}
set group all mol 1
variable vx atom 0.3*z-0.5*y
variable vy atom 0.5*x-0.2*z
variable vz atom 0.2*y-0.3*x
velocity all set v_vx v_vy v_vz
pair_style zero 2.0
pair_coeff * *
comm_modify cutoff 6.0
fix move all gear/quat molecule
timestep 0.01
thermo_style custom step f_move[1][16] f_move[1][17] f_move[1][18] f_move[1][19]
thermo_modify format float %.17g
thermo 1
run 170
{change}
run 5
"""
SHAPES = {
    "cube": [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)],
    "square": [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)],
    "rod": [(0, 0, 1), (0, 0, 0), (0, 0, -1)],
}
STILL = {
    "displaced": "displace_atoms all move 0.5 0 0",
    "set": "set atom 1 vx 0.31",
    "scaled": "velocity all scale 0.01",
    "stopped": "velocity all zero linear",
}


@pytest.mark.parametrize("change", STILL)
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("ranks", [1, 2])
def test_orientations_are_continuous(lmp_tree, shape, change, ranks):
    """The orientation is that at the end of the last run if the atoms have not turned; in 0.4.0 other axes were chosen."""
    atoms = "\n".join(f"create_atoms 1 single {x} {y} {z}" for x, y, z in SHAPES[shape])
    first, second = lmp_tree.succeed(CUBE.format(atoms=atoms, change=STILL[change]), ranks=ranks).thermo
    before = np.array([first[f"f_move[1][{column}]"][-1] for column in range(16, 20)])
    after = np.array([second[f"f_move[1][{column}]"][0] for column in range(16, 20)])
    assert np.abs(after - before).max() < 1e-9


def test_another_mass_turns_the_axes(lmp_tree):
    """A cube with another corner has other principal axes."""
    atoms = "\n".join(f"create_atoms 1 single {x} {y} {z}" for x, y, z in SHAPES["cube"])
    deck = CUBE.format(atoms=atoms, change="set atom 1 type 2").replace("create_box 1", "create_box 2")
    first, second = lmp_tree.succeed(deck.replace("mass 1 1.0", "mass 1 1.0\nmass 2 3.0")).thermo
    before = np.array([first[f"f_move[1][{column}]"][-1] for column in range(16, 20)])
    after = np.array([second[f"f_move[1][{column}]"][0] for column in range(16, 20)])
    assert np.abs(after - before).max() > 0.1
