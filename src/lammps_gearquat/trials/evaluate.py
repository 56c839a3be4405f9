"""Errors of bodies, cost of an error, and energy drift.  Arrays in, numbers out."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np


# --- bodies ---------------------------------------------------------------------------------------
def decade(value):
    """The power of ten that does not exceed ``value``; 1 for 0."""
    return 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0


def rms(values):
    """Root of the mean square over the last axis."""
    return np.sqrt(np.mean(np.square(values), axis=-1))


def parting_time(time, distance, threshold):
    """The first of the times (S,) at which a distance (S,) is not below ``threshold``; infinite if none."""
    apart = np.flatnonzero(~(distance <= threshold))
    return float(time[apart[0]]) if len(apart) else math.inf


# --- what an error costs --------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """A trial as a point of the work-precision diagram.

    ``evaluations`` of the forces and ``seconds`` count its steps; ``start_evaluations`` and ``start_seconds`` count
    the start before the first step.  ``seconds`` is the time of the fastest of ``timings`` runs.
    """

    method: str
    dt: float
    evaluations: float
    seconds: float
    error: float
    start_evaluations: int = 1
    start_seconds: float = 0.0
    timings: int = 1


def usable_step(dt):
    """A time step rounded down to two digits, for a script."""
    unit = 10.0 ** (math.floor(math.log10(dt)) - 1)
    return float(f"{math.floor(dt / unit * (1 + 1e-9)) * unit:.2g}")


def price(points, error):
    """The coarsest Point of one method at which this and all finer trials have at most this ``error``, up to where rounding
    begins, or None."""
    points = sorted(points, key=lambda p: p.dt)
    last = next((i for i, point in enumerate(points) if point.error <= error), None)
    if last is None:
        return None
    while last + 1 < len(points) and points[last + 1].error <= error:
        last += 1
    return points[last]


def candidates(points, error):
    """Keywords -> price of ``error`` with the methods that matter, as far as they reach it.

    These are the method of the deck (None), and the two fastest by seconds and by evaluations.
    """
    prices = {key: found for key, own in points.items() if (found := price(own, error))}
    kept = {None}
    for cost in ("seconds", "evaluations"):
        kept.update(sorted(prices.keys() - {None}, key=lambda key: getattr(prices[key], cost))[:2])
    return {key: prices[key] for key in prices if key in kept}


# --- how the energy drifts -------------------------------------------------------------------------
#: fewest samples of a trend
FEWEST = 20
#: the part of a random walk in the noise about a trend, as variances per sample
WALKS = np.concatenate([[0.0], np.logspace(-5, 0, 21)])


def trend(time, values):
    """Slope of ``values`` (n,) against equidistant ``time`` (n,), and its standard error.

    The noise about the line is a sum of white noise and a random walk, which the errors of many collisions are, in any
    proportion: A. C. Harvey, Forecasting, Structural Time Series Models and the Kalman Filter, Cambridge (1989), Section 2.3.
    Slope and error are averages over proportions, weighted by their restricted likelihood (H. D. Patterson and R. Thompson,
    Biometrika 58, 545 (1971)).  Raises ValueError for fewer than FEWEST samples.
    """
    n = len(time)
    if n < FEWEST:
        raise ValueError(f"a trend needs {FEWEST} samples or more, not {n}")
    slopes, variances, odds = np.array([_weighted_line(values, *line) for line in _lines(n)]).T
    weights = np.exp(odds - odds.max())
    weights /= weights.sum()
    slope, span = weights @ slopes, time[-1] - time[0]
    error = math.sqrt(weights @ (variances + (slopes - slope) ** 2))
    return float(slope / span), float(error / span)


@cache
def _lines(n):
    """Factors for fitting a line through n samples, for each of WALKS: (q^T L^-1, L^-1, r^-1, logarithm of
    determinants).

    L L^T is the covariance of the noise, and q r = L^-1 (1, t) the factors of the equations for the line.
    """
    rank = np.arange(1, n + 1)
    columns = np.column_stack([np.ones(n), (rank - rank.mean()) / (n - 1)])
    lines = []
    for part in WALKS:
        root = np.linalg.cholesky((1.0 - part) * np.eye(n) + part * np.minimum.outer(rank, rank))
        whiten = np.linalg.inv(root)
        q, r = np.linalg.qr(whiten @ columns)
        determinants = np.log(np.diag(root)).sum() + np.log(abs(np.diag(r))).sum()
        lines.append((q.T @ whiten, whiten, np.linalg.inv(r), determinants))
    return lines


def _weighted_line(values, project, whiten, inverse, determinants):
    """Slope, its variance and the logarithm of the restricted likelihood for noise with one part of a random walk."""
    fit, white = project @ values, whiten @ values
    scatter = max(white @ white - fit @ fit, np.finfo(float).tiny)
    left = len(values) - 2
    return (inverse @ fit)[1], scatter / left * (inverse[1] @ inverse[1]), -0.5 * left * math.log(scatter) - determinants
