"""Deflection by a central potential for many energies and impact parameters at once: a substitute for flights of two
atoms.

Formulas and quadrature are as in central.py; here the turning point is searched for.  Bodies of energy E orbit at
r_o.  For b^2 above B(r_o), the turning point is outside of r_o, or else inside of r_i, the inner radius with W(r_i) =
E.  Here W(r) = U + r U' / 2, which equals E where B has an extremum.
"""

import numpy as np

from .central import double_exponential

#: radii at which W is tabulated, and bisections for the turning point
RADII, BISECTIONS = 200_001, 60
#: nodes of the quadrature, on each side of r_o
NODES = 61


class Deflection:
    """``angles(energy, b)`` of a potential with ``energy(r)`` and ``slope(r)``, one well and no barrier.

    ``nearest`` and ``farthest``: radii between which bodies turn or orbit.
    """

    def __init__(self, potential, nearest=0.3, farthest=200.0):
        self.potential, self.nearest = potential, nearest
        r = np.geomspace(nearest, farthest, RADII)
        w = potential.energy(r) + 0.5 * r * potential.slope(r)
        # inside of its maximum beyond the well W falls to a minimum, and rises towards the wall
        top = len(r) - 1 - int(np.argmax(w[::-1] == w[r > 1.0].max()))
        #: the largest energy of orbits, and where they are
        self.limit, self.orbit = float(w[top]), float(r[top])
        self._outer = w[top:][::-1], r[top:][::-1]
        falling = np.flatnonzero(np.diff(w[: top + 1]) < 0.0)
        first = falling[-1] + 1 if len(falling) else 0
        self._inner = w[first : top + 1], r[first : top + 1]

    def _square(self, r, energy):
        """B(r)."""
        return r**2 * (1.0 - self.potential.energy(r) / energy)

    def _turning(self, energy, b, outer, inner):
        """Turning points (n,), of radii (n,) between which there are none."""
        beyond = b**2 >= self._square(outer, energy)
        low = np.where(beyond, outer, self.nearest)
        high = np.where(beyond, np.maximum(2.0 * outer, 2.0 * b), inner)
        for _ in range(BISECTIONS):
            middle = 0.5 * (low + high)
            below = self._square(middle, energy) < b**2
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return high

    def angles(self, energy, b):
        """chi (n,) for energies and impact parameters (n,), not reduced to 0 to pi."""
        outer = np.interp(energy, *self._outer, right=self.orbit)
        inner = np.interp(energy, *self._inner, right=self.orbit)
        turning = self._turning(energy, b, outer, inner)
        split = np.minimum(turning / outer, 1.0)
        total = self._part(energy, b, turning, 0.0, split[:, None])
        inside = split < 1.0
        own = (values[inside] for values in (energy, b, turning))
        total[inside] += self._part(*own, split[inside, None], 1.0)
        return np.pi - 2.0 * b / turning * total

    def _part(self, energy, b, turning, low, high):
        """Integral (n,) over x from ``low`` to ``high`` (n, 1); see central.py."""
        t, rest, weight = double_exponential(NODES)
        width, turning, energy = high - low, turning[:, None], energy[:, None]
        x = np.maximum(np.where(t < 0.5, low + width * t, high - width * rest), 1e-300)
        under = 1.0 - (b[:, None] / turning * x) ** 2 - self.potential.energy(turning / x) / energy
        return (width * weight / np.sqrt(np.maximum(under, 1e-30)) * (under > 0.0)).sum(axis=1)
