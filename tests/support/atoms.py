"""Flights of two atoms by quadrature instead of LAMMPS; the code of ``gearquat scatter`` draws and averages them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.reference.central import CollisionIntegrals, LennardJones, TwelveFour
from benchmarks.reference.deflection import Deflection

#: random numbers of a flight of two atoms
DIMENSIONS = 8
BOLTZMANN = 0.0019872067  # kcal/mol/K


@dataclass(frozen=True)
class Atoms:
    """Two atoms of mass 1 in reduced units, with a ``potential`` of benchmarks.reference.central up to a ``cutoff``."""

    potential: object
    cutoff: float

    @cached_property
    def facts(self):
        """The Pair of ``gearquat scatter`` for two atoms."""
        from lammps_gearquat.scatter.pool import Facts

        none, zeros = [0, 0], [[0.0] * 3] * 2
        return Facts("atoms", [1.0] * 2, zeros, none, None, 0.5, True, self.cutoff, 1.05 * self.cutoff, none, "lj", [])

    @cached_property
    def deflection(self):
        return Deflection(self.potential)

    @cached_property
    def exact(self):
        """Function (l, s, temperature) of the reduced collision integrals, without a largest impact parameter."""
        return CollisionIntegrals(self.potential, self.deflection.limit)

    def columns(self, b, energy):
        """Columns of flights, numbered from 0, with impact parameters and energies (n,)."""
        angle = np.concatenate(
            [self.deflection.angles(*part) for part in zip(*(np.array_split(a, len(b) // 4096 + 1) for a in (energy, b)))]
        )
        nothing, words = np.zeros(len(b)), np.full(len(b), "")
        known = {"flight": np.arange(len(b)), "b": b, "energy": energy, "energy_after": energy, "angle": angle}
        names = ("rotation_1", "rotation_2", "error_energy", "error_momentum", "error_angular")
        counts = dict.fromkeys(("turnings", "steps", "repeats"), nothing.astype(int))
        return known | dict.fromkeys(names, nothing) | counts | {"fate": np.full(len(b), "parted"), "message": words}

    def plan(self, seed, temperatures, error, energy=None):
        """(Plan, Largest) from the pilot flights with this seed."""
        from lammps_gearquat.scatter import conduct, pilots
        from lammps_gearquat.scatter.sampling import Plan

        plan = Plan((seed,), temperatures, energy, None, 0.0)
        places = pilots.cells(plan, self.cutoff, 1.0, DIMENSIONS - 2)
        columns = self.columns(places.b.ravel(), places.energy.ravel())
        return pilots.settle(plan, self.facts, places, columns, 1.0, conduct.LEFT_OUT * error)

    def flights(self, plan, number):
        """Columns of the first flights of a Plan."""
        from lammps_gearquat.scatter.sampling import uniform

        return self.columns(*plan.drawn(uniform(plan.seed, np.arange(number), DIMENSIONS), 1.0))

    def results(self, plan, farthest, columns, number):
        """Results of the first ``number`` flights."""
        from lammps_gearquat.scatter.results import results

        return results({name: own[:number] for name, own in columns.items()}, plan, self.facts, 1.0, farthest.left)


#: a cutoff of 30 Å of argon; an ion with a well of 0.2 kcal/mol and a diameter of 2.8 Å, with cutoffs of 25 and 60 Å
ARGON = Atoms(LennardJones(), 30.0 / 3.405)
IONS = {300.0: Atoms(TwelveFour(), 25.0 / 2.8), 20.0: Atoms(TwelveFour(), 60.0 / 2.8)}


def until(atoms, temperature, seed, error, most=1_000_000):
    """(number of flights, Answer) at which the command would stop."""
    from lammps_gearquat.scatter.conduct import rounds

    plan, farthest = atoms.plan(seed, (temperature,), error)
    for number in rounds(most):
        found = atoms.results(plan, farthest, atoms.flights(plan, number), number)
        if found.relative <= error:
            break
    return number, found.answers[0]
