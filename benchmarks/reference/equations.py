"""Equations of motion of B rigid bodies, in any NumPy float type.

Written down from the paper, independent of the fix: state of each body is center of mass and
velocity in space axes, unit quaternion q (paper's order, scalar last) and angular velocity along
the principal axes.  All B bodies are integrated as one array of shape (B, 13).

    x' = v                              v' = F / m
    q' = 1/2 q (omega_body, 0)          (Eq. 5)
    omega_body' = (torque_body - omega_body x I omega_body) / I     (Eq. 12)

Units follow the field (LAMMPS' "units"): ``field.force_to_acceleration`` turns force / mass
into acceleration, ``field.kinetic_to_energy`` turns mass velocity^2 into energy; both are 1 in lj.
"""

from dataclasses import dataclass, fields

import numpy as np

from . import quaternion as qt

#: columns of a packed state (B, 13)
PARTS = {
    "center": slice(0, 3),
    "velocity": slice(3, 6),
    "q": slice(6, 10),
    "omega_body": slice(10, 13),
}
#: a principal moment below this fraction of the largest one counts as zero (as in fix rigid)
NO_INERTIA = 1e-7


@dataclass(frozen=True)
class State:
    """State of B bodies: ``center``, ``velocity`` (B, 3) in space axes, ``q`` (B, 4),
    ``omega_body`` (B, 3) along the principal axes."""

    center: np.ndarray
    velocity: np.ndarray
    q: np.ndarray
    omega_body: np.ndarray

    def packed(self):
        """One array (B, 13)."""
        return np.concatenate([getattr(self, name) for name in PARTS], axis=1)

    @classmethod
    def of(cls, packed):
        """State of a packed array (B, 13)."""
        return cls(*(packed[:, columns] for columns in PARTS.values()))

    def astype(self, dtype):
        """The same state in another float type."""
        return State(*(getattr(self, f.name).astype(dtype) for f in fields(self)))

    @property
    def double(self):
        """The state rounded to float64."""
        return self.astype(np.float64)


def principal_axes(tensors):
    """Moments (B, 3), falling, and axes (B, 3, 3) of symmetric tensors (B, 3, 3).

    Columns of ``axes`` are the axes, right-handed: it turns body components into components in the frame of the
    tensor.  Found by cyclic Jacobi rotations, because LAPACK has double precision at most: errors are a few units in the
    last place of the tensor's own float type.
    """
    a = np.array(tensors)
    axes = np.zeros_like(a) + np.eye(3, dtype=a.dtype)
    negligible = np.finfo(a.dtype).eps ** 2 * np.abs(a).max()
    for _ in range(16):  # converges quadratically: 5 or 6 sweeps for an 80-bit float
        for p, q in ((0, 1), (0, 2), (1, 2)):
            off, rotated = a[:, p, q], np.abs(a[:, p, q]) > negligible
            theta = (a[:, q, q] - a[:, p, p]) / (2 * np.where(rotated, off, 1))
            t = np.where(theta < 0, -1, 1) / (np.abs(theta) + np.sqrt(theta * theta + 1))
            t = np.where(rotated, t, 0)
            c = 1 / np.sqrt(t * t + 1)
            turn = np.zeros_like(a) + np.eye(3, dtype=a.dtype)
            turn[:, p, p] = turn[:, q, q] = c
            turn[:, p, q], turn[:, q, p] = t * c, -t * c
            a = np.swapaxes(turn, 1, 2) @ a @ turn
            a[:, p, q] = a[:, q, p] = 0
            axes = axes @ turn
    moments = np.einsum("bii->bi", a)
    order = np.argsort(-moments, axis=1, kind="stable")
    axes = np.take_along_axis(axes, order[:, None, :], axis=2)
    right_handed = qt.cross(axes[:, :, 0], axes[:, :, 1])
    axes[:, :, 2] *= np.sign((right_handed * axes[:, :, 2]).sum(axis=1))[:, None]
    return np.take_along_axis(moments, order, axis=1), axes


def inertia_tensors(masses, arms, first):
    """Tensors (B, 3, 3) of point masses (S,) at ``arms`` (S, 3) from their body's center of mass;
    ``first`` (B,) is the index of each body's first site."""
    square = (arms * arms).sum(axis=1)[:, None, None] * np.eye(3, dtype=arms.dtype)
    outer = arms[:, :, None] * arms[:, None, :]
    return np.add.reduceat(masses[:, None, None] * (square - outer), first, axis=0)


@dataclass(frozen=True)
class RigidBodies:
    """Shapes of B rigid bodies with S sites in all, sorted by body.

    ``body`` (S,), index of a site's body; ``masses`` (B,); ``moments`` (B, 3), principal moments;
    ``sites_body`` (S, 3), sites in principal axes from the center of mass.
    """

    body: np.ndarray
    masses: np.ndarray
    moments: np.ndarray
    sites_body: np.ndarray

    def __post_init__(self):
        if (np.diff(self.body) < 0).any() or set(self.body) != set(range(len(self.masses))):
            raise ValueError("sites have to be sorted by body, and every body needs a site")
        without = np.flatnonzero(
            ~(self.moments.min(axis=1) > NO_INERTIA * self.moments.max(axis=1))
        )
        if len(without):
            raise ValueError(
                f"body {without[0]} is a point or a line: every body needs three principal moments"
                f" of inertia above {NO_INERTIA:g} of its largest one"
            )

    @property
    def first(self):
        """Index of each body's first site, shape (B,)."""
        return np.searchsorted(self.body, np.arange(len(self.masses)))

    def astype(self, dtype):
        """The same shapes in another float type."""
        return RigidBodies(
            self.body, *(a.astype(dtype) for a in (self.masses, self.moments, self.sites_body))
        )


