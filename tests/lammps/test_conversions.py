"""Scripts in the style of published ones, converted as doc/howto/from_rigid.md says and nothing more, by a program.

A converted script runs, or stops with a message that names a remedy, with which it runs.
"""

import re
from dataclasses import replace

import numpy as np
import pytest
from test_from_rigid import PAGE, rows

# --- the page as a program ------------------------------------------------------------------------

#: values behind the keywords of the rigid fixes
VALUES = {"langevin": 4, "temp": 3, "tchain": 1, "tparam": 3, "pparam": 3, "iso": 3, "aniso": 3, "x": 3, "y": 3, "z": 3}
VALUES |= {"couple": 1, "pchain": 1, "dilate": 1, "infile": 1, "mol": 1, "reinit": 1, "force": 4, "torque": 4, "gravity": 1}
#: the remark of a row "not there" -> what replaces the keyword, with its group and values
INSTEAD = {
    "leave them out": "",
    "leave it out": "",
    "use `fix gravity`": "",
    "use `f_move[1]`": "",
    "use `f_move[2]`": "",
    "use `velocity` without it": "",
}


def table():
    """Rows of the page: words, whether they work, remark."""
    lines = PAGE.read_text().split("## Keywords, outputs and companions")[1].split("\n## ")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("| ")]
    return [(re.findall("`([^`]+)`", first), says, remark) for first, says, remark in cells[1:]]


TABLE = table()


def row_of(word):
    """The second and the third cell of the table's row with this word."""
    for words, says, remark in TABLE:
        if word in words:
            return says, remark
    raise AssertionError(f"the page has no row for {word}")


def converted_fix(words):
    """Lines for the line of a rigid fix."""
    ID, group, (style, *arguments) = words[1], words[2], words[4:]
    rest = arguments[: {"single": 0, "molecule": 0, "custom": 1}.get(style, 1 + int(arguments[0]) if style == "group" else 0)]
    kept, lines, behind = [style, *rest], [], arguments[len(rest) :]
    while behind:
        keyword, count = behind[0], 1 + VALUES[behind[0]]
        values, behind = behind[1:count], behind[count:]
        says, remark = row_of(keyword)
        if says != "not there":
            kept += [keyword, *values]
            continue
        line = next(line for start, line in INSTEAD.items() if start in remark)
        lines += [line.format(ID=ID, group=group, values=" ".join(values))] if line else []
    return [f"fix {ID} {group} gear/quat {' '.join(kept)}", *lines]


def converted(script):
    lines = []
    for line in script.splitlines():
        words = line.split()
        if words[:1] == ["fix"] and words[3].startswith("rigid"):
            lines += converted_fix(words)
        elif words[:1] == ["velocity"] and "rigid" in words:
            assert row_of("velocity ... rigid")[0] == "not there"
            at = words.index("rigid")
            lines.append(" ".join(words[:at] + words[at + 2 :]))
        elif words[:1] == ["compute"] and words[3] in ("ke/rigid", "erotate/rigid"):
            element = re.search(r"f_move\[\d\]", row_of(f"compute {words[3]}")[1])[0].replace("move", words[4])
            lines.append(("replace", f"c_{words[1]}", element))
        else:
            lines.append(line)
    text = "\n".join(line for line in lines if isinstance(line, str))
    for _, old, new in (line for line in lines if isinstance(line, tuple)):
        text = re.sub(rf"{old}\b", new, text)
    return text + "\n"


# --- scripts --------------------------------------------------------------------------------------

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


