"""Temperatures by axis, dipole moment, diffusion and rotation of the molecules, from the dump of a run."""

import math
from dataclasses import dataclass

import numpy as np

from gearquat_analysis import Poses, open_dump
from gearquat_analysis.averages import integral_time
from gearquat_analysis.correlations import lags, mean_square_displacement, orientation_correlation
from gearquat_analysis.fluctuations import dipole_moments
from gearquat_analysis.box import own_motion
from gearquat_analysis.units import UNITS

REAL = UNITS["real"]
#: lags in ps between which the mean-square displacement is fitted: motion in cages lasts about a picosecond
LINEAR = (2.0, 8.0)
#: principal axes, the largest moment first: perpendicular to the molecule, dipole, and H-H
AXES = ("normal", "dipole", "H-H")
#: fewest frames of a part for its diffusion and rotation
FEWEST = 100
#: TIP4P/2005: distance of the negative charge from the oxygen, and the length of the sum of both bonds, in Angstrom
SHIFTED, BOTH_BONDS = 0.1546, 2 * 0.9572 * math.cos(math.radians(104.52 / 2))
#: dipole moment divided by the moment of charges at the three atoms
OF_ATOMS = {"tip4p": 1.0 - 2.0 * SHIFTED / BOTH_BONDS, "spce": 1.0}


@dataclass(frozen=True)
class Motion:
    """Means over a part of a run.

    ``normal``, ``dipole``, ``hydrogens``: temperatures in kelvin of the rotation about the three AXES.  ``moment2``: square
    of the total dipole moment in (e Angstrom)^2.  ``diffusion``: a sixth of the slope of the mean-square displacement,
    relative to the box, in Angstrom^2/ps.  ``turning``: integral of the second-order orientational correlation of the
    vector H-H in ps.  The latter two are NaN if the part is too short.
    """

    normal: float
    dipole: float
    hydrogens: float
    moment2: float
    diffusion: float
    turning: float


def read_motion(dump, model, blocks):
    """List of Motion in equal parts of a dump, without its first frame."""
    universe = open_dump(dump)
    poses = Poses(universe.atoms).run(start=1)
    results, bodies = poses.results, poses.bodies
    moments = OF_ATOMS[model] * dipole_moments(poses)
    time, centers = results.time * REAL.ps, own_motion(results)
    omega = np.array([np.einsum("bij,bj->bi", bodies.axes_space(q), w) for q, w in zip(results.q, results.omega_space)])
    hot = REAL.energy * np.mean(bodies.moments * omega**2, axis=1) / REAL.boltzmann
    length = len(time) // blocks
    parts = [slice(k * length, (k + 1) * length) for k in range(blocks)]
    return [_motion(time[own], hot[own], moments[own], centers[own], results.q[own], bodies) for own in parts]


def _motion(time, hot, moments, centers, q, bodies):
    diffusion = turning = math.nan
    if len(time) >= FEWEST:
        lag = lags(time)
        linear = (lag >= LINEAR[0]) & (lag <= LINEAR[1])
        diffusion = float(np.polyfit(lag[linear], mean_square_displacement(centers)[linear], 1)[0]) / 6.0
        turning = integral_time(lag, orientation_correlation(q, bodies.axes[:, 2], order=2))
    square = float(np.mean(np.sum(moments**2, axis=1)))
    return Motion(*(float(t) for t in hot.mean(axis=0)), square, diffusion, turning)
