"""Diffusion coefficients from the linear part of the mean-square displacement, with standard errors.

A range of lags extends from t to 8 t.  The mean-square displacement is fitted from 2 t to 8 t.  The range counts as
linear if this slope agrees with the slopes from t to 2 t, where motion at short times shows first, and from 8 t to 16 t.
The fit is weighted by the covariance of mean-square displacements of Brownian motion at overlapping lags (J. T.
Bullerjahn, S. von Buelow, G. Hummer, J. Chem. Phys. 153, 024116 (2020)), and has an offset for motion at short times.
"""

import functools
import math
from typing import NamedTuple

import numpy as np

from .blocks import Estimate, scatter
from .correlations import portions

#: lags in units of the first lag of a range; the lags of the fit; the lag at which the exponent is taken
LAGS, FITTED, MIDDLE = np.array([1, 2, 3, 4, 5, 6, 7, 8, 16]), slice(1, 8), 3
#: least length of a run, in units of the first lag, for a range with blocks, for one with a coefficient, and for one that
#: is only tested
LENGTH_BLOCKS, LENGTH, LENGTH_LINEAR = 100, 50, 32
#: number of origins of time per first lag
ORIGINS = 4
#: least length of a block of the run, in units of the first lag, and the largest number of blocks
BLOCK, MOST_BLOCKS = 20, 10
#: fewest bodies whose scatter is an error
FEWEST_BODIES = 5
#: slopes of two parts of a range agree if they differ by less than this number of standard errors
SAME = 3.0
#: d ln(mean square) / d ln(lag) in a range that is linear, and the largest relative error of a coefficient
EXPONENTS, PRECISION = (0.85, 1.18), 0.2
#: a range whose slope has a larger relative error than this counts as linear, because such errors are not normally
#: distributed
VAGUE = 0.5
#: bodies are confined if their mean square at late lags is below this fraction of the mean square of Brownian motion
CONFINED = 0.4


class Fit(NamedTuple):
    """Diffusion coefficient of a range whose first lag is ``frames``, in units of frames.

    * ``exponent``: d ln(mean square) / d ln(lag) in the range
    * ``square``: mean square in a direction at 8 times the first lag
    * ``linear``: True if the range is linear within errors
    * ``known``: True if it is linear and the errors are small enough
    * ``long``: True if the run is long enough for an error
    * ``together``: factor by which errors are larger because bodies are not independent
    """

    frames: int
    value: float
    error: float
    exponent: float
    square: float
    linear: bool
    long: bool
    together: float

    @property
    def known(self):
        least, most = EXPONENTS
        return self.long and self.linear and self.error < PRECISION * self.value and least <= self.exponent <= most


def diffusion(time, center, dimensions=3):
    """Estimate of the diffusion coefficient of centers (F, B, 3) of one kind of bodies, length squared / time.

    It is a sixth (in two ``dimensions``, a fourth) of the slope of the mean-square displacement.  The slope is taken
    from the earliest range of lags such that this range and all later ranges are linear.  The error is the largest of
    three: the scatter of blocks of the run, the scatter of bodies, and the error for Brownian motion.  With a first lag
    above a hundredth of the run there are no blocks, and the last two errors are multiplied by the factor by which blocks
    increased them at the latest range with blocks.  Half of the largest difference from ranges that begin up to twice as
    late is added in quadrature.  The coefficient is NaN if no range with a first lag below a fiftieth of the run is
    linear, if the error is above a fifth of the coefficient, or
    if bodies are confined.  ``time`` (F,) is evenly spaced.

    >>> import numpy as np
    >>> from gearquat_analysis.diffusion import diffusion
    >>> walk = np.random.default_rng(1).normal(size=(2000, 50, 3)).cumsum(axis=0)
    >>> bool(abs(diffusion(np.arange(2000.0), walk).value - 0.5) < 0.02)
    True
    >>> diffusion(np.arange(2000.0), np.arange(2000.0)[:, None, None] * walk[0]).why
    'the mean-square displacement is not linear up to a quarter of the run'
    """
    frames = len(time)
    if frames <= LENGTH_BLOCKS:
        return Estimate.missing(f"{frames} frames are too few: {LENGTH_BLOCKS + 1} are required")
    fits = _fits(center, dimensions)
    failing = [k for k, fit in enumerate(fits) if not fit.linear]
    later = fits[failing[-1] + 1 :] if failing else fits
    if not later:
        return Estimate.missing("the mean-square displacement is not linear up to a quarter of the run")
    known = [fit for fit in later if fit.known]
    if not known and not any(fit.long for fit in later):
        return Estimate.missing("the mean-square displacement becomes linear too late for an error")
    if not known:
        return Estimate.missing("errors are too large to tell whether the mean-square displacement is linear")
    best = known[0]
    if any(fit.square < CONFINED * 2.0 * best.value * 8 * fit.frames for fit in later):
        return Estimate.missing("bodies are confined")
    others = [abs(fit.value - best.value) for fit in known if fit.frames <= 2 * best.frames]
    unit = (time[-1] - time[0]) / (frames - 1)
    return Estimate(best.value / unit, math.hypot(best.error, 0.5 * max(others)) / unit)


