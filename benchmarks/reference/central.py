"""Classical scattering by a central potential: deflection, cross sections and collision integrals.

The method is quadrature, without trajectories.  It is the reference for flights of two atoms.  Lengths in sigma, energies in
epsilon.  With the distance of closest approach r_m for the energy E of relative motion (J. O. Hirschfelder,
C. F. Curtiss and R. B. Bird, Molecular Theory of Gases and Liquids, Wiley 1954, Eqs. 1.5-18, 8.2-2, 8.2-3):

    b^2      = r_m^2 (1 - U(r_m) / E) = B(r_m)
    chi      = pi - 2 b / r_m  integral_0^1 dx / sqrt(1 - (b x / r_m)^2 - U(r_m / x) / E)
    Q(l)     = 2 / (1 - (1 + (-1)^l) / (2 + 2 l))  integral (1 - cos^l chi) b db
    Omega(l, s) = 1 / ((s + 1)! T^(s+2))  integral exp(-E/T) E^(s+1) Q(l) dE

Q and Omega are 1 for rigid spheres of diameter 1.  The integrals over b run over r_m, so no turning point is
searched for.  Where B has a minimum at r_o, bodies orbit: r_m has two branches, up to the inner r_i with
B(r_i) = B(r_o), and from r_o on.  Nodes gather exponentially at both ends, where chi diverges
logarithmically, and at r_o inside the integral over x.
"""

from functools import lru_cache
from math import factorial

import numpy as np
from scipy.optimize import brentq

#: beyond this distance U is taken as its power law r^-6, and flights end
FAR = 40.0
#: parts of a branch that are left out at an orbiting end
LEFT_OUT = 1e-10
#: nodes of the integrals over x (on each side of r_o), r_m (each branch) and ln E (each side of the limit)
NODES_X, NODES_R, NODES_E = 61, 160, 60


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
def gauss(count):
    """Nodes and weights of Gauss and Legendre on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1.0) / 2.0, w / 2.0


@lru_cache
def double_exponential(count):
    """Nodes, their distances from 1, and weights of the tanh-sinh rule on [0, 1] (Takahasi and Mori 1974)."""
    s = np.linspace(-3.4, 3.4, count)
    inner = np.pi * np.sinh(s)
    weight = (s[1] - s[0]) * np.pi * np.cosh(s) / (2.0 + 2.0 * np.cosh(inner))
    return 1.0 / (1.0 + np.exp(-inner)), 1.0 / (1.0 + np.exp(inner)), weight


class Scattering:
    """Scattering by a potential with one well and no barrier at energy E.

    ``potential`` has ``energy(r)`` and ``slope(r)``.
    """

    def __init__(self, potential, energy):
        self.potential, self.E = potential, energy
        self.wall = brentq(lambda r: potential.energy(r) - energy, 0.3, 1.0001)
        self._orbit()

    def _rise(self, r):
        """B'(r) / (2 r)."""
        return 1.0 - self.potential.energy(r) / self.E - 0.5 * r * self.potential.slope(r) / self.E

    def b2(self, r_m):
        """B(r_m)."""
        return r_m**2 * (1.0 - self.potential.energy(r_m) / self.E)

    def _orbit(self):
        """Sets ``r_split``, where B rises least or has its minimum; ``orbits``; ``r_inner``."""
        r = np.geomspace(1.1, FAR / 2, 4000)
        rise = self._rise(r)
        falling = np.flatnonzero(rise < 0.0)
        self.orbits = len(falling) > 0
        if not self.orbits:
            self.r_split = self.r_inner = float(r[np.argmin(rise)])
            return
        last = falling[-1]
        self.r_split = brentq(self._rise, r[last], r[last + 1], xtol=1e-14)
        limit, peak = self.b2(self.r_split), r[falling[0]]
        self.r_inner = brentq(lambda x: self.b2(x) - limit, self.wall, peak, xtol=1e-15)

    def deflection(self, r_m):
        """chi, shape (n,), for turning points (n,)."""
        b, wall = np.sqrt(np.maximum(self.b2(r_m), 0.0)), r_m[:, None]
        t, rest, weight = double_exponential(NODES_X)
        split = np.minimum(r_m / self.r_split, 1.0)[:, None]
        total = 0.0
        # from 0 to r_split, and from there to the turning point; a part of no length adds nothing
        for low, high in ((0.0, split), (split, 1.0)):
            width = high - low
            x = np.where(t < 0.5, low + width * t, high - width * rest)
            under = 1.0 - (b[:, None] * x / wall) ** 2 - self.potential.energy(wall / np.maximum(x, 1e-300)) / self.E
            total = total + (width * weight / np.sqrt(np.maximum(under, 1e-30)) * (under > 0.0)).sum(axis=1)
        return np.pi - 2.0 * b / r_m * total

    def branches(self):
        """Turning points r_m and weights of b db over all impact parameters, shapes (n,)."""
        u, w = gauss(NODES_R)
        nodes, weights = [], []
        width = self.r_inner - self.wall
        s = np.log(LEFT_OUT) * (1.0 - u)
        nodes.append(self.r_inner - width * np.exp(s))
        weights.append(-np.log(LEFT_OUT) * w * width * np.exp(s))
        width = FAR - self.r_split
        s = np.log(np.sqrt(LEFT_OUT)) * (1.0 - u)
        nodes.append(self.r_split + width * np.exp(s))
        weights.append(-np.log(np.sqrt(LEFT_OUT)) * w * width * np.exp(s))
        r_m, weight = np.concatenate(nodes), np.concatenate(weights)
        return r_m, weight * self._rise(r_m) * r_m

    def cross_sections(self, orders=(1, 2)):
        """Q(l) for each of ``orders``."""
        r_m, weight = self.branches()
        cosine = np.cos(self.deflection(r_m))
        return [
            2.0 / (1.0 - (1.0 + (-1.0) ** n) / (2.0 + 2.0 * n)) * float(((1.0 - cosine**n) * weight).sum())
            for n in orders
        ]


def energies(lowest, highest, limit=0.8):
    """Nodes E and weights dE from ``lowest`` to ``highest``; nodes gather at the ``limit`` of orbiting."""
    u, w = gauss(NODES_E)
    parts = []
    for low, high in ((lowest, limit), (limit, highest)):
        # cubic at the limit, where cross sections have a cusp
        toward = u**3 if low == limit else 1.0 - (1.0 - u) ** 3
        density = 3.0 * u**2 if low == limit else 3.0 * (1.0 - u) ** 2
        span = np.log(high / low)
        E = low * np.exp(span * toward)
        parts.append((E, E * span * density * w))
    return tuple(np.concatenate(column) for column in zip(*parts))


class CollisionIntegrals:
    """Omega(l, s) of a potential for any temperatures from 0.2 to 100, in units of the integrals of rigid spheres.

    ``limit``: the largest energy at which bodies orbit, 0.8 of Lennard-Jones atoms.
    """

    def __init__(self, potential=None, limit=0.8):
        potential = potential or LennardJones()
        self.E, self.weight = energies(1e-3, 2e3, limit)
        self.Q = np.array([Scattering(potential, float(E)).cross_sections() for E in self.E]).T

    def __call__(self, order, power, temperature):
        """Omega(order, power) at a reduced temperature."""
        E, T = self.E, temperature
        kernel = np.exp(-E / T) * E ** (power + 1) * self.weight
        return float(kernel @ self.Q[order - 1] / (factorial(power + 1) * T ** (power + 2)))
