"""The starts of the flights: each is a function of the seed and of its number alone.

Flight i is point i // REPLICAS of the scrambled Sobol sequence number i % REPLICAS (A. B. Owen, J. Complexity
14, 466 (1998)).  The sequences are independent, so that their means have standard errors, and each of them
fills the space of all starts evenly.  In the frame of the center of mass the relative velocity points along
z and the impact parameter along x; that the bodies have all orientations makes it general.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import gamma, gammaincinv, ndtri
from scipy.stats import qmc

from .pair import Start

#: independent sequences
REPLICAS = 16
#: part of the flights within the core, if there is one
WITHIN = 0.75
#: points of a sequence are multiples of 2^-BITS; flights have those between
BITS = 30


@dataclass(frozen=True)
class Plan:
    """What is sampled: ``seed``, a tuple of numbers; ``temperature`` of translation, or one ``energy`` of it;
    ``rotation``, its temperature, 0 for none; ``largest``, the largest impact parameter; ``core``, that within which
    a part WITHIN of the flights is, 0 if they are uniform over the whole area.  Units are those of the deck.
    """

    seed: tuple
    temperature: float
    energy: float
    rotation: float
    largest: float
    core: float = 0.0

    @property
    def kind(self):
        """ "temperature" or "energy", whichever is given."""
        return "temperature" if self.energy is None else "energy"

    def starts(self, pair, numbers, b=None):
        """Flights with these numbers, as (impact parameter, energy of translation, Start); or all with this b."""
        points = uniform(self.seed, np.asarray(numbers), dimensions(pair))
        columns = iter(points.T)
        drawn = next(columns)
        b = self._impact(drawn) if b is None else np.full(len(drawn), b)
        energy = self._energies(pair, next(columns))
        speed = np.sqrt(2.0 * energy / (pair.reduced_mass * pair.units.energy))
        turned = [_orientations(next(columns), next(columns), next(columns)) for _ in range(2)]
        quaternion = np.stack(turned, axis=1)
        momentum = self._momenta(pair, quaternion, columns)
        return [
            (float(b[i]), float(energy[i]), start_of(pair, b[i], speed[i], quaternion[i], momentum[i]))
            for i in range(len(b))
        ]

    def _impact(self, u):
        """Impact parameters (n,), with uniform squares within the core and outside of it."""
        core, outside = self.core**2, self.largest**2 - self.core**2
        if not core:
            return self.largest * np.sqrt(u)
        return np.sqrt(np.where(u < WITHIN, core * u / WITHIN, core + outside * (u - WITHIN) / (1.0 - WITHIN)))

    def area(self, b):
        """What flights with impact parameters b (n,) stand for: the area by the number of them, (n,)."""
        core, outside = self.core**2, self.largest**2 - self.core**2
        if not core:
            return np.full(len(b), np.pi * self.largest**2)
        return np.pi * np.where(b < self.core, core / WITHIN, outside / (1.0 - WITHIN))

    def start(self, pair, number):
        """The Start of one flight."""
        return self.starts(pair, [number])[0][2]

    def _energies(self, pair, u):
        if self.energy is not None:
            return np.full(len(u), self.energy)
        return gammaincinv(shape(pair.bodies.moments), u) * pair.units.boltzmann * self.temperature

    def _momenta(self, pair, quaternion, columns):
        """Angular momenta (n, 2, 3) of a Boltzmann distribution."""
        bodies, thermal = pair.bodies, pair.units.boltzmann * self.rotation / pair.units.energy
        found = np.zeros((len(quaternion), 2, 3))
        for k in range(2):
            # along the principal axes of the body, then of the pose in the deck, then of space
            along = np.zeros((len(quaternion), 3))
            for axis in np.flatnonzero(bodies.moments[k] > 0.0):
                along[:, axis] = np.sqrt(bodies.moments[k, axis] * thermal) * ndtri(next(columns))
            found[:, k] = Rotation.from_quat(quaternion[:, k], scalar_first=True).apply(along @ bodies.axes[k])
        return found


def shape(moments):
    """That of the Gamma distribution of energies of translation in units of kT, from principal moments (2, 3).

    Integrands are the flux of collisions, x exp(-x), times what a flight changes: about x for Omega(1,1), and x^2
    for Omega(2,2).  3 suits atoms.  To slow molecules rotation can give energy, so weights must not grow like 1 / x:
    2.5 leaves all integrals of rotating molecules a small variance.
    """
    return 2.5 if np.any(np.asarray(moments) > 0.0) else 3


def weight(x, moments):
    """The flux x exp(-x) by the density from which energies x (n,) are drawn."""
    number = shape(moments)
    return gamma(number) * x ** (2.0 - number)


def dimensions(pair):
    """Random numbers of a flight: impact parameter, energy, orientations and angular momenta."""
    return 2 + 6 + int(np.count_nonzero(pair.bodies.moments > 0.0))


def uniform(seed, numbers, dimension):
    """Points (n, dimension) of flights ``numbers`` (n,), strictly between 0 and 1."""
    points = np.empty((len(numbers), dimension))
    for replica in np.unique(numbers % REPLICAS):
        own = np.flatnonzero(numbers % REPLICAS == replica)
        wanted = numbers[own] // REPLICAS
        first, last = int(wanted.min()), int(wanted.max())
        generator = np.random.default_rng([*seed, int(replica)])
        sequence = qmc.Sobol(dimension, scramble=True, bits=BITS, seed=generator)
        if first:
            sequence.fast_forward(first)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # that a part of a sequence is not as even as the whole
            points[own] = sequence.random(last - first + 1)[wanted - first]
    return points + 0.5 ** (BITS + 1)


def _orientations(first, second, third):
    """Uniformly distributed quaternions (n, 4) from uniform numbers (n,).

    K. Shoemake, Uniform random rotations, in Graphics Gems III, Academic Press (1992), p. 124.
    """
    a, b = np.sqrt(1.0 - first), np.sqrt(first)
    second, third = 2.0 * np.pi * second, 2.0 * np.pi * third
    return np.column_stack([b * np.cos(third), a * np.sin(second), a * np.cos(second), b * np.sin(third)])


def start_of(pair, b, speed, quaternion, momentum):
    """Start at the distance ``pair.reach`` with this impact parameter and relative speed."""
    away = np.array([b, 0.0, -np.sqrt(pair.reach**2 - b**2)])
    flight = np.array([0.0, 0.0, speed])
    # the center of mass is at rest in the origin
    parts = np.array([-1.0, 1.0]) * pair.bodies.mass[::-1] / pair.bodies.mass.sum()
    return Start(parts[:, None] * away, parts[:, None] * flight, quaternion, momentum)
