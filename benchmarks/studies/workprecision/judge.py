"""Errors of one run against the reference of its scene.

Positions and orientations are judged by the poses that carry the bodies' sites at the start onto
those at the end; the reference is given by the sites' positions at the end, too.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from lammps_gearquat.analysis.bodies import Bodies
from lammps_gearquat.analysis.superposition import superpose
from .plan import NORM, TANGENCY, TOTAL


@dataclass(frozen=True)
class Errors:
    """Errors of a run, in the units of its deck; inf where the run went astray.

    ``position``: distance of the centres of mass at the end, ``orientation``: angle of the rotation
    from the reference to the run, radians; both root mean square over the bodies.  ``energy``: largest
    deviation of the total energy from its start over the samples; ``drift``: magnitude of its slope,
    least squares over the samples, per unit of time.  ``norm``: largest | |q|^2 - 1 |, ``tangency``:
    largest | q.qdot | over the samples; NaN where the method has no quaternion of its own.
    """

    position: float
    orientation: float
    energy: float
    drift: float
    norm: float
    tangency: float


def pose_errors(masses, molecules, before, after, reference):
    """(position, orientation) as in Errors; all positions (n, 3), unwrapped; molecule 0 is in no body."""
    if not np.isfinite(after).all():
        return np.inf, np.inf
    bodies = Bodies(molecules, masses)
    bodies.set_shape(before[bodies.index])
    centres, turns = [], []
    for sites in (reference[bodies.index], after[bodies.index]):
        centres.append(bodies.center(sites))
        q, _ = superpose(bodies, sites - centres[-1][bodies.of])
        turns.append(Rotation.from_quat(q, scalar_first=True))
    shifts = np.linalg.norm(centres[1] - centres[0], axis=1)
    angles = (turns[1] * turns[0].inv()).magnitude()
    return tuple(float(np.sqrt(np.mean(np.square(x)))) for x in (shifts, angles))


def energy_errors(time, total):
    """(energy, drift) as in Errors."""
    deviation = np.abs(total - total[0])
    if not np.isfinite(deviation).all():
        return np.inf, np.inf
    return float(deviation.max()), abs(float(np.polyfit(time - time[0], total - total[0], 1)[0]))


def errors_of(outcome, reference):
    """Errors of an Outcome of a sampled run."""
    position = pose_errors(
        outcome.masses, outcome.molecules, outcome.before, outcome.after, reference
    )
    thermo = outcome.thermo
    energy = energy_errors(thermo["Time"], thermo[TOTAL])
    largest = [
        float(np.abs(thermo[column]).max()) if TANGENCY in thermo else np.nan
        for column in (NORM, TANGENCY)
    ]
    return Errors(*position, *energy, *largest)
