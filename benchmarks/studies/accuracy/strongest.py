"""Force evaluations in test case 1, compared with the strongest of the other methods."""

import numpy as np

from benchmarks.engine import Measurement, Table
from benchmarks.engine.methods import GEARS

from . import peers, plan
from .evaluate import cheapest, cost_of, price
from .tables import NONE, TARGETS, cheapest_setting, count_text, power, ratio_text

#: largest number of evaluations for each error in test case 1
MOST_DEFAULT = dict(zip(TARGETS, (650, 800, 1250, 2050)))
MOST_CHEAPEST = dict(zip(TARGETS, (500, 650, 1000, 1600)))
#: a step, and the largest error with the defaults of the first formulation
FIRST_STEP, MOST_FIRST = 0.1, 3e-7


def prices(results, target):
    """Name -> Cost in evaluations, or None, for an error in test case 1, with fix rigid/nve/small."""
    found = {name: cost_of(*results.peer("case1", name), target) for name in peers.NAMES}
    task = results, "case1", plan.RIGID_NVE, target, "evaluations"
    return found | {plan.RIGID_NVE.label: price(*task, extrapolate=True)}


def strongest(results, target):
    """(name, Cost) of the other method with the fewest evaluations; (None, None) if none reaches the error."""
    return cheapest(prices(results, target))


def error_at(steps, errors, step):
    """Error at a step between measured ones, interpolated log-log; arrays (n,)."""
    order = np.argsort(steps)
    steps, errors = np.log(np.asarray(steps)[order]), np.log(np.asarray(errors)[order])
    return float(np.exp(np.interp(np.log(step), steps, errors)))


def _of_ours(results, target):
    """(settings, Method or None, Cost or None, bound) of the defaults and of the cheapest settings."""
    method, best = cheapest_setting(results, "case1", target, "evaluations")
    usual = price(results, "case1", plan.DEFAULT, target, "evaluations")
    yield "default", plan.DEFAULT, usual, MOST_DEFAULT[target]
    yield "cheapest", method, best, MOST_CHEAPEST[target]


def columns(results, target):
    """Label -> cell for one error, for the page and for README."""
    others, (name, peer) = prices(results, target), strongest(results, target)
    ours = list(_of_ours(results, target))
    counts = {f"`fix gear/quat`, {words} settings": count_text(cost) for words, _, cost, _ in ours}
    factors = {
        f"strongest other method / {words} settings": ratio_text(
            peer and cost and peer.over(cost), False
        )
        for words, _, cost, _ in ours
    }
    method = ours[-1][1]
    namely = {"the cheapest settings are": method.label if method else NONE}
    gears = price(results, "case1", GEARS["second"], target, "evaluations")
    of_others = {"`fix gear/quat`, `corrector gear`": count_text(gears)}
    of_others |= {label: count_text(cost) for label, cost in others.items()}
    label = "the strongest of the other methods"
    page = counts | namely | of_others | {label: name or NONE} | factors
    return page, counts | {label: f"{count_text(peer)} ({name})" if peer else NONE} | factors


def case1(results):
    """The tables "evaluations" and "readme" of test case 1, and their measurements."""
    found = []
    for target in TARGETS:
        at, (name, peer) = f"test case 1, error {power(target)}", strongest(results, target)
        for words, _, cost, most in _of_ours(results, target):
            value = cost.value if cost else np.nan
            what = f"{at}: force evaluations with the {words} settings"
            found.append(Measurement(what, value, spec=",.0f", most=most))
            factor = peer.value / value if peer else np.nan
            what = f"{at}: ratio of force evaluations, strongest other method over these settings"
            found.append(Measurement(what, factor, None, ".3g", "times", name or "", least=1.0))
    error = error_at(*results.errors("case1", plan.DEFAULTS["first"]), FIRST_STEP)
    what = f"test case 1, first formulation, default settings, step {FIRST_STEP:g}: error"
    found.append(Measurement(what, error, most=MOST_FIRST))
    header = ("force evaluations", *(f"error {power(target)}" for target in TARGETS))
    tables = {}
    for key, cells in zip(("evaluations", "readme"), zip(*(columns(results, t) for t in TARGETS))):
        tables[key] = Table(header, [[label, *(c[label] for c in cells)] for label in cells[0]])
    return tables, found
