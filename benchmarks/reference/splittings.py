"""Symmetric splittings: kicks by the forces, and between them free flight with exact free rotation.

    kick(s)    velocity += s F / m,   omega_body += s torque_body / I,   places and poses stay
    drift(s)   center += s velocity,  pose and omega_body of a free top after the time s, exactly

One step of size h is kick(b_1 h) drift(a_1 h) kick(b_2 h) ... or begins with a drift; read backwards
it is the same.  The kinetic energy is quadratic in the momenta, so methods of Runge, Kutta and
Nystroem keep their order.  Each kick takes one evaluation of the forces; the last kick of a step
shares its evaluation with the first kick of the next step.

J. Laskar and P. Robutel, Celest. Mech. Dyn. Astron. 80, 39 (2001): SABA4.  S. Blanes et al., Appl. Numer. Math. 68, 58
(2013): ABA(10,6,4).  The free rotation by Jacobi's elliptic functions follows R. van Zon and J. Schofield, Phys. Rev. E 75, 056701 (2007), with the formulas of free_top.py in double
precision: ``FreeRotation``.
"""

from dataclasses import dataclass

import numpy as np
from scipy.special import ellipj, elliprj, ellipkinc

from . import quaternion as qt
from .equations import State


# --- schemes --------------------------------------------------------------------------------------
def symmetric(*half, even):
    """A sequence that reads the same backwards and has the sum 1, from the numbers it begins with.

    The remainder is in the middle: a separate number, or one that occurs there twice (``even``).
    """
    rest = 1.0 - 2.0 * sum(half)
    middle = (rest / 2, rest / 2) if even else (rest,)
    return (*half, *middle, *reversed(half))


@dataclass(frozen=True)
class Splitting:
    """Parts of a step: ``kicks`` and ``drifts`` in turn. There is one more of the kind that comes first."""

    label: str
    order: int
    drifts: tuple
    kicks: tuple

    @property
    def stages(self):
        """Evaluations of the forces in a step."""
        return min(len(self.kicks), len(self.drifts))

    @property
    def parts(self):
        """Parts in their order: (whether it is a kick, part of the step)."""
        first = len(self.kicks) > len(self.drifts)
        longer, other = (self.kicks, self.drifts) if first else (self.drifts, self.kicks)
        found = [(first, longer[0])]
        for own, following in zip(other, longer[1:]):
            found += [(not first, own), (first, following)]
        return found


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
#: for weak forces: errors are small in powers of the forces and of the step, as SABA4 has eps h^8 and eps^2 h^2
SPLITTINGS = (
    Splitting("SABA4, 4 stages", 2, tuple(np.diff([-1, *_NODES, 1]) / 2), tuple(_WEIGHTS / 2)),
    Splitting(
        "ABA(10,6,4), 8 stages",
        4,
        symmetric(
            *(0.03809449742241219545697532230863756534060, 0.1452987161169137492940200726606637497442),
            *(0.2076276957255412507162056113249882065158, 0.4359097036515261592231548624010651844006),
            even=False,
        ),
        symmetric(
            *(0.09585888083707521061077150377145884776921, 0.2044461531429987806805077839164344779763),
            0.2170703479789911017143385924306336714532,
            even=True,
        ),
    ),
)


