"""Rigid bodies with spheres, ellipsoids, lines, triangles and dipoles, and equivalent points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from support.scenes import empty_box
from scipy.spatial.transform import Rotation

# columns of a dump for each atom style, and settings that make its points pointlike
STYLES = {
    "sphere": ("", "omegax omegay omegaz", "set atom {i} mass {m:.17g}\nset atom {i} diameter 0"),
    "ellipsoid": (
        "compute q all property/atom quatw quati quatj quatk",
        "angmomx angmomy angmomz c_q[1] c_q[2] c_q[3] c_q[4]",
        "set atom {i} mass {m:.17g}",
    ),
    "tri": (
        "compute c all property/atom corner1x corner1y corner1z corner2x corner2y corner2z",
        "angmomx angmomy angmomz c_c[*]",
        "set atom {i} diameter 0\nset atom {i} mass {m:.17g}",
    ),
    "line": (
        "compute c all property/atom end1x end1y end2x end2y",
        "omegax omegay omegaz c_c[*]",
        "set atom {i} diameter 0\nset atom {i} mass {m:.17g}",
    ),
    "hybrid sphere dipole": (
        "",
        "omegax omegay omegaz mux muy muz",
        "set atom {i} mass {m:.17g}\nset atom {i} diameter 0",
    ),
}


def words(*values) -> str:
    """Numbers of a command, with all digits."""
    return " ".join(f"{value:.17g}" for value in values)


def rotation(axis, degrees: float) -> np.ndarray:
    """Matrix that turns by ``degrees`` about ``axis``, shape (3, 3)."""
    unit = np.array(axis) / np.linalg.norm(axis)
    return Rotation.from_rotvec(degrees * unit, degrees=True).as_matrix()


def matrix(wxyz) -> np.ndarray:
    """Rotation matrix body -> space of a quaternion, scalar first."""
    return Rotation.from_quat(wxyz, scalar_first=True).as_matrix()


@dataclass
class Atom:
    """A site; ``commands`` shape atom {i}; ``moments`` and ``turn`` refer to its own frame."""

    x: tuple
    mass: float
    commands: str = ""
    moments: tuple = (0.0, 0.0, 0.0)
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    charge: float = 0.0
    corners: np.ndarray | None = None  # of a triangle in a data file, in space

    @property
    def inertia(self) -> np.ndarray:
        """Tensor about its own center, space frame, shape (3, 3)."""
        return self.turn @ np.diag(self.moments) @ self.turn.T


AXIS, TURN = (1.0, -2.0, 0.5), 70.0


def shaped(x, mass, moments, turn, *shape):
    """An atom with a ``set`` command for each of the words of ``shape``."""
    commands = "\n".join(f"set atom {{i}} {w}" for w in (shape[0], f"mass {words(mass)}", *shape[1:]))
    return Atom(x, mass, commands, moments, turn)


def quat(axis, degrees: float) -> str:
    """Words of ``set quat``, with any axis."""
    return f"quat {words(*(np.array(axis) / np.linalg.norm(axis)), degrees)}"


def sphere(x, mass, radius):
    moments = (0.4 * mass * radius**2,) * 3
    return shaped(x, mass, moments, np.eye(3), f"diameter {words(2 * radius)}")


def ellipsoid(x, mass, axes, axis=AXIS, degrees=TURN):
    a, b, c = np.array(axes) ** 2
    moments = tuple(mass / 5 * np.array([b + c, a + c, a + b]))
    shape = f"shape {words(*(2 * np.array(axes)))}"
    return shaped(x, mass, moments, rotation(axis, degrees), shape, quat(axis, degrees))


def triangle(x, mass, side, axis=AXIS, degrees=TURN):
    """Equilateral."""
    plane = mass * side**2 / 24
    moments = (plane, plane, 2 * plane)
    return shaped(x, mass, moments, rotation(axis, degrees), f"tri {words(side)}", quat(axis, degrees))


def from_corners(corners, density):
    """A triangle of a data file.  Midpoints of edges, with equal weights, give its exact tensor."""
    mass = density * np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])) / 2
    arms = (corners + np.roll(corners, 1, axis=0)) / 2 - corners.mean(axis=0)
    moments, turn = np.linalg.eigh(mass / 3 * sum(arm @ arm * np.eye(3) - np.outer(arm, arm) for arm in arms))
    turn[:, 2] *= np.linalg.det(turn)
    return Atom(tuple(corners.mean(axis=0)), mass, moments=tuple(moments), turn=turn, corners=corners)


def write_triangles(path, atoms, edge):
    """A data file of those atoms that have corners, in a cube around the origin."""
    rows = [atom for atom in atoms if atom.corners is not None]
    densities = [a.mass / np.linalg.norm(np.cross(*(a.corners[1:] - a.corners[0]))) * 2 for a in rows]
    sections = [
        f"triangles\n\n{len(rows)} atoms\n{len(rows)} triangles\n1 atom types",
        "\n".join(f"{-edge} {edge} {axis}lo {axis}hi" for axis in "xyz"),
        "Atoms",
        "\n".join(f"{n} 0 1 1 {words(d, *a.x)}" for n, (a, d) in enumerate(zip(rows, densities), 1)),
        "Triangles",
        "\n".join(f"{n} {words(*a.corners.ravel())}" for n, a in enumerate(rows, 1)),
    ]
    path.write_text("\n\n".join(sections) + "\n")


def line(x, mass, length, degrees):
    moment = mass * length**2 / 12
    moments, turn = (0.0, moment, moment), rotation((0, 0, 1), degrees)
    return shaped(x, mass, moments, turn, f"length {words(length)}", f"theta {degrees}")


def equivalent_points(atom: Atom) -> list[Atom]:
    """Six points of the same mass, center and tensor of inertia."""
    moments = np.array(atom.moments)
    second = moments.sum() / 2 - moments
    arms = np.sqrt(np.maximum(3 * second / atom.mass, 0.0))
    return [
        Atom(tuple(np.array(atom.x) + sign * arms[k] * atom.turn[:, k]), atom.mass / 6)
        for k in range(3)
        for sign in (1, -1)
    ]


def center(atoms: list[Atom]) -> np.ndarray:
    """Center of mass, shape (3,)."""
    return np.average([a.x for a in atoms], axis=0, weights=[a.mass for a in atoms])


def inertia(atoms: list[Atom]) -> np.ndarray:
    """Tensor of a body about its center of mass, shape (3, 3)."""
    total = np.zeros((3, 3))
    for a in atoms:
        arm = a.x - center(atoms)
        total += a.inertia + a.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return total


def body_deck(style: str, atoms: list[Atom], omega, velocity=(0, 0, 0), data="", **settings) -> str:
    """A deck of one rigidly moving body; data: the file of its triangles; settings: as in `deck`."""
    _, columns, point = STYLES[style]
    lines = [f"create_atoms 1 single {words(*a.x)}" for a in atoms if a.corners is None]
    lines += [f"read_data {data} add append"] if data else []
    for i, a in enumerate(atoms, 1):
        if a.corners is None:
            lines.append((a.commands or point).format(i=i, m=a.mass))
        vx, vy, vz = velocity + np.cross(omega, a.x - center(atoms))
        lines.append(f"set atom {i} vx {words(vx)} vy {words(vy)} vz {words(vz)}")
        if a.charge:
            lines.append(f"set atom {i} charge {words(a.charge)}")
        if any(a.moments):
            rate = f"angmom {words(*(a.inertia @ omega))}"
            lines.append(f"set atom {i} {rate if 'angmom' in columns else 'omega ' + words(*omega)}")
    masses = "mass * 1.0" if "dipole" in style else ""
    return deck(style, "\n".join(lines), masses=masses, **settings)


def deck(style, atoms, columns="", fix="single", pair="", before="", after="", **settings) -> str:
    """A deck of bodies in a box; columns: more of the dump, settings: as in scenes.empty_box."""
    outputs, own_columns, _ = STYLES[style]
    # no temperature: a single body has too few degrees of freedom
    known = dict(masses="", exclude="", energies="pe", dt=0.005, steps=400)
    if settings.get("dimension") == 2:
        known |= dict(boundary="f f p", box="-20 20 -20 20 -0.5 0.5")
        after += "\nfix flat all enforce2d"
    known |= settings
    return empty_box(
        atoms,
        style=style,
        fix=f"gear/quat {fix}",
        before=f"{outputs}\n{pair}\n{before}",
        after=after,
        dumped=f"{own_columns} {columns}",
        **known,
    )
