"""Averages over a run with standard errors: temperatures, diffusion, rotational correlation times.

A run is cut into equal blocks; each gives a value, and the scatter of these the standard error (H.
Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91, 461 (1989)), which is right if a block is longer than what
it averages remembers.  All functions take finished ``Poses``, which know masses and moments.
"""

import math
from typing import NamedTuple

import numpy as np

from .units import UNITS
from . import correlations, export
from .superposition import rotate

#: of the averages of series, and of functions of time
BLOCKS, LONG_BLOCKS = 10, 5
#: fewest frames of a block in which a function of time can be fitted
FEWEST = 20
#: a total momentum whose energy is below this part of that of a degree of freedom is at rest
AT_REST = 1e-3
#: correlation at which its integral ends, and above which its tail is fitted
TAIL, BEFORE_TAIL = 0.1, 0.3


class Average(NamedTuple):
    """A number of a run with its standard error, NaN if the run is too short for it.

    >>> from gearquat_analysis.averages import Average
    >>> Average("diffusion coefficient", 0.3124, 0.0153, "Å²/ps").text()
    '0.312 ± 0.015 Å²/ps'
    """

    name: str
    value: float
    error: float
    unit: str

    @property
    def known(self):
        return bool(np.isfinite([self.value, self.error]).all())

    def text(self):
        """Value and error, the latter with two digits: 0.312 ± 0.015 Å²/ps, (2.74 ± 0.19)e-4 Å²/fs."""
        if not self.known or not self.error > 0.0:
            return f"{self.value:.4g} ± {self.error:.2g} {self.unit}".rstrip()
        last = math.floor(math.log10(self.error)) - 1
        power = math.floor(math.log10(abs(self.value) or self.error))
        power = power if not -4 < power < 6 else 0
        value, error = (f"{number / 10.0**power:.{max(power - last, 0)}f}" for number in (self.value, self.error))
        both = f"({value} ± {error})e{power}" if power else f"{value} ± {error}"
        return f"{both} {self.unit}".rstrip()


class Averages(list):
    """A list of every Average.

    >>> from gearquat_analysis import Poses, averages, open_dump
    >>> found = averages.averages(Poses(open_dump("nitrogen.dump").atoms).run(step=4))
    >>> found.to_dataframe()["name"][1], len(found)
    ('temperature of rotation', 7)
    """

    def to_dataframe(self):
        """pandas.DataFrame with the columns name, value, error and unit."""
        columns = dict(zip(Average._fields, zip(*self)))
        return export.dataframe(columns, {})


def of_blocks(values):
    """Mean of the values (n,) of n blocks and its standard error; (NaN, NaN) if one is NaN."""
    values = np.asarray(values, dtype=float)
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def of_series(series, count=BLOCKS):
    """Mean of a series (F,) and its standard error from ``count`` blocks; a remainder comes first and is left out.

    NaN if there are fewer samples than blocks.
    """
    length = len(series) // count
    if length < 1:
        return float("nan"), float("nan")
    return of_blocks(series[-length * count :].reshape(count, length).mean(axis=1))


def _boltzmann(poses):
    return UNITS[poses.units or "lj"].boltzmann


def temperatures(poses):
    """Temperatures of all frames, name -> (F,): of translation, of rotation and about each principal axis.

    The degrees of freedom of translation do not contain the total momentum if it is zero.  Empty without
    velocities or moments.  In LAMMPS' units; without ``units`` in those of mass x velocity^2.
    """
    bodies, results = getattr(poses, "bodies", None), poses.results
    if bodies is None or "velocity" not in results:
        return {}
    k, energy = _boltzmann(poses), UNITS[poses.units or "lj"].energy
    momentum = np.einsum("b,fbi->fi", bodies.mass, results.velocity)
    twice = 2.0 * results.ke_translation.sum(axis=1)
    of_total = energy * (momentum**2).sum(axis=1) / bodies.mass.sum()
    resting = of_total.mean() < AT_REST * twice.mean() / (3 * len(bodies))
    freedoms = 3 * len(bodies) - (3 if resting and len(bodies) > 1 else 0)
    found = {"translation": twice / (freedoms * k)}
    turning = bodies.moments > 0.0
    if not turning.any():
        return found
    found["rotation"] = 2.0 * results.ke_rotation.sum(axis=1) / (turning.sum() * k)
    for axis in range(3):
        own = turning[:, axis]
        if not own.any():
            continue
        sums = np.empty(len(results.time))
        for frame in range(len(sums)):
            along = rotate(results.q[frame, own], bodies.axes[own, axis])
            spin = np.einsum("bi,bi->b", along, results.omega_space[frame, own])
            sums[frame] = (bodies.moments[own, axis] * spin**2).sum()
        found[f"rotation about axis {axis + 1}"] = energy * sums / (own.sum() * k)
    return found


