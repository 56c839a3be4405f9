"""The starts of the flights: each is a function of the seed and of its number alone.

Flight i is point i // REPLICAS of the scrambled Sobol sequence number i % REPLICAS (A. B. Owen, J. Complexity
14, 466 (1998)).  The sequences are independent, so that their means have standard errors, and each of them
fills the space of all starts evenly.  In the frame of the center of mass the relative velocity points along
z and the impact parameter along x; this is no restriction, because the bodies have all orientations.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ndtri

from .density import density_of
from .pair import Start

#: independent sequences
REPLICAS = 16
#: points of a sequence are multiples of 2^-BITS; flights use the midpoints between them
BITS = 30


@dataclass(frozen=True)
class Plan:
    """The distribution of the flights, in units of the deck.

    ``seed``, a tuple of numbers; ``temperature``, an ascending tuple of temperatures of translation, or None with one
    ``energy`` of translation. ``rotation``, the temperature of rotation, 0 for none, or None for the temperature of
    translation.  ``largest``, the largest impact parameter; ``s0``, ``s1`` and ``power``, which density.py explains.
    If both s0 and s1 are 0, impact parameters are uniform over the whole area.
    """

    seed: tuple
    temperature: tuple
    energy: float
    rotation: float
    largest: float
    s0: float = 0.0
    s1: float = 0.0
    power: float = 1.0

    @property
    def kind(self):
        """ "temperature" or "energy", whichever is given."""
        return "temperature" if self.energy is None else "energy"

    @property
    def conditions(self):
        """The temperatures, or (None,) for one energy."""
        return self.temperature if self.energy is None else (None,)

    def scales(self, boltzmann):
        """kT of all temperatures, or the energy, a tuple."""
        if self.energy is not None:
            return (self.energy,)
        return tuple(boltzmann * temperature for temperature in self.temperature)

    def density(self, boltzmann):
        """The Density of energies and impact parameters."""
        s0 = self.s0 if self.s0 or self.s1 else self.largest**2
        single = self.energy is not None
        return density_of(self.scales(boltzmann), single, s0, self.s1, self.power, self.largest)

    def mixes_rotation(self, freedoms):
        """True if rotation has the temperature, one of several, with which a flight is drawn."""
        return self.energy is None and self.rotation is None and len(self.temperature) > 1 and any(freedoms)

    def balanced(self, freedoms):
        """True if rotation, if there is any, has the temperature of translation, so that detailed balance holds."""
        return self.energy is None and (self.rotation is None or not any(freedoms))

    def drawn(self, points, boltzmann):
        """(impact parameters (n,), energies (n,)) of points (n, 2 or more)."""
        density = self.density(boltzmann)
        energy = density.energies(points[:, 1])
        return density.impact(points[:, 0], energy), energy

    def starts(self, pair, numbers):
        """Flights with these numbers, as (impact parameter, energy of translation, Start)."""
        points = uniform(self.seed, np.asarray(numbers), self.dimensions(pair))
        b, energy = self.drawn(points, pair.units.boltzmann)
        return starts_of(pair, b, energy, self._thermal(pair, energy, points[:, -1]), points[:, 2:])

    def start(self, pair, number):
        """The Start of one flight."""
        return self.starts(pair, [number])[0][2]

    def dimensions(self, pair):
        """Random numbers of a flight: impact parameter, energy, orientations, angular momenta and, if it is drawn,
        the temperature of rotation, which is last."""
        return 2 + rotational(pair) + self.mixes_rotation(pair.freedoms)

    def _thermal(self, pair, energy, u):
        """kT (n,) of the rotation of flights with energies and uniform numbers (n,)."""
        boltzmann = pair.units.boltzmann
        if self.rotation is not None or self.energy is not None:
            return np.full(len(energy), boltzmann * (self.rotation or 0.0))
        scales = np.array(self.scales(boltzmann))
        if not self.mixes_rotation(pair.freedoms):
            return np.full(len(energy), scales[0])
        density = self.density(boltzmann)
        parts = np.cumsum(density.shares[:, None] * density.densities(energy), axis=0)
        return scales[np.minimum((u >= parts / parts[-1]).sum(axis=0), len(scales) - 1)]


def rotational(pair):
    """Random numbers of the orientations and angular momenta of a flight."""
    return 6 + int(np.count_nonzero(pair.bodies.moments > 0.0))


def starts_of(pair, b, energy, thermal, points):
    """List of (impact parameter, energy, Start), of b, energies and kT of rotation (n,).

    ``points`` (n, rotational(pair) or more), uniform numbers.
    """
    columns = iter(points.T)
    speed = np.sqrt(2.0 * energy / (pair.reduced_mass * pair.units.energy))
    turned = [_orientations(next(columns), next(columns), next(columns)) for _ in range(2)]
    quaternion = np.stack(turned, axis=1)
    momentum = _momenta(pair, quaternion, thermal, columns)
    return [
        (float(b[i]), float(energy[i]), start_of(pair, b[i], speed[i], quaternion[i], momentum[i]))
        for i in range(len(b))
    ]


def _momenta(pair, quaternion, thermal, columns):
    """Angular momenta (n, 2, 3) of a Boltzmann distribution with kT (n,)."""
    bodies, found = pair.bodies, np.zeros((len(quaternion), 2, 3))
    for k in range(2):
        # along the principal axes of the body, then of the pose in the deck, then of space
        along = np.zeros((len(quaternion), 3))
        for axis in np.flatnonzero(bodies.moments[k] > 0.0):
            width = np.sqrt(bodies.moments[k, axis] * thermal / pair.units.energy)
            along[:, axis] = width * ndtri(next(columns))
        turn = Rotation.from_quat(quaternion[:, k], scalar_first=True).as_matrix() @ bodies.axes[k].T
        # matrix products would add in an order that depends on n, but the last digits of a flight must not depend on
        # other flights
        found[:, k] = sum(turn[:, :, axis] * along[:, axis, None] for axis in range(3))
    return found


def uniform(seed, numbers, dimension):
    """Points (n, dimension) of flights ``numbers`` (n,), strictly between 0 and 1."""
    # imported here because it takes long, and a process whose deck is refused does not need it
    from scipy.stats import qmc

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
            warnings.simplefilter("ignore")  # a part of a sequence is not as even as the whole
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
