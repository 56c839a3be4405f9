"""Force evaluations compared with the strongest of the other methods, in test case 1 and in the scenes of rivals.py."""

import numpy as np

from benchmarks.engine import Measurement, Table
from benchmarks.engine.methods import GEARS

from . import peers, plan, rivals
from .evaluate import cheapest, curves, lowest_cost, price
from .tables import NONE, TARGETS, cheapest_setting, count_text, power, ratio_text, significant

#: largest number of evaluations for each error in test case 1
MOST_DEFAULT = dict(zip(TARGETS, (650, 800, 1250, 2050)))
MOST_TOLERANCE = dict(zip(TARGETS, (500, 650, 1000, 1600)))
#: a step, and the largest error with the defaults of the first formulation
FIRST_STEP, MOST_FIRST = 0.1, 3e-7
#: the fix in tables: key -> label
OURS = {rivals.FIXED: "`fix gear/quat`, default settings", rivals.TOLERANCE: "`fix gear/quat`, keyword `tolerance`"}
OTHER = "the strongest of the other methods"


# --- costs ----------------------------------------------------------------------------------------
def prices(results, target):
    """Name -> Cost in evaluations, or None, for an error in test case 1, with fix rigid/nve/small."""
    found = {name: lowest_cost(results.peer("case1", name), target) for name in peers.NAMES}
    task = results, "case1", plan.RIGID_NVE, target, "evaluations"
    return found | {plan.RIGID_NVE.label: price(*task, extrapolate=True)}


def strongest(results, target):
    """(name, Cost) of the other method with the fewest evaluations; (None, None) if none reaches the error."""
    return cheapest(prices(results, target))


def ours(results, target):
    """Key of OURS -> Cost or None in test case 1."""
    usual = price(results, "case1", plan.DEFAULT, target, "evaluations")
    return {rivals.FIXED: usual, rivals.TOLERANCE: lowest_cost(results.peer("case1", "tolerance"), target)}


def compared(results):
    """Title -> for each of TARGETS a pair: key of OURS -> Cost or None, and (name, Cost) of the strongest other method."""
    found = {}
    if "case1" in results.scenes:
        found["Test case 1"] = [(ours(results, target), strongest(results, target)) for target in TARGETS]
    for title, (column, own) in results.rivals.items():
        measured = {name: curves(rows, column) for name, rows in own.items()}
        found[title] = [
            (
                {key: lowest_cost(measured.get(key, []), target) for key in OURS},
                cheapest({name: lowest_cost(own, target) for name, own in measured.items() if name not in OURS}),
            )
            for target in TARGETS
        ]
    return found


def error_at(steps, errors, step):
    """Error at a step between measured ones, interpolated log-log; arrays (n,)."""
    order = np.argsort(steps)
    steps, errors = np.log(np.asarray(steps)[order]), np.log(np.asarray(errors)[order])
    return float(np.exp(np.interp(np.log(step), steps, errors)))


# --- test case 1 ----------------------------------------------------------------------------------
def _named(name, cost):
    return f"{count_text(cost)} ({name})" if cost else NONE


def columns(results, target):
    """Label -> cell for one error, for the page and for README."""
    others, (name, peer), own = prices(results, target), strongest(results, target), ours(results, target)
    counts = {OURS[key]: count_text(cost) for key, cost in own.items()}
    words = {rivals.FIXED: "default settings", rivals.TOLERANCE: "`tolerance`"}
    factors = {
        f"strongest other method / {words[key]}": ratio_text(peer and cost and peer.over(cost), False)
        for key, cost in own.items()
    }
    method, best = cheapest_setting(results, "case1", target, "evaluations")
    namely = {"`fix gear/quat`, best number of values": count_text(best)}
    namely["this setting is"] = method.label if method else NONE
    gears = price(results, "case1", GEARS["second"], target, "evaluations")
    of_others = {"`fix gear/quat`, `corrector gear`": count_text(gears)}
    of_others |= {label: count_text(cost) for label, cost in others.items()}
    return counts | namely | of_others | {OTHER: name or NONE} | factors, counts | {OTHER: _named(name, peer)} | factors


