"""Means, slopes and their uncertainties.  Arrays in, numbers out."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

#: confidence level of a significant deviation, over all values that are compared at once
CONFIDENCE = 0.99


@dataclass(frozen=True)
class Mean:
    """A mean, its standard error, and the degrees of freedom of this error."""

    value: np.ndarray
    error: np.ndarray
    freedoms: int


def mean_of_blocks(blocks):
    """Mean of ``blocks`` (n, ...) over the first axis, and standard error from their scatter.

    Raises ValueError for fewer than three blocks.
    """
    blocks = np.asarray(blocks)
    n = len(blocks)
    if n < 3:
        raise ValueError(f"{n} blocks are too few for a standard error")
    return Mean(blocks.mean(axis=0), stats.sem(blocks), n - 1)


def blocks_of(values, count):
    """Means of ``count`` equal parts of a series (n,), without its first sample and a remainder.

    Raises ValueError if there are fewer samples than blocks.
    """
    length = (len(values) - 1) // count
    if length < 1:
        raise ValueError(f"{len(values)} samples are too few for {count} blocks")
    return np.asarray(values)[-length * count :].reshape(count, length).mean(axis=1)


def mean_of_series(series, count):
    """Mean of several series (n,) without their first samples; its standard error is from ``count`` blocks of each."""
    return mean_of_blocks(np.concatenate([blocks_of(one, count) for one in series]))


def allowed(count, freedoms):
    """The bound, in standard errors, below which the largest of ``count`` deviations is not significant.

    From Student's t distribution with the degrees of freedom of the errors, and Bonferroni's
    correction.
    """
    return float(stats.t.ppf(1 - (1 - CONFIDENCE) / (2 * count), freedoms))


def slope(time, values):
    """Least-squares slope of ``values`` (n,) against ``time`` (n,), and its standard error.

    Neighboring errors are correlated, so the error of the slope is larger than for n independent samples.  The standard
    error follows W. K. Newey and K. D. West, Econometrica 55, 703 (1987), Eq. 5, with lags up to a twentieth of the
    series.  Raises ValueError for fewer than 20 samples.
    """
    n = len(time)
    if n < 20:
        raise ValueError(f"a slope needs 20 samples or more, not {n}")
    x = time - time.mean()
    rate = x @ values / (x @ x)
    score = x * (values - values.mean() - rate * x)
    lags = n // 20
    total = score @ score
    for lag in range(1, lags + 1):
        total += 2 * (1 - lag / (lags + 1)) * (score[lag:] @ score[:-lag])
    return float(rate), float(math.sqrt(max(total, 0.0) * n / (n - 2)) / (x @ x))
