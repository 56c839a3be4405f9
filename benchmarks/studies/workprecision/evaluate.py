"""Fitted orders, costs of given errors, verdicts.  Arrays in, numbers out."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import theilslopes

#: the part of a curve that its order is fitted on (see ``asymptotic``)
FINEST, ABOVE_FLOOR, DECADES, FINER, PAST = 5, 3.0, 3, 1.25, 2.0
FEWEST_POINTS = 3
RULE = (
    f"lines of fitted order: median slope (Theil and Sen) over the {DECADES} decades above rounding, "
    f"steps below 1/{FINER:g} of the largest usable one and at most 1/{PAST:g} of one at which the "
    f"error changes sign; rounding: {ABOVE_FLOOR:g} times the worst of "
    f"the {FINEST} finest runs, where their errors do not fall any more"
)
MET, MISSED = "met", "missed"


@dataclass(frozen=True)
class Fit:
    """error = coefficient * step^order through the points ``used`` (mask)."""

    order: float
    coefficient: float
    used: np.ndarray

    def error(self, step):
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
    order, constant, *_ = theilslopes(np.log(errors[used]), np.log(steps[used]))
    return Fit(float(order), float(np.exp(constant)), used)


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
    """What an error costs; ``kind`` is measured, extrapolated, or "at most": any run is enough."""

    value: float
    kind: str = "measured"


def cost_of(costs, errors, target):
    """Cost beyond which all errors are at most ``target``; None if the dearest run misses it.

    Log-log between the dearest run that misses the target and the next dearer one, which reaches it.
    A run that went astray has the error inf, and the cost NaN where that is not known.
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
    """(name, Cost) of the lowest cost of a dictionary name -> Cost or None; None if all are."""
    known = {name: cost for name, cost in costs_by_name.items() if cost is not None}
    if not known:
        return None
    name = min(known, key=lambda key: known[key].value)
    return name, known[name]


def at_least(measured, asked):
    """Verdict on a number that has to be at least ``asked``; NaN and None miss."""
    return MET if measured is not None and measured >= asked else MISSED


def at_most(measured, asked):
    """Verdict on a number that has to be at most ``asked``; NaN and None miss."""
    return MET if measured is not None and measured <= asked else MISSED


def order_asked(formulation, values, c0="position"):
    """Order of the global error that Gear's method with N values is expected to have.

    An odd N has order N, an even one N + 1 by symmetry; in the second formulation from N = 5 on, and
    with c0 "velocity" N - 1 for even N.
    """
    even = values % 2 == 0
    if formulation == "second" and values == 4:
        return 3
    if c0 == "velocity" and even:
        return values - 1
    return values + 1 if even else values