def _long_blocks(frames):
    """Slices of the blocks in which functions of time are found; empty if these would be too short."""
    length = frames // LONG_BLOCKS
    first = frames - length * LONG_BLOCKS
    return [slice(first + i * length, first + (i + 1) * length) for i in range(LONG_BLOCKS)] if length >= FEWEST else []


def diffusion(time, center):
    """Diffusion coefficient of centers (F, B, 3) and its standard error, length squared / time.

    A sixth of the slope of the mean-square displacement at lags from a tenth to a half of a block.
    NaN if blocks have too few frames.
    """
    values = []
    for own in _long_blocks(len(time)):
        lag, square = correlations.lags(time[own]), correlations.mean_square_displacement(center[own])
        part = slice(len(lag) // 10, len(lag) // 2)
        values.append(np.polyfit(lag[part], square[part], 1)[0] / 6.0)
    return of_blocks(values) if values else (float("nan"), float("nan"))


def integral_time(lag, correlation):
    """Integral of a correlation function (F,) that begins with 1, over all times.

    It is summed until the function falls below 0.1; the rest is that of the exponential which it follows since it
    was 0.3.  NaN if it does not fall so far within half of the lags.
    """
    half = correlation[: len(correlation) // 2]
    if not (half < TAIL).any():
        return float("nan")
    end = int(np.argmax(half < TAIL))
    before = min(int(np.argmax(half < BEFORE_TAIL)), end - 1)
    rest = 0.0
    if correlation[end] > 0.0:
        rest = correlation[end] * (lag[end] - lag[before]) / np.log(correlation[before] / correlation[end])
    return float(np.trapezoid(correlation[: end + 1], lag[: end + 1]) + rest)


def rotational_time(time, q, axis, order):
    """Correlation time of a body's axis, as ``orientation_correlation`` has it, and its standard error.

    NaN if blocks are too short for the correlation to decay.
    """
    values = []
    for own in _long_blocks(len(time)):
        correlation = correlations.orientation_correlation(q[own], axis, order)
        values.append(integral_time(correlations.lags(time[own]), correlation))
    return of_blocks(values) if values else (float("nan"), float("nan"))


def averages(poses):
    """The Averages that finished ``Poses`` or ``TablePoses`` have the data for.

    Raises ValueError if frames are not evenly spaced in time.
    """
    results, bodies = poses.results, getattr(poses, "bodies", None)
    found = Averages(
        Average(f"temperature of {name}", *of_series(series), poses.unit("temperature"))
        for name, series in temperatures(poses).items()
    )
    correlations.lags(results.time)
    name = "diffusion coefficient"
    found.append(Average(name, *diffusion(results.time, results.center), poses.unit(name)))
    if bodies is not None and bodies.point.all():
        return found
    linear = bodies is not None and (bodies.linear | bodies.point).any()
    for k in (2,) if linear else range(3):
        axis = np.eye(3)[k] if bodies is None else bodies.axes[:, k]
        for order in (1, 2):
            time = rotational_time(results.time, results.q, axis, order)
            unit = poses.unit("correlation time")
            found.append(Average(f"correlation time of axis {k + 1}, order {order}", *time, unit))
    return found
