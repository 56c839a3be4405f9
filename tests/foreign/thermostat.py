"""Keyword temp together with other styles: the degrees of freedom agree with the motion.

All atoms are in bodies, and their total momentum is zero at first.  A component of the total momentum that the log excludes
from the degrees of freedom must be constant apart from rounding, for any other style.
"""

import re
from typing import NamedTuple

import numpy as np

from . import scene

TARGET = 1.2
MOVER = f"gear/quat molecule values 9 temp {TARGET} {TARGET} 0.5"
#: LAMMPS 4 Feb 2025 does not divide the heat by the number of atoms
OUTPUT = ("thermo_modify norm no",)
#: after the scene is made: no atoms outside of bodies, no total momentum
BEGIN = ("delete_atoms group free compress no", "velocity all zero linear")
#: styles that are thermostats themselves, which the fix refuses
THERMOSTATS = re.compile(r"temp/.*|langevin")
#: styles that put atoms into their group; other styles have no effect if the group is empty
INSERTS = ("deposit", "gcmc")
#: when it is noted: at the end of the first run and of the second
MOMENTS = ("middle", "atoms")
#: elements of the fix's vector: kinetic energies, heat, temperatures of translation and rotation
TRANSLATION, ROTATION, HEAT, OF_TRANSLATION, OF_ROTATION, ELEMENTS = 0, 1, 8, 9, 10, 12
#: of the sum of all momenta without their signs: change of a total momentum that is constant
ROUNDING = 1e-11
#: of a number of degrees of freedom
EXACT = 1e-6
#: change of the conserved energy in units of the heat that the thermostat takes
DRIFT = 2e-3
SAID = re.compile(r"thermostat of (\d+) degrees of freedom of translation(.*) and (\d+) of rotation")
EXCLUDED = re.compile(r"without those of the total momentum(?: along ([xyz])(?: and ([xyz]))?)?,")


class Bodies(NamedTuple):
    """Equal bodies, whose atoms come first: masses of a body's atoms, number, Boltzmann constant."""

    masses: tuple = scene.SITE_MASSES
    number: int = scene.MOLECULES
    boltzmann: float = 1.0


def note(moment):
    """Lines of a job that note what `faults` reads, besides the atoms."""
    return [f"@vector vector-{moment} m {ELEMENTS}", f"@thermo energy-{moment} econserve"]


def momenta(atoms, bodies):
    """Array of the momenta of all atoms in bodies; ``atoms``: a row (ID, x, v) per atom."""
    sites = len(bodies.masses)
    of_bodies = atoms[atoms[:, 0] <= sites * bodies.number]
    masses = np.take(bodies.masses, (of_bodies[:, 0].astype(int) - 1) % sites)
    return masses[:, None] * of_bodies[:, 4:]


def constant_directions(before, after, bodies):
    """Directions in which the total momentum is constant; if bodies were removed, all directions."""
    first, last = momenta(before, bodies), momenta(after, bodies)
    if len(first) != len(last):
        return {0, 1, 2}
    change = np.abs(last.sum(axis=0) - first.sum(axis=0))
    return set(np.flatnonzero(change <= ROUNDING * np.abs(last).sum()))


def excluded_directions(words):
    """Directions of the total momentum that a line of the log excludes."""
    found = EXCLUDED.search(words)
    if not found:
        return []
    return ["xyz".index(one) for one in found.groups() if one] or [0, 1, 2]


def freedoms(atoms, vector, directions, bodies):
    """Degrees of freedom of translation and rotation, as they must be and as the fix has them.

    The fix has twice a kinetic energy by its temperature, without the energy of a common motion, which
    is nonzero in units with mvv2e = 1 only.
    """
    present = momenta(atoms, bodies)
    number = len(present) // len(bodies.masses)
    total = present.sum(axis=0)[list(directions)]
    common = 0.5 * total @ total / (number * sum(bodies.masses))
    energies = vector[TRANSLATION] - common, vector[ROTATION]
    temperatures = vector[OF_TRANSLATION], vector[OF_ROTATION]
    own = [float(2.0 * e / (bodies.boltzmann * t)) for e, t in zip(energies, temperatures)]
    return (3 * number - len(directions), 3 * number), own


def faults(answer, conserves, bodies=Bodies()):
    """The errors in a result, as texts; ``conserves`` if the other style's energy is in the total."""
    found = []
    said = [line for line in map(SAID.search, answer.warnings) if line]
    if not said:
        return ["the log has no degrees of freedom"]
    excluded = excluded_directions(said[-1][2])
    for before, moment in zip(("begin", *MOMENTS), MOMENTS):
        atoms, vector = answer.noted[moment], answer.noted[f"vector-{moment}"]
        constant = constant_directions(answer.noted[before], atoms, bodies)
        if not constant.issuperset(excluded):
            found.append(f"the total momentum changes in directions {set(excluded) - constant}, which do not count")
        right, own = freedoms(atoms, vector, excluded, bodies)
        if not np.allclose(own, right, rtol=0.0, atol=EXACT):
            found.append(
                "degrees of freedom of translation and rotation are {:g} and {:g}, not {} and {}"
                .format(*own, *right)
            )
    same = len(momenta(answer.noted[before], bodies)) == len(momenta(atoms, bodies))  # the log reports removals later
    if same and [int(said[-1][1]), int(said[-1][3])] != [round(n) for n in own]:
        found.append(f"the log has other degrees of freedom than the vector, {own}")
    if conserves:
        energies = [answer.noted[f"energy-{moment}"] for moment in MOMENTS]
        heats = [answer.noted[f"vector-{moment}"][HEAT] for moment in MOMENTS]
        change, heat = (abs(after - before) for before, after in (energies, heats))
        if not change <= DRIFT * heat:
            found.append(f"the conserved energy changes by {change:.1e}, and the heat by {heat:.1e}")
    return found
