#!/usr/bin/env python3
"""Write data.top: a free asymmetric top that tumbles near its intermediate axis.

    python make_top.py [FOLDER]

writes ``top/data.top`` below FOLDER (default: the examples folder this program lies in).  Two sites
on each principal axis, with the center of mass at the origin, have principal moments 39/2, 15 and
15/2.  The top spins about the intermediate axis, but for a little; it does not move otherwise.

Units: lj.  Frames: ``body`` (principal axes), ``space``.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "common"))
from data_files import cross, cube, data_text, dot, general_rotation, matvec, write  # noqa: E402

SITE_MASS = (1.0, 2.0, 1.0, 2.0, 1.0, 2.0)
SITE_BODY = (
    (1.0, 0.0, 0.0), (-0.5, 0.0, 0.0),
    (0.0, 2.0, 0.0), (0.0, -1.0, 0.0),
    (0.0, 0.0, 3.0), (0.0, 0.0, -1.5),
)  # fmt: skip
OMEGA_BODY = (0.02, 1.0, 0.01)

BOX_HALF_LENGTH = 10.0


def moments():
    """Principal moments, largest first."""
    x, y, z = (dot(SITE_MASS, [c * c for c in axis]) for axis in zip(*SITE_BODY))
    return (y + z, x + z, x + y)


def data_file():
    """Text of a LAMMPS data file, atom style full: one molecule of six atoms."""
    space_from_body = general_rotation()
    omega_space = matvec(space_from_body, OMEGA_BODY)
    positions = [matvec(space_from_body, site) for site in SITE_BODY]
    velocities = [cross(omega_space, x) for x in positions]
    atoms = [(1, mass, 0.0, x) for mass, x in zip(SITE_MASS, positions)]
    title = "a free asymmetric top (make_top.py)"
    return data_text(title, cube(BOX_HALF_LENGTH), (1.0, 2.0), atoms, velocities)


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {"top/data.top": data_file()}


if __name__ == "__main__":
    write(scene_files())
