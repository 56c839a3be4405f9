#!/usr/bin/env python3
"""Write the data files of examples/hard/poles: a body whose Euler angle theta is 0 or pi.

    python make_poles.py [FOLDER]

writes ``hard/poles/data.POSE`` and ``hard/poles/data.POSE-turned`` below FOLDER (default: the
examples folder this program is in) for three starts:

    upright    theta = 0: the third principal axis is the z axis of space
    inverted   theta = pi: the same turned by half a turn about x
    passing    turned by 53 degrees about y and turning about y: body and cage are symmetric in y,
               so that theta goes through pi and 0 exactly, again and again; y is the body's first
               axis, because a turn about the second one would not be stable

"turned" is the whole scene, cage, body and velocities, turned by one rotation about a general axis.

Units: lj.  Frames: ``body`` (principal axes), ``space``.
"""

import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "common"))
from data_files import (  # noqa: E402
    ONE, add, cross, cube, data_text, general_rotation, matmul, matvec, write,
)  # fmt: skip

# moments are largest about y, smallest about z; the heaviest site makes the third axis point to +z
SITES = (
    # type, charge, position in the body
    (1, 1.0, (0.0, 0.0, 1.0)),
    (2, -1.0, (0.0, 0.0, -1.5)),
    (3, 0.3, (0.7, 0.0, 0.0)),
    (3, -0.3, (-0.7, 0.0, 0.0)),
    (3, 0.0, (0.0, 0.4, 0.0)),
    (3, 0.0, (0.0, -0.4, 0.0)),
)
MASSES = (3.0, 2.0, 1.0, 1.0)
# fixed spheres around it, symmetric in y
CAGE = (
    (1.0, (4.5, 2.0, 0.5)),
    (1.0, (4.5, -2.0, 0.5)),
    (-1.0, (-4.0, 2.5, 1.0)),
    (-1.0, (-4.0, -2.5, 1.0)),
    (-1.5, (0.5, 0.0, 5.0)),
    (1.5, (-0.5, 0.0, -5.0)),
)
HALF_TURN = ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
ABOUT_Y = ((0.6, 0.0, 0.8), (0.0, 1.0, 0.0), (-0.8, 0.0, 0.6))
# pose: axes of the body in space, angular velocity and velocity in space
POSES = {
    "upright": (ONE, (0.7, -0.4, 0.3), (0.1, 0.05, -0.1)),
    "inverted": (HALF_TURN, (0.7, -0.4, 0.3), (0.1, 0.05, -0.1)),
    "passing": (ABOUT_Y, (0.0, 1.5, 0.0), (0.0, 0.0, 0.0)),
}
BOX_HALF_LENGTH = 100.0


def data_file(pose, turned):
    """Text of a LAMMPS data file, atom style full: molecule 1 is the body, 0 the cage."""
    rotation, omega, velocity = POSES[pose]
    frame = general_rotation() if turned else ONE
    rotation = matmul(frame, rotation)
    omega, velocity = matvec(frame, omega), matvec(frame, velocity)
    atoms = [(1, kind, charge, matvec(rotation, site)) for kind, charge, site in SITES]
    velocities = [add(velocity, cross(omega, arm)) for *_, arm in atoms]
    atoms += [(0, 4, charge, matvec(frame, place)) for charge, place in CAGE]
    velocities += [(0.0, 0.0, 0.0)] * len(CAGE)
    title = "%s%s (make_poles.py)" % (pose, ", turned" * turned)
    return data_text(title, cube(BOX_HALF_LENGTH), MASSES, atoms, velocities)


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {
        "hard/poles/data.%s%s" % (pose, "-turned" * turned): data_file(pose, turned)
        for pose in POSES
        for turned in (False, True)
    }


if __name__ == "__main__":
    write(scene_files())
