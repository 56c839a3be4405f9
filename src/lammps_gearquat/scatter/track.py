"""The distance of two bodies during a flight, from looks at it every few steps."""

import numpy as np
from scipy.interpolate import BPoly
from scipy.optimize import brentq

#: steps between two looks, and before a turning point, where the steps of one coarse look could reach it AHEAD times
COARSE, FINE, AHEAD = 20, 4, 1.2


class Track:
    """``turnings``, how often the radial velocity has changed its sign; ``closest``, the smallest distance.

    Between the two looks around a turning point the distance is that of the polynomial of fifth order through
    positions, velocities and accelerations.
    """

    def __init__(self):
        self.turnings, self._square, self._before, self._sign = 0, np.inf, None, -1.0
        self._steps = COARSE

    @property
    def closest(self):
        return float(np.sqrt(self._square))

    def look(self, time, away, velocity, acceleration):
        """See the second body at ``away`` from the first, with its relative velocity and acceleration, (3,) each."""
        radial = away @ velocity
        self._square = min(self._square, away @ away)
        if radial * self._sign < 0.0:
            self.turnings, self._sign = self.turnings + 1, radial
            if radial > 0.0 and self._before:
                self._square = min(self._square, self._between((time, away, velocity, acceleration)))
        ahead = -radial / (velocity @ velocity)
        step = (time - (self._before[0] if self._before else 0.0)) / self._steps
        self._steps = FINE if 0.0 < ahead < AHEAD * COARSE * step else COARSE
        self._before = time, away, velocity, acceleration
        return self._steps

    def _between(self, now):
        """Smallest square of the distance between the last look and ``now``, where the radial velocity vanishes."""
        begin, end = self._before[0], now[0]
        path = BPoly.from_derivatives([0.0, end - begin], [self._before[1:], now[1:]])
        slope = path.derivative()
        at = brentq(lambda time: path(time) @ slope(time), 0.0, end - begin, xtol=1e-9 * (end - begin))
        return float(path(at) @ path(at))
