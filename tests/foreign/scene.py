"""The scene that every style is tried in: 27 rigid molecules and 8 free atoms, in lj units.

A molecule has four atoms, not in a plane, with bonds, angles, a dihedral and an improper, so that
styles that look at topology have some to look at; the forces are smooth.
"""

import numpy as np

MOLECULES, FREE, SIDE = 27, 8, 3.2
#: sites of a molecule: type, place, charge
SITES = (
    (1, (0.0, 0.0, 0.0), -0.3),
    (2, (0.5, 0.1, 0.0), 0.1),
    (2, (-0.1, 0.45, 0.1), 0.1),
    (3, (-0.1, -0.1, 0.55), 0.1),
)
MASSES = (4.0, 1.0, 2.0, 3.0)
#: fields of a line in Atoms for an atom style
FORMATS = {
    "full": "{id} {mol} {type} {q} {x}",
    "hybrid full sphere": "{id} {type} {x} {mol} {q} 0.6 {density}",
    "hybrid full sphere dipole": "{id} {type} {x} {mol} {q} 0.6 {density} {mu}",
}


def _rotation(rng):
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _atoms(rng):
    """(type, molecule, charge, place, velocity, angular velocity) of all atoms, molecules first."""
    sites = np.array([place for _, place, _ in SITES])
    masses = np.array([MASSES[kind - 1] for kind, _, _ in SITES])
    arm = sites - masses @ sites / masses.sum()
    nodes = [SIDE * (np.array(n) + 0.5) for n in np.ndindex(3, 3, 3)]
    found = []
    for number, node in enumerate(nodes):
        turned = arm @ _rotation(rng).T
        velocity, omega = 0.4 * rng.normal(size=3), rng.normal(size=3)
        place = node + 0.1 * rng.normal(size=3)
        for (kind, _, charge), r in zip(SITES, turned):
            found.append(
                (kind, number + 1, charge, place + r, velocity + np.cross(omega, r), omega)
            )
    for n in np.ndindex(2, 2, 2):
        place = SIDE * (np.array(n) + 1.0) + 0.1 * rng.normal(size=3)
        found.append((4, 0, 0.0, place, 0.5 * rng.normal(size=3), np.zeros(3)))
    return found


def data(atom_style):
    """Text of a data file."""
    atoms, edge = _atoms(np.random.default_rng(7)), 3 * SIDE
    bonds = [(4 * m + 1, 4 * m + n) for m in range(MOLECULES) for n in (2, 3, 4)]
    angles = [(4 * m + 2, 4 * m + 1, 4 * m + 3) for m in range(MOLECULES)]
    four = [(4 * m + 2, 4 * m + 1, 4 * m + 3, 4 * m + 4) for m in range(MOLECULES)]
    lines = ["27 molecules and 8 atoms", ""]
    lines += [f"{len(atoms)} atoms", f"{len(bonds)} bonds", f"{len(angles)} angles"]
    lines += [f"{len(four)} dihedrals", f"{len(four)} impropers", "4 atom types", "1 bond types"]
    lines += ["1 angle types", "1 dihedral types", "1 improper types"]
    lines += [f"0 {edge} {axis}lo {axis}hi" for axis in "xyz"] + [""]
    if "sphere" not in atom_style:
        lines += ["Masses", "", *(f"{n + 1} {m}" for n, m in enumerate(MASSES)), ""]
    lines += [f"Atoms # {atom_style}", ""]
    for n, (kind, mol, q, x, _, _) in enumerate(atoms):
        density = MASSES[kind - 1] / (np.pi / 6 * 0.6**3)
        mu = f"{0.3 * np.cos(n):.15g} {0.3 * np.sin(n):.15g} 0.1"
        place = " ".join(f"{value:.15g}" for value in x)
        words = {"id": n + 1, "mol": mol, "type": kind, "q": q, "x": place}
        lines.append(FORMATS[atom_style].format(**words, density=density, mu=mu))
    spins = "sphere" in atom_style
    lines += ["", "Velocities", ""]
    for n, (*_, v, omega) in enumerate(atoms):
        values = [*v, *omega] if spins else v
        lines.append(f"{n + 1} " + " ".join(f"{value:.15g}" for value in values))
    for title, entries in (
        ("Bonds", bonds),
        ("Angles", angles),
        ("Dihedrals", four),
        ("Impropers", four),
    ):
        lines += ["", title, ""]
        lines += [f"{n + 1} 1 {' '.join(map(str, e))}" for n, e in enumerate(entries)]
    return "\n".join(lines) + "\n"


def file_name(atom_style):
    return "data." + atom_style.replace(" ", "_")


def write_files(folder):
    """All data files, into ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    for style in FORMATS:
        (folder / file_name(style)).write_text(data(style))
    atoms = _atoms(np.random.default_rng(7))
    rows = [f"{n + 1} {' '.join(map(str, atom[3] + 0.5))}" for n, atom in enumerate(atoms)]
    (folder / "target").write_text("\n".join(rows) + "\n")  # for fix tmd


FORCES = """pair_style lj/charmm/coul/charmm 2.0 3.0
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
    """Lines that follow read_data or read_restart: what no restart file keeps."""
    return [
        *FORCES,
        "neighbor 0.4 bin",
        "neigh_modify every 1 delay 0 check yes exclude molecule/intra all",
        "group bodies type 1 2 3",
        "group free type 4",
    ]
