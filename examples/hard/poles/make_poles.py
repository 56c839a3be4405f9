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

EXAMPLES = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(EXAMPLES / "common"), str(EXAMPLES / "top")]
from make_scenes import cross, matmul, matvec, numbers  # noqa: E402
from make_top import rotation_space_from_body  # noqa: E402

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
MASS = {1: 3.0, 2: 2.0, 3: 1.0, 4: 1.0}
# fixed spheres around it, symmetric in y
CAGE = (
    (1.0, (4.5, 2.0, 0.5)),
    (1.0, (4.5, -2.0, 0.5)),
    (-1.0, (-4.0, 2.5, 1.0)),
    (-1.0, (-4.0, -2.5, 1.0)),
    (-1.5, (0.5, 0.0, 5.0)),
    (1.5, (-0.5, 0.0, -5.0)),
)
ONE = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
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
    frame = rotation_space_from_body() if turned else ONE
    rotation = matmul(frame, rotation)
    omega, velocity = matvec(frame, omega), matvec(frame, velocity)
    lines = ["LAMMPS data file: %s%s (make_poles.py)" % (pose, ", turned" * turned), ""]
    lines += ["%d atoms" % (len(SITES) + len(CAGE)), "4 atom types", ""]
    lines += ["%g %g %slo %shi" % (-BOX_HALF_LENGTH, BOX_HALF_LENGTH, a, a) for a in "xyz"]
    lines += ["", "Masses", "", *("%d %g" % item for item in MASS.items()), "", "Atoms # full", ""]
    velocities = []
    for tag, (kind, charge, site) in enumerate(SITES, start=1):
        arm = matvec(rotation, site)
        lines.append("%d 1 %d %g %s" % (tag, kind, charge, numbers(arm)))
        around = cross(omega, arm)
        velocities.append([v + w for v, w in zip(velocity, around)])
    for tag, (charge, place) in enumerate(CAGE, start=len(SITES) + 1):
        lines.append("%d 0 4 %g %s" % (tag, charge, numbers(matvec(frame, place))))
        velocities.append((0.0, 0.0, 0.0))
    lines += ["", "Velocities", ""]
    lines += ["%d %s" % (tag, numbers(v)) for tag, v in enumerate(velocities, start=1)]
    return "\n".join(lines) + "\n"


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {
        "hard/poles/data.%s%s" % (pose, "-turned" * turned): data_file(pose, turned)
        for pose in POSES
        for turned in (False, True)
    }


def main(folder):
    """Write all files below ``folder``."""
    for name, text in scene_files().items():
        path = Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(path)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else EXAMPLES)
