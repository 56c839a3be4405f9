"""The starts of the flights, and the area that each of them represents.

Flights are points of REPLICAS independent scrambled Sobol sequences (A. B. Owen, J. Complexity 14, 466 (1998)): the
sequences are independent, so that their means have standard errors, and each of them fills the space of all starts
evenly.  In the frame of the center of mass the relative velocity points along z and the impact parameter along x; this
is no restriction, because the bodies have all orientations.

Let E be the energy of the relative translation, x = E / kT, and s(E) the distance within which bodies at rest have more than
PART of E.  Energies count in proportion
to the flux x exp(-x) dx times the changes in a flight, which increase with x, so that

    density of x:              x^(3/2) exp(-x) / Gamma(5/2)
    density of xi = b^2/s^2:   1 / A up to 1, xi^-2 / A beyond, up to xm = largest^2 / s^2, with A = 2 - 1 / xm.

This is importance sampling (J. M. Hammersley and D. C. Handscomb, Monte Carlo Methods, Methuen (1964), section 5.4):
averages with the weights pi s^2 A max(xi, 1)^2 x exp(-x) by the density of x are unbiased for any s, whose choice changes
errors only.  Beyond the ``largest`` impact parameter no force acts.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import gamma, gammaincinv, ndtri
from scipy.stats import qmc

from .pair import Start

#: independent sequences, and flights of each of them in the first round; the number doubles in each further round
REPLICAS, FIRST = 16, 32
#: points of a sequence are multiples of 2^-BITS; flights use the midpoints between them
BITS = 30
#: shape of the Gamma density of x; potential energy by the energy of a flight at the distance s
SHAPE, PART = 2.5, 0.3


@dataclass(frozen=True)
class Plan:
    """The distribution of the flights, in units of the deck.

    ``temperature`` of translation, or None with one ``energy`` of translation; ``rotation``, the temperature of rotation,
    0 for none; ``scale``, kT or the energy; ``largest`` impact parameter; ``distances`` and ``potential`` (n,), the
    envelope of a Pair.
    """

    seed: int
    temperature: float
    energy: float
    rotation: float
    scale: float
    largest: float
    distances: np.ndarray
    potential: np.ndarray

    @property
    def balanced(self):
        """True if rotation has the temperature of translation, so that detailed balance holds."""
        return self.temperature == self.rotation

    def size(self, energy):
        """s (n,) at energies (n,)."""
        far = np.interp(PART * energy, self.potential, self.distances)
        return np.minimum(far, self.largest)

    def points(self, dimension):
        """Uniform numbers (n, dimension) of the first round, and of each further round."""
        sequences = [
            qmc.Sobol(dimension, scramble=True, bits=BITS, seed=np.random.default_rng([self.seed, k]))
            for k in range(REPLICAS)
        ]
        number = FIRST
        while True:
            yield np.stack([one.random(number) for one in sequences], axis=1).reshape(-1, dimension) + 0.5 ** (BITS + 1)
            number = sequences[0].num_generated

    def impact(self, u, energy):
        """Impact parameters (n,) of uniform numbers and energies (n,)."""
        size = self.size(energy)
        drawn = u * (2.0 - (size / self.largest) ** 2)
        return size * np.sqrt(np.where(drawn <= 1.0, drawn, 1.0 / (2.0 - np.maximum(drawn, 1.0))))

    def energies(self, u):
        """Energies (n,) of uniform numbers (n,)."""
        return np.full(len(u), self.energy) if self.energy else self.scale * gammaincinv(SHAPE, u)

    def weights(self, b, energy):
        """The area (n,) that each flight represents, times the flux x exp(-x) by the density of x."""
        size = self.size(energy)
        area = np.pi * size**2 * (2.0 - (size / self.largest) ** 2) * np.maximum((b / size) ** 2, 1.0) ** 2
        return area if self.energy else area * gamma(SHAPE) * (energy / self.scale) ** (2.0 - SHAPE)

    def starts(self, pair, points):
        """List of (impact parameter, energy of translation, Start) of uniform numbers (n, dimension(pair))."""
        columns = iter(points.T)
        place, energy = next(columns), self.energies(next(columns))
        b = self.impact(place, energy)
        speed = np.sqrt(2.0 * energy / (pair.reduced_mass * pair.units.energy))
        quaternion = np.stack([_orientations(next(columns), next(columns), next(columns)) for _ in range(2)], axis=1)
        momentum = _momenta(pair, quaternion, pair.units.boltzmann * self.rotation, columns)
        drawn = zip(b.tolist(), energy.tolist(), speed, quaternion, momentum)
        return [(b, energy, _start(pair, b, *rest)) for b, energy, *rest in drawn]


def dimension(pair):
    """Random numbers of a flight: impact parameter, energy, orientations, and angular momenta."""
    return 8 + int(np.count_nonzero(pair.bodies.moments > 0.0))


def _momenta(pair, quaternion, thermal, columns):
    """Angular momenta (n, 2, 3) of a Boltzmann distribution with kT ``thermal``."""
    bodies, found = pair.bodies, np.zeros((len(quaternion), 2, 3))
    for k in range(2):
        # along the principal axes of the body, then of the pose in the deck, then of space
        along = np.zeros((len(quaternion), 3))
        for axis in np.flatnonzero(bodies.moments[k] > 0.0):
            along[:, axis] = np.sqrt(bodies.moments[k, axis] * thermal / pair.units.energy) * ndtri(next(columns))
        turns = Rotation.from_quat(quaternion[:, k], scalar_first=True)
        found[:, k] = turns.apply(along @ bodies.axes[k])
    return found


def _orientations(first, second, third):
    """Uniformly distributed quaternions (n, 4) from uniform numbers (n,).

    K. Shoemake, Uniform random rotations, in Graphics Gems III, Academic Press (1992), p. 124.
    """
    a, b = np.sqrt(1.0 - first), np.sqrt(first)
    second, third = 2.0 * np.pi * second, 2.0 * np.pi * third
    return np.column_stack([b * np.cos(third), a * np.sin(second), a * np.cos(second), b * np.sin(third)])


def _start(pair, b, speed, quaternion, momentum):
    """Start at the distance ``pair.reach`` with this impact parameter and relative speed."""
    away = np.array([b, 0.0, -np.sqrt(pair.reach**2 - b**2)])
    flight = np.array([0.0, 0.0, speed])
    # the center of mass is at rest in the origin
    parts = np.array([-1.0, 1.0]) * pair.bodies.mass[::-1] / pair.bodies.mass.sum()
    return Start(parts[:, None] * away, parts[:, None] * flight, quaternion, momentum)
