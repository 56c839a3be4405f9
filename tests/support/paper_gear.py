"""The two predictor-correctors of the paper, implemented a second time in plain numpy.

Exactly as the paper ran them: zero start, nothing projected, every formula as it stands (Eqs. 5 to 18
as corrected), so that |q| wanders off 1 and the matrix of Eq. 8 is not quite a rotation.  Then the
motion depends on the choice of body axes: A(q) = |q|^2 R + (|q|^2 - 1) 1 holds for no other labeling
of the principal axes.  ``turn`` takes the body axes of the reference into any of the 24.
"""

import numpy as np
from scipy.linalg import pascal
from scipy.spatial.transform import Rotation

from benchmarks.reference import paper_problem
from benchmarks.reference import quaternion as qt

FIRST = np.array([251 / 720, 1, 11 / 12, 1 / 3, 1 / 24])  # Table 1
SECOND = np.array([3 / 16, 251 / 360, 1, 11 / 18, 1 / 6, 1 / 60])  # Table 2


def eq_8(q):
    """Space -> body matrix for a quaternion of any length, as printed (corrected)."""
    q1, q2, q3, q4 = q
    return 2 * np.array(
        [
            [q1**2 + q4**2 - 0.5, q1 * q2 + q3 * q4, q1 * q3 - q2 * q4],
            [q1 * q2 - q3 * q4, q2**2 + q4**2 - 0.5, q2 * q3 + q1 * q4],
            [q1 * q3 + q2 * q4, q2 * q3 - q1 * q4, q3**2 + q4**2 - 0.5],
        ]
    )


def matrix_w(q):
    """The matrix W of Eqs. 5 and 6 (corrected)."""
    q1, q2, q3, q4 = q
    return np.array([[q4, -q3, q2, q1], [q3, q4, -q1, q2], [-q2, q1, q4, q3], [-q1, -q2, -q3, q4]])


#: the 24 rotations that permute and flip axes, (24, 3, 3): old body axes -> new body axes
FRAMES = np.rint(Rotation.create_group("O").as_matrix())


def quaternion_of(turn):
    """Quaternion, vector first, whose Eq. 8 is ``turn``."""
    return Rotation.from_matrix(turn.T).as_quat()


class PaperGear:
    """One body that moves as in the paper, with body axes chosen by ``turn``."""

    def __init__(self, kind, case, h, turn, predicted_momentum=True):
        problem = paper_problem(case, kind, np.float64)
        self.cage, bodies, start = problem.field, problem.bodies, problem.start
        self.h, self.mass, self.predicted_momentum = h, bodies.masses[0], predicted_momentum
        self.moments, self.sites = np.abs(turn) @ bodies.moments[0], bodies.sites_body @ turn.T
        # space <- old body <- new body
        self.q = qt.product(start.q[0], quaternion_of(turn))
        self.center, self.velocity = start.center[0], start.velocity[0]
        self.omega = turn @ start.omega_body[0]

    def accelerations(self, center, q, omega):
        """Force (3,) and rate of omega (3,), Eqs. 7, 10 and 12."""
        a = eq_8(q)
        arms = self.sites @ a  # Eq. 9
        _, forces = self.cage.energy_and_forces(center + arms)
        torque = a @ np.cross(arms, forces).sum(axis=0)
        gyroscopic = np.cross(omega, self.moments * omega)
        return forces.sum(axis=0), (torque - gyroscopic) / self.moments

    def first(self, steps):
        """Centre of mass after ``steps`` of the first-order form."""
        h, predict = self.h, pascal(5, "upper")
        x, p, q, w = (np.zeros((5, n)) for n in (3, 3, 4, 3))
        x[0], x[1], p[0] = self.center, h * self.velocity, self.mass * self.velocity
        q[0], w[0] = self.q, self.omega
        q[1] = h * 0.5 * matrix_w(self.q) @ [*self.omega, 0]
        for _ in range(steps):
            x, p, q, w = (predict @ rows for rows in (x, p, q, w))
            force, omega_dot = self.accelerations(x[0], q[0], w[0])
            momentum = p[0]
            p = p + np.outer(FIRST, h * force - p[1])  # Eq. 14
            if not self.predicted_momentum:
                momentum = p[0]
            x = x + np.outer(FIRST, h * momentum / self.mass - x[1])  # Eq. 13
            w = w + np.outer(FIRST, h * omega_dot - w[1])  # Eq. 15
            q_dot = 0.5 * matrix_w(q[0]) @ [*w[0], 0]  # Eq. 5
            q = q + np.outer(FIRST, h * q_dot - q[1])  # Eq. 16
        return x[0]

    def second(self, steps):
        """Centre of mass after ``steps`` of the second-order form."""
        h, predict = self.h, pascal(6, "upper")
        x, q = np.zeros((6, 3)), np.zeros((6, 4))
        x[0], x[1] = self.center, h * self.velocity
        q[0], q[1] = self.q, h * 0.5 * matrix_w(self.q) @ [*self.omega, 0]
        for _ in range(steps):
            x, q = predict @ x, predict @ q
            q_dot = q[1] / h
            omega = 2 * (matrix_w(q[0]).T @ q_dot)[:3]
            force, omega_dot = self.accelerations(x[0], q[0], omega)
            q_ddot = 0.5 * matrix_w(q[0]) @ [*omega_dot, -2 * q_dot @ q_dot]  # Eq. 6
            x = x + np.outer(SECOND, 0.5 * h * h * force / self.mass - x[2])  # Eq. 17
            q = q + np.outer(SECOND, 0.5 * h * h * q_ddot - q[2])  # Eq. 18
        return x[0]
