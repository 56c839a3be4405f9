"""Made-up series with known answers."""

import numpy as np

from lammps_gearquat.series import Series


def make(time, centre, potential=None, translation=None, rotation=None, error=None):
    """Series at ``time`` (n,) with the given columns; what is not given is zero or constant."""
    n = len(time)

    def column(values, default=0.0):
        return np.full(n, default) if values is None else np.asarray(values, dtype=float)

    potential, translation = column(potential), column(translation)
    rotation = column(rotation, 1.0)
    total = potential + translation + rotation if error is None else 1.0 + column(error)
    centre = np.asarray(centre, dtype=float)
    return Series(time, time, centre, potential, translation, rotation, total, np.zeros(n))


def line(end=100, rate=(0.0, 0.0, 0.0), start=(0.0, 0.0, 0.0), **columns):
    """A body in uniform motion, sampled once per unit of time."""
    time = np.arange(end + 1.0)
    return make(time, np.asarray(start) + np.outer(time, rate), **columns)
