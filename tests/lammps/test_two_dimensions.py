"""In two dimensions bodies move in the plane, whatever acts on their atoms, in every order of fixes."""

from itertools import permutations

import numpy as np
import pytest
from support.scenes import one_after_the_other, template

TRIANGLE = template([(0, 0, 0), (0.8, 0.58, 0), (-0.8, 0.58, 0)])
ROD = template([(k, 0, 0) for k in range(-2, 3)])
LINES = {
    "flat": "fix flat all enforce2d",
    "bath": "fix bath all langevin 1.0 1.0 0.5 {seed}",
    "move": "fix move all gear/quat molecule",
}
FREE_OF_FORCES = "pair_style zero 2.5\npair_coeff * *"
LATTICE = "lattice sq 0.04 origin 0.5 0.5 0\ncreate_atoms 0 box mol w 4711"
SCENES = {  # pair style, edge of the box, bodies and their number, steps
    "liquid": ("pair_style lj/cut 2.5\npair_coeff * * 1.0 0.8", 35, LATTICE, 49, 12000),
    "one body": (FREE_OF_FORCES, 10, "create_atoms 0 single 5 5 0 mol w 4711", 1, 100000),
}
SCENE = """
units lj
dimension 2
atom_style full
region b block 0 {size} 0 {size} -0.5 0.5
create_box 1 b
molecule w triangle.mol
{create}
mass * 1
{pair}
neigh_modify exclude molecule/intra all
velocity all create 1.0 4711
{fixes}
timestep 0.005
compute away all reduce max z vz fz
thermo 20
thermo_style custom step ke c_away[*]
thermo_modify norm no
run {steps}
"""
ORDERS = [*permutations(LINES), ("bath", "move")]


@pytest.mark.parametrize("name", SCENES)
def test_every_order_of_fixes(lmp_tree, name):
    """With other random numbers in each order; the temperature of all of them within three standard errors."""
    (lmp_tree.folder / "triangle.mol").write_text(TRIANGLE)
    pair, size, create, number, steps = SCENES[name]
    settings = dict(pair=pair, size=size, create=create, steps=steps)
    fixes = ["\n".join(LINES[one] for one in order).format(seed=4711 + n) for n, order in enumerate(ORDERS)]
    tables = lmp_tree.succeed(one_after_the_other([SCENE.format(fixes=one, **settings) for one in fixes])).thermo
    assert len(tables) == len(ORDERS)
    for table in tables:
        assert set(table["c_away[1]"]) == set(table["c_away[2]"]) == {0.0}
    times = len(ORDERS) * (steps * 0.005 - 5) / 0.5  # energies are uncorrelated after damp / 2, on both sides
    bar = np.sqrt(2 / (3 * number * times))
    found = [np.mean(table["KinEng"][50:]) / (1.5 * number) for table in tables]
    assert np.mean(found) == pytest.approx(1.0, abs=3 * bar)
    assert found == pytest.approx([1.0] * len(ORDERS), abs=4 * bar * len(ORDERS) ** 0.5)


ARMS = np.array([(-0.6, 0.1, 0.2), (0.5, 0.4, -0.3), (0.2, -0.7, 0.1), (0.3, 0.2, 0.25)])
SPIN, SPEED = np.array([0.3, -0.2, 0.9]), np.array([0.5, -0.4, 0.7])
FREE = """
units lj
dimension 2
atom_style molecular
atom_modify map array
read_data data.body
{heights}
pair_style zero 2.0
pair_coeff * *
timestep 0.01
{fixes}
run 100
set group all vz 0.5
run 100
write_dump all custom end.dump id xu yu zu vx vy vz modify sort id format float %.17g
"""


@pytest.mark.parametrize("flat", [True, False])
@pytest.mark.parametrize("words", ["", "formulation first", "formulation momentum", "values 5"])
def test_a_body_that_leaves_the_plane_turns_about_z(lmp_tree, words, flat):
    """A body with velocities out of the plane, also one that is not flat, keeps center and rotation in the plane."""
    arms = (ARMS - ARMS.mean(axis=0)) * [1, 1, 0 if flat else 1]
    speeds = SPEED + np.cross(SPIN, arms)
    lines = ["body", "", "4 atoms", "1 atom types", "", "0 10 xlo xhi", "0 10 ylo yhi", "-0.5 0.5 zlo zhi"]
    lines += ["", "Masses", "", "1 1.0", "", "Atoms # molecular", ""]
    lines += [f"{k} 1 1 {x:.17g} {y:.17g} 0" for k, (x, y, _) in enumerate(arms + 5, 1)]
    lines += ["", "Velocities", ""] + [f"{k} {x:.17g} {y:.17g} {z:.17g}" for k, (x, y, z) in enumerate(speeds, 1)]
    heights = "\n".join(f"set atom {k} z {z:.17g}" for k, z in enumerate(arms[:, 2], 1))
    (lmp_tree.folder / "data.body").write_text("\n".join(lines) + "\n")
    result = lmp_tree.succeed(FREE.format(fixes=f"fix move all gear/quat molecule {words}", heights=heights))
    assert "WARNING: Fix gear/quat" not in result.words
    found = np.loadtxt(lmp_tree.folder / "end.dump", skiprows=9)[:, 1:]
    rate = np.cross(arms, speeds).sum(axis=0)[2] / (arms[:, :2] ** 2).sum()
    c, s = np.cos(2.0 * rate), np.sin(2.0 * rate)
    turned = arms @ np.array([(c, s, 0), (-s, c, 0), (0, 0, 1)])
    place = [5, 5, 0] + turned + 2.0 * SPEED * [1, 1, 0]
    assert np.abs(found[:, :3] - place).max() < 1e-9
    assert np.abs(found[:, 3:] - SPEED * [1, 1, 0] - np.cross([0, 0, rate], turned)).max() < 1e-9


PRESSED = """
units lj
dimension 2
atom_style molecular
atom_modify map yes
region box block 0 30 0 30 -{half} {half}
create_box 1 box
mass 1 1
molecule m rod.mol
create_atoms 0 random 20 771 NULL mol m 772 overlap 0.9 maxtry 2000
pair_style lj/cut 1.122462
pair_coeff * * 1 1
comm_modify cutoff 6
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
velocity all create 1.0 99
timestep 0.005
fix move all gear/quat molecule temp 1 1 0.5 {words}
thermo 100
thermo_style custom step temp press lx ly econserve
thermo_modify format float %.17g
run 500
"""


@pytest.mark.parametrize("words", ["iso 0.1 0.1 5.0", "aniso 0.1 0.1 5.0", "x 0.1 0.1 5.0 y 0.1 0.1 5.0 couple xy"])
def test_constant_pressure_in_a_thin_box(lmp_tree, words):
    """The edge along z, along which there are no images, does not count."""
    (lmp_tree.folder / "rod.mol").write_text(ROD)
    decks = [PRESSED.format(half=half, words=words) for half in (0.5, 5.0)]
    thin, thick = lmp_tree.succeed(one_after_the_other(decks)).thermo
    assert thin == thick
    assert thin["Lx"][-1] < 29
