"""The paper's body and its starts, from Tables 3 to 6 and the notes on the paper.

Two readings of the same start: ``consistent``, a real rigid body whose principal axes are tilted by
5.6 degrees against the axes the Euler angles turn; ``unrotated``, the principal moments taken along
those axes themselves.  Units: lj.
"""

import numpy as np

from . import quaternion as qt
from .equations import Problem, RigidBodies, State, inertia_tensors
from .fields import Cage

BODIES = ("consistent", "unrotated")
SITE_MASSES = (2, 2, 10, 50)
SITES = ((3, -4, 0), (-3, -4, 0), (0, 0, 0), (0, 0, 12))
EULER_DEGREES = (40, 100, 85)  # phi, psi, theta

#: case -> center of mass, velocity, omega_body in units of pi; as text, so that any float type
#: takes the decimal number itself and not its neighbor in double precision
STARTS = {
    1: (("84", "0", "0"), ("0.2", "0", "0"), ("0.00625", "-0.0125", "0.00625")),
    3: (("70", "0", "0"), ("0", "0", "0"), ("0.01", "-0.02", "0.01")),
}
STARTS[2] = STARTS[1]

_PI = "3.14159265358979323846264338327950288419717"


def _principal_frame(masses, sites):
    """Moments (3,), and axes (3, 3) as columns, in the order of the paper's list.

    The body is symmetric in x: one moment is I_xx, the others follow from a turn about x.
    """
    tensor = inertia_tensors(masses, sites, [0])[0]
    half = (tensor[1, 1] - tensor[2, 2]) / 2
    mean = (tensor[1, 1] + tensor[2, 2]) / 2
    root = np.hypot(half, tensor[1, 2])
    tilt = np.arctan2(tensor[1, 2], half) / 2
    one, zero, c, s = tilt * 0 + 1, tilt * 0, np.cos(tilt), np.sin(tilt)
    axes = np.array([[one, zero, zero], [zero, c, -s], [zero, s, c]])
    # product of the two moments from the determinant: the difference would lose digits
    determinant = tensor[1, 1] * tensor[2, 2] - tensor[1, 2] ** 2
    return np.array([tensor[0, 0], mean + root, determinant / (mean + root)]), axes


def quaternion_of_euler(phi, psi, theta):
    """Eq. 2; angles in radians.  Shape (4,)."""
    half_difference, half_sum = (phi - psi) / 2, (phi + psi) / 2
    s, c = np.sin(theta / 2), np.cos(theta / 2)
    vector = [s * np.cos(half_difference), s * np.sin(half_difference), c * np.sin(half_sum)]
    return np.array([*vector, c * np.cos(half_sum)])


def paper_problem(case=1, body="consistent", dtype=np.longdouble):
    """The Problem of test case 1, 2 or 3 in the cage; ``body`` is consistent or unrotated."""
    if case not in STARTS or body not in BODIES:
        raise ValueError(f"the case is 1, 2 or 3 and the body one of {BODIES}: not {case}, {body}")
    masses, sites = np.array(SITE_MASSES, dtype=dtype), np.array(SITES, dtype=dtype)
    sites = sites - (masses[:, None] * sites).sum(axis=0) / masses.sum()
    moments, axes = _principal_frame(masses, sites)
    pi = dtype(_PI)
    q = quaternion_of_euler(*(pi * degrees / 180 for degrees in EULER_DEGREES))
    if body == "consistent":
        sites = (sites[:, :, None] * axes).sum(axis=1)
        q = qt.product(q, qt.of_rotation(axes))
    center, velocity, turns = (np.array([dtype(t) for t in row]) for row in STARTS[case])
    shapes = RigidBodies(np.zeros(4, dtype=int), masses.sum()[None], moments[None], sites)
    start = State(center[None], velocity[None], q[None], pi * turns[None])
    return Problem(f"case {case}, {body} body", shapes, Cage(dtype), start)
