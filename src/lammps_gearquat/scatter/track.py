"""The distance of two bodies during a flight, sampled every few steps."""

import numpy as np
from scipy.interpolate import BPoly

#: steps between two samples
STEPS = 15
#: places between two samples, and the values there of the fifth-order polynomials whose value, derivative and second
#: derivative are (1, 0, 0), ... at the first and then at the second sample
_BETWEEN = np.linspace(0.0, 1.0, 129)
_BASIS = BPoly.from_derivatives([0.0, 1.0], np.eye(6).reshape(2, 3, 6))(_BETWEEN)


class Track:
    """``turnings``, how often the radial velocity has changed its sign, and ``closest``, the smallest distance.

    Between the two samples around a turning point, the distance follows the fifth-order polynomial through
    positions, velocities and accelerations.
    """

    def __init__(self, away, velocity):
        """From a start without forces at ``away`` with the relative ``velocity``, (3,) each."""
        self.turnings, self._square, self._sign = 0, away @ away, -1.0
        self._time, self._before = 0.0, np.array([away, velocity, np.zeros(3)])

    @property
    def closest(self):
        return float(np.sqrt(self._square))

    def look(self, time, away, velocity, acceleration):
        """Record the second body at ``away`` from the first, with its relative velocity and acceleration, (3,) each."""
        radial, now = away @ velocity, np.array([away, velocity, acceleration])
        self._square = min(self._square, away @ away)
        if radial * self._sign < 0.0:
            self.turnings, self._sign = self.turnings + 1, radial
            if radial > 0.0:
                self._square = min(self._square, self._between(time - self._time, now))
        self._time, self._before = time, now

    def _between(self, step, now):
        """Smallest square of the distance between the last sample and ``now``, after a time ``step``."""
        scales = np.array([1.0, step, step * step])[:, None]
        path = _BASIS @ np.concatenate([scales * self._before, scales * now])
        squares = np.einsum("ij,ij->i", path, path)
        k = min(max(int(np.argmin(squares)), 1), len(squares) - 2)
        left, middle, right = squares[k - 1 : k + 2]
        bend = left - 2.0 * middle + right
        return middle - 0.125 * (right - left) ** 2 / bend if bend > 0.0 else middle
