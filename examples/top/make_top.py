#!/usr/bin/env python3
"""Write data.top: a free asymmetric top that tumbles near its intermediate axis.

    python make_top.py [FOLDER]

writes ``top/data.top`` below FOLDER (default: the examples folder this program lies in).  Two sites
on each principal axis, with the centre of mass at the origin, have principal moments 39/2, 15 and
15/2.  The top spins about the intermediate axis, but for a little; it does not move otherwise.

Units: lj.  Frames: ``body`` (principal axes), ``space``.
"""

import sys
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parent.parent
sys.path.append(str(EXAMPLES / "common"))
from make_scenes import cross, dot, matvec, numbers  # noqa: E402

SITE_MASS = (1.0, 2.0, 1.0, 2.0, 1.0, 2.0)
SITE_BODY = (
    (1.0, 0.0, 0.0), (-0.5, 0.0, 0.0),
    (0.0, 2.0, 0.0), (0.0, -1.0, 0.0),
    (0.0, 0.0, 3.0), (0.0, 0.0, -1.5),
)  # fmt: skip
OMEGA_BODY = (0.02, 1.0, 0.01)
QUATERNION = (4, 1, 2, 3)  # space <- body, scalar first, of length sqrt(30)

BOX_HALF_LENGTH = 10.0


def rotation_space_from_body():
    """Rotation matrix of QUATERNION; its entries are multiples of 1/15."""
    w, x, y, z = QUATERNION
    square = w * w + x * x + y * y + z * z
    rows = (
        (w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z),
    )
    return tuple(tuple(entry / square for entry in row) for row in rows)


def moments():
    """Principal moments, largest first."""
    x, y, z = (dot(SITE_MASS, [c * c for c in axis]) for axis in zip(*SITE_BODY))
    return (y + z, x + z, x + y)


def data_file():
    """Text of a LAMMPS data file, atom style full: one molecule of six atoms."""
    space_from_body = rotation_space_from_body()
    omega_space = matvec(space_from_body, OMEGA_BODY)
    positions = [matvec(space_from_body, site) for site in SITE_BODY]
    velocities = [cross(omega_space, x) for x in positions]
    lines = ["LAMMPS data file: a free asymmetric top (make_top.py)", ""]
    lines += ["%d atoms" % len(positions), "2 atom types", ""]
    lines += ["%g %g %slo %shi" % (-BOX_HALF_LENGTH, BOX_HALF_LENGTH, a, a) for a in "xyz"]
    lines += ["", "Masses", "", "1 1", "2 2", "", "Atoms # full", ""]
    for tag, (mass, x) in enumerate(zip(SITE_MASS, positions), start=1):
        lines.append("%d 1 %d 0 %s" % (tag, mass, numbers(x)))
    lines += ["", "Velocities", ""]
    lines += ["%d %s" % (tag, numbers(v)) for tag, v in enumerate(velocities, start=1)]
    return "\n".join(lines) + "\n"


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {"top/data.top": data_file()}


def main(folder):
    """Write all files below ``folder``."""
    for name, text in scene_files().items():
        path = Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(path)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else EXAMPLES)
