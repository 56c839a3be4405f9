"""Classical scattering by a central potential by quadrature: a substitute for flights of two atoms.

Lengths in sigma, energies in epsilon.  With the distance of closest approach r_m for the energy E of relative motion (J. O.
Hirschfelder, C. F. Curtiss and R. B. Bird, Molecular Theory of Gases and Liquids, Wiley 1954, Eqs. 1.5-18, 8.2-2, 8.2-3):

    b^2      = r_m^2 (1 - U(r_m) / E) = B(r_m)
    chi      = pi - 2 b / r_m  integral_0^1 dx / sqrt(1 - (b x / r_m)^2 - U(r_m / x) / E)

Bodies of energy E orbit at r_o.  For b^2 above B(r_o), the turning point is outside of r_o, or else inside of r_i, the inner
radius with W(r_i) = E.  Here W(r) = U + r U' / 2, which equals E where B has an extremum.
"""

from functools import lru_cache

import numpy as np
#: radii at which W is tabulated, and bisections for the turning point
RADII, BISECTIONS = 200_001, 60
#: nodes of the quadrature, on each side of r_o
NODES = 61


class LennardJones:
    """4 (r^-12 - r^-6)."""

    def energy(self, r):
        """Potential energy at distances r."""
        y = 1.0 / (r * r)
        y = y * y * y
        return 4.0 * y * (y - 1.0)

    def slope(self, r):
        """Its derivative."""
        y = r**-6.0
        return 24.0 * y * (1.0 - 2.0 * y) / r


class TwelveFour:
    """3^1.5 / 2 (r^-12 - r^-4), of an ion and an atom that it polarizes: the well is at 3^(1/8) and has the depth 1."""

    DEPTH = 1.5 * np.sqrt(3.0)

    def energy(self, r):
        """Potential energy at distances r."""
        y = 1.0 / (r * r)
        y = y * y
        return self.DEPTH * y * (y * y - 1.0)

    def slope(self, r):
        """Its derivative."""
        y = r**-4.0
        return self.DEPTH * 4.0 * y * (1.0 - 3.0 * y * y) / r


@lru_cache
def double_exponential(count):
    """Nodes, their distances from 1, and weights of the tanh-sinh rule on [0, 1] (Takahasi and Mori 1974)."""
    s = np.linspace(-3.4, 3.4, count)
    inner = np.pi * np.sinh(s)
    weight = (s[1] - s[0]) * np.pi * np.cosh(s) / (2.0 + 2.0 * np.cosh(inner))
    return 1.0 / (1.0 + np.exp(-inner)), 1.0 / (1.0 + np.exp(inner)), weight


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
        """Integral (n,) over x from ``low`` to ``high`` (n, 1)."""
        t, rest, weight = double_exponential(NODES)
        width, turning, energy = high - low, turning[:, None], energy[:, None]
        x = np.maximum(np.where(t < 0.5, low + width * t, high - width * rest), 1e-300)
        under = 1.0 - (b[:, None] / turning * x) ** 2 - self.potential.energy(turning / x) / energy
        return (width * weight / np.sqrt(np.maximum(under, 1e-30)) * (under > 0.0)).sum(axis=1)
