"""Independent reference for the paper's scene: one rigid body in the cage, SciPy's DOP853.

Shares no code with the fix, with the scene generator or with LAMMPS: body, cage, potential and
equations of motion are written down here a second time, from the paper.  State of the integrator:
centre of mass r and velocity v in space axes, unit quaternion q (paper's order: vector part first,
scalar last; A(q) turns space into body axes) and angular velocity w in body axes, 13 numbers.
Units: lj.  ``tests/python/test_oracle.py`` tests it against simpler truths.
"""

import numpy as np
from scipy.integrate import solve_ivp

MASSES = np.array([2.0, 2.0, 10.0, 50.0])
CHARGES = np.array([-0.25, -0.25, -0.5, 1.0])
SITES = np.array([[3.0, -4.0, 0.0], [-3.0, -4.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 12.0]])
SIGMA_SPHERE_4_CAGE = 10.0
EPSILON_SPHERE_4_CAGE = 10.0  # spheres 1 to 3 have no well: epsilon is zero

STARTS = {  # centre of mass, velocity, angular velocity along the principal axes
    1: ([84.0, 0.0, 0.0], [0.2, 0.0, 0.0], 0.05 * np.pi * np.array([1 / 8, -1 / 4, 1 / 8])),
    3: ([70.0, 0.0, 0.0], [0.0, 0.0, 0.0], 0.08 * np.pi * np.array([1 / 8, -1 / 4, 1 / 8])),
}


def quaternion_of_euler(phi, psi, theta):
    """Eq. 2; angles in radians.  Returns q, shape (4,), vector part first."""
    return np.array(
        [
            np.sin(theta / 2) * np.cos((phi - psi) / 2),
            np.sin(theta / 2) * np.sin((phi - psi) / 2),
            np.cos(theta / 2) * np.sin((phi + psi) / 2),
            np.cos(theta / 2) * np.cos((phi + psi) / 2),
        ]
    )


def rotation_space_body(q):
    """Rotation matrix body -> space, the transpose of Eq. 8 as corrected, by the vector form."""
    u, s = np.asarray(q[:3]), q[3]
    skew = np.array([[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]])
    return (s * s - u @ u) * np.eye(3) + 2.0 * np.outer(u, u) + 2.0 * s * skew


def quaternion_product(a, b):
    """Hamilton product of two quaternions, vector part first."""
    vector = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.append(vector, a[3] * b[3] - a[:3] @ b[:3])


class Cage:
    """The 26 fixed spheres; the pattern of their charges is reconstructed (reading of the paper)."""

    def __init__(self):
        levels = (-1, 0, 1)
        grid = [(x, y, z) for z in levels for y in levels for x in levels if x or y or z]
        self.positions = 100.0 * np.array(grid, dtype=float)
        sign = [z or y or -x for x, y, z in grid]
        self.charges = np.where(np.array(sign) > 0, -1.0, 1.0)

    def energy_and_forces(self, positions):
        """Eq. 19 for sites at ``positions``, shape (4, 3): energy and forces, shape (4, 3)."""
        gap = positions[:, None, :] - self.positions[None, :, :]
        distance = np.sqrt((gap**2).sum(axis=2))
        coulomb = CHARGES[:, None] * self.charges[None, :] / distance
        sixth = np.zeros_like(distance)
        sixth[3] = (SIGMA_SPHERE_4_CAGE / distance[3]) ** 6
        well = 4.0 * EPSILON_SPHERE_4_CAGE
        energy = coulomb.sum() + (well * (sixth**2 - sixth)).sum()
        radial = (coulomb + well * (12.0 * sixth**2 - 6.0 * sixth)) / distance**2
        return energy, (radial[:, :, None] * gap).sum(axis=1)


class FreeSpace:
    """No cage: a free body."""

    def energy_and_forces(self, positions):
        """No energy, no forces."""
        return 0.0, np.zeros_like(positions)


class Body:
    """The paper's body; ``kind`` is consistent or unrotated (see examples/common)."""

    def __init__(self, kind="consistent"):
        centred = SITES - MASSES @ SITES / MASSES.sum()
        tensor = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(MASSES, centred))
        moments, axes = np.linalg.eigh(tensor)
        # order of the paper's list: about x first, the smallest last; axes nearest to the site axes
        order = [int(np.argmax(np.abs(axes[k]))) for k in range(3)]
        axes = axes[:, order] * np.sign(axes[range(3), order])
        self.mass = MASSES.sum()
        self.moments = moments[order]
        self.site_from_body = axes if kind == "consistent" else np.eye(3)
        self.sites_body = centred @ self.site_from_body

    def start_quaternion(self):
        """Quaternion of the principal frame at the start, shape (4,)."""
        q = quaternion_of_euler(*np.radians([40.0, 100.0, 85.0]))
        matrix = self.site_from_body
        turn = np.array(
            [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
        )
        scalar = np.sqrt(1.0 + np.trace(matrix)) / 2.0
        return quaternion_product(q, np.append(turn / (4.0 * scalar), scalar))


class Problem:
    """Equations of motion of one body in a field; integrates them to a tolerance."""

    def __init__(self, body, field):
        self.body, self.field = body, field

    def start(self, case):
        """State at t = 0 of test case 1 or 3, shape (13,)."""
        centre, velocity, omega = STARTS[case]
        return np.concatenate([centre, velocity, self.body.start_quaternion(), omega])

    def site_positions(self, state):
        """Sites in space, shape (4, 3)."""
        return state[:3] + self.body.sites_body @ rotation_space_body(state[6:10]).T

    def rates(self, _time, state):
        """Time derivative of the state, shape (13,)."""
        body, q, omega = self.body, state[6:10], state[10:13]
        positions = self.site_positions(state)
        _, forces = self.field.energy_and_forces(positions)
        torque_space = np.cross(positions - state[:3], forces).sum(axis=0)
        torque_body = rotation_space_body(q).T @ torque_space
        omega_dot = (torque_body - np.cross(omega, body.moments * omega)) / body.moments
        q_dot = 0.5 * quaternion_product(q, np.append(omega, 0.0))
        acceleration = forces.sum(axis=0) / body.mass
        return np.concatenate([state[3:6], acceleration, q_dot, omega_dot])

    def energies(self, state):
        """Potential, translational and rotational kinetic energy."""
        potential, _ = self.field.energy_and_forces(self.site_positions(state))
        translation = 0.5 * self.body.mass * state[3:6] @ state[3:6]
        return potential, translation, 0.5 * self.body.moments @ state[10:13] ** 2

    def integrate(self, state, times, rtol=1e-12):
        """States at ``times`` (rising, the first is that of ``state``), shape (len(times), 13)."""
        solution = solve_ivp(
            self.rates, (times[0], times[-1]), state, "DOP853", times, rtol=rtol, atol=1e-14
        )
        if not solution.success:
            raise RuntimeError(solution.message)
        return solution.y.T
