"""Rigid bodies with spheres, ellipsoids, lines, triangles and dipoles, and what they amount to."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

DECK = """
units lj
atom_style {style}
atom_modify map array sort 0 0.0
dimension {dimension}
boundary {boundary}
newton on
region box block {box}
create_box 2 box
{atoms}
{masses}
{before}
fix move all gear/quat {fix}
fix_modify move energy yes
{after}
timestep {dt:.17g}
thermo_style custom step pe f_move[1] f_move[2]
thermo_modify norm no format float %.17g lost error
thermo {steps}
{outputs}
dump poses all custom {steps} {dump} {columns}
dump_modify poses sort id format float %.17g
{run}
"""

# what an atom style needs to dump, and what its points need so that they are points
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


def rotation(axis, degrees: float) -> np.ndarray:
    """Matrix that turns by ``degrees`` about ``axis``, shape (3, 3)."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.deg2rad(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def matrix(wxyz) -> np.ndarray:
    """Rotation matrix body -> space of a quaternion, scalar first."""
    w, v = wxyz[0], np.array(wxyz[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross


@dataclass
class Atom:
    """A site; ``commands`` shape atom {i}, ``moments`` and ``turn`` are those of its own frame."""

    x: tuple
    mass: float
    commands: str = ""
    moments: tuple = (0.0, 0.0, 0.0)
    turn: np.ndarray = field(default_factory=lambda: np.eye(3))
    charge: float = 0.0
    kind: int = 1

    @property
    def inertia(self) -> np.ndarray:
        """Tensor about its own centre, space frame, shape (3, 3)."""
        return self.turn @ np.diag(self.moments) @ self.turn.T


AXIS, TURN = (1.0, -2.0, 0.5), 70.0


def quat(axis, degrees: float) -> str:
    """Words of ``set quat``, which takes the axis as it is."""
    unit = np.array(axis) / np.linalg.norm(axis)
    return "quat " + " ".join(f"{c:.17g}" for c in unit) + f" {degrees:.17g}"


def sphere(x, mass, radius):
    commands = f"set atom {{i}} diameter {2 * radius:.17g}\nset atom {{i}} mass {mass:.17g}"
    return Atom(x, mass, commands, (0.4 * mass * radius**2,) * 3)


def ellipsoid(x, mass, axes, axis=AXIS, degrees=TURN):
    a, b, c = np.array(axes) ** 2
    commands = (
        "set atom {i} shape " + " ".join(f"{2 * s:.17g}" for s in axes) + f"\n"
        f"set atom {{i}} mass {mass:.17g}\n"
        f"set atom {{i}} {quat(axis, degrees)}"
    )
    moments = tuple(mass / 5 * np.array([b + c, a + c, a + b]))
    return Atom(x, mass, commands, moments, rotation(axis, degrees))


def triangle(x, mass, side, axis=AXIS, degrees=TURN):
    """Equilateral."""
    commands = (
        f"set atom {{i}} tri {side:.17g}\nset atom {{i}} mass {mass:.17g}\n"
        f"set atom {{i}} {quat(axis, degrees)}"
    )
    plane = mass * side**2 / 24
    return Atom(x, mass, commands, (plane, plane, 2 * plane), rotation(axis, degrees))


def line(x, mass, length, degrees):
    commands = (
        f"set atom {{i}} length {length:.17g}\nset atom {{i}} theta {degrees}\n"
        f"set atom {{i}} mass {mass:.17g}"
    )
    moment = mass * length**2 / 12
    return Atom(x, mass, commands, (0.0, moment, moment), rotation((0, 0, 1), degrees))


def equivalent_points(atom: Atom) -> list[Atom]:
    """Six points of the same mass, centre and tensor of inertia."""
    moments = np.array(atom.moments)
    second = moments.sum() / 2 - moments
    arms = np.sqrt(np.maximum(3 * second / atom.mass, 0.0))
    return [
        Atom(tuple(np.array(atom.x) + sign * arms[k] * atom.turn[:, k]), atom.mass / 6)
        for k in range(3)
        for sign in (1, -1)
    ]


def inertia(atoms: list[Atom]) -> np.ndarray:
    """Tensor of a body about its centre of mass, shape (3, 3)."""
    centre = sum(a.mass * np.array(a.x) for a in atoms) / sum(a.mass for a in atoms)
    total = np.zeros((3, 3))
    for a in atoms:
        arm = np.array(a.x) - centre
        total += a.inertia + a.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return total


def moving(style: str, atoms: list[Atom], omega, velocity=(0, 0, 0)) -> tuple[str, str]:
    """Commands that make the atoms of one body, moving as such, and those for masses by type."""
    _, columns, point = STYLES[style]
    centre = sum(a.mass * np.array(a.x) for a in atoms) / sum(a.mass for a in atoms)
    lines = []
    for i, a in enumerate(atoms, 1):
        lines.append(f"create_atoms {a.kind} single " + " ".join(f"{c:.17g}" for c in a.x))
    for i, a in enumerate(atoms, 1):
        lines.append((a.commands or point).format(i=i, m=a.mass))
        v = np.array(velocity) + np.cross(omega, np.array(a.x) - centre)
        lines.append(f"set atom {i} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g}")
        if a.charge:
            lines.append(f"set atom {i} charge {a.charge:.17g}")
        if any(a.moments):
            word, rate = ("omega", omega)
            if "angmom" in columns:
                word, rate = ("angmom", a.inertia @ omega)
            lines.append(f"set atom {i} {word} " + " ".join(f"{w:.17g}" for w in rate))
    kinds = {a.kind: a.mass for a in atoms}
    masses = "\n".join(f"mass {k} {kinds.get(k, 1.0):.17g}" for k in (1, 2))
    return "\n".join(lines), masses if "dipole" in style else ""


def deck(style, atoms, masses="", columns="", before="", after="", **settings) -> str:
    """A deck of bodies in a box; settings: those of DECK."""
    outputs, own_columns, _ = STYLES[style]
    chosen = dict(
        style=style,
        atoms=atoms,
        masses=masses,
        outputs=outputs,
        columns=f"id x y z vx vy vz {own_columns} {columns}",
        before="pair_style zero 2.0\npair_coeff * *\n" + before,
        after=after,
        dimension=3,
        boundary="f f f",
        box="-20 20 -20 20 -20 20",
        fix="single",
        dt=0.005,
        steps=400,
        dump="poses.dump",
        run="run {steps}",
    )
    if settings.get("dimension") == 2:
        chosen |= dict(boundary="f f p", box="-20 20 -20 20 -0.5 0.5")
    chosen |= settings
    chosen["run"] = chosen["run"].format(**chosen)
    return DECK.format(**chosen)
