"""The scene that every style is tried in: 27 rigid molecules and 8 free atoms, in lj units.

A molecule has four atoms, not in a plane, with bonds, angles, a dihedral and an improper, so that styles that depend on
the topology have an effect; the forces are smooth, and the derivatives of an energy.
"""

import numpy as np
from scipy.spatial.transform import Rotation

MOLECULES, FREE, SIDE = 27, 8, 3.2
#: sites of a molecule: type, place, charge
SITES = (
    (1, (0.0, 0.0, 0.0), -0.3),
    (2, (0.5, 0.1, 0.0), 0.1),
    (2, (-0.1, 0.45, 0.1), 0.1),
    (3, (-0.1, -0.1, 0.55), 0.1),
)
MASSES = (4.0, 1.0, 2.0, 3.0)
SITE_MASSES = tuple(MASSES[kind - 1] for kind, *_ in SITES)
#: fields of a line in Atoms for an atom style
FORMATS = {
    "full": "{id} {mol} {type} {q} {x}",
    "hybrid full sphere": "{id} {type} {x} {mol} {q} 0.6 {density}",
    "hybrid full sphere dipole": "{id} {type} {x} {mol} {q} 0.6 {density} {mu}",
}
#: sections of topology: atoms of each entry, counted from 1 in each molecule
TOPOLOGY = {
    "bond": ((1, 2), (1, 3), (1, 4)),
    "angle": ((2, 1, 3),),
    "dihedral": ((2, 1, 3, 4),),
    "improper": ((2, 1, 3, 4),),
}


def _atoms():
    """(type, molecule, charge, place, velocity, angular velocity) of all atoms, molecules first."""
    rng = np.random.default_rng(7)
    sites = np.array([place for _, place, _ in SITES])
    arm = sites - SITE_MASSES @ sites / sum(SITE_MASSES)
    atoms = []
    for number, node in enumerate(np.ndindex(3, 3, 3)):
        turned = Rotation.from_quat(np.roll(rng.normal(size=4), -1)).apply(arm)
        velocity, omega = 0.4 * rng.normal(size=3), rng.normal(size=3)
        place = SIDE * (np.array(node) + 0.5) + 0.1 * rng.normal(size=3)
        for (kind, _, charge), r in zip(SITES, turned):
            atoms.append(
                (kind, number + 1, charge, place + r, velocity + np.cross(omega, r), omega)
            )
    for node in np.ndindex(2, 2, 2):
        place = SIDE * (np.array(node) + 1.0) + 0.1 * rng.normal(size=3)
        atoms.append((4, 0, 0.0, place, 0.5 * rng.normal(size=3), np.zeros(3)))
    return atoms


def _numbers(values):
    return " ".join(f"{value:.15g}" for value in values)


def data(atom_style):
    """Text of a data file."""
    atoms, spheres = _atoms(), "sphere" in atom_style
    lines = ["27 molecules and 8 atoms", "", f"{len(atoms)} atoms", "4 atom types"]
    for what, entries in TOPOLOGY.items():
        lines += [f"{MOLECULES * len(entries)} {what}s", f"1 {what} types"]
    lines += [f"0 {3 * SIDE} {axis}lo {axis}hi" for axis in "xyz"]
    if not spheres:
        lines += ["", "Masses", "", *(f"{n + 1} {m}" for n, m in enumerate(MASSES))]
    lines += ["", f"Atoms # {atom_style}", ""]
    for n, (kind, mol, q, x, _, _) in enumerate(atoms):
        words = {"id": n + 1, "mol": mol, "type": kind, "q": q, "x": _numbers(x)}
        words["density"] = MASSES[kind - 1] / (np.pi / 6 * 0.6**3)
        words["mu"] = _numbers((0.3 * np.cos(n), 0.3 * np.sin(n), 0.1))
        lines.append(FORMATS[atom_style].format(**words))
    lines += ["", "Velocities", ""]
    for n, (*_, v, omega) in enumerate(atoms):
        lines.append(f"{n + 1} {_numbers([*v, *omega] if spheres else v)}")
    for what, entries in TOPOLOGY.items():
        lines += ["", f"{what.capitalize()}s", ""]
        ids = np.concatenate([np.array(entries) + 4 * m for m in range(MOLECULES)])
        lines += [f"{n + 1} 1 {' '.join(map(str, row))}" for n, row in enumerate(ids)]
    return "\n".join(lines) + "\n"


def file_name(atom_style):
    return "data." + atom_style.replace(" ", "_")


def write_files(folder):
    """All data files, into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    for style in FORMATS:
        (folder / file_name(style)).write_text(data(style))
    rows = [f"{n + 1} {_numbers(atom[3] + 0.5)}\n" for n, atom in enumerate(_atoms())]
    (folder / "target").write_text("".join(rows))  # for fix tmd


PAIR = "lj/charmmfsw/coul/charmmfsh"
FORCES = f"""pair_style {PAIR} 2.0 3.0
pair_coeff * * 0.3 0.9
bond_style harmonic
bond_coeff 1 50.0 0.5
angle_style harmonic
angle_coeff 1 20.0 100.0
dihedral_style harmonic
dihedral_coeff 1 1.0 1 2
improper_style harmonic
improper_coeff 1 1.0 30.0""".splitlines()


def begin(atom_style="full"):
    """Lines that make the scene; no fix yet."""
    return [
        "units lj",
        f"atom_style {atom_style}",
        "atom_modify map yes",
        *(["comm_modify vel yes"] if "sphere" in atom_style else []),
        *(line for line in FORCES if "_coeff" not in line),
        f"read_data {file_name(atom_style)}",
        *after_restart(),
    ]


def after_restart():
    """Lines that follow read_data or read_restart: settings that restart files do not contain."""
    return [
        *FORCES,
        "neighbor 0.4 bin",
        "neigh_modify every 1 delay 0 check yes exclude molecule/intra all",
        "group bodies type 1 2 3",
        "group free type 4",
    ]
