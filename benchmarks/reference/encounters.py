"""Flights of two rigid bodies with independent forces and equations of motion, by SciPy's solvers.

A state (2, 13) has for each body center, velocity, quaternion (scalar first, from the pose of the deck) and
angular momentum L along the axes of space, so points and linear bodies need no other equations:

    x' = v,  v' = F / m,  q' = 1/2 (0, omega) q,  L' = torque,  omega = R I^-1 R^T L

with I^-1 of the pose in the deck, zero for axes without inertia.  The potential is a sum over pairs of sites, of
Lennard-Jones terms as cut by LAMMPS' pair style lj/gromacs and charges as damped by coul/dsf
(C. J. Fennell and J. D. Gezelter, J. Chem. Phys. 124, 234104 (2006), Eq. 18), whose erfc is formula 7.1.26 of M. Abramowitz
and I. A. Stegun, as in LAMMPS.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

CENTER, VELOCITY, Q, MOMENTUM = slice(0, 3), slice(3, 6), slice(6, 10), slice(10, 13)
#: coefficients of formula 7.1.26
_P, _A = 0.3275911, (0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429)


@dataclass(frozen=True)
class Dispersion:
    """Lennard-Jones terms (n, m) between the sites of two bodies, cut between two distances."""

    epsilon: np.ndarray
    sigma: np.ndarray
    inner: float
    outer: float

    def terms(self, r):
        """Energy and -dU/dr, shapes (n, m)."""
        energy, force, width = 0.0, 0.0, self.outer - self.inner
        inside = np.maximum(r - self.inner, 0.0)
        for sign, power in ((4.0, 12), (-4.0, 6)):
            size, c = sign * self.epsilon * self.sigma**power, self.outer ** (power + 2)
            a = -power * ((power + 4) * self.outer - (power + 1) * self.inner) / (c * width**2)
            b = power * ((power + 3) * self.outer - (power + 1) * self.inner) / (c * width**3)
            shift = self.outer**-power - a * width**3 / 3 - b * width**4 / 4
            energy = energy + size * (r**-power - a * inside**3 / 3 - b * inside**4 / 4 - shift)
            force = force + size * (power * r ** -(power + 1) + a * inside**2 + b * inside**3)
        here = r < self.outer
        return energy * here, force * here


@dataclass(frozen=True)
class Charges:
    """Products of charges (n, m), as energies times lengths, damped and cut."""

    product: np.ndarray
    damping: float
    cut: float

    def terms(self, r):
        """Energy and -dU/dr, shapes (n, m)."""
        a = self.damping
        slope = 2.0 * a / np.sqrt(np.pi)
        at_cut = _erfc(a * self.cut) / self.cut**2 + slope * np.exp(-((a * self.cut) ** 2)) / self.cut
        screened = _erfc(a * r)
        energy = screened / r - _erfc(a * self.cut) / self.cut + at_cut * (r - self.cut)
        force = screened / r**2 + slope * np.exp(-((a * r) ** 2)) / r - at_cut
        here = r < self.cut
        return self.product * energy * here, self.product * force * here


def _erfc(x):
    t = 1.0 / (1.0 + _P * x)
    return t * (_A[0] + t * (_A[1] + t * (_A[2] + t * (_A[3] + t * _A[4])))) * np.exp(-x * x)


def rotation(q):
    """Matrix (3, 3) of a quaternion, scalar first, of any length."""
    w, x, y, z = q / np.sqrt(q @ q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class Encounter:
    """Two bodies: ``masses`` (2,), ``sites`` and ``site_masses`` of both, (n, 3) and (n,), in the pose of the deck
    about their centers.  ``forces``, a sequence of Dispersion and Charges; ``factor``, the energy of a unit of mass
    times length^2 / time^2.
    """

    def __init__(self, sites, site_masses, forces, factor=1.0):
        self.sites, self.forces, self.factor = sites, forces, factor
        self.masses = np.array([m.sum() for m in site_masses])
        self.inverse = [_inverse_inertia(x, m) for x, m in zip(sites, site_masses)]
        self.evaluations = 0

    def _loads(self, y):
        """Potential energy, forces (2, 3) and torques (2, 3)."""
        turns = [rotation(q) for q in y[:, Q]]
        one, two = (x @ turn.T for x, turn in zip(self.sites, turns))
        apart = (y[1, CENTER] + two)[None] - (y[0, CENTER] + one)[:, None]
        r = np.sqrt((apart * apart).sum(axis=2))
        energies, forces = zip(*(term.terms(r) for term in self.forces))
        pair = (sum(forces) / r)[:, :, None] * apart
        on_one, on_two = -pair.sum(axis=1), pair.sum(axis=0)
        torques = np.array([_cross(one, on_one).sum(axis=0), _cross(two, on_two).sum(axis=0)])
        return float(sum(energies).sum()), np.array([on_one.sum(axis=0), on_two.sum(axis=0)]), torques, turns

    def rates(self, _, packed):
        """Time derivative of a packed state (26,)."""
        self.evaluations += 1
        y = packed.reshape(2, 13)
        _, forces, torques, turns = self._loads(y)
        found = np.empty_like(y)
        found[:, CENTER] = y[:, VELOCITY]
        found[:, VELOCITY] = forces / self.factor / self.masses[:, None]
        found[:, MOMENTUM] = torques / self.factor
        for k in range(2):
            omega = turns[k] @ (self.inverse[k] @ (turns[k].T @ y[k, MOMENTUM]))
            s, v = y[k, 6], y[k, 7:10]
            found[k, 6] = -0.5 * (omega @ v)
            found[k, 7:10] = 0.5 * (s * omega + _cross(omega, v))
        return found.ravel()

    def energy(self, packed):
        """Sum of potential and kinetic energies."""
        y = packed.reshape(2, 13)
        potential, *_, turns = self._loads(y)
        kinetic = (self.masses * (y[:, VELOCITY] ** 2).sum(axis=1)).sum()
        for k in range(2):
            along = turns[k].T @ y[k, MOMENTUM]
            kinetic += along @ self.inverse[k] @ along
        return potential + 0.5 * self.factor * kinetic

    def fly(self, start, time, method="DOP853", tolerance=1e-13):
        """States (n, 26) at the steps of a method from the packed ``start`` (26,) until ``time``.

        The tolerance is relative to each component and to the largest of its kind.  Raises RuntimeError.
        """
        sizes = np.empty((2, 13))
        for columns in (CENTER, VELOCITY, Q, MOMENTUM):
            sizes[:, columns] = np.abs(start.reshape(2, 13)[:, columns]).max() or 1.0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings about tolerances near the smallest possible tolerance
            found = solve_ivp(
                self.rates, (0.0, time), start, method, rtol=tolerance, atol=tolerance * sizes.ravel()
            )
        if not found.success:
            raise RuntimeError(f"{method}: {found.message}")
        return found.y.T


def _cross(a, b):
    return a[..., [1, 2, 0]] * b[..., [2, 0, 1]] - a[..., [2, 0, 1]] * b[..., [1, 2, 0]]


def _inverse_inertia(sites, masses):
    """Inverse tensor of inertia (3, 3), zero along axes without inertia."""
    tensor = np.einsum("s,sij->ij", masses, (sites**2).sum(1)[:, None, None] * np.eye(3)) - (masses * sites.T) @ sites
    moments, axes = np.linalg.eigh(tensor)
    inverse = np.where(moments > 1e-7 * max(moments.max(), 1e-300), 1.0 / np.maximum(moments, 1e-300), 0.0)
    return (axes * inverse) @ axes.T
