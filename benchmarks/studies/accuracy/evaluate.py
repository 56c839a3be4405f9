"""Fitted orders and costs of errors.  Arrays in, numbers out."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import theilslopes

#: limits of the part of a curve from which its order is fitted (see ``asymptotic``)
FINEST, ABOVE_FLOOR, DECADES, FINER, PAST = 5, 3.0, 3, 1.25, 2.0
FEWEST_POINTS = 3
#: fraction of all slopes within the uncertainty of an order; it corresponds to one standard error
CONFIDENCE = 0.683


@dataclass(frozen=True)
class Fit:
    """error = coefficient * step^order through the points ``used`` (mask); ``error`` of the order."""

    order: float
    error: float
    coefficient: float
    used: np.ndarray

    def at(self, step):
        """The line at ``step``."""
        return self.coefficient * np.asarray(step, dtype=float) ** self.order


def rounding_floor(steps, errors):
    """Round-off error: the largest error of the FINEST finest runs; 0 if their errors still fall."""
    finest = np.asarray(errors, dtype=float)[np.argsort(steps)][:FINEST]
    return 0.0 if (finest[1:] > finest[:-1]).all() else float(finest.max())


def asymptotic(steps, errors, limit=np.inf):
    """Mask of the points that show the order of a method.

    Above round-off: the error is at least ABOVE_FLOOR times ``rounding_floor``, at this and every larger step.
    Not too coarse: the error is within DECADES decades of the smallest of these errors.  The step is at least FINER
    times smaller than the largest usable step ``limit``, and at least PAST times smaller than a step at which leading
    terms cancel (``sign_change``).
    """
    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    rounding = ~(errors > ABOVE_FLOOR * rounding_floor(steps, errors))
    used = np.isfinite(errors) & (steps > steps[rounding].max(initial=0.0))
    used &= steps * FINER <= limit
    cancels = sign_change(steps, errors)
    if cancels is not None:
        used &= steps * PAST <= cancels
    if used.any():
        used &= errors <= errors[used].min() * 10.0**DECADES
    return used


def fitted_order(steps, errors, limit=np.inf):
    """Log-log fit of the asymptotic part by the method of Theil and Sen; None with too few points.

    The slope is the median of the slopes between all pairs of points, which is robust against a single small error.
    """
    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    used = asymptotic(steps, errors, limit)
    if used.sum() < FEWEST_POINTS:
        return None
    line = theilslopes(np.log(errors[used]), np.log(steps[used]), CONFIDENCE, "joint")
    error = 0.5 * (line.high_slope - line.low_slope)
    return Fit(float(line.slope), float(error), float(np.exp(line.intercept)), used)


def sign_change(steps, errors):
    """The smallest step, above round-off, at which the error is smaller than at the next finer step; None if there is none.

    The leading terms of the error cancel there, so slopes close to it are not meaningful.
    """
    order = np.argsort(steps)
    steps, errors = np.asarray(steps, float)[order], np.asarray(errors, float)[order]
    lowest = ABOVE_FLOOR * rounding_floor(steps, errors)
    cancels = np.flatnonzero((errors[1:] < errors[:-1]) & (errors[1:] > lowest)) + 1
    return float(steps[cancels[0]]) if len(cancels) else None


@dataclass(frozen=True)
class Cost:
    """The cost of an error; ``kind`` is measured, extrapolated, or "at most" if every run reaches the error.

    ``error``: standard error relative to the value.
    """

    value: float
    kind: str = "measured"
    error: float = 0.0

    def over(self, other):
        """This cost divided by another; None if either is None.  The kind of a ratio may also be "at least"."""
        kinds = {"measured": "at least", "extrapolated": "at most", "at most": "at most"}
        kind = kinds[self.kind] if other.kind == "at most" else self.kind
        return Cost(self.value / other.value, kind, float(np.hypot(self.error, other.error)))


def cost_of(costs, errors, target):
    """Cost above which all errors are at most ``target``; None if the most expensive run misses it.

    It is interpolated log-log between the most expensive run that misses the target and the next one, which reaches it.
    A lost run has the error inf, and the cost NaN if the cost is not known.
    """
    costs, errors = np.asarray(costs, float), np.asarray(errors, float)
    known = ~np.isnan(costs)
    costs, errors = costs[known], errors[known]
    order = np.argsort(costs)
    costs, errors = costs[order], errors[order]
    missing = np.flatnonzero(~(errors <= target))
    if not len(costs) or (len(missing) and missing[-1] == len(costs) - 1):
        return None
    if not len(missing):
        return Cost(float(costs[0]), "at most" if known.all() else "measured")
    last = missing[-1]
    if not np.isfinite(errors[last]):
        return Cost(float(costs[last + 1]))
    span = np.log(errors[[last, last + 1]])
    share = (span[0] - np.log(target)) / (span[0] - span[1])
    return Cost(float(costs[last] ** (1 - share) * costs[last + 1] ** share))


def extrapolated_cost(costs, errors, target):
    """Cost of an error that no run reaches, from the line through the asymptotic part; None without a line."""
    fit = fitted_order(1.0 / np.asarray(costs, float), errors)
    if fit is None:
        return None
    return Cost(float((fit.coefficient / target) ** (1.0 / fit.order)), "extrapolated")


def cheapest(costs_by_name):
    """(name, Cost) of the lowest cost in a dict name -> Cost or None; (None, None) if all are None."""
    known = [item for item in costs_by_name.items() if item[1] is not None]
    return min(known, key=lambda item: item[1].value, default=(None, None))


def price(results, scene, method, target, unit="seconds", extrapolate=False):
    """Cost of an error with one method, with the uncertainty of its timings.

    ``unit``: evaluations or seconds; ``extrapolate``: allow extrapolation if no run reaches the error and forces are smooth.
    """
    _, errors = results.errors(scene, method)
    costs = results.column(scene, method, unit)
    cost = cost_of(costs, errors, target)
    if cost is None and extrapolate and results.scenes[scene].smooth:
        cost = extrapolated_cost(costs, errors, target)
    if cost is None or unit == "evaluations":
        return cost
    low, high, count = (results.column(scene, method, c) for c in ("low", "high", "timings"))
    error = np.nanmedian(0.93 * (high - low) / np.sqrt(np.maximum(count, 1)) / costs)
    return replace(cost, error=float(error))


def expected_order(formulation, values):
    """Order of the error of positions with N values, at least.

    It is N, except N - 1 for odd N with tuned coefficients (see Scheme::order() of the kernel).
    """
    return values - values % 2 if formulation == "momentum" else values
