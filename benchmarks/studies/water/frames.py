"""Diffusion and rotation of the molecules, from the dump of a run."""

import math
from dataclasses import dataclass

import numpy as np

from gearquat_analysis import Poses, open_dump
from gearquat_analysis.averages import integral_time
from gearquat_analysis.correlations import lags, mean_square_displacement, orientation_correlation
from gearquat_analysis.box import own_motion
from gearquat_analysis.units import UNITS

REAL = UNITS["real"]
#: lags in ps between which the mean-square displacement is fitted: motion in cages lasts about a picosecond
LINEAR = (2.0, 8.0)
#: fewest frames of a part for its diffusion and rotation
FEWEST = 100


@dataclass(frozen=True)
class Motion:
    """Means over a part of a run.

    ``diffusion``: a sixth of the slope of the mean-square displacement,
    relative to the box, in Angstrom^2/ps.  ``turning``: integral of the second-order orientational correlation of the
    vector H-H in ps.  NaN if the part is too short.
    """

    diffusion: float
    turning: float


def read_motion(dump, blocks):
    """List of Motion in equal parts of a dump, without its first frame."""
    poses = Poses(open_dump(dump).atoms).run(start=1)
    results = poses.results
    time, centers = results.time * REAL.ps, own_motion(results)
    length = len(time) // blocks
    parts = [slice(k * length, (k + 1) * length) for k in range(blocks)]
    return [_motion(time[own], centers[own], results.q[own], poses.bodies) for own in parts]


def _motion(time, centers, q, bodies):
    if len(time) < FEWEST:
        return Motion(math.nan, math.nan)
    lag = lags(time)
    linear = (lag >= LINEAR[0]) & (lag <= LINEAR[1])
    diffusion = float(np.polyfit(lag[linear], mean_square_displacement(centers)[linear], 1)[0]) / 6.0
    return Motion(diffusion, integral_time(lag, orientation_correlation(q, bodies.axes[:, 2], order=2)))
