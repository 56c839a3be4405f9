"""The cost of accuracy: error of a trajectory against force evaluations and against wall time.

plan.py      scenes, methods and steps
runs.py      references, errors of runs, and the sequence of all runs
heldout.py   scenes that were not used to choose coefficients
choice.py    scenes that were not used for the rule of `values auto`
evaluate.py  fitted orders, costs of given errors; arrays in, numbers out
tables.py    tables and measurements
figures.py   the pictures
"""

from benchmarks.engine import Finding, Study
from benchmarks.engine.session import Session

from . import choice, evaluate, figures, heldout, plan, runs, tables

#: error that the sentences of the page use
SAMPLE = 1e-6
#: parts of the study with the scenes of heldout.py and choice.py, and their share of the work
HELD_OUT, CHOICE = "heldout", "choice"
SHARE = 0.05


def _milliseconds(cost):
    return "more than was tried" if cost is None else f"{tables.significant(1e3 * cost.value)} ms"


def _of_case1(results):
    """Tables, measurements and variables of the template from test case 1."""
    shown, measurements = tables.case1(results)
    shown["evaluations"] = tables.evaluations(results)
    for name in ("orders", "rounding", "modify"):
        shown[name], found = getattr(tables, name)(results)
        measurements += found
    method, best = tables.cheapest_setting(results, "case1", SAMPLE)
    others = plan.DEFAULT, plan.RIGID_NVE
    prices = [best, *(evaluate.price(results, "case1", m, SAMPLE) for m in others)]
    exact = [error for key, points in results.rounding.items() if key[1] for _, error in points]
    count = evaluate.price(results, "case1", plan.DEFAULT, SAMPLE, "evaluations")
    context = {
        "count": tables.count_text(count),
        "speedup": tables.ratio_text(tables.speedups(results, "case1", SAMPLE)[0], error=False),
        "end": f"{results.scenes['case1'].end:g}",
        "sample": tables.power(SAMPLE),
        "best": method.label if method else "",
        "times": [_milliseconds(cost) for cost in prices],
        "closest": [tables.closest(results, m) for m in (tables.GEAR, {plan.RIGID_NVE.key})],
        "compensated": f"{min(exact):.1e}",
        "timings": min(point.timings for point in results.runs if point.timings),
    }
    return shown, measurements, context


def measure(lab):
    """Results of the requested parts."""
    apart, results = {HELD_OUT, CHOICE}, runs.Results(lab.quick)
    asked = {part for part in apart if part in lab.parts or not lab.parts}
    with Session(lab.out / "logs") as session:
        if set(lab.parts) - apart or not lab.parts:
            with lab.share(1 - SHARE * len(asked)):
                results = runs.measure(lab, session)
        if HELD_OUT in asked:
            with lab.share(SHARE if len(lab.parts) != 1 else 1.0):
                results.heldout = heldout.measure(lab, session)
    if CHOICE in asked:
        results.choice = choice.measure(lab)
    return results


def find(results):
    """Finding of Results."""
    shown, measurements, context, scenes = {}, [], {}, set(results.scenes)
    if "case1" in scenes:
        shown, measurements, context = _of_case1(results)
    if scenes - {"case1", "water-plain"}:
        shown["other_speedups"] = tables.other_speedups(results)
    if {"water", "water-plain"} <= scenes:
        context["cutoff"] = tables.cutoff(results)
    if results.heldout:
        shown["heldout"], found = heldout.find(results.heldout)
        measurements += found
    if results.choice:
        shown["choice"], found = choice.find(results.choice)
        measurements += found
    names = {"starts": "STARTS", "seed": "SEED", "coarse": "COARSE", "above": "ABOVE_FLOOR"}
    context["held_out"] = {key: getattr(heldout, name) for key, name in names.items()}
    context |= {"choice_target": tables.power(choice.TARGET), "choice_most": choice.MOST}
    # the fix reports round-off as zero
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
    parts=(*plan.scenes(False), HELD_OUT, CHOICE),
    blocks={
        "README.md": "accuracy_cost.readme.md.j2",
        "paper/paper.md": "accuracy_cost.paper.md.j2",
    },
)
