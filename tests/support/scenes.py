"""Simulations used by several tests of the fix: two small molecules, and boxes of rigid water."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from support.running import EXAMPLES

FORMULATIONS = ["momentum", "second", "first"]

# Two rigid triangles in a box without forces: for tests of commands and life cycles.
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


# Bodies in an empty box; forces on them are in {before} and {after}.
PLACED = """
units {units}
atom_style {style}
atom_modify map array sort 0 0.0
dimension {dimension}
boundary {boundary}
region box block {box}
create_box 2 box {room}
{atoms}
{masses}
pair_style zero 3.0
pair_coeff * *
neigh_modify every 1 delay 0 check yes {exclude}
{before}
fix move {group} {fix}
{after}
timestep {dt}
thermo_style custom step {energies} {columns}
thermo_modify norm no format float %.17g
thermo {thermo}
dump poses all custom {steps} {dump} id xu yu zu vx vy vz {dumped}
dump_modify poses sort id format float %.17g
{run}
"""


def empty_box(atoms: str, steps=100, **settings) -> str:
    """A deck of bodies made by the commands ``atoms``; settings: as in PLACED."""
    known = dict(units="lj", style="molecular", dimension=3, boundary="f f f", group="all")
    known |= dict(box="-20 20 -20 20 -20 20", room="", masses="mass * 1.0", before="", after="")
    known |= dict(fix="gear/quat molecule", dt=0.01, thermo=steps, columns="", run=f"run {steps}")
    known |= dict(exclude="exclude molecule/intra all", dump="poses.dump", dumped="")
    known |= dict(energies="time pe ke etotal") | settings
    if known["fix"].startswith("gear/quat"):
        known["after"] = "fix_modify move energy yes\n" + known["after"]
        known["columns"] += " f_move[1] f_move[2]"
    return PLACED.format(atoms=atoms, steps=steps, **known)


def placed(bodies, velocities=(), kinds=None, molecules=None, **settings) -> str:
    """A deck with bodies whose sites are in rows of three numbers.

    ``velocities``: a row for each atom, ``kinds``: its type, ``molecules``: an ID for each body;
    settings: as in empty_box.
    """
    lines, count = [], 0
    for k, sites in enumerate(bodies):
        for x, y, z in sites:
            count += 1
            kind = kinds[count - 1] if kinds else 1
            lines.append(f"create_atoms {kind} single {x:.17g} {y:.17g} {z:.17g}")
        ID = molecules[k] if molecules else k + 1
        lines.append(f"set atom {count - len(sites) + 1}*{count} mol {ID}")
    for i, (x, y, z) in enumerate(velocities, 1):
        lines.append(f"set atom {i} vx {x:.17g} vy {y:.17g} vz {z:.17g}")
    return empty_box("\n".join(lines), **settings)


# SPC/E; dense enough to migrate and collide, with a smooth cutoff so that rounding errors stay small. The list has all
# pairs: without the exclusion, the internal forces of a molecule would add rounding errors.
WATER = """
units {units}
atom_style full
newton {newton}
processors {processors}
comm_style {comm}
read_data {data}
{pair}
neighbor {skin} bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
atom_modify sort 0 0.0
timestep {dt}
{before}
fix move all {fix}
{after}
thermo_style custom step temp pe ke etotal press {columns}
thermo_modify norm no format float %.17g
thermo {thermo}
dump poses all custom {steps} {dump} id xu yu zu vx vy vz {dumped}
dump_modify poses sort id format float %.17g
{run}
"""
SPCE_PAIRS = """
pair_style lj/charmm/coul/charmm {inner} {outer}
pair_coeff 1 1 {epsilon} {sigma}
pair_coeff 2 2 0.0 1.0
pair_coeff 1 2 0.0 1.0
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


# sites of SPC/E about their center of mass, in the plane y = 0
WATER_MASSES = np.array([15.9994, 1.008, 1.008])
WATER_CHARGES = np.array([-0.8476, 0.4238, 0.4238])
_HALF = np.deg2rad(109.47 / 2)
WATER_SITES = np.array(
    [[0, 0, 0], [np.sin(_HALF), 0, np.cos(_HALF)], [-np.sin(_HALF), 0, np.cos(_HALF)]]
)
WATER_SITES -= WATER_MASSES @ WATER_SITES / WATER_MASSES.sum()


def template(sites, types=(), charges=(), bonds=()) -> str:
    """A file for LAMMPS' command molecule; sites of type 1, and bonds between pairs of them, unless given otherwise."""
    parts = {"Coords": sites, "Types": [[kind] for kind in types or [1] * len(sites)]}
    parts |= {"Charges": [[charge] for charge in charges]} if charges else {}
    parts |= {"Bonds": [[1, *pair] for pair in bonds]} if bonds else {}
    counts = f"{len(sites)} atoms\n" + f"{len(bonds)} bonds\n" * bool(bonds)
    lines = ["rigid body", "", counts]
    for name, rows in parts.items():
        numbered = (" ".join(f"{w:.17g}" for w in (k, *row)) for k, row in enumerate(rows, 1))
        lines += [name, "", *numbered, ""]
    return "\n".join(lines)


