"""The density from which energies and impact parameters are drawn, and the area that each flight represents.

Let E be the energy of the relative translation and x = E / kT.  Energies count in proportion to the flux x exp(-x) dx
times the changes in a flight.  Slow bodies deflect each other at larger impact parameters b than fast bodies.  With t =
b^2,

    S(E) = s0 + s1 (E / E0)^-p                             the square of the impact parameter up to which flights count
    P(x) = 0.2 P_1(x) + 0.4 P_2(x) + 0.4 P_3(x),           density of x, where P_k(x) is proportional to x^k S exp(-x)
    density of xi = t / S:  1 / A up to 1, xi^-2 / A beyond, up to xm = largest^2 / S, with A = min(xm, 2 - 1 / xm).

This is importance sampling (J. M. Hammersley and D. C. Handscomb, Monte Carlo Methods, Methuen (1964), section 5.4):
averages with the weights pi S A max(xi, 1)^2 x exp(-x) / P(x) are unbiased for all s0, s1 and p.  Their choice
changes errors only.  P_1 has energies near zero, where rotation can give a slow pair much energy.

Of several temperatures each has its own P(x), and E is drawn from their mixture.  The weights have the density of
the whole mixture, the balance heuristic (E. Veach and L. J. Guibas, Proc. SIGGRAPH 95, p. 419 (1995)), so that every
flight counts for every temperature.  E0 is kT of the lowest temperature.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from scipy.special import gamma, gammainc, gammaln

#: power of x in P_k -> part of P that it is
POWERS = {1: 0.2, 2: 0.4, 3: 0.4}
#: share of the mixture for the lowest and for the highest of three or more temperatures
END = 0.4
#: energies of the table from which the inversion starts: the lowest relative to E0, the highest relative to the largest
#: kT, and their number
LOWEST, HIGHEST, ENTRIES = 1e-10, 60.0, 3000
#: Newton's steps of the inversion
NEWTON = 3


@dataclass(frozen=True)
class Density:
    """``scales``: kT of all temperatures, rising; ``single``: one energy, the only scale, instead of temperatures;
    ``s0``, ``s1`` and ``power`` (p), the parameters of S, areas in units of the deck; ``largest``, the largest
    impact parameter.
    """

    scales: tuple
    single: bool
    s0: float
    s1: float
    power: float
    largest: float

    # --- impact parameters ----------------------------------------------------------------------
    def reach(self, energy):
        """S (n,) at energies (n,)."""
        return self.s0 + self.s1 * (energy / self.scales[0]) ** -self.power

    def _norm(self, square):
        """A (n,) where S is ``square`` (n,)."""
        most = self.largest**2 / square
        return np.where(most <= 1.0, most, 2.0 - 1.0 / np.maximum(most, 1.0))

    def impact(self, u, energy):
        """Impact parameters (n,) of uniform numbers (n,) and energies (n,)."""
        square = self.reach(energy)
        drawn = u * self._norm(square)
        xi = np.where(drawn <= 1.0, drawn, 1.0 / (2.0 - np.maximum(drawn, 1.0)))
        return np.sqrt(np.minimum(xi * square, self.largest**2))

    def area(self, b, energy):
        """pi S A max(xi, 1)^2 (n,): the inverse of the density of pi b^2, at b (n,) and energies (n,)."""
        square = self.reach(energy)
        return np.pi * square * self._norm(square) * np.maximum(b**2 / square, 1.0) ** 2

    # --- energies -------------------------------------------------------------------------------
    @cached_property
    def shares(self):
        """Weights (m,) of the temperatures in the mixture."""
        return shares_of(len(self.scales))

    @cached_property
    def _gammas(self):
        """(m, 6, 2) of all temperatures: Gamma densities of x that make up P, each as (weight, shape)."""
        found = []
        for scale in self.scales:
            own = self.s1 * (scale / self.scales[0]) ** -self.power
            for k, part in POWERS.items():
                near, slow = self.s0 * gamma(k + 1.0), own * gamma(k + 1.0 - self.power)
                found += [(part * near / (near + slow), k + 1.0)]
                found += [(part * slow / (near + slow), k + 1.0 - self.power)]
        return np.array(found).reshape(len(self.scales), -1, 2)

    def _sum(self, function, energy):
        """Sum (m, n) over the Gamma densities of each temperature of weight times function(shape, x)."""
        total, x = 0.0, energy / np.array(self.scales)[:, None]
        # one after the other for any n, because the last digits of a flight must not depend on other flights
        for weight, shape in np.moveaxis(self._gammas, 0, -1):
            total = total + weight[:, None] * function(shape[:, None], x)
        return total

    def densities(self, energy):
        """Densities (m, n) of the energy of each temperature, at energies (n,) above 0."""

        def value(shape, x):
            return np.exp((shape - 1.0) * np.log(x) - x - gammaln(shape))

        return self._sum(value, energy) / np.array(self.scales)[:, None]

    def density(self, energy):
        """Density (n,) of the mixture."""
        return self._mixed(self.densities(energy))

    def cumulative(self, energy):
        """Fraction (n,) of the energies below ``energy`` (n,)."""
        return self._mixed(self._sum(gammainc, energy))

    def _mixed(self, values):
        """Mean (n,) over the mixture of values (m, n) of the temperatures."""
        return sum(share * own for share, own in zip(self.shares, values))

    @cached_property
    def _table(self):
        """Logarithms of energies, and the fractions below them, ascending."""
        grid = np.geomspace(LOWEST * self.scales[0], HIGHEST * self.scales[-1], ENTRIES)
        below = self.cumulative(grid)
        rising = np.concatenate([[True], np.diff(below) > 0.0])
        return np.log(grid[rising]), below[rising]

    def energies(self, u):
        """Energies (n,) of uniform numbers (n,): the inverse of ``cumulative``."""
        if self.single:
            return np.full(len(u), float(self.scales[0]))
        logarithms, below = self._table
        energy = np.exp(np.interp(u, below, logarithms))
        for _ in range(NEWTON):  # the same number for all flights, because a flight must not depend on other flights
            step = (self.cumulative(energy) - u) / self.density(energy)
            energy = np.clip(energy - step, 0.5 * energy, 2.0 * energy)
        return energy


def shares_of(number):
    """Weights (number,) of the components of a mixture of ``number`` temperatures."""
    if number < 3:
        return np.full(number, 1.0 / number)
    return np.array([END, *[(1.0 - 2.0 * END) / (number - 2)] * (number - 2), END])


@lru_cache(maxsize=16)
def density_of(*members):
    """The Density with these members; its table is computed once."""
    return Density(*members)
