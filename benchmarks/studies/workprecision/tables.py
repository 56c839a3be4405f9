"""The tables: header and rows of text, each from Results by rule, with the verdict beside the demand.

What is asked stands here, nowhere else; every other number is measured.
"""

from . import plan
from .evaluate import (
    MET,
    at_least,
    at_most,
    cheapest,
    cost_of,
    extrapolated_cost,
    fitted_order,
    order_asked,
    sign_change,
)
from .results import facts
from .stability import first_order_step, linear_limit, second_order_step

TARGETS = (1e-4, 1e-6, 1e-8, 1e-10)
#: speed-up over fix rigid/nve/small, test case 1
SPEEDUP_ASKED = {1e-4: 5.0, 1e-6: 30.0, 1e-8: 150.0}
ORDER_MARGIN, LEAST_N = 0.4, 5
FLOOR_ASKED = {"no": 5e-11, "yes": 1e-12}
MODIFY_ASKED = 1.0
SOLVERS = ("DOP853", "LSODA")
NONE = "–"
FORMULATIONS = (plan.SECOND, plan.FIRST)


def power(number):
    """A power of ten as text."""
    return f"{number:.0e}".replace("e-0", "e-")


def significant(number, digits=2):
    """A number with a few significant digits, without exponent, thousands apart."""
    rounded = float(f"{number:.{digits - 1}e}")
    return grouped(rounded) if rounded >= 10 else f"{rounded:g}"


# --- prices ---------------------------------------------------------------------------------------
def price(results, scene, method, target, unit):
    """Cost of an error with one method; ``unit``: evaluations or seconds."""
    _, errors = results.errors(scene, method)
    return cost_of(results.column(scene, method, unit), errors, target)


def cheapest_setting(results, scene, target, unit, passes=None):
    """(Row of the method, Cost) of the cheapest setting of fix gear/quat; None if none reaches it.

    ``passes``: only settings with so many.
    """
    ours = {row.method: row for row in results.runs if row.scene == scene}
    ours = {
        key: row
        for key, row in ours.items()
        if row.family != plan.RIGID and passes in (None, row.passes)
    }
    found = cheapest({key: price(results, scene, key, target, unit) for key in ours})
    return found and (ours[found[0]], found[1])


def rigid_price(results, scene, target, unit="seconds"):
    """Cost with fix rigid/nve/small, extrapolated where it does not get there; None without order."""
    method = plan.RIGID_NVE.key
    found = price(results, scene, method, target, unit)
    if found is None and facts(scene).smooth:
        _, errors = results.errors(scene, method)
        found = extrapolated_cost(results.column(scene, method, unit), errors, target)
    return found


def ratio(theirs, ours):
    """(number, text) of a speed-up; (None, dash) if a side is missing."""
    if theirs is None or ours is None:
        return None, NONE
    number = theirs.value / ours.value
    text = f"{significant(number)}×"
    if "at most" in (theirs.kind, ours.kind):
        text = ("≥ " if theirs.kind == "measured" else "≤ ") + text
    return number, text + (" (extrapolated)" if theirs.kind == "extrapolated" else "")


def speedup(results, scene="case1"):
    """Wall time of fix rigid/nve/small over ours, by error."""
    header = ["error", "asked", "cheapest setting", "which", "", "default setting", ""]
    rows = []
    for target in TARGETS:
        theirs = rigid_price(results, scene, target)
        best = cheapest_setting(results, scene, target, "seconds")
        default = price(results, scene, plan.DEFAULT.key, target, "seconds")
        asked = SPEEDUP_ASKED.get(target)
        number, text = ratio(theirs, best and best[1])
        own, own_text = ratio(theirs, default)
        rows.append(
            [
                power(target),
                f"≥ {asked:g}×" if asked else "reached",
                text,
                best[0].label if best else NONE,
                at_least(number, asked or 0.0),
                own_text,
                at_least(own, asked or 0.0),
            ]
        )
    return header, rows


def other_speedups(results):
    """The same for the other scenes with smooth forces, cheapest setting and default in one cell."""
    header = ["scene", *(power(target) for target in TARGETS)]
    rows = []
    for scene in results.scenes:
        if scene == "case1" or not facts(scene).smooth:
            continue
        cells = []
        for target in TARGETS:
            theirs = rigid_price(results, scene, target)
            best = cheapest_setting(results, scene, target, "seconds")
            if best is None or theirs is None:
                cells.append(NONE)
                continue
            default = price(results, scene, plan.DEFAULT.key, target, "seconds")
            both = ratio(theirs, best[1])[1], best[0].label, ratio(theirs, default)[1]
            cells.append("{} ({}); default {}".format(*both))
        rows.append([f"{results.title(scene)}: {facts(scene).measure}", *cells])
    return header, rows


def evaluations(results, scene="case1"):
    """Force evaluations to reach an error, start included, beside SciPy's solvers."""
    header = ["error", "cheapest setting", "which", "default setting", *SOLVERS, "fewer than both"]
    rows = []
    for target in TARGETS:
        best = cheapest_setting(results, scene, target, "evaluations")
        default = price(results, scene, plan.DEFAULT.key, target, "evaluations")
        others = [cost_of(*results.solver(scene, solver), target) for solver in SOLVERS]
        known = [cost.value for cost in others if cost]
        verdict = at_most(best and best[1].value, min(known)) if known else NONE
        cells = [best and best[1], best, default, *others]
        cells = [show_count(cell) if cell is not best else _label(best) for cell in cells]
        rows.append([power(target), *cells, verdict])
    return header, rows


