"""Compressibility and dielectric constant from fluctuations of the volume and of the dipole moment.

Both are averages of a square and need much longer blocks than the average of the quantity itself.  Errors are from
``of_series``.
"""

import numpy as np
from scipy.constants import Boltzmann

from .blocks import Estimate, of_series
from .superposition import rotate
from .units import UNITS

#: a body is an ion if its total charge is above this fraction of the largest charge of a site
NEUTRAL = 1e-4


def compressibility(poses, volume, temperature, weights=None):
    """Estimate of the isothermal compressibility from volumes (F,) at constant pressure, in 1/GPa; with units lj, σ³/ε.

    It is (<V²> - <V>²) / (kB T <V>), with the ``temperature`` of the bodies.
    """
    units = UNITS[poses.units or "lj"]
    mean = np.average(volume, weights=weights)
    found = of_series((volume - mean) ** 2, weights)
    factor = 1.0 / (units.boltzmann * temperature * mean)
    if poses.units not in (None, "lj"):
        factor *= (1e-10 * units.angstrom) ** 3 * units.boltzmann / Boltzmann * 1e9
    return Estimate(factor * found.value, factor * found.error, found.why)


def dipole_moments(poses):
    """Total dipole moment of all bodies in each frame, (F, 3), charge x length, from the sites' ``charges``.

    Raises ValueError if there are no charges, or if a body has a net charge: the dipole moment of an ion depends on the
    origin.
    """
    bodies, q = poses.bodies, poses.results.q
    charges = getattr(poses.atoms, "charges", None)
    if charges is None or not np.any(charges):
        raise ValueError("the dump has no charges (column q)")
    charges = np.asarray(charges, dtype=float)[bodies.index]
    largest = np.abs(charges).max()
    if np.abs(bodies.sum(charges)).max() > NEUTRAL * largest:
        raise ValueError("bodies have charges, and the dipole moment of ions depends on the origin")
    own = bodies.sum(charges[:, None] * bodies.shape)
    return np.array([rotate(one, own).sum(axis=0) for one in q])


def dielectric_constant(poses, temperature, weights=None):
    """Estimate of the static dielectric constant of an isotropic periodic system with Ewald sums or PPPM.

    It is 1 + 4 pi C <M²> / (3 V kB T), with Coulomb's constant C and conducting boundaries (M. Neumann, Mol. Phys. 50,
    841 (1983), Eq. 21); <M> is taken as zero.  NaN with the reason if there are no charges, if there are ions, or if a
    direction is not periodic.
    """
    try:
        moments = dipole_moments(poses)
    except ValueError as error:
        return Estimate.missing(str(error))
    if not poses.periodic.all():
        return Estimate.missing("the box is not periodic in all directions")
    units = UNITS[poses.units or "lj"]
    volume = np.abs(np.linalg.det(poses.results.cell[:, 1:]))
    found = of_series(np.sum(moments**2, axis=1) / volume, weights)
    factor = 4.0 * np.pi * units.coulomb / (3.0 * units.boltzmann * temperature)
    return Estimate(1.0 + factor * found.value, factor * found.error, found.why)
