"""An independent version of the paper's scene in mpmath, with 30 digits, for the tests of the reference package."""

import itertools

import mpmath as mp
import numpy as np

DIGITS = 30
MASSES = np.array([2, 2, 10, 50], dtype=object)
SITES = np.array([(3, -4, 0), (-3, -4, 0), (0, 0, 0), (0, 0, 12)], dtype=object)
CAGE = np.array([place for place in itertools.product((-1, 0, 1), repeat=3) if any(place)])
CAGE_CHARGES = np.array([-1 if (z or y or -x) > 0 else 1 for x, y, z in CAGE])


def rotation(q):
    """Matrix body -> space of a unit quaternion, vector first; the transpose of Eq. 8."""
    a, b, c, s = q
    return np.array(
        [
            [2 * (a * a + s * s) - 1, 2 * (a * b - c * s), 2 * (a * c + b * s)],
            [2 * (a * b + c * s), 2 * (b * b + s * s) - 1, 2 * (b * c - a * s)],
            [2 * (a * c - b * s), 2 * (b * c + a * s), 2 * (c * c + s * s) - 1],
        ]
    )


class Scene:
    """Test case 1, consistent body; ``moments``, ``sites`` (principal axes), ``start`` (13 numbers)."""

    def __init__(self):
        with mp.workdps(DIGITS):
            self.total = mp.mpf(MASSES.sum())
            arms = SITES - MASSES @ SITES / self.total
            tensor = mp.matrix(3, 3)
            for mass, arm in zip(MASSES, arms):
                tensor += mp.matrix(mass * (arm @ arm * np.eye(3, dtype=int) - np.outer(arm, arm)))
            self.moments = np.array(sorted(mp.eigsy(tensor, eigvals_only=True))[::-1])
            tilt = mp.atan2(2 * tensor[1, 2], tensor[1, 1] - tensor[2, 2]) / 2
            c, s = mp.cos(tilt), mp.sin(tilt)
            self.sites = np.array([[x, c * y + s * z, c * z - s * y] for x, y, z in arms])
            self.charges = np.array([mp.mpf(quarters) / 4 for quarters in (-1, -1, -2, 4)])
            self.start = self._start(tilt)

    @staticmethod
    def _start(tilt):
        phi, psi, theta = (mp.mpf(a) * mp.pi / 180 for a in (40, 100, 85))
        s, c = mp.sin(theta / 2), mp.cos(theta / 2)
        x, y = s * mp.cos((phi - psi) / 2), s * mp.sin((phi - psi) / 2)
        z, w = c * mp.sin((phi + psi) / 2), c * mp.cos((phi + psi) / 2)
        a, d = mp.sin(tilt / 2), mp.cos(tilt / 2)  # turned on about the body's x
        q = [x * d + w * a, y * d + z * a, z * d - y * a, w * d - x * a]
        turns = [mp.mpf(k) * mp.pi / 160 for k in (1, -2, 1)]
        return [mp.mpf(84), mp.mpf(0), mp.mpf(0), mp.mpf(1) / 5, mp.mpf(0), mp.mpf(0), *q, *turns]

    def _forces(self, positions):
        """Forces (4, 3) on the sites."""
        gap = positions[:, None] - 100 * CAGE
        square = (gap * gap).sum(axis=2)
        radial = self.charges[:, None] * CAGE_CHARGES / square ** mp.mpf("1.5")
        sixth = (100 / square[3]) ** 3
        radial[3] += 40 * (12 * sixth * sixth - 6 * sixth) / square[3]
        return (radial[:, :, None] * gap).sum(axis=1)

    def rates(self, _time, y):
        """Time derivative of [center, velocity, q, omega_body], 13 numbers."""
        center, velocity, q, s, w = np.split(np.array(y), (3, 6, 9, 10))
        turn = rotation(y[6:10])
        arms = self.sites @ turn.T
        forces = self._forces(center + arms)
        torque_body = np.cross(arms, forces).sum(axis=0) @ turn
        spin = (torque_body - np.cross(w, self.moments * w)) / self.moments
        vector = (s * w + np.cross(q, w)) / 2
        return [*velocity, *forces.sum(axis=0) / self.total, *vector, -(q @ w) / 2, *spin]

    def at(self, time):
        """State at ``time`` by mpmath's Taylor integrator: seconds of work for each unit of time."""
        with mp.workdps(DIGITS):
            solution = mp.odefun(self.rates, 0, self.start, tol=mp.mpf(10) ** -22)
            return solution(time)