# the same molecule for LAMMPS' command molecule
SPCE = template(
    [(0, 0, 0), (0.81649658092772603, 0.57735026918962576, 0), (-0.81649658092772603, 0.57735026918962576, 0)],
    [1, 2, 2], [-0.8476, 0.4238, 0.4238],
)  # fmt: skip
#: a template of a neutral molecule with a dipole moment of 0.3 and three moments of inertia
TRIMER = template([(0, 0, 0), (0.6, 0, 0), (0, 0.7, 0)], [1, 1, 2], [0.5, -0.5, 0])
#: and of the smallest body that rotates
TWO_SITES = template([(0, 0, 0), (1, 0, 0)])


def random_rotation(rng: np.random.Generator) -> np.ndarray:
    """Rotation matrix, shape (3, 3)."""
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return turn * np.linalg.det(turn)


def write_data(path: Path, box: list[str], masses, atoms: list, velocities: list) -> Path:
    """A data file of atom style full.

    ``box``: lines of the header; ``atoms``: rows of molecule, type, charge, position and image flags;
    ``velocities``: rows of three numbers.
    """

    def section(name, rows):
        numbered = (" ".join(f"{w:.17g}" for w in (k, *row)) for k, row in enumerate(rows, 1))
        return ["", name, "", *numbered]

    lines = ["rigid bodies", "", f"{len(atoms)} atoms", f"{len(masses)} atom types", *box]
    lines += section("Masses", [[mass] for mass in masses])
    lines += section("Atoms # full", atoms) + section("Velocities", velocities)
    path.write_text("\n".join(lines) + "\n")
    return path


def water_data(
    path: Path,
    n: int = 3,
    units: str = "real",
    spacing: float = 3.3,
    tilt: float = 0.0,
    shift: float = 0.0,
    factors=(1.0, 1.0, 1.0),
) -> Path:
    """n^3 rigid SPC/E molecules near a lattice, with random orientations and velocities, across all boundaries.

    If shifted by half a spacing (Angstrom), all of them are inside the box; ``factors`` scale its edges and the centers.
    """
    rng = np.random.default_rng(20251121)
    scale = UNITS[units]
    box = np.diag(n * spacing * np.array(factors))  # rows are its vectors
    box[1, 0] = tilt
    charges = WATER_CHARGES * scale["charge"]
    atoms, velocities = [], []
    for molecule, cell in enumerate(np.ndindex(n, n, n), 1):
        center = (np.array(cell) * spacing + shift + rng.uniform(-0.1, 0.1, 3)) * factors
        arms = WATER_SITES @ random_rotation(rng).T
        velocity, spin = rng.normal(size=3) * 0.003, rng.normal(size=3) * 0.01
        x = center + arms
        image = np.floor(x @ np.linalg.inv(box))
        x = (x - image @ box) * scale["length"]
        atoms += np.column_stack([[molecule] * 3, [1, 2, 2], charges, x, image]).tolist()
        speed = (velocity + np.cross(spin, arms)) * scale["length"] / scale["time"]
        velocities += speed.tolist()
    lines = [f"0 {box[k, k] * scale['length']:.17g} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    if tilt:
        lines.append(f"{tilt * scale['length']:.17g} 0 0 xy xz yz")
    masses = [WATER_MASSES[k] * scale["mass"] for k in (0, 1)]
    return write_data(path, lines, masses, atoms, velocities)


def with_bonds(data: Path, *more: str) -> Path:
    """The same molecules with bonds and angles; more: a type and two atoms of each further bond."""
    text = data.read_text()
    oxygens = range(1, int(re.search(r"(\d+) atoms", text)[1]), 3)
    bonds = [*(f"1 {o} {o + k}" for o in oxygens for k in (1, 2)), *more]
    sections = {"bond": bonds, "angle": [f"1 {o + 1} {o} {o + 2}" for o in oxygens]}
    for name, rows in sections.items():
        kinds = len({row.split()[0] for row in rows})
        text = text.replace("\nMasses", f"{len(rows)} {name}s\n{kinds} {name} types\n\nMasses", 1)
        text += "\n".join(["", f"{name.capitalize()}s", "", *(f"{k} {row}" for k, row in enumerate(rows, 1)), ""])
    path = data.with_name(f"{data.name}.bonds")
    path.write_text(text)
    return path


def flat_water_data(path: Path, n: int = 4, spacing: float = 3.3) -> Path:
    """n^2 rigid SPC/E molecules in the plane z = 0, across all boundaries, for `dimension 2`."""
    rng = np.random.default_rng(20251122)
    length = n * spacing
    atoms, velocities = [], []
    for molecule, cell in enumerate(np.ndindex(n, n), 1):
        center = np.array(cell) * spacing + rng.uniform(-0.1, 0.1, 2)
        c, s = np.cos(angle := rng.uniform(0, 2 * np.pi)), np.sin(angle)
        velocity, spin = rng.normal(size=2) * 0.003, rng.normal() * 0.01
        arms = WATER_SITES[:, [0, 2]] @ np.array([[c, s], [-s, c]])
        image = np.floor((center + arms) / length)
        x, v = center + arms - image * length, velocity + spin * arms[:, ::-1] * [-1, 1]
        for k in range(3):
            atoms.append([molecule, 1 + (k > 0), WATER_CHARGES[k], *x[k], 0, *image[k], 0])
            velocities.append([*v[k], 0])
    box = [f"0 {length:.17g} {axis}lo {axis}hi" for axis in "xy"] + ["-0.5 0.5 zlo zhi"]
    return write_data(path, box, WATER_MASSES[:2], atoms, velocities)


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
    columns="",
    pair=SPCE_PAIRS,
    skin=0.9,
    dumped="",
) -> str:
    """A deck; dt in fs for all units, ``columns`` of thermo after the usual columns.

    With other pairs (style and coefficients) and units lj it can be used for any data of atom style full.
    """
    scale = UNITS["real" if units == "lj" else units]
    if fix.startswith("gear/quat"):
        after = "fix_modify move energy yes\n" + after
    pair = pair.format(
        inner=2.7 * scale["length"],
        outer=3.9 * scale["length"],
        epsilon=0.1553 * scale["energy"],
        sigma=3.166 * scale["length"],
    )
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
        columns=columns,
        pair=pair,
        dumped=dumped,
        thermo=thermo or steps,
        dt=f"{dt * scale['time']:.17g}",
        skin=skin * scale["length"],
        run=run.format(steps=steps),
    )


