"""What very long runs have shown: table as CSV, and drift.md, every number from Drifts."""

import math
from pathlib import Path

from benchmarks.engine.tables import markdown_table, write_csv
from .judge import SIGNIFICANT, SPOILS
from .runs import DEFAULT, DEFAULT_COMPENSATED, VERLET

#: errors within this factor are called equal: chaotic motions differ by as much from run to run
EQUAL = 2.0
CSV_HEADER = ("scene", "method", "dt", "steps", "slope", "uncertainty", "largest", "lost")


def write(folder, results):
    """drift.csv, one line a run, and drift.md; ``results``: Run -> Drift."""
    rows = []
    for run, drift in results.items():
        head = (run.scene.key, run.method.label, f"{run.dt:g}", run.steps)
        numbers = (f"{x:.6e}" for x in (drift.slope, drift.uncertainty, drift.largest))
        rows.append((*head, *numbers, "" if drift.lost is None else f"{drift.lost:g}"))
    write_csv(Path(folder) / "drift.csv", CSV_HEADER, rows)
    text = "\n".join(markdown(results)) + "\n"
    (Path(folder) / "drift.md").write_text(text, encoding="utf-8")


def show_largest(drift):
    """Largest error as text."""
    return f"lost, t = {drift.lost:.0f}" if drift.lost is not None else f"{drift.largest:.1e}"


def show_slope(drift):
    """Slope as text, in parentheses where it is none to speak of."""
    if drift.lost is not None:
        return "lost"
    text = f"{drift.slope:.1e} ± {drift.uncertainty:.0e}"
    return text if abs(drift.slope) > SIGNIFICANT * drift.uncertainty else f"({text})"


def _methods(results):
    return list(dict.fromkeys(run.method for run in results))


def _scenes(results):
    return list(dict.fromkeys(run.scene for run in results))


def _by(results, scene):
    """(method, dt) -> Drift of one scene."""
    return {(run.method, run.dt): drift for run, drift in results.items() if run.scene == scene}


def table(results, scene, first, show):
    """Markdown lines of one table: a row a method, a column a step."""
    found = _by(results, scene)
    header = [first, *(f"step {dt:g}" for dt in scene.dts)]
    rows = [
        [method.label, *(show(found[method, dt]) for dt in scene.dts)]
        for method in _methods(results)
    ]
    return markdown_table(header, rows)


def times(ratio):
    """A ratio of errors as text; nothing for one that is infinite."""
    if not math.isfinite(ratio):
        return ""
    return f" ({ratio:.0e} times)" if ratio >= 1e4 else f" ({float(f'{ratio:.1e}'):g} times)"


def compare(found, dts, ours, theirs):
    """At which steps methods hold the energy better, equally well, and worse than others.

    ``ours`` and ``theirs`` are lists of methods; the best of each counts at every step.  Returns
    three lists of (step, ratio of the errors); errors within the factor EQUAL are equal.
    """
    better, equal, worse = [], [], []
    for dt in dts:
        own, other = (min(found[m, dt].largest for m in methods) for methods in (ours, theirs))
        if own <= EQUAL * other and other <= EQUAL * own:
            equal.append((dt, 1.0))
        elif own < other:
            better.append((dt, other / own))
        else:
            worse.append((dt, own / other))
    return better, equal, worse


def _comparison(subject, other, lists):
    words = ("better", f"equally well (within a factor {EQUAL:g})", "worse")
    parts = []
    for word, steps in zip(words, lists):
        shown = [f"{dt:g}" + (times(ratio) if ratio > EQUAL else "") for dt, ratio in steps]
        parts += [f"{word} at {', '.join(shown)}"] if shown else []
    return f"{subject} against {other}, by step: {'; '.join(parts)}."


def _winner(lists):
    """Who holds the energy best at which step: lists of the best of fix gear/quat for each step."""
    parts = []
    for name, steps in zip(("`fix gear/quat`", "neither", "NO_SQUISH"), lists):
        parts += [f"{name} at {', '.join(f'{dt:g}' for dt, _ in steps)}"] if steps else []
    return f"Who holds the energy best, with the best setting for each step: {'; '.join(parts)}."


def _where(found, dts, methods, true_of):
    """Methods and the steps at which something is true of them, as text."""
    parts = []
    for method in methods:
        steps = [f"{dt:g}" for dt in dts if true_of(found[method, dt])]
        if steps:
            parts.append(f"{method.label} at {', '.join(steps)}")
    return "; ".join(parts) or "none"


def verdict(results, scene):
    """Sentences, from the numbers alone: who holds the energy at which step, and who drifts."""
    found, methods = _by(results, scene), _methods(results)
    gear = [method for method in methods if method.gear]
    squish = [method for method in methods if not method.gear and method != VERLET]
    name = "NO_SQUISH (`fix rigid/nve/small`, `fix rigid/nve`)"
    contests = [
        ("The default of `fix gear/quat`", [DEFAULT], name, squish),
        ("The best setting of `fix gear/quat` for each step", gear, name, squish),
        ("The default with compensated sums", [DEFAULT_COMPENSATED], "without", [DEFAULT]),
        (f"`{VERLET.label}`", [VERLET], name, squish),
    ]
    sentences = [
        _comparison(subject, other, compare(found, scene.dts, ours, theirs))
        for subject, ours, other, theirs in contests
        if set(ours) | set(theirs) <= set(methods)
    ]
    best = compare(found, scene.dts, gear, squish)
    return (
        [_winner(best)]
        + sentences
        + [
            f"No drift: {_where(found, scene.dts, methods, lambda d: not d.drifts)}.",
            f"Energy wrong by more than {SPOILS:.0%} of the kinetic energy at the start: "
            f"{_where(found, scene.dts, methods, lambda d: d.spoiled and d.lost is None)}.",
            f"Numbers no longer finite: {_where(found, scene.dts, methods, lambda d: d.lost is not None)}.",
        ]
    )


def markdown(results, picture="drift.png"):
    """The whole account as Markdown lines, headings of the second level."""
    steps = next(iter(results)).steps
    lines = [f"## Energy over {steps:,} steps".replace(",", " "), ""]
    lines += [
        "Total energy of the corrected pose, error against its start. A slope is that of a "
        f"least-squares line, ± one standard error; one of less than {SIGNIFICANT:g} of them is in "
        "parentheses and, unless the energy is quite wrong, called no drift. `lost`: energies or "
        "positions stopped being finite numbers. Gear's method is not symplectic; NO_SQUISH is. Units are those of the scene (lj).",
        "",
        f"![Largest error and drift of the energy.]({picture})",
    ]
    for scene in _scenes(results):
        lines += ["", f"### {scene.title}", ""]
        lines += table(results, scene, "largest error of the energy", show_largest)
        lines += [""] + table(results, scene, "drift, energy per unit of time", show_slope)
        lines += [""] + [f"- {sentence}" for sentence in verdict(results, scene)]
    return lines
