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

EXAMPLES = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(EXAMPLES / "common"), str(EXAMPLES / "top")]
from make_scenes import cross, matvec, numbers  # noqa: E402
from make_top import rotation_space_from_body  # noqa: E402

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
    rotation = rotation_space_from_body()
    omega = matvec(rotation, omega_body)
    masses = sorted({mass for mass, _ in sites})
    lines = ["LAMMPS data file: %s (make_inertia.py)" % body, ""]
    lines += ["%d atoms" % len(sites), "%d atom types" % len(masses), ""]
    lines += ["%g %g %slo %shi" % (-BOX_HALF_LENGTH, BOX_HALF_LENGTH, a, a) for a in "xyz"]
    lines += ["", "Masses", ""]
    lines += ["%d %.17g" % pair for pair in enumerate(masses, start=1)]
    lines += ["", "Atoms # full", ""]
    velocities = []
    for tag, (mass, site) in enumerate(sites, start=1):
        arm = matvec(rotation, site)
        lines.append("%d 1 %d 0 %s" % (tag, masses.index(mass) + 1, numbers(arm)))
        velocities.append([v + w for v, w in zip(VELOCITY, cross(omega, arm))])
    lines += ["", "Velocities", ""]
    lines += ["%d %s" % (tag, numbers(v)) for tag, v in enumerate(velocities, start=1)]
    return "\n".join(lines) + "\n"


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    return {"hard/inertia/data.%s" % body: data_file(body) for body in BODIES}


def main(folder):
    """Write all files below ``folder``."""
    for name, text in scene_files().items():
        path = Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="ascii")
        print(path)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else EXAMPLES)
