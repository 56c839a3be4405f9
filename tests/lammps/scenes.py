"""Scenes that several tests of the fix run: two small molecules, and boxes of rigid water."""

from __future__ import annotations

from pathlib import Path

import numpy as np

# Two rigid triangles in a box, no forces: for everything about commands and life cycles.
TWO_MOLECULES = """
units lj
atom_style molecular
atom_modify map array
boundary {boundary}
region box block -10 10 -10 10 -10 10
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 0.0 1.2 0.1
create_atoms 1 single 5.0 5.0 5.0
create_atoms 1 single 6.0 5.0 5.0
create_atoms 1 single 5.0 6.2 5.1
mass 1 1.0
set atom 1*3 mol 1
set atom 4*6 mol 2
velocity all create 1.0 4711 loop geom
pair_style zero 2.0
pair_coeff * *
timestep 0.01
{before}
fix move all gear/quat {fix}
{after}
"""


def two_molecules(fix="molecule", before="", after="run 2", boundary="p p p") -> str:
    return TWO_MOLECULES.format(fix=fix, before=before, after=after, boundary=boundary)


# SPC/E; dense enough to migrate and to collide, cut off smoothly so that rounding stays rounding.
# The list has every pair: without the exclusion the sum of a molecule's own forces is rounding too.
WATER = """
units {units}
atom_style full
newton {newton}
processors {processors}
comm_style {comm}
read_data {data}
pair_style lj/charmm/coul/charmm {inner} {outer}
pair_coeff 1 1 {epsilon} {sigma}
pair_coeff 2 2 0.0 1.0
pair_coeff 1 2 0.0 1.0
neighbor {skin} bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
atom_modify sort 0 0.0
timestep {dt}
{before}
fix move all {fix}
{after}
thermo_style custom step temp pe ke etotal press
thermo_modify norm no format float %.17g
thermo {thermo}
dump poses all custom {steps} {dump} id xu yu zu vx vy vz
dump_modify poses sort id format float %.17g
{run}
"""

# length in Angstrom, mass in g/mol, charge in e, energy in kcal/mol, time in fs -> other units
UNITS = {
    "real": dict(length=1.0, mass=1.0, charge=1.0, energy=1.0, time=1.0),
    "metal": dict(length=1.0, mass=1.0, charge=1.0, energy=0.0433641, time=1.0e-3),
    "si": dict(
        length=1.0e-10, mass=1.66053907e-27, charge=1.602176634e-19, energy=6.9477e-21, time=1e-15
    ),
    "cgs": dict(
        length=1.0e-8, mass=1.66053907e-24, charge=4.803204e-10, energy=6.9477e-14, time=1e-15
    ),
    "electron": dict(length=1.8897261, mass=1.0, charge=1.0, energy=1.5936e-3, time=1.0),
    "micro": dict(
        length=1.0e-4, mass=1.66053907e-12, charge=1.602176634e-7, energy=6.9477e-12, time=1e-9
    ),
    "nano": dict(length=0.1, mass=1.66053907e-6, charge=1.0, energy=6.9477, time=1e-6),
}


def water_data(
    path: Path,
    n: int = 3,
    units: str = "real",
    spacing: float = 3.3,
    tilt: float = 0.0,
    shift: float = 0.0,
) -> Path:
    """n^3 rigid SPC/E molecules near a lattice, turned and thrown at random, over all boundaries.

    Shifted by half a spacing (Angstrom) all of them lie inside of the box.
    """
    rng = np.random.default_rng(20251121)
    scale = UNITS[units]
    half = np.deg2rad(109.47 / 2)
    site = np.array([[0, 0, 0], [np.sin(half), 0, np.cos(half)], [-np.sin(half), 0, np.cos(half)]])
    mass, charge = np.array([15.9994, 1.008, 1.008]), [-0.8476, 0.4238, 0.4238]
    site -= mass @ site / mass.sum()
    box = np.array([n * spacing] * 3)
    atoms, velocities = [], []
    for cell in np.ndindex(n, n, n):
        centre = np.array(cell) * spacing + shift + rng.uniform(-0.1, 0.1, 3)
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        arms = site @ (turn * np.linalg.det(turn)).T
        velocity, spin = rng.normal(size=3) * 0.003, rng.normal(size=3) * 0.01
        for k, arm in enumerate(arms):
            tag = len(atoms) + 1
            x = centre + arm
            image = np.zeros(3, int)
            for axis in (2, 1, 0):  # the box vectors are (L,0,0), (tilt,L,0), (0,0,L)
                image[axis] = np.floor(x[axis] / box[axis])
                x[axis] -= image[axis] * box[axis]
                if axis == 1:
                    x[0] -= image[1] * tilt
                if axis == 0 and tilt:
                    inside = np.floor((x[0] - x[1] / box[1] * tilt) / box[0])
                    x[0] += (image[0] - inside) * box[0]
                    image[0] = inside
            v = (velocity + np.cross(spin, arm)) * scale["length"] / scale["time"]
            x = x * scale["length"]
            atoms.append(
                f"{tag} {tag // 3 + (tag % 3 > 0)} {1 + (k > 0)} {charge[k] * scale['charge']:.17g} "
                + " ".join(f"{c:.17g}" for c in x)
                + " "
                + " ".join(map(str, image))
            )
            velocities.append(f"{tag} " + " ".join(f"{c:.17g}" for c in v))
    lengths = box * scale["length"]
    lines = ["rigid water", "", f"{len(atoms)} atoms", "2 atom types", ""]
    lines += [f"0 {length:.17g} {axis}lo {axis}hi" for axis, length in zip("xyz", lengths)]
    if tilt:
        lines.append(f"{tilt * scale['length']:.17g} 0 0 xy xz yz")
    lines += [
        "",
        "Masses",
        "",
        f"1 {mass[0] * scale['mass']:.17g}",
        f"2 {mass[1] * scale['mass']:.17g}",
    ]
    lines += ["", "Atoms # full", "", *atoms, "", "Velocities", "", *velocities, ""]
    path.write_text("\n".join(lines))
    return path