CHARGES = (-0.8476, 0.4238, 0.4238)
#: id, masstotal, center of mass, inertia, velocity, angular momentum, image flags of each body
TRIANGLES = "\n".join(
    f"{1 + i + 4 * j + 16 * k} 3 {3 * i} {0.38493 + 3 * j} {3 * k} 0.22224 1.33334 1.55558 0 0 0 0 0 0 0 0 0 0 0 0"
    for k in range(4)
    for j in range(4)
    for i in range(4)
)
FILES = {
    "bodies.txt": f"64\n{TRIANGLES}\n",
    "water.mol": molecule(TRIANGLE, (1, 2, 2), CHARGES, (2, 3)),
    "triangle.mol": molecule(TRIANGLE, (1, 1, 1)),
    "rod.mol": molecule(ROD, (1, 1, 1, 1)),
    "patchy.mol": molecule(TRIANGLE * 0.5, (1, 2, 2)),
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
LIQUID = WATER.format(edge=14.4, ions="")
IONIC = WATER.format(edge=14.4, ions=IONS)

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
RODS = "fix 1 rods rigid/nve/small molecule\n"

# kind in the census -> script; the message that the converted script stops with, and the remedy: what it replaces, and by what
KINDS = {
    "a slab pulled by a spring": (
        """
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
""",
        "write atom_modify map yes before the box is created", ("lattice fcc", "atom_modify map yes\nlattice fcc"),
    ),
    "two dimensions": (
        GAS.format(dimension=2, z="-0.5 0.5", file="triangle.mol", lattice="sq 0.11", more="")
        + """
fix flat all enforce2d
fix 1 all rigid/nve/small molecule langevin 1.0 1.0 1.0 4711
thermo 50
run 100
""",
    ),
    "patchy particles": (
        GAS.format(dimension=3, z="0 12", file="patchy.mol", lattice="sc 0.037037", more="")
        + """
fix which all property/atom i_body
variable which atom mol
set group all i_body v_which
pair_coeff 2 2 3.0 0.4
fix 1 all rigid/nve custom i_body langevin 1.0 1.0 1.0 4711
thermo 50
run 100
""",
    ),
    "clumps that fall on a floor": (
        """
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
""",
    ),
    "a nanoparticle in a fluid": (
        """
units lj
atom_style atomic
lattice fcc 0.8
region box block 0 6 0 6 0 6
create_box 2 box
create_atoms 1 box
region ball sphere 3 3 3 1.4
group ball region ball
set group ball type 2
group fluid subtract all ball
mass * 1.0
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
neigh_modify exclude group ball ball
velocity fluid create 1.4 4711
fix 1 ball rigid/nve single
fix 2 fluid nvt temp 1.4 1.4 0.5
compute r all ke/rigid 1
compute e all erotate/rigid 1
timestep 0.002
thermo_style custom step temp c_r c_e
thermo 20
run 60
""",
        "write atom_modify map yes before the box is created", ("lattice fcc", "atom_modify map yes\nlattice fcc"),
    ),
    "two groups, one held": (
        BODIES
        + """
group left molecule 1
group right molecule 2
group pair union left right
group rest subtract all pair
fix 1 pair rigid/nvt group 2 left right force 1 off off off torque 1 off off off temp 1.0 1.0 0.5 tparam 5 3 3
fix 2 rest nve
velocity left zero linear rigid 1
thermo 20
run 60
""",
    ),
    "water at constant pressure": (
        LIQUID
        + """
velocity all create 300 4711
fix 1 all rigid/npt/small molecule temp 300 300 100 iso 1 1 1000 tparam 5 3 3 dilate all
thermo 20
run 40
""",
    ),
    "salt water at constant pressure": (
        IONIC
        + """
velocity all create 300 4711
fix 1 water rigid/npt/small molecule temp 300 300 100 iso 1 1 1000
fix 2 ions nvt temp 300 300 100
thermo 20
run 40
""",
        "requires all moving atoms to be in bodies of this fix, and 2 that fix 2 (nvt) moves are not",
        ("fix 1 water gear/quat molecule", "fix 1 all gear/quat molecule points ions"),
        ("fix 2 ions nvt temp 300 300 100\n", ""),
    ),
    "rods under shear": (
        MIXED
        + """
change_box all triclinic
fix 1 rods rigid/nvt/small molecule temp 1.0 1.0 0.5
fix 2 fluid nvt/sllod temp 1.0 1.0 0.5
fix 3 all deform 1 xy erate 0.05 remap v
thermo 50
run 100
""",
        "add keyword tchain 1", ("gear/quat molecule temp 1.0 1.0 0.5", "gear/quat molecule temp 1.0 1.0 0.5 tchain 1"),
    ),
    "masses from a file": (
        BODIES
        + """
fix 1 all rigid/nvt/small molecule infile bodies.txt temp 1.0 1.0 0.5
thermo 50
run 100
""",
    ),
    "nve over all atoms": (
        MIXED
        + RODS
        + """
fix 2 all nve
thermo 50
run 100
""",
        "is also moved by fix 2 (nve); take it out of the group", ("fix 2 all nve", "fix 2 fluid nve"),
    ),
}


# --- scripts with fix shake -----------------------------------------------------------------------


def converted_shake(script):
    """As doc/howto/from_shake.md says: one line replaces fix shake and the integrator of its molecules."""
    _, ID, group, *_ = re.search(r"^fix \S+ \S+ shake.*$", script, re.M)[0].split()
    line = re.search(r"^fix \S+ (?:all|water) (?:nve|nvt|npt).*$", script, re.M)[0]
    _, name, whole, style, *words = line.split()
    new = f"fix {name} {group} gear/quat molecule {' '.join(words)}\n"
    if whole != group and style == "npt":  # the table: ions at constant pressure
        new = f"group rest subtract {whole} {group}\n"
        new += f"fix {name} {whole} gear/quat molecule points rest {' '.join(words)}\n"
    elif whole != group:
        new += f"group rest subtract {whole} {group}\nfix {name}_rest rest {style} {' '.join(words)}\n"
    return re.sub(r"^fix \S+ \S+ shake.*\n", "", script, flags=re.M).replace(f"{line}\n", new)


SHAKE_PAGE = (PAGE.parent / "from_shake.md").read_text()
MADE = "velocity all create 300 4711\nfix s water shake 1e-6 100 0 b 1 a 1\n"
SHAKEN = {
    "water, nve": f"{LIQUID}{MADE}fix n all nve\nthermo 20\nrun 40\n",
    "water and ions, nvt": f"{IONIC}{MADE}fix n all nvt temp 300 300 100\nthermo 20\nrun 40\n",
    "water and ions, npt": f"{IONIC}{MADE}fix n all npt temp 300 300 100 iso 1 1 1000\nthermo 20\nrun 40\n",
}


@pytest.mark.parametrize("kind", SHAKEN)
def test_converted_scripts_of_fix_shake_run(lmp_wheel, kind):
    script, text = SHAKEN[kind], converted_shake(SHAKEN[kind])
    (lmp_wheel.folder / "water.mol").write_text(FILES["water.mol"])
    assert "shake" not in text and text.count("gear/quat") == 1
    before, after = (lmp_wheel.succeed(one).thermo[-1] for one in (script, text))
    assert after["Step"] == before["Step"]
    assert after["E_pair"] == pytest.approx(before["E_pair"], rel=0.05)
    assert after["Temp"][1:] == pytest.approx(before["Temp"][1:], rel=0.3)  # projected by then


# --- all of them ----------------------------------------------------------------------------------


def stops(script, lmp):
    result = lmp.run(script, timeout=300)
    return result, result.errors[0] if result.returncode else ""


@pytest.mark.parametrize("kind", KINDS)
def test_converted_scripts_run(lmp_wheel, kind):
    script, *rest = KINDS[kind]
    for name, text in FILES.items():
        (lmp_wheel.folder / name).write_text(text)
    # fix rigid reads memory that it does not set, which is zero in a new process
    before = replace(lmp_wheel, library=None).run(script, timeout=300)
    assert "nve over" in kind or before.returncode == 0, before.output  # the script itself is right
    text = converted(script)
    assert "rigid" not in re.sub("rigid 1 vz|rigid move", "", text) and "gear/quat" in text
    result, message = stops(text, lmp_wheel)
    if not rest:
        assert not message, result.output
    else:
        expected, *edits = rest
        assert expected in message, result.output
        command = re.search(r'"(variable b atom .*?)" and', message)
        for old, new in edits:
            assert old in text
            text = text.replace(old, new.replace("{command}", command[1].replace("'", '"') if command else ""))
        result, message = stops(text, lmp_wheel)
        assert not message, result.output
    assert len(result.thermo[-1]["Step"]) == len(before.thermo[-1]["Step"]) or "nve over" in kind
    assert np.isfinite(result.thermo[-1]["Temp"]).all() and 0.0 <= result.thermo[-1]["Temp"][-1] < 1e4


def test_every_rule_of_the_program_is_on_the_page():
    assert len(TABLE) == len(rows())
    remarks = " ".join(remark for _, _, remark in TABLE)
    assert all(start in remarks for start in INSTEAD)
