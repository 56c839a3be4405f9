"""Scripts in the style of published ones, converted as doc/howto/from_rigid.md and from_shake.md say and nothing more.

A converted script runs, or stops with a message that names a remedy, with which it runs.  The rows of the page are in
test_from_rigid.py, LAMMPS' own scripts in tests/foreign.
"""

from dataclasses import replace

import numpy as np
import pytest

TRIANGLE = np.array([(0.0, 0.0, 0.0), (0.8165, 0.5774, 0.0), (-0.8165, 0.5774, 0.0)])
ROD = np.array([(0.0, 0.0, 0.9 * k) for k in range(4)])


def molecule(sites, types, charges=None, bonds=()):
    parts = {"Coords": sites, "Types": [(kind,) for kind in types]}
    if charges is not None:
        parts["Charges"] = [(charge,) for charge in charges]
    text = [f"molecule\n\n{len(sites)} atoms"]
    if bonds:
        text = [f"molecule\n\n{len(sites)} atoms\n{len(bonds)} bonds\n1 angles"]
        parts |= {"Bonds": [(1, 1, k) for k in bonds], "Angles": [(1, bonds[0], 1, bonds[1])]}
        parts |= {"Special Bond Counts": [(2, 0, 0), (1, 1, 0), (1, 1, 0)], "Special Bonds": [(2, 3), (1, 3), (1, 2)]}
    for name, lines in parts.items():
        text.append(f"{name}\n\n" + "\n".join(f"{k} {' '.join(f'{w:.10g}' for w in line)}" for k, line in enumerate(lines, 1)))
    return "\n\n".join(text) + "\n"


FILES = {
    "water.mol": molecule(TRIANGLE, (1, 2, 2), (-0.8476, 0.4238, 0.4238), (2, 3)),
    "triangle.mol": molecule(TRIANGLE, (1, 1, 1)),
    "rod.mol": molecule(ROD, (1, 1, 1, 1)),
    "clump.mol": "clump\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 0.6 0 0\n\nTypes\n\n1 1\n2 1\n\nDiameters\n\n1 1.0\n2 1.0\n"
    "\nMasses\n\n1 0.5\n2 0.5\n",
}
WATER = """
units real
atom_style full
bond_style harmonic
angle_style harmonic
region box block 0 {edge} 0 {edge} 0 {edge}
create_box 4 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 2
mass 1 15.9994
mass 2 1.008
mass 3 22.99
mass 4 35.45
molecule w water.mol
lattice sc 3.6
create_atoms 0 box mol w 4711
group water type 1 2
lattice sc 3.6 origin 0.5 0.5 0.5
region few block 0 2 0 1 0 1
{ions}
pair_style lj/cut/coul/long 6.5
pair_coeff * * 0.05 2.6
pair_coeff 1 1 0.1553 3.166
pair_coeff 2 2*4 0.0 1.0
pair_coeff 1 3*4 0.1 3.2
pair_coeff 2 3*4 0.05 1.8
kspace_style pppm 1e-4
bond_coeff 1 600.0 1.0
angle_coeff 1 75.0 109.47
timestep 1.0
"""
IONS = """create_atoms 3 region few
group sodium type 3
set group sodium type/subset 4 1 4711
set type 3 charge 1.0
set type 4 charge -1.0
group ions type 3 4"""
IONIC = WATER.format(edge=14.4, ions=IONS) + "velocity all create 300 4711\n"
GAS = """
units lj
dimension {dimension}
atom_style molecular
region box block 0 12 0 12 {z}
create_box 2 box
molecule m {file}
lattice {lattice}
create_atoms 0 box mol m 4711
mass * 1.0
pair_style lj/cut 2.5
pair_coeff * * 0.5 0.8
{more}
neigh_modify exclude molecule/intra all
velocity all create 1.0 4711
timestep 0.002
"""
BODIES = GAS.format(dimension=3, z="0 12", file="triangle.mol", lattice="sc 0.037037", more="")
MIXED = GAS.format(
    dimension=3,
    z="0 12",
    file="rod.mol",
    lattice="sc 0.0046296",
    more="group rods molecule > 0\nlattice sc 0.2 origin 0.25 0.25 0.25\nregion free block 0 3 0 3 0 1\n"
    "create_atoms 2 region free\ngroup fluid type 2\ndelete_atoms overlap 0.7 fluid rods",
)
SLAB = """
units lj
atom_style atomic
lattice fcc 0.9
region box block 0 5 0 5 0 8
create_box 3 box
region low block INF INF INF INF INF 1.9
region high block INF INF INF INF 5.9 7.4
region gap block INF INF INF INF 2.4 5.4
create_atoms 1 region low
create_atoms 2 region high
create_atoms 3 region gap
group lower type 1
group upper type 2
group film type 3
mass * 1.0
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
neigh_modify exclude group lower lower exclude group upper upper
velocity film create 0.7 4711
velocity upper set 0 0 0
fix hold lower setforce 0 0 0
fix 1 upper rigid single force * on off on torque * off off off
fix pull upper smd cvel 5.0 0.1 tether 100.0 NULL NULL 0.0
fix load upper aveforce NULL NULL -0.5
fix 2 film nvt temp 0.7 0.7 0.5
timestep 0.003
thermo_style custom step temp f_pull[1] f_pull[7]
thermo 20
run 60
"""
CLUMPS = """
units lj
atom_style sphere
atom_modify map yes
boundary p p f
region box block 0 6 0 6 0 12
create_box 1 box
fix mol all property/atom mol ghost yes
molecule c clump.mol
pair_style gran/hooke/history 2000.0 NULL 20.0 NULL 0.5 1
pair_coeff * *
comm_modify vel yes
timestep 0.002
neigh_modify every 1 delay 0 check yes
region drop block 1 5 1 5 8 11
fix 1 all rigid/small molecule mol c
fix 2 all deposit 6 0 60 4711 region drop near 1.5 mol c rigid 1 vz -1 -1
fix 3 all gravity 1.0 vector 0 0 -1
fix 4 all wall/gran hooke/history 2000.0 NULL 20.0 NULL 0.5 1 zplane 0.0 NULL
thermo 200
run 600
"""
GROUPS = """
group left molecule 1
group right molecule 2
group pair union left right
group rest subtract all pair
fix 1 pair rigid/nvt group 2 left right force 1 off off off torque 1 off off off temp 1.0 1.0 0.5 tparam 5 3 3
fix 2 rest nve
velocity left zero linear rigid 1
thermo 20
run 60
"""
SHEAR = """
change_box all triclinic
fix 1 rods rigid/nvt/small molecule temp 1.0 1.0 0.5
fix 2 fluid nvt/sllod temp 1.0 1.0 0.5
fix 3 all deform 1 xy erate 0.05 remap v
thermo 50
run 100
"""
RUN = "thermo 20\nrun 40\n"
SALT = "fix 1 water {}temp 300 300 100 iso 1 1 1000{}\nfix 2 ions nvt temp 300 300 100\n"
NVE = "fix 1 rods rigid/nve/small molecule\nfix 2 all nve\n"
WITH_MAP = ("lattice fcc", "atom_modify map yes\nlattice fcc")

