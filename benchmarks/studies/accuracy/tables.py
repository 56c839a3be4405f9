"""Costs of errors, and the tables and measurements of the page.

All bounds are defined here; every other number is measured.
"""

from dataclasses import astuple, fields
from functools import partial

import numpy as np

from benchmarks.engine import Measurement, Table
from benchmarks.engine.methods import DEFAULTS, gear
from benchmarks.engine.page import grouped
from benchmarks.engine.statistics import order
from benchmarks.reference.stability import first_order_step, linear_limit, second_order_step
from benchmarks.studies.coefficients import kernel

from . import plan
from .evaluate import cheapest, expected_order, fitted_order, price, sign_change
from .runs import Point

TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
#: least speed-up over fix rigid/nve/small in test case 1 for each error
LEAST_SPEEDUP = {1e-4: 5.0, 1e-6: 30.0, 1e-8: 150.0}
#: slopes may be smaller than the order by this much; they are judged from this number of values on
ORDER_MARGIN, LEAST_VALUES = 0.4, 5
#: bounds: error of position at the smallest step with plain and with compensated sums; time in the fix
MOST_ROUNDING, MOST_MODIFY = {False: 5e-11, True: 1e-12}, 1.0
NONE = "–"
GEAR = {method.key for method in plan.ALL_METHODS if method.gear}
THEIRS = f"time of `{plan.RIGID_NVE.label}` relative to"
ROWS = ("`fix gear/quat`, default settings", "`fix gear/quat`, cheapest settings")


def power(number):
    """A power of ten as text."""
    return f"{number:.0e}".replace("e-0", "e-")


def significant(number, digits=2):
    """A number with a few significant digits, without exponent, with thousands separated."""
    rounded = float(f"{number:.{digits - 1}e}")
    return grouped(rounded) if rounded >= 10 else f"{rounded:g}"


def cheapest_setting(results, scene, target, unit="seconds"):
    """(Method, Cost) of the cheapest setting of fix gear/quat; (None, None) if none reaches the error."""
    ours = [m for m in results.scenes[scene].methods if m.gear]
    return cheapest({method: price(results, scene, method, target, unit) for method in ours})


def speedups(results, scene, target):
    """Ratios of wall times: fix rigid/nve/small over the defaults, and over the cheapest setting.

    Returns two Costs, each None if a time is missing, and the cheapest Method or None.
    """
    theirs = price(results, scene, plan.RIGID_NVE, target, extrapolate=True)
    default = price(results, scene, plan.DEFAULT, target)
    method, best = cheapest_setting(results, scene, target)
    return *(theirs and own and theirs.over(own) for own in (default, best)), method


def ratio_text(cost, error=True):
    """A ratio of costs as text, with its standard error."""
    if cost is None:
        return NONE
    sign = {"at least": "≥ ", "at most": "≤ "}.get(cost.kind, "")
    own = f" ± {significant(cost.error * cost.value, 1)}" if error and cost.error else ""
    remark = " (extrapolated)" if cost.kind == "extrapolated" else ""
    return f"{sign}{significant(cost.value)}×{own}{remark}"


def count_text(cost):
    """A number of evaluations as text."""
    return NONE if cost is None else "≤ " * (cost.kind == "at most") + grouped(cost.value)


# --- test case 1 and other scenes -----------------------------------------------------------------
def case1(results):
    """Table of speed-ups over fix rigid/nve/small, and their measurements."""
    speed, found = [], []
    for target in TARGETS:
        default, best, method = speedups(results, "case1", target)
        words = NONE if method is None else method.label
        speed.append([power(target), ratio_text(best), words, ratio_text(default)])
        for name, cost in zip(ROWS, (default, best)):
            value, error = (cost.value, cost.error * cost.value) if cost else (np.nan, None)
            what = f"test case 1, error {power(target)}: {THEIRS} {name}"
            least = LEAST_SPEEDUP.get(target)
            found.append(Measurement(what, value, error, ".3g", "times", least=least))
    header = ("error", "cheapest settings", "namely", "default settings")
    return {"speedup": Table(header, speed)}, found


def evaluations(results):
    """Table of force evaluations in test case 1."""
    methods = {"default settings": plan.DEFAULT}
    methods |= {f"`formulation {name}`": DEFAULTS[name] for name in ("second", "first")}
    cells = {f"`fix gear/quat`, {words}": [] for words in (*methods, "best number of values")}
    cells |= {"this setting is": [], plan.RIGID_NVE.label: []}
    for target in TARGETS:
        method, best = cheapest_setting(results, "case1", target, "evaluations")
        costs = [price(results, "case1", m, target, "evaluations") for m in methods.values()]
        theirs = price(results, "case1", plan.RIGID_NVE, target, "evaluations", extrapolate=True)
        texts = [*map(count_text, (*costs, best)), method.label if method else NONE, count_text(theirs)]
        for row, text in zip(cells.values(), texts):
            row.append(text)
    header = ("force evaluations", *(f"error {power(target)}" for target in TARGETS))
    return Table(header, [[label, *row] for label, row in cells.items()])