# --- free rotation --------------------------------------------------------------------------------
class FreeRotation:
    """Exact motion of B free tops; ``moments`` (B, 3).

    Raises ValueError for three equal moments, and for a rotation about a principal axis.  For a
    rotation at a small angle a from the middle axis, the relative error is larger by a factor of 1/a^2.
    """

    def __init__(self, moments):
        self.moments = np.asarray(moments, dtype=np.float64)
        if (np.ptp(self.moments, axis=1) == 0).any():
            raise ValueError("three equal moments of inertia: a top with an axis of its own is required")
        self._rising = np.argsort(self.moments, axis=1, kind="stable")
        even = np.linalg.det(np.eye(3)[self._rising])
        self._parity = np.where(even > 0, 1, -1)

    def _order(self, omega):
        """Axes 1, 2, 3 of the formulas, (B, 3), and the parity of that permutation, (B,)."""
        energies = self.moments * omega**2
        middle = np.take_along_axis(self.moments, self._rising[:, 1:2], axis=1)
        falling = (energies * (middle - self.moments)).sum(axis=1) > 0
        order = np.where(falling[:, None], self._rising[:, ::-1], self._rising)
        return order, np.where(falling, -self._parity, self._parity)

    def _frame(self, momentum, axis):
        """Axes (B, 3, 3), as columns: part of ``axis`` across the momentum, momentum x axis, momentum."""
        z = momentum / np.sqrt((momentum * momentum).sum(axis=1))[:, None]
        y = qt.cross(z, axis)
        y /= np.sqrt((y * y).sum(axis=1))[:, None]
        return np.stack([qt.cross(y, z), y, z], axis=2)

    def __call__(self, rotation, omega, time):
        """Rotation body -> space (B, 3, 3) and omega_body (B, 3) after ``time``."""
        order, parity = self._order(omega)
        i1, i2, i3 = np.take_along_axis(self.moments, order, axis=1).T
        w1, w2, w3 = np.take_along_axis(omega, order, axis=1).T
        # 2T I_3 - L^2 and L^2 - 2T I_1 have the same sign
        near = i1 * w1 * w1 * (i3 - i1) + i2 * w2 * w2 * (i3 - i2)
        far = i2 * w2 * w2 * (i2 - i1) + i3 * w3 * w3 * (i3 - i1)
        if (near * far <= 0).any():
            raise ValueError("a rotation that is not quite about a principal axis is required")
        a1, a2 = np.sqrt(near / (i1 * (i3 - i1))), np.sqrt(near / (i2 * (i3 - i2)))
        a3 = np.copysign(np.sqrt(far / (i3 * (i3 - i1))), w3)
        a2 = np.copysign(a2, parity * (i3 - i1) * a3)
        rate = np.sqrt((i3 - i2) * far / (i1 * i2 * i3))
        m = np.minimum((i2 - i1) * near / ((i3 - i2) * far), 1.0)
        before = np.arctan2(w2 / a2, w1 / a1)
        sn, cn, dn, after = ellipj(ellipkinc(before, m) + rate * time, m)
        turned = np.empty_like(omega)
        np.put_along_axis(turned, order, np.stack([a1 * cn, a2 * sn, a3 * dn], axis=1), axis=1)
        # Pi(n; phi, m) = F(phi, m) + n/3 third(phi): the part F joins the time
        n = -i3 * (i2 - i1) / (i1 * (i3 - i2))
        third = _third(n, after, m) - _third(n, before, m)
        momentum = self.moments * omega
        length = np.sqrt((momentum * momentum).sum(axis=1))
        angle = length / i1 * (time + (i3 - i1) / (i3 * rate) * n / 3 * third)
        axis = np.eye(3)[order[:, 2]]
        there = self._frame(momentum, axis) @ _about_z(angle)
        back = np.swapaxes(self._frame(self.moments * turned, axis), 1, 2)
        return rotation @ (there @ back), turned


def _third(n, phi, m):
    """3 (Pi(n; phi, m) - F(phi, m)) / n by Carlson's integral, continuous in phi."""
    turns = np.rint(phi / np.pi)
    s, c = np.sin(phi - np.pi * turns), np.cos(phi - np.pi * turns)
    found = s**3 * elliprj(c * c, 1 - m * s * s, 1.0, 1 - n * s * s)
    return found + 2 * turns * elliprj(0.0, 1 - m, 1.0, 1 - n) if turns.any() else found


def _about_z(angle):
    """Matrices (B, 3, 3) of rotations about the third axis."""
    matrix, c, s = np.zeros((len(angle), 3, 3)), np.cos(angle), np.sin(angle)
    matrix[:, 0, 0], matrix[:, 0, 1], matrix[:, 1, 0], matrix[:, 1, 1] = c, -s, s, c
    matrix[:, 2, 2] = 1.0
    return matrix


# --- motion ---------------------------------------------------------------------------------------
class Motion:
    """Bodies of a Problem on their way, in double precision.

    ``center``, ``velocity``, ``omega_body`` (B, 3); ``rotation`` (B, 3, 3) body -> space;
    ``evaluations`` of the forces so far.
    """

    def __init__(self, problem):
        self.problem = problem.astype(np.float64)
        start = self.problem.start
        self.center, self.velocity, self.omega_body = start.center, start.velocity, start.omega_body
        self.rotation = qt.rotation_space_body(start.q)
        self.evaluations, self._forces = 0, None
        self._free = FreeRotation(self.problem.bodies.moments)

    def kick(self, time):
        """A kick: the forces act for ``time``; they are evaluated unless they are known from the last kick."""
        bodies = self.problem.bodies
        if self._forces is None:
            _, force, torque = self.problem.forces(self.center, self.rotation)
            self._forces = force / bodies.masses[:, None], torque / bodies.moments
            self.evaluations += 1
        self.velocity = self.velocity + time * self._forces[0]
        self.omega_body = self.omega_body + time * self._forces[1]

    def drift(self, time):
        """Free motion for ``time``."""
        self.center = self.center + time * self.velocity
        self.rotation, self.omega_body = self._free(self.rotation, self.omega_body, time)
        self._forces = None

    def advance(self, splitting, step):
        """One step of a Splitting."""
        for is_kick, part in splitting.parts:
            (self.kick if is_kick else self.drift)(part * step)

    @property
    def state(self):
        """The State now."""
        q = np.array([qt.of_rotation(matrix) for matrix in self.rotation])
        return State(self.center, self.velocity, q, self.omega_body)


def states(problem, time, splitting, steps, every=None):
    """States after every given number of the ``steps`` equal steps to ``time``; default: after the last step.

    Returns a list of (State, evaluations of the forces so far).
    """
    motion, step, found = Motion(problem), float(time) / steps, []
    for number in range(1, steps + 1):
        motion.advance(splitting, step)
        if number % (every or steps) == 0:
            found.append((motion.state, motion.evaluations))
    return found
