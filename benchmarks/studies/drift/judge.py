"""How a series of the total energy is judged: its drift and its largest error."""

import math
from dataclasses import dataclass

import numpy as np

#: a slope of less than so many standard errors, which are themselves estimates, is no drift
SIGNIFICANT = 4.0
#: an error of more than this part of the kinetic energy at the start spoils a run
SPOILS = 0.1


def slope(time, error):
    """Least-squares slope of ``error`` (n,) against ``time`` (n,), and its standard error.

    Neighbouring errors are alike, so the scatter about the line does not shrink as it would with n
    independent samples: the standard error is that of W. K. Newey and K. D. West, Econometrica 55,
    703 (1987), Eq. 5, with lags up to a twentieth of the series.
    """
    n = len(time)
    if n < 20:
        raise ValueError(f"a slope needs 20 samples or more, not {n}")
    x = time - time.mean()
    found = x @ error / (x @ x)
    score = x * (error - error.mean() - found * x)
    lags = n // 20
    total = score @ score
    for lag in range(1, lags + 1):
        total += 2 * (1 - lag / (lags + 1)) * (score[lag:] @ score[:-lag])
    return float(found), float(math.sqrt(max(total, 0.0) * n / (n - 2)) / (x @ x))


@dataclass(frozen=True)
class Drift:
    """What a run did to the energy: ``time``, ``error`` (n,) of the samples, error = E(t) - E(0).

    ``slope`` and ``uncertainty`` (one standard error), energy per unit of time; ``largest`` |error|.
    ``spoiled``: whether that is more than SPOILS of the kinetic energy at the start.
    ``lost``: the time by which numbers were no longer finite, None if they always were; slope and
    uncertainty are then NaN, ``largest`` is infinite.
    """

    time: np.ndarray
    error: np.ndarray
    slope: float
    uncertainty: float
    largest: float
    spoiled: bool = False
    lost: float = None

    @property
    def drifts(self):
        """Whether the slope is significant; a run that was spoiled or lost counts."""
        return self.spoiled or abs(self.slope) > SIGNIFICANT * self.uncertainty

    @property
    def largest_so_far(self):
        """Largest |error| up to each sample, shape (n,)."""
        return np.maximum.accumulate(np.abs(self.error))


def judge(time, total, kinetic):
    """Drift of a complete series: ``time`` and ``total`` energy (n,), kinetic energy at the start."""
    error = total - total[0]
    largest = float(np.abs(error).max())
    return Drift(time, error, *slope(time, error), largest, largest > SPOILS * kinetic)


def lost(time):
    """Drift of a run whose numbers were not finite any more at ``time``."""
    return Drift(np.empty(0), np.empty(0), math.nan, math.nan, math.inf, True, time)
