"""Superposition of many bodies at once: the rotations of reference shapes that fit sites best.

The mass-weighted least-squares rotation follows from a singular value decomposition (W. Kabsch, Acta Cryst. A 34, 827
(1978)), refined by one step of Newton's method.  The refinement is needed for thin bodies: two of their singular values
are small, so the decomposition alone loses as many digits as there are in the ratio of length to width.

Quaternions (B, 4): scalar first, as in the array of the fix; body -> space.
"""

import numpy as np
from scipy.spatial.transform import Rotation


def rotate(q, vectors):
    """Vectors (B, 3) turned by quaternions (B, 4)."""
    return Rotation.from_quat(q, scalar_first=True).apply(vectors)


def shortest_turn(before, after):
    """Quaternions (B, 4) of the shortest rotations between unit vectors ``before`` and ``after`` (B, 3).

    For opposite directions the rotation is half a turn about an axis perpendicular to them.
    """
    scalar = 1.0 + np.einsum("ij,ij->i", before, after)
    vector = np.cross(before, after)
    opposite = scalar < 1e-14
    if opposite.any():
        # perpendicular to the direction: its vector product with the least aligned axis
        far = np.eye(3)[np.argmin(np.abs(before[opposite]), axis=1)]
        vector[opposite], scalar[opposite] = np.cross(before[opposite], far), 0.0
    q = np.column_stack([scalar, vector])
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def superpose(bodies, arms):
    """Quaternions (B, 4), with nonnegative scalar, of the rotations shape -> arms; and residuals (B,).

    ``bodies``: Bodies with the shapes; ``arms`` (n, 3): sites relative to their centers of mass, in the order of
    ``bodies``.  The residual is the largest distance of a site from its position in the rotated shape.

    The angle about the axis of a linear body is undefined; its rotation is the shortest one from the shape.  The rotation
    of a point is the identity.
    """
    shape, mass = bodies.shape, bodies.masses[:, None]
    s = bodies.sum((mass * shape)[:, :, None] * arms[:, None, :])
    u, _, vt = np.linalg.svd(s)
    u[:, :, 2] *= np.linalg.det(u @ vt)[:, None]  # proper
    q = Rotation.from_matrix(np.swapaxes(u @ vt, 1, 2)).as_quat(scalar_first=True)
    linear, point = bodies.linear, bodies.point
    if linear.any():
        axis = bodies.axes[linear, 2]
        # the weighted mean direction of all sites along the axis
        along = np.einsum("bij,bi->bj", s[linear], axis)
        q[linear] = shortest_turn(axis, along / np.linalg.norm(along, axis=1, keepdims=True))
    q[point] = [1.0, 0.0, 0.0, 0.0]
    further = Rotation.from_rotvec(bodies.divided_by_inertia(q, _torque(bodies, q, arms)))
    q = (further * Rotation.from_quat(q, scalar_first=True)).as_quat(scalar_first=True)
    residual = np.linalg.norm(arms - rotate(q[bodies.of], shape), axis=1)
    return np.where(q[:, :1] < 0.0, -q, q), bodies.largest(residual)


def angles(bodies, reference, positions):
    """Angles (..., B) in radians between the poses of bodies at two sets of ``positions`` (..., n, 3).

    ``bodies``: Bodies; their shapes are set to the last reference.  For a linear body it is the angle between its axes, for
    a point 0.
    """
    reference, positions = np.broadcast_arrays(reference, positions)
    turned = np.empty((*positions.shape[:-2], len(bodies)))
    for frame in np.ndindex(positions.shape[:-2]):
        bodies.set_shape(reference[frame])
        arms = positions[frame] - bodies.center(positions[frame])[bodies.of]
        q, _ = superpose(bodies, arms)
        turned[frame] = 2.0 * np.arctan2(np.linalg.norm(q[:, 1:], axis=1), q[:, 0])
    return turned


def _torque(bodies, q, arms):
    """Sums (B, 3), in space, of m (rotated shape x arms); zero at the best fit."""
    # along principal axes, so that the component about a thin body's axis is not a difference of large numbers
    axes = bodies.axes_space(q)
    own = np.einsum("nij,nj->ni", bodies.axes[bodies.of], bodies.shape)
    measured = np.einsum("nij,nj->ni", axes[bodies.of], arms)
    torque = bodies.sum(bodies.masses[:, None] * np.cross(own, measured))
    return np.einsum("bij,bi->bj", axes, torque)
