"""Fitted orders and costs of errors.  Arrays in, numbers out."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import theilslopes

#: the part of a curve that its order is fitted on (see ``asymptotic``)
FINEST, ABOVE_FLOOR, DECADES, FINER, PAST = 5, 3.0, 3, 1.25, 2.0
FEWEST_POINTS = 3
#: part of all slopes that the uncertainty of an order holds, that of one standard error
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
    """Error that rounding makes: the worst of the FINEST finest runs; 0 if their errors still fall."""
    finest = np.asarray(errors, dtype=float)[np.argsort(steps)][:FINEST]
    return 0.0 if (finest[1:] > finest[:-1]).all() else float(finest.max())


def asymptotic(steps, errors, limit=np.inf):
    """Mask of the points that show the order of a method.

    Not rounding: error at least ABOVE_FLOOR times ``rounding_floor``, at this and at every larger
    step.  Not too coarse: of those, the ones within DECADES decades of the smallest, a step at least
    FINER times smaller than ``limit``, the largest usable one, and PAST times smaller than one at
    which leading terms cancel (``sign_change``).
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
    """Fit in log-log over the asymptotic part, by Theil and Sen; None with too few points.

    Theil and Sen: the median of the slopes between all pairs, which one lucky error cannot bend.
    """
    steps, errors = np.asarray(steps, dtype=float), np.asarray(errors, dtype=float)
    used = asymptotic(steps, errors, limit)
    if used.sum() < FEWEST_POINTS:
        return None
    line = theilslopes(np.log(errors[used]), np.log(steps[used]), CONFIDENCE, "joint")
    error = 0.5 * (line.high_slope - line.low_slope)
    return Fit(float(line.slope), float(error), float(np.exp(line.intercept)), used)


def sign_change(steps, errors):
    """The smallest step, before rounding, at which the error is smaller than at the next finer one.

    There the leading terms of the error cancel, and close to it slopes mean little; None without.
    """
    order = np.argsort(steps)
    steps, errors = np.asarray(steps, float)[order], np.asarray(errors, float)[order]
    lowest = ABOVE_FLOOR * rounding_floor(steps, errors)
    cancels = np.flatnonzero((errors[1:] < errors[:-1]) & (errors[1:] > lowest)) + 1
    return float(steps[cancels[0]]) if len(cancels) else None


@dataclass(frozen=True)
class Cost:
    """What an error costs; ``kind`` is measured, extrapolated, or "at most": any run is enough.

    ``error``: standard error relative to the value.
    """

    value: float
    kind: str = "measured"
    error: float = 0.0

    def over(self, other):
        """This cost over another one; None if one of them is.  A ratio may be "at least", too."""
        kinds = {"measured": "at least", "extrapolated": "at most", "at most": "at most"}
        kind = kinds[self.kind] if other.kind == "at most" else self.kind
        return Cost(self.value / other.value, kind, float(np.hypot(self.error, other.error)))


def cost_of(costs, errors, target):
    """Cost beyond which all errors are at most ``target``; None if the dearest run misses it.

    Log-log between the dearest run that misses the target and the next dearer one, which reaches it.
    A lost run has the error inf, and the cost NaN where that is not known.
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
    """Cost of an error that no run has: by the line through the asymptotic part; None without."""
    fit = fitted_order(1.0 / np.asarray(costs, float), errors)
    if fit is None:
        return None
    return Cost(float((fit.coefficient / target) ** (1.0 / fit.order)), "extrapolated")


def cheapest(costs_by_name):
    """(name, Cost) of the lowest cost of a dictionary name -> Cost or None; twice None if all are."""
    known = [item for item in costs_by_name.items() if item[1] is not None]
    return min(known, key=lambda item: item[1].value, default=(None, None))


def price(results, scene, method, target, unit="seconds", extrapolate=False):
    """Cost of an error with one method, with the uncertainty of its timings.

    ``unit``: evaluations or seconds; ``extrapolate``: where no run gets there and forces are smooth.
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
    """Order of the error of positions with the tuned coefficients for so many values.

    N; in the second formulation N - 1 for odd N (see Scheme::order() of the kernel).
    """
    return values - values % 2 if formulation == "second" else values
