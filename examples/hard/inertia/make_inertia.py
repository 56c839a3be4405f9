#!/usr/bin/env python3
"""Write the data files of examples/hard/inertia: bodies with small, equal or no moments.

    python make_inertia.py [FOLDER]

writes ``hard/inertia/data.BODY`` below FOLDER (default: the examples folder this program is in):

    thin3, thin6     smallest moment a thousandth, a millionth of the largest, spinning about that
                     axis so fast that each axis has the same energy
    two, three       two and three equal sites in a line: no moment about it
    one              a single site: no moment at all
    ball             three equal moments
    rod, disc        two equal moments, the third smaller, larger
    flat             all sites in a plane

Each is turned by one general rotation.  Units: lj.  Frames: ``body`` (principal axes), ``space``.
"""

import math
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "common"))
from data_files import add, cross, cube, data_text, general_rotation, matvec, write  # noqa: E402

VELOCITY = (0.3, -0.2, 0.1)
SPIN = (0.7, 0.6, 0.5)


def cross_of(x, y, z, masses=(1.0, 1.0, 1.0)):
    """Pairs of sites at +-x, +-y, +-z on the axes, as (mass, site)."""
    sites = []
    for axis, (length, mass) in enumerate(zip((x, y, z), masses)):
        for sign in (1, -1):
            sites.append((mass, tuple(sign * length * (k == axis) for k in range(3))))
    return sites


def thin(ratio):
    """Two heavy sites on the z axis and light ones about it; moments about z to x: ``ratio``."""
    light, wide = 0.05, math.sqrt(20.0 * ratio)
    return cross_of(0.84 * wide, 0.54 * wide, 1.0, (light, light, 1.0))


def spins(ratio):
    """Angular velocity with about the same energy about each axis."""
    return (SPIN[0], SPIN[1], SPIN[0] / math.sqrt(ratio))


# body: sites in the body, angular velocity along its axes
BODIES = {
    "thin3": (thin(1e-3), spins(1e-3)),
    "thin6": (thin(1e-6), spins(1e-6)),
    "two": ([(1.0, (0.0, 0.0, 0.8)), (1.0, (0.0, 0.0, -0.8))], (0.9, 0.0, 0.0)),
    "three": (
        [(1.0, (0.0, 0.0, 0.9)), (1.0, (0.0, 0.0, 0.1)), (1.0, (0.0, 0.0, -1.0))],
        (0.9, 0.0, 0.0),
    ),
    "one": ([(1.0, (0.0, 0.0, 0.0))], (0.0, 0.0, 0.0)),
    "ball": (cross_of(1.0, 1.0, 1.0), SPIN),
    "rod": (cross_of(0.5, 0.5, 1.0), SPIN),
    "disc": (cross_of(1.0, 1.0, 0.4), SPIN),
    "flat": (
        [(2.0, (0.5, 0.0, 0.0)), (1.0, (-1.0, 0.8, 0.0)), (1.0, (-1.0, -0.8, 0.0)),
         (1.0, (1.0, 0.0, 0.0))],
        SPIN,
    ),
}  # fmt: skip
BOX_HALF_LENGTH = 50.0


def data_file(body):
    """Text of a LAMMPS data file, atom style full, a type for each mass."""
    sites, omega_body = BODIES[body]
    rotation = general_rotation()
    omega = matvec(rotation, omega_body)
    masses = sorted({mass for mass, _ in sites})
    atoms = [(1, masses.index(mass) + 1, 0.0, matvec(rotation, site)) for mass, site in sites]
    velocities = [add(VELOCITY, cross(omega, arm)) for *_, arm in atoms]
    title = "%s (make_inertia.py)" % body
    return data_text(title, cube(BOX_HALF_LENGTH), masses, atoms, velocities)


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {"hard/inertia/data.%s" % body: data_file(body) for body in BODIES}


if __name__ == "__main__":
    write(scene_files())