def flat_water_data(path: Path, n: int = 4, spacing: float = 3.3) -> Path:
    """n^2 rigid SPC/E molecules that lie in the plane z = 0, over all boundaries, for `dimension 2`."""
    rng = np.random.default_rng(20251122)
    half = np.deg2rad(109.47 / 2)
    mass, charge = np.array([15.9994, 1.008, 1.008]), [-0.8476, 0.4238, 0.4238]
    site = np.array([[0, 0], [np.sin(half), np.cos(half)], [-np.sin(half), np.cos(half)]])
    site -= mass @ site / mass.sum()
    length = n * spacing
    atoms, velocities = [], []
    for molecule, cell in enumerate(np.ndindex(n, n), 1):
        centre = np.array(cell) * spacing + rng.uniform(-0.1, 0.1, 2)
        c, s = np.cos(angle := rng.uniform(0, 2 * np.pi)), np.sin(angle)
        velocity, spin = rng.normal(size=2) * 0.003, rng.normal() * 0.01
        for k, arm in enumerate(site @ np.array([[c, s], [-s, c]])):
            tag = len(atoms) + 1
            image = np.floor((centre + arm) / length).astype(int)
            x, v = centre + arm - image * length, velocity + spin * np.array([-arm[1], arm[0]])
            atoms.append(
                f"{tag} {molecule} {1 + (k > 0)} {charge[k]} {x[0]:.17g} {x[1]:.17g} 0 "
                f"{image[0]} {image[1]} 0"
            )
            velocities.append(f"{tag} {v[0]:.17g} {v[1]:.17g} 0")
    lines = ["flat rigid water", "", f"{len(atoms)} atoms", "2 atom types", ""]
    lines += [f"0 {length:.17g} {axis}lo {axis}hi" for axis in "xy"] + ["-0.5 0.5 zlo zhi"]
    lines += ["", "Masses", "", *(f"{k} {mass[k - 1]}" for k in (1, 2))]
    lines += ["", "Atoms # full", "", *atoms, "", "Velocities", "", *velocities, ""]
    path.write_text("\n".join(lines))
    return path


def water(
    data: Path,
    fix="gear/quat molecule",
    dt=0.1,
    steps=100,
    units="real",
    before="",
    after="",
    thermo=None,
    run="run {steps}",
    dump="poses.dump",
    newton="on",
    processors="* * *",
    comm="brick",
) -> str:
    """A deck; dt in fs whatever the units."""
    scale = UNITS[units]
    if fix.startswith("gear/quat"):
        after = "fix_modify move energy yes\n" + after
    return WATER.format(
        units=units,
        data=data,
        fix=fix,
        before=before,
        after=after,
        steps=steps,
        dump=dump,
        newton=newton,
        processors=processors,
        comm=comm,
        thermo=thermo or steps,
        dt=f"{dt * scale['time']:.17g}",
        inner=2.7 * scale["length"],
        outer=3.9 * scale["length"],
        skin=0.9 * scale["length"],
        epsilon=0.1553 * scale["energy"],
        sigma=3.166 * scale["length"],
        run=run.format(steps=steps),
    )


def restarted(deck: str, restart: Path | str) -> str:
    """The same deck that reads a restart file instead of its data and pair coefficients."""
    lines = []
    for line in deck.splitlines():
        if line.startswith("read_data"):
            line = f"read_restart {restart}"
        if not line.startswith(
            ("pair_style", "pair_coeff", "pair_modify", "atom_style", "boundary")
        ):
            lines.append(line)
    return "\n".join(lines)


def one_after_the_other(decks) -> str:
    """Independent decks in one start of MPI, which costs more than a small run does."""
    return "\nclear\n".join(decks)


def last_frame(path: Path) -> np.ndarray:
    """Columns of the last frame of a dump, shape (atoms, columns), sorted as dumped."""
    return np.loadtxt(path.read_text().rpartition("ITEM: ATOMS")[2].splitlines()[1:], ndmin=2)


def whole_deck(path: Path, files=("data", "infile")) -> str:
    """An example's deck with its includes written out and its files named from anywhere."""
    lines = []
    for line in path.read_text().splitlines():
        if line.startswith("include "):
            lines.append(whole_deck(path.parent / line.split()[1], ()))
        else:
            lines.append(line)
    text = "\n".join(lines)
    for name in files:
        text = text.replace(f"index {name}", f"index {path.parent / name}")
    return text
