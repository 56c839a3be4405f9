"""Unit quaternions in the paper's order: vector part first, scalar part last; any float type.

``q`` of a body turns space into body axes by the paper's matrix A(q) (Eq. 8, corrected);
``rotation_space_body`` is its transpose, which turns components in body axes into components in
space axes.  All functions work on arrays (..., 4) and (..., 3) and keep their float type.
"""

import numpy as np

_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


def cross(a, b):
    """Vector product of (..., 3) and (..., 3); numpy.cross costs several times as much."""
    return a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]


def product(a, b):
    """Hamilton product a b, shape (..., 4)."""
    u, s, v, t = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = s * v + t * u + cross(u, v)
    scalar = s * t - (u * v).sum(axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)


def conjugate(q):
    """The quaternion of the inverse rotation, of a unit quaternion."""
    return np.concatenate([-q[..., :3], q[..., 3:]], axis=-1)


def normalised(q):
    """q at unit length."""
    return q / np.sqrt((q * q).sum(axis=-1, keepdims=True))


def rotation_space_body(q):
    """Rotation matrices body -> space, shape (..., 3, 3), also of a q whose length is only nearly one.

    Division by |q|^2 keeps the sites rigid whatever the length of q, so a solver without the constraint cannot deform
    the body.
    """
    x, y, z, s = (q[..., k] for k in range(4))
    matrix = np.empty(q.shape[:-1] + (3, 3), dtype=q.dtype)
    xx, yy, zz, ss = x * x, y * y, z * z, s * s
    matrix[..., 0, 0] = xx - yy - zz + ss
    matrix[..., 1, 1] = yy - xx - zz + ss
    matrix[..., 2, 2] = zz - xx - yy + ss
    for i, j, a, b, c in ((0, 1, x, y, z), (1, 2, y, z, x), (0, 2, x, z, -y)):
        matrix[..., i, j] = 2 * (a * b - s * c)
        matrix[..., j, i] = 2 * (a * b + s * c)
    return matrix / (xx + yy + zz + ss)[..., None, None]


def of_rotation(matrix):
    """Quaternion, shape (4,), of one rotation matrix (3, 3) body -> space.

    The largest of the four squares is taken as the pivot, so no digit is lost for any rotation.
    """
    m = np.asarray(matrix)
    squares = [
        1 + m[0, 0] - m[1, 1] - m[2, 2],
        1 + m[1, 1] - m[0, 0] - m[2, 2],
        1 + m[2, 2] - m[0, 0] - m[1, 1],
        1 + m[0, 0] + m[1, 1] + m[2, 2],
    ]
    pivot = int(np.argmax(squares))
    if pivot == 3:
        rest = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]]
    else:
        i, j, k = pivot, _NEXT[pivot], _LAST[pivot]
        rest = [None] * 4
        rest[i], rest[3] = squares[i], m[k, j] - m[j, k]
        rest[j], rest[k] = m[j, i] + m[i, j], m[k, i] + m[i, k]
    return normalised(np.array(rest, dtype=m.dtype))


def angle_between(a, b):
    """Angle of the rotation that carries orientation b into a, shape (...); q and -q are equal."""
    turn = product(conjugate(b), a)
    sine = np.sqrt((turn[..., :3] ** 2).sum(axis=-1))
    return 2 * np.arctan2(sine, np.abs(turn[..., 3]))
