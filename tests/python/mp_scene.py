"""The paper's scene once more in mpmath, 30 digits, plain loops: for the reference package's tests."""

import mpmath as mp

DIGITS = 30
MASSES = (2, 2, 10, 50)
SITES = ((3, -4, 0), (-3, -4, 0), (0, 0, 0), (0, 0, 12))
LEVELS = (-1, 0, 1)
CAGE = [
    ((100 * x, 100 * y, 100 * z), -1 if (z or y or -x) > 0 else 1)
    for x in LEVELS
    for y in LEVELS
    for z in LEVELS
    if x or y or z
]


def cross(a, b):
    """Vector product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def rotation(q):
    """Matrix body -> space of a unit quaternion, vector first; the transpose of Eq. 8."""
    a, b, c, s = q
    return [
        [2 * (a * a + s * s) - 1, 2 * (a * b - c * s), 2 * (a * c + b * s)],
        [2 * (a * b + c * s), 2 * (b * b + s * s) - 1, 2 * (b * c - a * s)],
        [2 * (a * c - b * s), 2 * (b * c + a * s), 2 * (c * c + s * s) - 1],
    ]


class Scene:
    """Test case 1, consistent body; ``moments``, ``sites`` (principal axes), ``start`` (13 numbers)."""

    def __init__(self):
        with mp.workdps(DIGITS):
            total = mp.mpf(sum(MASSES))
            center = [sum(m * s[k] for m, s in zip(MASSES, SITES)) / total for k in range(3)]
            arms = [[s[k] - center[k] for k in range(3)] for s in SITES]
            tensor = mp.matrix(3, 3)
            for m, (x, y, z) in zip(MASSES, arms):
                tensor += m * mp.matrix(
                    [
                        [y * y + z * z, -x * y, -x * z],
                        [-x * y, x * x + z * z, -y * z],
                        [-x * z, -y * z, x * x + y * y],
                    ]
                )
            self.total, self.moments = total, sorted(mp.eigsy(tensor, eigvals_only=True))[::-1]
            tilt = mp.atan2(2 * tensor[1, 2], tensor[1, 1] - tensor[2, 2]) / 2
            c, s = mp.cos(tilt), mp.sin(tilt)
            self.sites = [[x, c * y + s * z, c * z - s * y] for x, y, z in arms]
            self.charges = [mp.mpf(-1) / 4, mp.mpf(-1) / 4, mp.mpf(-1) / 2, mp.mpf(1)]
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

    def _force(self, k, position):
        """Force on site k."""
        force = [mp.mpf(0)] * 3
        for place, charge in CAGE:
            gap = [position[i] - place[i] for i in range(3)]
            square = mp.fsum(g * g for g in gap)
            radial = self.charges[k] * charge / (square * mp.sqrt(square))
            if k == 3:
                sixth = (100 / square) ** 3
                radial += 40 * (12 * sixth * sixth - 6 * sixth) / square
            force = [f + radial * g for f, g in zip(force, gap)]
        return force

    def rates(self, _time, y):
        """Time derivative of [center, velocity, q, omega_body], 13 numbers."""
        q, w, turn = y[6:10], y[10:], rotation(y[6:10])
        force, torque = [mp.mpf(0)] * 3, [mp.mpf(0)] * 3
        for k, site in enumerate(self.sites):
            arm = [mp.fdot(row, site) for row in turn]
            own = self._force(k, [y[i] + arm[i] for i in range(3)])
            force = [a + b for a, b in zip(force, own)]
            torque = [a + b for a, b in zip(torque, cross(arm, own))]
        torque_body = [mp.fdot([row[j] for row in turn], torque) for j in range(3)]
        gyroscopic = cross(w, [i * a for i, a in zip(self.moments, w)])
        vector = [(q[3] * w[i] + c) / 2 for i, c in enumerate(cross(q[:3], w))]
        spin = [(t - g) / i for t, g, i in zip(torque_body, gyroscopic, self.moments)]
        return [*y[3:6], *(f / self.total for f in force), *vector, -mp.fdot(q[:3], w) / 2, *spin]

    def at(self, time):
        """State at ``time`` by mpmath's Taylor integrator: seconds of work for each unit of time."""
        with mp.workdps(DIGITS):
            solution = mp.odefun(self.rates, 0, self.start, tol=mp.mpf(10) ** -22)
            return solution(time)
