"""Costs of given errors, from the costs and errors of runs, and how tables show them."""

from dataclasses import dataclass

import numpy as np

from .page import grouped

NONE = "–"


@dataclass(frozen=True)
class Cost:
    """The cost of an error; ``kind`` is measured, or "at most" if every run reaches the error.

    ``error``: standard error relative to the value.
    """

    value: float
    kind: str = "measured"
    error: float = 0.0

    def over(self, other):
        """This cost divided by another.  The kind of a ratio may also be "at least"."""
        kind = {"measured": "at least"}.get(self.kind, "at most") if other.kind == "at most" else self.kind
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


def cheapest(costs_by_name):
    """(name, Cost) of the lowest cost in a dict name -> Cost or None; (None, None) if all are None."""
    known = [item for item in costs_by_name.items() if item[1] is not None]
    return min(known, key=lambda item: item[1].value, default=(None, None))


def power(number):
    """A power of ten as text."""
    return f"{number:.0e}".replace("e-0", "e-")


def significant(number, digits=2):
    """A number with a few significant digits, without exponent, with thousands separated."""
    rounded = float(f"{number:.{digits - 1}e}")
    return grouped(rounded) if rounded >= 10 else f"{rounded:g}"


def ratio_text(cost):
    """A ratio of costs as text, with its standard error if it has one."""
    if cost is None:
        return NONE
    sign = {"at least": "≥ ", "at most": "≤ "}.get(cost.kind, "")
    error = f" ± {significant(cost.error * cost.value, 1)}" if cost.error else ""
    return f"{sign}{significant(cost.value)}×{error}"


def count_text(cost):
    """A number of evaluations as text."""
    return NONE if cost is None else "≤ " * (cost.kind == "at most") + grouped(cost.value)