def _fits(center, dimensions):
    """Fits of all ranges for which centers (F, B, 3) have enough frames, the earliest first; in units of frames."""
    number, bodies = center.shape[:2]
    firsts = _first_lags(number)
    of_bodies = {first: np.empty((len(LAGS), bodies)) for first in firsts}
    of_blocks = dict.fromkeys(firsts, 0.0)
    for own in portions(center):
        x = center[:, own]
        for first in firsts:
            squares, blocks = _squares(x[:: _stride(first)], first // _stride(first))
            of_bodies[first][:, own] = squares / dimensions
            of_blocks[first] = of_blocks[first] + blocks / (dimensions * bodies)
    fits, together = [], 1.0
    for first in firsts:
        fit = _fit(first, number, of_bodies[first], of_blocks[first], dimensions, together)
        fits, together = [*fits, fit], fit.together
    return fits


def _first_lags(frames):
    """First lags of all ranges: powers of two, and three times powers of two."""
    most = (frames - 1) // LENGTH_LINEAR
    return sorted({first for k in range(most.bit_length()) for first in (2**k, 3 * 2**k) if first <= most})


def _stride(first):
    return max(1, first // ORIGINS)


def _squares(x, first):
    """Mean-square displacements (9, b) of x (n, b, 3) at the lags of a range, and their sums over bodies in each block (9, N)."""
    length = len(x) - 1
    number = min(MOST_BLOCKS, length // (BLOCK * first)) if length >= LENGTH_BLOCKS * first else 0
    ends = np.linspace(0, length, number + 1).astype(int)
    means, blocks = np.empty((len(LAGS), x.shape[1])), np.empty((len(LAGS), len(ends) - 1))
    for row, lag in enumerate(LAGS * first):
        square = np.einsum("nbi,nbi->nb", moved := x[lag:] - x[:-lag], moved)
        means[row], of_all = square.mean(axis=0), square.sum(axis=1)
        # displacements that begin and end in the block
        blocks[row] = [of_all[begin : end + 1 - lag].mean() for begin, end in zip(ends, ends[1:])]
    return means, blocks


def _fit(first, frames, of_bodies, of_blocks, dimensions, together):
    """Fit of a range, from the mean squares per direction of bodies (9, B) and of blocks (9, N)."""
    stride, long = _stride(first), frames - 1 >= LENGTH * first
    steps, per_lag = (frames - 1) // stride, first // stride
    weights, mean = _weights(steps, per_lag), of_bodies.mean(axis=1)
    slope, through = float(weights[0] @ mean), mean[MIDDLE] / LAGS[MIDDLE]  # per first lag
    if not through > 0.0:
        return Fit(first, 0.0, math.inf, 0.0, 0.0, False, long, together)
    number = of_bodies.shape[1]
    errors = [max(slope, through) * _brownian_errors(steps, per_lag) / math.sqrt(number * dimensions)]
    if number > 1:
        errors[0] *= math.sqrt(number / (number - 1))  # their total momentum may be zero
    if number >= FEWEST_BODIES:
        errors.append(scatter((weights @ of_bodies).T))
    errors = np.max(errors, axis=0)
    if of_blocks.shape[1]:
        of_run = scatter((weights @ of_blocks).T)
        together = max(1.0, of_run[0] / errors[0])
        errors = np.maximum(errors, of_run)
    else:
        errors = errors * together
    error, of_differences = errors[0], errors[1:]
    exponent, uncertain = slope / through, SAME * error / through
    linear = (np.abs(weights[1:] @ mean) <= SAME * of_differences).all()
    linear &= exponent + uncertain >= EXPONENTS[0] and exponent - uncertain <= EXPONENTS[1]
    linear |= error > VAGUE * through
    return Fit(first, slope / (2.0 * first), error / (2.0 * first), exponent, mean[7], bool(linear), long, together)


@functools.lru_cache(maxsize=64)
def _weights(steps, per_lag):
    """Weights (4, 9) of mean squares at the lags of a range; slopes are per first lag t.

    Row 0 gives the slope of the fit; rows 1 and 2 the slopes from t to 2 t and from 8 t to 16 t minus the slope of the
    fit; row 3 the slope from 2 t to 4 t minus the slope from 4 t to 8 t.
    """
    covariance = brownian_covariance(steps, LAGS * per_lag)
    weights = np.zeros((4, len(LAGS)))

    def slope(part):
        design = np.column_stack([np.ones(len(LAGS[part])), LAGS[part]])
        solved = np.linalg.solve(covariance[part, part], design)
        return np.linalg.solve(design.T @ solved, solved.T)[1]

    weights[0, FITTED] = slope(FITTED)
    weights[1:3] = -weights[0]
    weights[1, :2] += slope(slice(0, 2))
    weights[2, 7:] += slope(slice(7, 9))
    weights[3, 1:4] += slope(slice(1, 4))
    weights[3, 3:8] -= slope(slice(3, 8))
    return weights


@functools.lru_cache(maxsize=64)
def _brownian_errors(steps, per_lag):
    """Standard errors (4,) of the results of ``_weights`` for a Brownian motion along a line with a slope of 1."""
    weights = _weights(steps, per_lag)
    covariance = brownian_covariance(steps, LAGS * per_lag) / per_lag**2
    return np.sqrt(np.einsum("ai,ij,aj->a", weights, covariance, weights))


def brownian_covariance(steps, lags):
    """Covariance (L, L) of mean squares of a Brownian motion of ``steps`` at ``lags`` (L,), over all origins of time.

    The motion is along a line, and the mean square at a lag of n is n.  Means of products of four Gaussian displacements
    follow from means of pairs (L. Isserlis, Biometrika 12, 134 (1918)).
    """
    covariance = np.empty((len(lags), len(lags)))
    for row, p in enumerate(lags):
        for column, q in enumerate(lags):
            apart = np.arange(-q, p + 1)  # distances between the origins at which the displacements overlap
            overlap = np.minimum(p, apart + q) - np.maximum(0, apart)
            pairs = np.minimum(steps + 1 - p, steps + 1 - q - apart) - np.maximum(0, -apart)
            total = 2.0 * np.sum(np.maximum(overlap, 0) ** 2 * np.maximum(pairs, 0))
            covariance[row, column] = total / ((steps + 1 - p) * (steps + 1 - q))
    return covariance