#: kind in the census -> script, what the page replaces, the message with which the script stops, the remedy
KINDS = {
    "a slab pulled by a spring": (
        SLAB, [("fix 1 upper rigid", "fix 1 upper gear/quat")], "write atom_modify map yes before the box is created", [WITH_MAP],
    ),
    "clumps that fall on a floor": (CLUMPS, [("rigid/small", "gear/quat")], "", []),
    "two groups, one held": (
        BODIES + GROUPS, [("rigid/nvt", "gear/quat"), (" tparam 5 3 3", ""), (" rigid 1", "")], "", [],
    ),
    "salt water at constant pressure": (
        IONIC + SALT.format("rigid/npt/small molecule ", " tparam 5 3 3 dilate all") + RUN,
        [("rigid/npt/small", "gear/quat"), (" tparam 5 3 3", "")],
        "requires all moving atoms to be in bodies of this fix, and 2 that fix 2 (nvt) moves are not",
        [("fix 1 water gear/quat molecule", "fix 1 all gear/quat molecule points ions"), ("fix 2 ions nvt temp 300 300 100\n", "")],
    ),
    "rods under shear": (
        MIXED + SHEAR, [("rigid/nvt/small", "gear/quat")],
        "add keyword tchain 1", [("gear/quat molecule temp 1.0 1.0 0.5", "gear/quat molecule temp 1.0 1.0 0.5 tchain 1")],
    ),
    "nve over all atoms": (
        MIXED + NVE + RUN, [("rigid/nve/small", "gear/quat")],
        "is also moved by fix 2 (nve); take it out of the group", [("fix 2 all nve", "fix 2 fluid nve")],
    ),
    "shake, constant pressure": (
        IONIC + "fix s water shake 1e-6 100 0 b 1 a 1\nfix n all npt temp 300 300 100 iso 1 1 1000\n" + RUN,
        [("fix s water shake 1e-6 100 0 b 1 a 1", "group rest subtract all water"), ("npt", "gear/quat molecule points rest")], "", [],
    ),
    "shake, constant temperature": (
        IONIC + "fix s water shake 1e-6 100 0 b 1 a 1\nfix n all nvt temp 300 300 100\n" + RUN,
        [("fix s water shake 1e-6 100 0 b 1 a 1", "group rest subtract all water\nfix r rest nvt temp 300 300 100"),
         ("fix n all nvt", "fix n water gear/quat molecule")], "", [],
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_converted_scripts_run(lmp_wheel, kind):
    script, edits, message, remedy = KINDS[kind]
    for name, text in FILES.items():
        (lmp_wheel.folder / name).write_text(text)
    # fix rigid reads memory that it does not set, which is zero in a new process
    before = replace(lmp_wheel, library=None).run(script, timeout=300)
    right = "nve over" not in kind
    assert not right or before.returncode == 0, before.output  # the script itself is right
    for old, new in edits:
        assert old in script
        script = script.replace(old, new)
    if message:
        lmp_wheel.refuse(script, message)
        for old, new in remedy:
            assert old in script
            script = script.replace(old, new)
    table = lmp_wheel.succeed(script, timeout=300).thermo[-1]
    assert np.isfinite(table["Temp"]).all() and 0.0 <= table["Temp"][-1] < 1e4
    if right:
        assert table["Step"] == before.thermo[-1]["Step"]
    if "shake" in kind:
        assert table["E_pair"] == pytest.approx(before.thermo[-1]["E_pair"], rel=0.05)
        assert table["Temp"][1:] == pytest.approx(before.thermo[-1]["Temp"][1:], rel=0.3)  # projected by then
