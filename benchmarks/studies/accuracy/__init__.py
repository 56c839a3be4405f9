"""What accuracy costs: error of a trajectory against force evaluations and against wall time.

plan.py      what is run: scenes, methods, steps
runs.py      references, errors of runs, and everything that is run, in order
evaluate.py  fitted orders, costs of given errors; arrays in, numbers out
tables.py    tables and measurements
figures.py   the pictures
"""

from benchmarks.engine import Finding, Study

from . import evaluate, figures, plan, tables
from .runs import measure

#: errors the sentences speak of
SAMPLE, FINE = 1e-6, 1e-8


def _milliseconds(cost):
    return "more than was tried" if cost is None else f"{tables.significant(1e3 * cost.value)} ms"


def _of_case1(results):
    """Tables, measurements and names of the template from test case 1."""
    shown, measurements = tables.case1(results)
    for name in ("orders", "rounding", "modify"):
        shown[name], found = getattr(tables, name)(results)
        measurements += found
    method, best = tables.cheapest_setting(results, "case1", SAMPLE)
    others = plan.DEFAULT, plan.RIGID_NVE
    prices = [best, *(evaluate.price(results, "case1", m, SAMPLE) for m in others)]
    exact = [error for key, points in results.rounding.items() if key[1] for _, error in points]
    context = {
        "end": f"{results.scenes['case1'].end:g}",
        "sample": tables.power(SAMPLE),
        "best": method.label if method else "",
        "times": [_milliseconds(cost) for cost in prices],
        "closest": [tables.closest(results, m) for m in (tables.GEAR, {plan.RIGID_NVE.key})],
        "compensated": f"{min(exact):.1e}",
        "timings": min(point.timings for point in results.runs if point.timings),
    }
    return shown, measurements, context


def find(results):
    """Finding of Results."""
    shown, measurements, context, scenes = {}, [], {}, set(results.scenes)
    if "case1" in scenes:
        shown, measurements, context = _of_case1(results)
    if scenes - {"case1", "water-plain"}:
        shown["other_speedups"] = tables.other_speedups(results)
    if "top" in scenes:
        task = results, "top", FINE, "evaluations"
        one, two = (tables.cheapest_setting(*task, passes)[1] for passes in plan.PASSES)
        if one and two:
            saved = 1 - two.value / one.value
            context["passes"] = {"error": tables.power(FINE), "saved": saved}
    if {"water", "water-plain"} <= scenes:
        context["cutoff"] = tables.cutoff(results)
    # the fix reports as zero what is rounding
    context["norm"], context["tangency"] = (max(x, 1e-15) for x in tables.constraints(results))
    shown["runs"] = tables.of_runs(results)
    context["rule"] = {name: getattr(evaluate, name) for name in dir(evaluate) if name.isupper()}
    return Finding(measurements, shown, figures.pictures(results), context)


STUDY = Study(
    "accuracy",
    "What accuracy costs",
    1200.0,
    measure,
    find,
    page="accuracy_cost",
    parts=tuple(plan.scenes(False)),
    blocks={"README.md": "accuracy_cost.readme.md.j2"},
)
