"""Errors of bodies, what an error costs, and how a difference grows.  Arrays in, numbers out."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

#: a principal moment below this fraction of the largest counts as zero, as in fix rigid
LINEAR = 1e-7


# --- bodies ---------------------------------------------------------------------------------------
def centres(bodies, masses, positions):
    """Centres of mass (..., B, 3) of sites at ``positions`` (..., n, 3).

    ``bodies`` (n,) are numbers 0 … B-1, ``masses`` (n,).
    """
    order = np.argsort(bodies, kind="stable")
    first = np.searchsorted(bodies[order], np.arange(bodies.max() + 1))
    weighted = (masses[:, None] * positions)[..., order, :]
    return np.add.reduceat(weighted, first, axis=-2) / np.bincount(bodies, masses)[:, None]


def body_size(bodies, masses, positions):
    """Median over the bodies of the largest distance of a site from the centre of mass.

    ``positions`` (n, 3).  Bodies of one site have no size; 0 if all are such.
    """
    arms = np.linalg.norm(positions - centres(bodies, masses, positions)[bodies], axis=1)
    largest = np.zeros(bodies.max() + 1)
    np.maximum.at(largest, bodies, arms)
    extended = largest[np.bincount(bodies) > 1]
    return float(np.median(extended)) if len(extended) else 0.0


def decade(value):
    """The power of ten that does not exceed ``value``; 1 for 0."""
    return 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0


def angles(bodies, masses, reference, positions):
    """Angles (..., B) in radians between poses of bodies, both positions (..., n, 3).

    That of the rotation which superposes them best, as in analysis.superposition, but of many
    frames at once.  Sites in a line only have an axis to turn, a single site has none.
    """
    found = np.zeros((*positions.shape[:-2], bodies.max() + 1))
    order = np.argsort(bodies, kind="stable")
    counts = np.bincount(bodies)
    for count in set(counts.tolist()) - {1}:
        chosen = np.flatnonzero(counts == count)
        sites = order[np.isin(bodies[order], chosen)].reshape(len(chosen), count)
        weights = masses[sites][..., None]
        now, then = positions[..., sites, :], reference[..., sites, :]
        total = weights.sum(axis=-2, keepdims=True)
        now = now - (weights * now).sum(axis=-2, keepdims=True) / total
        then = then - (weights * then).sum(axis=-2, keepdims=True) / total
        found[..., chosen] = _best_angle(np.swapaxes(weights * now, -1, -2) @ then)
    return found


def _best_angle(covariance):
    """Angle of the rotation that superposes arms with this covariance (..., 3, 3)."""
    left, spread, right = np.linalg.svd(covariance)
    in_line = spread[..., 1] + spread[..., 2] < LINEAR * (spread[..., 0] + spread[..., 1])
    axes = left[..., :, 0], right[..., 0, :]
    sine = np.linalg.norm(np.cross(*axes), axis=-1)
    of_axis = np.arctan2(sine, (axes[0] * axes[1]).sum(axis=-1))
    left[..., :, 2] *= np.sign(np.linalg.det(left @ right))[..., None]
    rotation = left @ right
    twice = rotation - np.swapaxes(rotation, -1, -2)
    sine = np.sqrt((twice**2).sum(axis=(-1, -2)) / 8.0)
    cosine = (np.trace(rotation, axis1=-2, axis2=-1) - 1.0) / 2.0
    return np.where(in_line, of_axis, np.arctan2(sine, cosine))


def rms(values):
    """Root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


# --- what an error costs --------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """A trial as a point of the work-precision diagram."""

    method: str
    dt: float
    evaluations: float
    seconds: float
    error: float


@dataclass(frozen=True)
class Price:
    """What an error costs with one method.

    ``kind``: "between" two trials, "at most" (the coarsest trial is better than asked), or
    "extrapolated" (no trial was as good as asked).
    """

    method: str
    dt: float
    evaluations: float
    seconds: float
    kind: str


#: steeper than this, the error is not that of an order but of a limit of stability
CLIFF = 16.0


