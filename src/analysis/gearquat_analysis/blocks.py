"""Standard errors from blocks of a run, with a check that the blocks are long enough.

A series is cut into blocks, and its error is the scatter of their means (H. Flyvbjerg and H. G. Petersen, J. Chem.
Phys. 91, 461 (1989)).  This is correct if blocks are independent, that is, longer than correlations in the series.
"""

import math
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2

#: fewest blocks, ratio of the numbers of blocks from level to level, and least length of a block in statistical
#: inefficiencies
FEWEST_BLOCKS, FINER, INEFFICIENCIES = 8, 1.3, 5.0
#: quantile of the distribution of an error up to which an error from longer blocks counts as equal to the chosen error
PLATEAU = 0.9999


class Estimate(NamedTuple):
    """A value with its standard error; NaN if an assumption of the error fails, with the reason in ``why``.

    >>> import numpy as np
    >>> from gearquat_analysis.blocks import of_series
    >>> of_series(np.zeros(5)).why
    '5 frames are too few for 8 independent blocks'
    """

    value: float
    error: float
    why: str = ""

    @classmethod
    def missing(cls, why):
        return cls(math.nan, math.nan, why)


def widening(blocks):
    """Factor that widens a standard error from the scatter of a few ``blocks`` (more than three).

    Deviations divided by such an error follow Student's distribution; with the factor their mean square is 1.
    """
    return math.sqrt((blocks - 1) / (blocks - 3))


def scatter(values):
    """Standard errors (...) of the means over the first axis of independent values (n, ...), n > 3."""
    values = np.asarray(values, dtype=float)
    return values.std(axis=0, ddof=1) / math.sqrt(len(values)) * widening(len(values))


def of_series(series, weights=None):
    """Estimate of the mean of a series (F,) with ``weights`` (F,), equal unless given.

    Blocks are five times as long as the statistical inefficiency, the factor by which correlations between samples
    increase the variance of the mean.  The error is NaN if there are fewer than 8 such blocks, or if it still grows with
    the length of blocks; the value is given in any case.
    """
    series = np.asarray(series, dtype=float)
    weights = np.ones(len(series)) if weights is None else np.asarray(weights, dtype=float)
    mean = float(np.average(series, weights=weights))
    # contribution of each sample to the deviation of the mean
    moves = (series - mean) * weights / weights.sum()
    numbers = _numbers_of_blocks(len(series))
    if not len(numbers):
        return Estimate(mean, math.nan, f"{len(series)} frames are too few for {FEWEST_BLOCKS} independent blocks")
    squares = np.array([_square_of_error(moves, number) for number in numbers])
    if not squares[0] > 0.0:
        return Estimate(mean, 0.0)
    enough = len(series) / numbers >= INEFFICIENCIES * squares / squares[0]
    if not enough.any():
        return Estimate(mean, math.nan, f"the run is shorter than {FEWEST_BLOCKS} blocks that are independent")
    chosen = int(np.argmax(enough))
    most = squares[chosen] * chi2.ppf(PLATEAU, numbers - 1) / (numbers - 1)
    if (squares[chosen:] > most[chosen:]).any():
        return Estimate(mean, math.nan, "it drifts, or changes as slowly as the run is long")
    return Estimate(mean, math.sqrt(squares[chosen]) * widening(numbers[chosen]))


def _numbers_of_blocks(samples):
    """The numbers of blocks to try, in descending order."""
    numbers = []
    number = samples
    while number > FEWEST_BLOCKS:
        numbers.append(number)
        number = int(number / FINER)
    return np.array(numbers + [FEWEST_BLOCKS] if samples >= FEWEST_BLOCKS else [])


def _square_of_error(moves, number):
    begins = np.linspace(0, len(moves), number + 1)[:-1].astype(int)
    return number / (number - 1) * np.sum(np.add.reduceat(moves, begins) ** 2)
