"""The strongest of the other methods in each scene; curves of scenes.py in, numbers and tables out."""

import numpy as np

from benchmarks.engine import Measurement, Table
from benchmarks.engine.costs import NONE, cheapest, cost_of, count_text, power, ratio_text
from benchmarks.studies.accuracy import TARGETS

from . import peers, scenes

#: largest number of evaluations for each error in test case 1
MOST = {scenes.FIXED: (650, 800, 1250, 2050), scenes.TOLERANCE: (310, 420, 560, 720)}
#: the fix in tables: key -> label
OURS = {scenes.FIXED: "`fix gear/quat`, default settings", scenes.TOLERANCE: "`fix gear/quat`, keyword `tolerance`"}
OTHER = "the strongest of the other methods"


# --- costs ----------------------------------------------------------------------------------------
def curves(rows, column):
    """Arrays (2, n) of evaluations and errors of lists of rows of peers.py, with the errors of a column."""
    return [np.array([(row[1], row[column]) for row in own], dtype=float).reshape(-1, 2).T for own in rows]


def lowest_cost(curves, target):
    """Cost of an error on the curve on which it is lowest, None if none reaches it."""
    return cheapest({k: cost_of(*curve, target) for k, curve in enumerate(curves)})[1]


def costs(results, title, target):
    """Name -> Cost or None, for the fix and the other methods in a scene."""
    column, own = results[title]
    return {name: lowest_cost(curves(rows, column), target) for name, rows in own.items()}


def compared(results):
    """Title -> for each of TARGETS a pair: key of OURS -> Cost or None; (name, Cost) of the strongest other method."""
    found = {}
    for title in results:
        of_targets = [costs(results, title, target) for target in TARGETS]
        found[title] = [
            (
                {key: own.get(key) for key in OURS},
                cheapest({name: cost for name, cost in own.items() if name not in OURS}),
            )
            for own in of_targets
        ]
    return found


# --- test case 1 ----------------------------------------------------------------------------------
def _named(name, cost):
    return f"{count_text(cost)} ({name})" if cost else NONE


def case1(results):
    """The tables "evaluations" and "readme" of test case 1, and their measurements."""
    found, cells, words = [], compared(results)[scenes.CASE1], dict(zip(OURS, ("default settings", "`tolerance`")))
    page = {label: [count_text(own[key]) for own, _ in cells] for key, label in OURS.items()}
    short = page | {OTHER: [_named(*peer) for _, peer in cells]}
    for name in peers.NAMES:
        page[name] = [count_text(costs(results, scenes.CASE1, target).get(name)) for target in TARGETS]
    page[OTHER] = [name or NONE for _, (name, _) in cells]
    for key in OURS:
        texts = [ratio_text(peer and own[key] and peer.over(own[key])) for own, (_, peer) in cells]
        page[f"strongest other method / {words[key]}"] = short[f"strongest other method / {words[key]}"] = texts
        for target, most, (own, (name, peer)) in zip(TARGETS, MOST[key], cells):
            value, at = own[key].value if own[key] else np.nan, f"test case 1, error {power(target)}"
            found.append(Measurement(f"{at}: force evaluations with {key}", value, spec=",.0f", most=most))
            what = f"{at}: evaluations of the strongest other method over {key}"
            factor = peer.value / value if peer else np.nan
            least = 1.0 if key == scenes.TOLERANCE else None
            found.append(Measurement(what, factor, None, ".3g", "times", name or "", least=least))
    header = ("force evaluations", *(f"error {power(target)}" for target in TARGETS))
    tables = {"evaluations": page, "readme": short}
    return {key: Table(header, [[label, *row] for label, row in own.items()]) for key, own in tables.items()}, found


# --- other scenes ---------------------------------------------------------------------------------
def _is_start(title):
    return title.startswith("start ")


def _ratios(cells, key):
    """Evaluations of the strongest other method over those of the fix, where both reach the error."""
    return np.array([peer.value / own[key].value for own, (_, peer) in cells if peer and own[key]])


def _mean(ratios):
    return f"{np.exp(np.log(ratios).mean()):.2f}" if len(ratios) else NONE


def of_scenes(results):
    """Tables "rivals" and "starts" of all other scenes."""
    rows, starts, found = [], [], compared(results)
    for title, cells in found.items():
        three = [[count_text(own[key]) for own, _ in cells] for key in OURS]
        three.append([_named(*peer) for _, peer in cells])
        if _is_start(title):
            starts.append([title, *map(" / ".join, zip(*three))])
        elif title != scenes.CASE1:
            labels = zip((title, "", ""), (*OURS, "others"))
            rows += [[*label, *row] for label, row in zip(labels, three)]
    of_starts = zip(*(cells for title, cells in found.items() if _is_start(title)))
    means = [" / ".join(_mean(_ratios(cells, key)) for key in OURS) for cells in of_starts]
    starts.append(["others over the fix, geometric mean", *means])
    errors = list(map(power, TARGETS))
    return {"rivals": Table(["scene", "method", *errors], rows), "starts": Table(["scene", *errors], starts)}


def losses(results):
    """Other methods that take fewer evaluations than the fix with either setting, and counts for the starts.

    Returns a list of (title, names, factors as text), and (number of comparisons from the starts, key of OURS ->
    number of those that another method wins).
    """
    texts, lost, number = [], dict.fromkeys(OURS, 0), 0
    for title, cells in compared(results).items():
        if _is_start(title):
            number += len(cells)
            for key in OURS:
                lost[key] += int((_ratios(cells, key) < 1).sum())
            continue
        factors, names = [], {}
        for own, (name, peer) in cells:
            _, best = cheapest(own)
            if peer and best and peer.value < best.value:
                names[name.rpartition(", ")[0] or name] = True
                factors.append(best.value / peer.value)
        if factors:
            span = dict.fromkeys(f"{x:.2g}" for x in (min(factors), max(factors)))
            texts.append((title, " or ".join(names), " to ".join(span)))
    return texts, (number, lost)