def other_speedups(results):
    """Speed-ups in the other scenes with smooth forces."""
    rows = []
    for key, scene in results.scenes.items():
        if key == "case1" or not scene.smooth:
            continue
        cells = []
        for target in TARGETS:
            default, best, method = speedups(results, key, target)
            words = f"{ratio_text(best, False)} ({method.label}), " if best else ""
            cells.append(f"{words}default {ratio_text(default, False)}" if best else NONE)
        rows.append([f"{scene.heading}: {scene.measure}", *cells])
    return Table(["scene", *map(power, TARGETS)], rows)


# --- order, stability, rounding, time in the fix --------------------------------------------------
def limit_of(formulation, n):
    """Largest stable omega h of the linear test equation."""
    steps = {"second": partial(second_order_step, n), "first": partial(first_order_step, n)}
    return linear_limit(steps.get(formulation) or kernel.tuned(n).step)


def order_fits(results):
    """(formulation, N) -> (steps, errors, Fit or None) of test case 1 with compensated sums."""
    columns = {key: np.transpose(points) for key, points in results.orders.items()}
    return {key: (*columns[key], fitted_order(*columns[key])) for key in columns}


def orders(results):
    """Order and slope of each N, and the largest stable steps; table and measurements."""
    header = ["formulation", "N", "order", "slope", "ω Δt, linear", "largest usable step"]
    rows, found = [], []
    for (name, n), (steps, errors, fit) in order_fits(results).items():
        expected, cancels = expected_order(name, n), sign_change(steps, errors)
        slope, error = (fit.order, fit.error) if fit else (np.nan, None)
        remark = f"the error changes sign at step {cancels:.2g}" if cancels else ""
        least = expected - ORDER_MARGIN if n >= LEAST_VALUES else None
        what = f"{name} formulation, N = {n}: order of the error of position"
        found.append(Measurement(what, slope, error, ".2f", remark=remark, least=least))
        limit = results.limits.get(("case1", gear(name, n).key))
        text = found[-1].text if fit else NONE
        rows.append([name, n, expected, text, f"{limit_of(name, n):.2f}", f"{limit:.2f}" if limit else NONE])
    return Table(header, rows), found


def rounding(results):
    """Errors at small steps, plain and compensated; table and measurements."""
    steps, rows, found = [dt for dt, _ in next(iter(results.rounding.values()))], [], []
    for (name, compensate), points in results.rounding.items():
        sums = "compensated" if compensate else "plain"
        rows.append([name, sums, *(f"{error:.1e}" for _, error in points)])
        what = f"{name} formulation, {sums} sums, step {steps[-1]:g}: error of position"
        found.append(Measurement(what, points[-1][1], most=MOST_ROUNDING[compensate]))
    return Table(["formulation", "sums", *(f"step {dt:g}" for dt in steps)], rows), found


def modify(results):
    """Time inside the fix, compared with fix rigid/nve/small; table and measurements."""
    yard, rows, found = results.modify[plan.RIGID_NVE.key], [], []
    relative = f"relative to {plan.RIGID_NVE.label}"
    for method in plan.MODIFY:
        own = results.modify[method.key]
        share = own.median / yard.median
        error, label = share * np.hypot(own.error, yard.error), method.label
        times = f"{own.median * 1e9:.0f} ({own.low * 1e9:.0f} to {own.high * 1e9:.0f})"
        if method == plan.DEFAULT:
            what, label = f"time inside the fix {relative}", f"{label} (default)"
            found.append(Measurement(what, share, error, ".2f", most=MOST_MODIFY))
        cell = "1" if method == plan.RIGID_NVE else f"{share:.2f} ± {error:.2f}"
        rows.append([label, times, cell])
    return Table(("", "nanoseconds per step (quartiles)", relative), rows), found


# --- numbers of the sentences ---------------------------------------------------------------------
def constraints(results):
    """(largest | |q|^2 - 1 |, largest |q.qdot|) over all sampled runs with usable steps."""
    rows = [
        (p.norm, p.tangency)
        for p in results.runs
        if p.method in GEAR and np.isfinite(p.energy)
        if p.dt <= results.limits.get((p.scene, p.method), 0.0)
    ]
    return np.max(np.reshape(rows, (-1, 2)), axis=0, initial=0.0)


def closest(results, methods):
    """The Point of test case 1 with the smallest error among the methods with these keys."""
    points = [p for p in results.runs if p.scene == "case1" and p.method in methods]
    return min(points, key=lambda p: p.position)


def cutoff(results):
    """Observed orders of errors in water for each scene, and errors with a plain cutoff."""
    powers, methods = {}, (plan.DEFAULT, plan.RIGID_NVE)
    for scene in ("water", "water-plain"):
        for method in methods:
            steps, errors = results.errors(scene, method)
            ended = np.isfinite(errors)
            powers[scene, method.gear] = order(steps[ended], errors[ended])
    found = [{p.steps: p.position for p in results.curve("water-plain", m)} for m in methods]
    steps = max(set(found[0]) & set(found[1]))
    return {"powers": powers, "steps": steps, "errors": [errors[steps] for errors in found]}


def of_runs(results):
    """All runs as a table."""
    return Table([f.name for f in fields(Point)], list(map(astuple, results.runs)))
