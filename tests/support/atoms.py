"""Flights of two atoms by quadrature instead of LAMMPS; the code of ``gearquat scatter`` draws and averages them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scipy.special import gammaincinv

from benchmarks.reference.deflection import Deflection, LennardJones, TwelveFour
from lammps_gearquat.scatter.flights import Facts
from lammps_gearquat.scatter.integrals import quantities
from lammps_gearquat.scatter.sampling import Plan

#: random numbers of a flight of two atoms
DIMENSION = 8
BOLTZMANN = 0.0019872067  # kcal/mol/K


@dataclass(frozen=True)
class Atoms:
    """Two atoms of mass 1 in reduced units, with a ``potential`` of benchmarks.reference.central; ``largest`` impact
    parameter."""

    potential: object
    largest: float

    #: the Pair of ``gearquat scatter`` for two atoms
    facts = Facts((0, 0), None, 0.5, True, "lj", DIMENSION)

    @cached_property
    def deflection(self):
        return Deflection(self.potential)

    def cross_section(self, order, energy):
        """Integral (n,) of (1 - cos^order chi) 2 pi b db at energies (n,)."""
        b = np.linspace(0.0, 1.0, 4001)[1:] ** 2 * self.largest
        angles = np.array([self.deflection.angles(np.full(len(b), one), b) for one in energy])
        return np.trapezoid((1.0 - np.cos(angles) ** order) * 2.0 * np.pi * b, b)

    def exact(self, order, temperature):
        """Omega(order, order), relative to spheres of diameter 1: the mean of cross sections over energies."""
        x = gammaincinv(order + 2, (np.arange(200) + 0.5) / 200)
        sphere = np.pi * (1.0 - (1.0 + (-1.0) ** order) / (2.0 + 2.0 * order))
        return self.cross_section(order, x * temperature).mean() / sphere

    def columns(self, b, energy):
        """Columns of flights, numbered from 0, with impact parameters and energies (n,)."""
        angle = np.concatenate(
            [self.deflection.angles(*part) for part in zip(*(np.array_split(a, len(b) // 4096 + 1) for a in (energy, b)))]
        )
        known = {"flight": np.arange(len(b)), "b": b, "energy": energy, "energy_after": energy, "angle": angle}
        words = {"fate": np.full(len(b), "parted"), "message": np.full(len(b), "")}
        return known | words | {"error_energy": np.zeros(len(b))}

    def plan(self, seed, temperature, energy=None):
        distances = np.geomspace(self.largest, 0.05, 4000)
        potential = np.maximum.accumulate(np.abs(self.potential.energy(distances)))
        return Plan(
            seed, temperature, energy, temperature or 0.0, energy or temperature, self.largest, distances, potential
        )

    def rounds(self, plan):
        """Columns of the flights of a Plan after each round."""
        points = np.empty((0, DIMENSION))
        for more in plan.points(DIMENSION):
            points = np.concatenate([points, more])
            energy = plan.energies(points[:, 1])
            yield self.columns(plan.impact(points[:, 0], energy), energy)

    def quantities(self, plan, columns):
        """Name -> (value, error); collision integrals are relative to those of spheres of diameter 1."""
        found = {one.name: np.array([one.value, one.error]) for one in quantities(columns, plan, self.facts)}
        if plan.energy:
            return found
        sphere = np.sqrt(plan.temperature * np.pi)  # (k T / (2 pi mu))^(1/2) pi for mu = 1/2
        return found | {f"{k}": found[f"Omega({k},{k})"] / (k * sphere) for k in (1, 2)}


#: argon; ions in units of a well of 0.2 kcal/mol and a diameter of 2.8 Angstrom
ARGON, ION = Atoms(LennardJones(), 30.0 / 3.405), Atoms(TwelveFour(), 25.0 / 2.8)