def _label(best):
    return best[0].label if best else NONE


def grouped(number):
    """A whole number in groups of thousands."""
    return f"{number:,.0f}".replace(",", " ")


def show_count(cost):
    """A number of evaluations as text."""
    if cost is None:
        return NONE
    return ("≤ " if cost.kind == "at most" else "") + grouped(cost.value)


# --- order, stability, rounding, time in the fix --------------------------------------------------
def order_fits(results):
    """(formulation, N) -> (steps, errors, Fit or None) of test case 1 with compensated sums."""
    fits = {}
    for formulation in FORMULATIONS:
        for n in plan.VALUES[formulation]:
            rows = [r for r in results.orders if (r.formulation, r.values) == (formulation, n)]
            steps, errors = [r.dt for r in rows], [r.position for r in rows]
            if rows:
                fits[formulation, n] = steps, errors, fitted_order(steps, errors)
    return fits


def limit_of(formulation, n):
    """Largest omega h of the linear test equation."""
    step = second_order_step if formulation == plan.SECOND else first_order_step
    return linear_limit(lambda omega_h: step(n, omega_h))


def orders(results, scene="case1"):
    """Slope of each N beside the order, and the largest stable steps."""
    header = ["formulation", "N", "order", "asked", "slope", "", "ω Δt, linear"]
    header += [f"largest usable step, {count} pass{'es' * (count > 1)}" for count in plan.PASSES]
    rows = []
    for (formulation, n), (steps, errors, fit) in order_fits(results).items():
        order, slope = order_asked(formulation, n), fit.order if fit else None
        asked = order - ORDER_MARGIN if n >= LEAST_N else None
        largest = [
            results.largest_step(scene, plan.gear(formulation, n, count).key)
            for count in plan.PASSES
        ]
        rows.append(
            [
                formulation,
                n,
                order,
                f"≥ {asked:g}" if asked else NONE,
                f"{slope:.2f}" if slope is not None else NONE,
                _order_verdict(slope, asked, steps, errors) if asked else NONE,
                f"{limit_of(formulation, n):.2f}",
                *(f"{step:.2f}" for step in largest),
            ]
        )
    return header, rows


def _order_verdict(slope, asked, steps, errors):
    """Verdict on a slope, and where the error changes sign if it misses."""
    verdict, cancels = at_least(slope, asked), sign_change(steps, errors)
    if verdict == MET or cancels is None:
        return verdict
    return f"{verdict}: the error changes sign at step {cancels:.2g}"


def rounding(results):
    """Errors at small steps, plain and compensated, and whether the floor is low enough."""
    steps = sorted({row.dt for row in results.rounding}, reverse=True)
    header = ["formulation", "sums", *(f"step {dt:g}" for dt in steps), "asked at the smallest", ""]
    by = {(r.formulation, r.compensate, r.dt): r.position for r in results.rounding}
    rows = []
    for formulation, compensate in dict.fromkeys((r[0], r[1]) for r in by):
        errors = [by[formulation, compensate, dt] for dt in steps]
        asked = FLOOR_ASKED[compensate]
        rows.append(
            [
                formulation,
                "compensated" if compensate == "yes" else "plain",
                *(f"{error:.1e}" for error in errors),
                f"≤ {power(asked)}",
                at_most(errors[-1], asked),
            ]
        )
    return header, rows


def modify(results):
    """Time inside the fix, beside that of fix rigid/nve/small."""
    header = ["", "nanoseconds a step (quartiles)", "of fix rigid/nve/small", "asked", ""]
    yard = {row.method: row.median for row in results.modify}.get(plan.RIGID_NVE.key)
    rows = []
    for row in results.modify:
        share = row.median / yard
        asked = row.method == plan.DEFAULT.key
        rows.append(
            [
                row.label + (" (default)" if asked else ""),
                f"{row.median * 1e9:.0f} ({row.low * 1e9:.0f}–{row.high * 1e9:.0f})",
                f"{share:.2f}×",
                f"≤ {MODIFY_ASKED:.1f}×" if asked else NONE,
                at_most(share, MODIFY_ASKED) if asked else NONE,
            ]
        )
    return header, rows


def constraints(results):
    """(largest | |q|^2 - 1 |, largest |q.qdot|) over all sampled runs with usable steps."""
    rows = [
        row
        for row in results.runs
        if row.family != plan.RIGID and row.dt <= results.largest_step(row.scene, row.method)
    ]
    rows = [row for row in rows if facts(row.scene).smooth and row.energy < float("inf")]
    return max(row.norm for row in rows), max(row.tangency for row in rows)


TABLES = {
    "speedup": speedup,
    "other_speedups": other_speedups,
    "evaluations": evaluations,
    "orders": orders,
    "rounding": rounding,
    "modify": modify,
}