def bodies_from_sites(site_masses, positions, velocities, body, dtype=np.longdouble):
    """Bodies and their state from point masses: (RigidBodies, State).

    ``site_masses`` (S,); ``positions`` and ``velocities`` (S, 3), unwrapped; ``body`` (S,), rising
    from 0.  The velocities need not be exactly rigid; momentum and angular momentum are preserved.
    """
    masses, x, v = (np.asarray(a, dtype=dtype) for a in (site_masses, positions, velocities))
    body = np.asarray(body)
    first = np.searchsorted(body, np.arange(body.max() + 1))

    def total(values):
        return np.add.reduceat(values, first, axis=0)

    mass = total(masses)
    center = total(masses[:, None] * x) / mass[:, None]
    velocity = total(masses[:, None] * v) / mass[:, None]
    arms, relative = x - center[body], v - velocity[body]
    moments, axes = principal_axes(inertia_tensors(masses, arms, first))
    bodies = RigidBodies(body, mass, moments, np.einsum("si,sij->sj", arms, axes[body]))
    momentum = total(masses[:, None] * qt.cross(arms, relative))
    omega_body = np.einsum("bi,bij->bj", momentum, axes) / moments
    q = np.array([qt.of_rotation(matrix) for matrix in axes])
    return bodies, State(center, velocity, q, omega_body)


class Problem:
    """An initial value problem: bodies in a field from a start on.

    ``name`` is for messages; ``field`` has ``energy_and_forces(positions)`` for site positions
    (S, 3), the two factors of the units and ``astype`` (see fields.py);
    ``start`` is the State at t = 0.
    """

    def __init__(self, name, bodies, field, start):
        self.name, self.bodies, self.field, self.start = name, bodies, field, start
        self.dtype = start.center.dtype
        self._first = bodies.first

    def astype(self, dtype):
        """The same problem in another float type."""
        return Problem(
            self.name, self.bodies.astype(dtype), self.field.astype(dtype), self.start.astype(dtype)
        )

    def with_field(self, field, name=None):
        """The same bodies and start in another field."""
        return Problem(name or self.name, self.bodies, field.astype(self.dtype), self.start)

    def _arms_space(self, rotation):
        """Sites from their centers of mass in space axes, (S, 3), of matrices body -> space (B, 3, 3)."""
        return (rotation[self.bodies.body] * self.bodies.sites_body[:, None, :]).sum(axis=2)

    def site_positions(self, state):
        """Site positions in space, shape (S, 3), of a State."""
        arms = self._arms_space(qt.rotation_space_body(state.q))
        return state.center[self.bodies.body] + arms

    def forces(self, center, rotation):
        """Potential energy; force in space axes and torque in body axes, (B, 3) each.

        ``center`` (B, 3), ``rotation`` (B, 3, 3) body -> space.  Force over mass and torque over moment
        of inertia are rates of change: the factor of the units is applied.
        """
        arms = self._arms_space(rotation)
        energy, forces = self.field.energy_and_forces(center[self.bodies.body] + arms)
        forces = np.asarray(forces, dtype=center.dtype)
        force = np.add.reduceat(forces, self._first, axis=0)
        torque_space = np.add.reduceat(qt.cross(arms, forces), self._first, axis=0)
        torque_body = (torque_space[:, :, None] * rotation).sum(axis=1)
        factor = center.dtype.type(self.field.force_to_acceleration)
        return energy, factor * force, factor * torque_body

    def rates(self, _time, y):
        """Time derivative of a packed state, shape (B, 13)."""
        bodies, state = self.bodies, State.of(y)
        q, omega = state.q, state.omega_body
        _, force, torque_body = self.forces(state.center, qt.rotation_space_body(q))
        gyroscopic = qt.cross(omega, bodies.moments * omega)
        spin = np.concatenate([omega, np.zeros_like(omega[:, :1])], axis=1)
        acceleration = force / bodies.masses[:, None]
        omega_rate = (torque_body - gyroscopic) / bodies.moments
        return State(state.velocity, acceleration, qt.product(q, spin) / 2, omega_rate).packed()

    def energies(self, state):
        """Potential, translational and rotational kinetic energy of all bodies, in energy units."""
        potential, _ = self.field.energy_and_forces(self.site_positions(state))
        half = self.dtype.type(self.field.kinetic_to_energy) / 2
        translation = half * (self.bodies.masses[:, None] * state.velocity**2).sum()
        rotation = half * (self.bodies.moments * state.omega_body**2).sum()
        return potential, translation, rotation

    def angular_momentum_space(self, state):
        """Spin angular momentum of each body in space axes, shape (B, 3)."""
        momentum_body = self.bodies.moments * state.omega_body
        rotation = qt.rotation_space_body(state.q)
        return (rotation * momentum_body[:, None, :]).sum(axis=2)

    def scales(self, y):
        """Size of each column of a packed state, shape (13,): largest value of its part."""
        scale = np.empty(y.shape[1], dtype=y.dtype)
        for columns in PARTS.values():
            scale[columns] = np.abs(y[:, columns]).max()
        return scale
