"""Averages over a run with standard errors: temperatures, diffusion, rotational correlation times.

A run is cut into equal blocks; each gives a value, and the scatter of these the standard error (H.
Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91, 461 (1989)), which is right if a block is longer than what
it averages remembers.  All functions take finished ``Poses``, which know masses and moments.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from .units import UNITS
from . import correlations, export
from .bodies import axes_named, axis_groups, equal_moments

#: of the averages of series, and of functions of time
BLOCKS, LONG_BLOCKS = 10, 5
#: fewest frames of a block in which a function of time can be fitted
FEWEST = 20
#: a total momentum whose energy is below this part of that of a degree of freedom is at rest
AT_REST = 1e-3
#: angular velocities of another axis, by those about z, that are rounding in a run of dimension 2
IN_PLANE = 1e-6
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
    ('temperature of rotation', 5)
    """

    def to_dataframe(self):
        """pandas.DataFrame with the columns name, value, error and unit."""
        columns = dict(zip(Average._fields, zip(*self)))
        return export.dataframe(columns, {})


def of_blocks(values):
    """Mean of the values (n,) of n blocks and its standard error; (NaN, NaN) if one is NaN."""
    values = np.asarray(values, dtype=float)
    return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))


def of_series(series, count=BLOCKS, weights=None):
    """Mean of a series (F,), and its standard error from ``count`` blocks that differ by one sample at most.

    ``weights`` (F,) of the samples, equal unless given.  The error is NaN if there are fewer samples than blocks.
    """
    series = np.asarray(series, dtype=float)
    weights = np.ones(len(series)) if weights is None else np.asarray(weights, dtype=float)
    mean = float(np.average(series, weights=weights))
    if len(series) < count:
        return mean, float("nan")
    parts = np.array_split(series * weights, count), np.array_split(weights, count)
    # how much each block moves the mean; of equal weights this is the standard error of the blocks' mean
    moves = [(part.sum() - mean * weight.sum()) / weights.sum() for part, weight in zip(*parts)]
    return mean, math.sqrt(count / (count - 1) * np.sum(np.square(moves)))


def weights_of(time):
    """Weights (F,) of frames at ``time`` (F,): the time to the middle between a frame and those beside it.

    The first and the last count for the whole of it, so that even times have equal weights.  None, which is equal
    weights, if times go back or all are the same.
    """
    gaps = np.diff(time)
    return np.gradient(time) if gaps.any() and (gaps >= 0.0).all() else None


def _boltzmann(poses):
    return UNITS[poses.units or "lj"].boltzmann


def dimension(results):
    """2 if no center ever moves along z and no body turns about another axis, as in a run of dimension 2; else 3."""
    center = results.center
    if len(center) < 2 or np.ptp(center[..., 2], axis=0).any() or not np.ptp(center[..., :2], axis=0).any():
        return 3
    if "omega_space" not in results:
        return 2
    largest = np.abs(results.omega_space).max(axis=(0, 1))
    return 2 if largest[:2].max() <= IN_PLANE * largest[2] else 3


def temperatures(poses):
    """Temperatures of all frames, name -> (F,): of translation, of rotation and about each principal axis.

    Axes of equal moments are arbitrary, and each has their mean; if they are equal in all bodies, it is given once.

    The degrees of freedom of translation do not contain the total momentum if it is zero.  In two dimensions
    (``dimension``) a body has two, and one of rotation.  Empty without velocities or masses.  In LAMMPS' units;
    without ``units`` in those of mass x velocity^2.
    """
    bodies, results = getattr(poses, "bodies", None), poses.results
    if bodies is None or "velocity" not in results:
        return {}
    k, energy = _boltzmann(poses), UNITS[poses.units or "lj"].energy
    momentum = np.einsum("b,fbi->fi", bodies.mass, results.velocity)
    twice = 2.0 * results.ke_translation.sum(axis=1)
    of_total = energy * (momentum**2).sum(axis=1) / bodies.mass.sum()
    dimensions = dimension(results)
    resting = of_total.mean() < AT_REST * twice.mean() / (dimensions * len(bodies))
    freedoms = dimensions * (len(bodies) - (1 if resting and len(bodies) > 1 else 0))
    found = {"translation": twice / (freedoms * k)}
    turning = bodies.moments > 0.0
    if not turning.any():
        return found
    if dimensions == 2:
        found["rotation"] = 2.0 * results.ke_rotation.sum(axis=1) / (turning.any(axis=1).sum() * k)
        return found
    found["rotation"] = 2.0 * results.ke_rotation.sum(axis=1) / (turning.sum() * k)
    twice = energy * _about_axes(bodies, results)
    groups = [axes for axes in axis_groups(bodies.moments[turning[:, 0]]) if turning[:, axes[0]].any()]
    if len(groups) > 1:  # one is that of rotation
        for axes in groups:
            own = turning[:, axes[0]].sum()
            found[f"rotation about {axes_named(axes)}"] = twice[:, axes[0]] / (own * k)
    return found


def _about_axes(bodies, results):
    """Twice the kinetic energies (F, 3) about the principal axes, mass x velocity^2; of equal moments their mean."""
    equal = equal_moments(bodies.moments)
    share = equal / equal.sum(axis=1, keepdims=True)
    sums = np.empty((len(results.time), 3))
    for frame, (q, omega) in enumerate(zip(results.q, results.omega_space)):
        omega_body = Rotation.from_quat(q, scalar_first=True).inv().apply(omega)
        spin = np.einsum("bkj,bj->bk", bodies.axes, omega_body)
        sums[frame] = np.einsum("bkl,bl->k", share, bodies.moments * spin**2)
    return sums


def _long_blocks(frames):
    """Slices of the blocks in which functions of time are found; empty if these would be too short."""
    length = frames // LONG_BLOCKS
    first = frames - length * LONG_BLOCKS
    return [slice(first + i * length, first + (i + 1) * length) for i in range(LONG_BLOCKS)] if length >= FEWEST else []


def diffusion(time, center, dimensions=3):
    """Diffusion coefficient of centers (F, B, 3) and its standard error, length squared / time.

    The slope of the mean-square displacement at lags from a tenth to a half of a block, divided by twice the
    number of ``dimensions``.  NaN if blocks have too few frames.
    """
    values = []
    for own in _long_blocks(len(time)):
        lag, square = correlations.lags(time[own]), correlations.mean_square_displacement(center[own])
        part = slice(len(lag) // 10, len(lag) // 2)
        values.append(np.polyfit(lag[part], square[part], 1)[0] / (2.0 * dimensions))
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

    A frame counts for the time it stands for (``weights_of``).  Of frames that are not evenly spaced in time there are
    only temperatures, with a warning.
    """
    results = poses.results
    times = results.time
    weights = weights_of(times)
    found = Averages(
        Average(f"temperature of {name}", *of_series(series, weights=weights), poses.unit("temperature"))
        for name, series in temperatures(poses).items()
    )
    try:
        correlations.lags(times)
    except ValueError as error:
        warnings.warn(f"there are no averages but temperatures: {error}", stacklevel=2)
        return found
    name = "diffusion coefficient"
    found.append(Average(name, *diffusion(results.time, results.center, dimension(results)), poses.unit(name)))
    q, _, axes = correlations.turning(poses)
    for group, axis in axes.items():
        for order in (1, 2):
            time = rotational_time(results.time, q, axis, order)
            unit = poses.unit("correlation time")
            found.append(Average(f"correlation time of {axes_named(group)}, order {order}", *time, unit))
    return found
