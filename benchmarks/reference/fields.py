"""Fields that act on the sites: the cage of the paper, and no field.  Fields of LAMMPS are in lammps_forces.py.

A field has
    energy_and_forces(positions)  potential energy and forces (S, 3) at site positions (S, 3)
    force_to_acceleration, kinetic_to_energy   factors of its units (LAMMPS' ftm2v and mvv2e)
    dtype                         float type its forces are good to, None for any
    astype(dtype)                 itself, for states of another float type
"""

import numpy as np


class LennardJonesUnits:
    """Units in which both factors are 1."""

    force_to_acceleration = 1.0
    kinetic_to_energy = 1.0
    dtype = None


class FreeField(LennardJonesUnits):
    """No forces."""

    def energy_and_forces(self, positions):
        """Zero energy, zero forces."""
        return positions.dtype.type(0), np.zeros_like(positions)

    def astype(self, _dtype):
        """The field itself: it follows the positions' float type."""
        return self



class Cage(LennardJonesUnits):
    """The paper's 26 fixed spheres around one body of four sites; Eq. 19.

    The charges are reconstructed, the paper does not print them: of the thirteen pairs of mirror
    images the sphere for which the first non-zero entry of (z, y, -x) is positive carries -1.
    Site 4 and the cage have a Lennard-Jones well (epsilon 10, sigma 10), sites 1 to 3 none.
    """

    SITE_CHARGES = (-0.25, -0.25, -0.5, 1.0)
    SIGMA, EPSILON = 10, 10

    def __init__(self, dtype=np.longdouble):
        levels = (-1, 0, 1)
        grid = [(x, y, z) for z in levels for y in levels for x in levels if x or y or z]
        positive = np.array([(z or y or -x) > 0 for x, y, z in grid])
        self.positions = 100 * np.array(grid, dtype=dtype)
        self.charges = np.where(positive, -1, 1).astype(dtype)
        self.site_charges = np.array(self.SITE_CHARGES, dtype=dtype)

    def energy_and_forces(self, positions):
        """Energy, and forces (4, 3) at site positions (4, 3)."""
        gap = positions[:, None, :] - self.positions
        square = (gap * gap).sum(axis=2)
        coulomb = self.site_charges[:, None] * self.charges / np.sqrt(square)
        sixth = (self.SIGMA**2 / square[3]) ** 3
        well = 4 * self.EPSILON * sixth
        radial = coulomb / square
        radial[3] += well * (12 * sixth - 6) / square[3]
        forces = (radial[:, :, None] * gap).sum(axis=1)
        return coulomb.sum() + (well * (sixth - 1)).sum(), forces

    def astype(self, dtype):
        """The cage in another float type."""
        return Cage(dtype)
