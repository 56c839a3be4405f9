#!/usr/bin/env python3
"""Write the data files of the paper's three test cases.

    python make_scenes.py [FOLDER]

writes ``case1/data.consistent``, ``case1/data.unrotated``, ``case1/infile.unrotated`` and the same
three for case 3 below FOLDER (default: the examples folder this program lies in).  Case 2 starts as
case 1 does and reads the files of case 1.  Standard library only, sums rounded once (``fsum``), so
that the files come out the same to the last digit wherever they are written.

Source: R. M. Pratt and K. M. Bin Mohamad Zaini, "General Algorithms for 3-D Motion of a Non-Planar
Body in a Steady-State Force Field", Tables 3 to 6.  The paper does not print two things:

* the charges of the cage: their pattern here is RECONSTRUCTED.  It reproduces both total energies
  the paper prints (-0.7236 and +3.993); the energies support it without proving it.
* along which axes its principal moments lie, hence two bodies from one start:
  ``consistent``  a real rigid body: moments along the principal axes of the four sites, which are
                  tilted by 5.6 degrees about x against the axes the Euler angles turn;
  ``unrotated``   the same moments along the unrotated axes, as if the sites had been ignored when
                  the tensor was made diagonal.  Only an infile can state such a body.

Units: lj.  Frames: ``site`` (axes in which the sites are listed, origin at the center of mass),
``body`` (principal axes), ``space``.
"""

import math
import sys
from collections import namedtuple
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent))
from data_files import (  # noqa: E402
    add, cross, cube, data_text, diagonal, dot, matmul, matvec, numbers, transpose, write,
)  # fmt: skip

# --- Table 3: the four sites; coordinates from Fig. 1 and the printed inertia tensor -------------
SITE_MASS = (2.0, 2.0, 10.0, 50.0)
SITE_CHARGE = (-0.25, -0.25, -0.5, 1.0)
SITE_TYPE = (1, 1, 2, 3)
SITE_XYZ = ((3.0, -4.0, 0.0), (-3.0, -4.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 12.0))

# --- Tables 3 and 4: atom types; the pair coefficients are in common/in.scene ---------------------
TYPE_MASS = {1: 2.0, 2: 10.0, 3: 50.0, 4: 1.0}
TYPE_COMMENT = {
    1: "spheres 1 and 2",
    2: "sphere 3",
    3: "sphere 4",
    4: "cage (fixed: its mass is never used)",
}
CAGE_TYPE = 4
CAGE_HALF_LENGTH = 100.0

# --- Tables 5 and 6: the starts; angular velocity along the principal axes ------------------------
Start = namedtuple("Start", "center velocity omega_body")
STARTS = {
    "case1": Start(
        (84.0, 0.0, 0.0),
        (0.2, 0.0, 0.0),
        (0.05 * math.pi / 8, -0.05 * math.pi / 4, 0.05 * math.pi / 8),
    ),
    "case3": Start(
        (70.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.08 * math.pi / 8, -0.08 * math.pi / 4, 0.08 * math.pi / 8),
    ),
}
EULER_PHI, EULER_PSI, EULER_THETA = (math.radians(a) for a in (40.0, 100.0, 85.0))

BOX_HALF_LENGTH = 1.0e5


def rotation_space_to_site():
    """Matrix A of Eq. 8 (corrected) for the start's quaternion, Eq. 2 (order: vector, scalar)."""
    half_difference, half_sum = (EULER_PHI - EULER_PSI) / 2, (EULER_PHI + EULER_PSI) / 2
    s, c = math.sin(EULER_THETA / 2), math.cos(EULER_THETA / 2)
    q1, q2 = s * math.cos(half_difference), s * math.sin(half_difference)
    q3, q4 = c * math.sin(half_sum), c * math.cos(half_sum)
    return (
        (2 * (q1 * q1 + q4 * q4) - 1, 2 * (q1 * q2 + q3 * q4), 2 * (q1 * q3 - q2 * q4)),
        (2 * (q1 * q2 - q3 * q4), 2 * (q2 * q2 + q4 * q4) - 1, 2 * (q2 * q3 + q1 * q4)),
        (2 * (q1 * q3 + q2 * q4), 2 * (q2 * q3 - q1 * q4), 2 * (q3 * q3 + q4 * q4) - 1),
    )


def sites_about_center():
    """Site coordinates in the site frame, origin moved to the center of mass."""
    total = math.fsum(SITE_MASS)
    center = [dot(SITE_MASS, axis) / total for axis in zip(*SITE_XYZ)]
    return tuple(tuple(x - c for x, c in zip(site, center)) for site in SITE_XYZ)