def restarted(deck: str, restart: Path | str) -> str:
    """The same deck with a restart file instead of its data and pair coefficients."""
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
    """Independent decks in a single MPI job, whose start takes longer than a small run."""
    return "\nclear\n".join(decks)


def frames(path: Path) -> dict[int, np.ndarray]:
    """Step -> columns of each frame of a dump, shape (rows, columns), sorted as dumped.

    A last frame that is incomplete is omitted.
    """
    found = {}
    for text in path.read_text().split("ITEM: TIMESTEP\n")[1:]:
        words = text.split()
        rows = re.split("ITEM: (?:ATOMS|ENTRIES).*\n", text)[-1].partition("ITEM:")[0]
        if rows.count("\n") == int(words[words.index("OF") + 2]):
            found[int(words[0])] = np.array([row.split() for row in rows.splitlines()], float)
    return found


def last_frame(path: Path) -> np.ndarray:
    """Columns of the last frame of a dump, shape (rows, columns), sorted as dumped."""
    return list(frames(path).values())[-1]


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of two frames, relative to the largest position and the largest velocity.

    Columns 1 to 3 are positions, 4 to 6 velocities.
    """
    parts = (slice(1, 4), slice(4, 7))
    return max(np.abs((one - other)[:, k]).max() / np.abs(one[:, k]).max() for k in parts)


def largest_change(table, column: str = "Econserve") -> float:
    """Largest change of a column of thermo output from its first value."""
    values = np.array(table[column])
    return np.abs(values - values[0]).max()


def expect(found: np.ndarray, right: np.ndarray, tolerance: float) -> None:
    """Equal within the tolerance, relative to the largest number; numbers 1 % off are not."""
    scale = np.abs(right).max()
    assert np.abs(found - right).max() < tolerance * scale


def last_numbers(path: Path, count: int) -> np.ndarray:
    """The last numbers of a file, such as those written by fix ave/time, shape (count,)."""
    return np.array(path.read_text().split()[-count:], float)


def assigned(values: dict) -> str:
    """Commands that set index variables of a deck; variables persist through `clear`."""
    return "".join(f'variable {k} delete\nvariable {k} index "{v}"\n' for k, v in values.items())


def whole_deck(path: Path) -> str:
    """A scene's deck with its includes expanded and absolute names of files."""
    lines = path.read_text().splitlines()
    included = [whole_deck(path.parent / line.split()[1]) if line.startswith("include ") else line for line in lines]
    return "\n".join(included).replace("../../examples", str(EXAMPLES))


# Three triangles and a dumbbell that attract each other and stay together; there is no cutoff.
MOLECULES = [
    [(0.0, 0.0, 0.0), (0.7, 0.0, 0.1), (0.0, 0.6, 0.2)],
    [(2.0, 0.3, 0.0), (2.5, 0.9, 0.1), (2.6, 0.0, 0.6)],
    [(0.8, 2.0, 0.4), (1.4, 2.3, 0.0), (0.9, 1.9, 1.1)],
    [(1.0, 0.6, -1.6), (1.4, 1.1, -1.8)],
]
BEFORE = """
velocity all create 0.6 4711 loop geom
pair_style lj/cut 40.0
pair_coeff * * 0.3 1.0
"""