def price(points, error, extrapolate=False):
    """Price of ``error`` from the Points of one method, or None if it is not reached.

    Between two trials logarithms are interpolated linearly.  The largest step counts below which
    no finer trial is worse than asked, up to where rounding begins.  With ``extrapolate`` the line
    through the two finest trials is continued if none is good enough.
    """
    points = sorted(points, key=lambda p: p.dt)
    good = [i for i, point in enumerate(points) if point.error <= error]
    if not good:
        if not extrapolate or len(points) < 2 or not points[0].error < points[1].error:
            return None
        return _on_line(points[0], points[1], error, "extrapolated")
    last = good[0]
    while last + 1 < len(points) and points[last + 1].error <= error:
        last += 1
    best = points[last]
    if last + 1 == len(points):
        return Price(best.method, best.dt, best.evaluations, best.seconds, "at most")
    coarser = points[last + 1]
    slope = math.log(coarser.error / best.error) / math.log(coarser.dt / best.dt)
    if not slope < CLIFF:
        return Price(best.method, best.dt, best.evaluations, best.seconds, "at most")
    return _on_line(best, coarser, error, "between")


def _on_line(one, other, error, kind):
    """Price on the log-log line through two points."""
    share = math.log(error / one.error) / math.log(other.error / one.error)

    def along(a, b):
        return math.exp(math.log(a) + share * math.log(b / a))

    return Price(
        one.method,
        along(one.dt, other.dt),
        along(one.evaluations, other.evaluations),
        along(one.seconds, other.seconds),
        kind,
    )


def front(points, cost):
    """Points that no other beats in both ``cost(point)`` and error, the cheapest first."""
    kept, best = [], math.inf
    for point in sorted(points, key=lambda p: (cost(p), p.error)):
        if point.error < best:
            kept.append(point)
            best = point.error
    return kept


# --- how a difference grows -----------------------------------------------------------------------
@dataclass(frozen=True)
class Growth:
    """A difference that grows as level · t^power · exp(rate t) from ``begin`` to ``end``.

    ``rate`` with its standard error (jackknife over ten blocks of time); the power is that of the
    sum of local errors which a difference is before it grows by itself.
    """

    rate: float
    error: float
    power: float
    level: float
    begin: float
    end: float

    @property
    def lyapunov_time(self):
        """Time in which the difference grows by e."""
        return 1.0 / self.rate

    @property
    def factor(self):
        """By how much the exponential alone grew."""
        return math.exp(self.rate * (self.end - self.begin))

    def at(self, time):
        """The fitted difference, shape of ``time``."""
        return self.level * time**self.power * np.exp(self.rate * time)


#: an exponential has to grow by this factor, over at least so many samples, to be called one
GROWTH, SAMPLES = 100.0, 20
#: no tenth of the time may hold more than this part of it (of its logarithm)
STEADY = 0.4
BLOCKS = 10
#: differences below this fraction of the positions themselves are rounding
ROUNDING = 1e-13


def growth(time, difference, saturation, floor=0.0):
    """(Growth, "") of where ``difference`` (n,) is exponential, or (None, why it is not).

    What is fitted is the logarithm of the running maximum, between ``floor`` and ``saturation``.
    """
    largest = np.maximum.accumulate(np.nan_to_num(difference, nan=np.inf))
    kept = (largest > floor) & (largest < saturation) & (time > 0)
    t, y = time[kept], np.log(largest[kept])
    if len(t) < SAMPLES:
        return None, f"fewer than {SAMPLES} samples between rounding and saturation"
    level, power, rate = _fit_growth(t, y)
    if rate * np.ptp(t) < math.log(GROWTH):
        return None, "the difference grows no faster than a power of time, or by too little to tell"
    tenths = np.diff(np.interp(np.linspace(t[0], t[-1], 11), t, y - power * np.log(t)))
    if tenths.max() > STEADY * tenths.sum():
        return None, "the difference grows in jumps"
    parts = [np.arange(len(t)) * BLOCKS // len(t) != block for block in range(BLOCKS)]
    rates = [_fit_growth(t[part], y[part])[2] for part in parts]
    error = math.sqrt((BLOCKS - 1) * np.var(rates))
    return Growth(rate, error, power, math.exp(level), float(t[0]), float(t[-1])), ""


def _fit_growth(t, y):
    """level, power >= 0, rate >= 0 of y = level + power ln t + rate t by least squares."""
    columns = np.column_stack([np.ones(len(t)), np.log(t), t])
    bounds = ([-np.inf, 0.0, 0.0], np.inf)
    return lsq_linear(columns, y, bounds).x.tolist()