def principal_moments_and_axes():
    """Principal moments, largest first, and the rotation site -> body (rows are the axes).

    The body is symmetric in x, so one moment is I_xx and the other two follow from a 2x2 problem.
    """
    x, y, z = zip(*sites_about_center())

    def second(a, b):
        return math.fsum(m * p * q for m, p, q in zip(SITE_MASS, a, b))

    ixx = second(y, y) + second(z, z)
    iyy = second(x, x) + second(z, z)
    izz = second(x, x) + second(y, y)
    iyz = -second(y, z)
    root = math.hypot((iyy - izz) / 2, iyz)
    tilt = math.atan2(2 * iyz, iyy - izz) / 2
    axes = (
        (1.0, 0.0, 0.0),
        (0.0, math.cos(tilt), math.sin(tilt)),
        (0.0, -math.sin(tilt), math.cos(tilt)),
    )
    return (ixx, (iyy + izz) / 2 + root, (iyy + izz) / 2 - root), axes


def cage():
    """Charge and position of the 26 spheres (charges: reconstructed, see above)."""
    spheres = []
    levels = (-1, 0, 1)
    for x, y, z in ((x, y, z) for x in levels for y in levels for z in levels):
        if (x, y, z) == (0, 0, 0):
            continue
        first = next(entry for entry in (z, y, -x) if entry != 0)
        position = tuple(CAGE_HALF_LENGTH * level for level in (x, y, z))
        spheres.append((-1.0 if first > 0 else 1.0, position))
    return spheres


def motion(start, body):
    """Site positions, site velocities, inertia tensor and angular momentum, all in space axes."""
    space_from_site = transpose(rotation_space_to_site())
    moments, body_from_site = principal_moments_and_axes()
    if body == "unrotated":
        body_from_site = diagonal((1.0, 1.0, 1.0))
    space_from_body = matmul(space_from_site, transpose(body_from_site))
    omega_space = matvec(space_from_body, start.omega_body)
    arms = [matvec(space_from_site, site) for site in sites_about_center()]
    positions = [add(start.center, arm) for arm in arms]
    velocities = [add(start.velocity, cross(omega_space, arm)) for arm in arms]
    inertia = matmul(matmul(space_from_body, diagonal(moments)), transpose(space_from_body))
    momentum = matvec(space_from_body, tuple(i * w for i, w in zip(moments, start.omega_body)))
    return positions, velocities, inertia, momentum


def data_file(case, body):
    """Text of a LAMMPS data file, atom style full: the body is molecule 1, atoms 1 to 4."""
    positions, velocities, _, _ = motion(STARTS[case], body)
    atoms = [
        (1, kind, charge, xyz) for kind, charge, xyz in zip(SITE_TYPE, SITE_CHARGE, positions)
    ] + [(0, CAGE_TYPE, charge, xyz) for charge, xyz in cage()]
    velocities = velocities + [(0.0, 0.0, 0.0)] * len(cage())
    title = "%s, %s body; cage charges are reconstructed (make_scenes.py)" % (case, body)
    masses = ["%g  # %s" % (TYPE_MASS[t], TYPE_COMMENT[t]) for t in sorted(TYPE_MASS)]
    return data_text(title, cube(BOX_HALF_LENGTH), masses, atoms, velocities)


def infile(case):
    """Text of an infile, in the format of fix rigid, that states the unrotated body."""
    start = STARTS[case]
    _, _, inertia, momentum = motion(start, "unrotated")
    tensor = (inertia[0][0], inertia[1][1], inertia[2][2],
              inertia[0][1], inertia[0][2], inertia[1][2])  # fmt: skip
    fields = (math.fsum(SITE_MASS),) + start.center + tensor + start.velocity + momentum
    return (
        "# %s, unrotated body: principal moments along the unrotated axes (make_scenes.py)\n"
        "# ID masstotal xcm ycm zcm ixx iyy izz ixy ixz iyz vxcm vycm vzcm lx ly lz ixcm iycm izcm\n"
        "1\n1 %s 0 0 0\n" % (case, numbers(fields))
    )


def scene_files():
    """All files as a dictionary: path below the examples folder -> text."""
    files = {}
    for case in STARTS:
        for body in ("consistent", "unrotated"):
            files["%s/data.%s" % (case, body)] = data_file(case, body)
        files["%s/infile.unrotated" % case] = infile(case)
    return files


if __name__ == "__main__":
    write(scene_files())