def case1(results):
    """The tables "evaluations" and "readme" of test case 1, and their measurements."""
    found, bounds = [], dict(zip(OURS, (MOST_DEFAULT, MOST_TOLERANCE)))
    for target in TARGETS:
        at, (name, peer) = f"test case 1, error {power(target)}", strongest(results, target)
        for key, cost in ours(results, target).items():
            value = cost.value if cost else np.nan
            what = f"{at}: force evaluations with {key}"
            found.append(Measurement(what, value, spec=",.0f", most=bounds[key][target]))
            factor = peer.value / value if peer else np.nan
            what = f"{at}: ratio of force evaluations, strongest other method over {key}"
            least = 1.0 if key == rivals.TOLERANCE else None
            found.append(Measurement(what, factor, None, ".3g", "times", name or "", least=least))
    error = error_at(*results.errors("case1", plan.DEFAULTS["first"]), FIRST_STEP)
    what = f"test case 1, first formulation, default settings, step {FIRST_STEP:g}: error"
    found.append(Measurement(what, error, most=MOST_FIRST))
    header = ("force evaluations", *(f"error {power(target)}" for target in TARGETS))
    tables = {}
    for key, cells in zip(("evaluations", "readme"), zip(*(columns(results, t) for t in TARGETS))):
        tables[key] = Table(header, [[label, *(c[label] for c in cells)] for label in cells[0]])
    return tables, found


# --- other scenes ---------------------------------------------------------------------------------
def _is_start(title):
    return title.startswith("start ")


def _ratios(cells, key):
    """Evaluations of the strongest other method over those of the fix, where both reach the error."""
    return np.array([peer.value / own[key].value for own, (_, peer) in cells if peer and own[key]])


def _row(cells):
    """Cells of the fix and of the strongest method, as text."""
    return [[count_text(own[key]) for own, _ in cells] for key in OURS], [_named(*peer) for _, peer in cells]


def scenes(results):
    """Tables "rivals" and "starts" of all scenes of ``compared``."""
    rows, starts, found = [], [], compared(results)
    for title, cells in found.items():
        own, others = _row(cells)
        if _is_start(title):
            starts.append([title, *(" / ".join(three) for three in zip(*own, others))])
            continue
        rows += [[title if not k else "", label, *row] for k, (label, row) in enumerate(zip((*OURS, "others"), (*own, others)))]
    columns = zip(*(cells for title, cells in found.items() if _is_start(title)))
    means = [[_mean(_ratios(cells, key)) for key in OURS] for cells in columns]
    if starts:
        starts.append(["others / the fix, geometric mean", *(" / ".join(f"{x:.2f}" for x in two) for two in means)])
    errors = list(map(power, TARGETS))
    return {"rivals": Table(["scene", "method", *errors], rows), "starts": Table(["scene", *errors], starts)}


def _mean(ratios):
    return float(np.exp(np.log(ratios).mean())) if len(ratios) else np.nan


def losses(results):
    """Sentences about other methods that take fewer evaluations than the fix, and counts for the starts.

    Returns a list of texts, and (number of comparisons from the starts, key of OURS -> number that another method wins).
    """
    texts, lost, number, found = [], dict.fromkeys(OURS, 0), 0, compared(results)
    for title, cells in found.items():
        if _is_start(title):
            number += len(cells)
            for key in OURS:
                lost[key] += int((_ratios(cells, key) < 1).sum())
            continue
        factors, names = [], {}
        for own, (name, peer) in cells:
            _, best = cheapest(own)
            if peer and (best is None or peer.value < best.value):
                names[name.partition(",")[0]] = True
                factors += [best.value / peer.value] if best else []
        if factors:
            span = sorted({significant(min(factors)), significant(max(factors))}, key=float)
            texts.append((title, " or ".join(names), " to ".join(span)))
    return texts, (number, lost)
