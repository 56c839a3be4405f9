"""Results as text and for JSON."""

import numpy as np

from gearquat_analysis.tables import aligned
from gearquat_analysis.units import UNITS

from .results import NAMED


def _with_units(unit, style):
    """A unit with the names that lengths and times have in the style, if it is one of the deck."""
    units = UNITS[style]
    if style == "lj":
        return "" if unit in ("length^2", "length^3/time") else unit
    names = {"length": units.length, "time": units.time}
    for name, own in names.items():
        unit = unit.replace(name, own)
    return unit


def quantity(name, estimate, style):
    """Cells of a row: digits go as far as the error does."""
    if not np.isfinite(estimate.error):
        return [name, f"{estimate.value:.6g}", "", _with_units(estimate.unit, style), estimate.about]
    digits = 6 if not estimate.error else int(np.clip(np.ceil(-np.log10(estimate.relative)) + 1, 1, 12))
    value = f"{estimate.value:.{digits}g}"
    return [name, value, f"{estimate.error:.1g}", _with_units(estimate.unit, style), estimate.about]


def text(facts, plan, farthest, found):
    """What the command prints."""
    units = UNITS[facts.style]
    rows = [quantity(name, estimate, facts.style) for name, estimate in found.estimates.items()]
    table = aligned(["quantity", "value", "error", "unit", ""], rows)
    counts = found.counts
    lines = [f"{facts.name}, {_conditions(plan, facts.style)}: {counts['flights']} flights", "", table, ""]
    lines.append(_distance(farthest, units.length))
    lines.append(
        f"{counts['steps'] / max(counts['flights'], 1):.0f} steps a flight; steps repeated in {counts['repeated']}"
        f" flights; {counts['orbiting']} flights orbiting (more than one turning); {counts['unparted']} unparted;"
        f" {counts['lost']} lost"
    )
    largest = ", ".join(f"{words} {values[0]:.1e}" for words, values in found.errors.items())
    lines.append(f"Largest errors of a flight, relative: {largest}")
    for fate, numbers in found.unfinished.items():
        if numbers:
            more = "" if len(numbers) <= NAMED else f" and {len(numbers) - NAMED} more"
            lines.append(
                f"{fate.capitalize()}: {', '.join(map(str, numbers[:NAMED]))}{more}; averages count them as if they"
                " had left in all directions alike, without transfer of energy"
            )
    return "\n".join(lines)


def _conditions(plan, style):
    if plan.energy is not None:
        rotation = f", rotation at temperature {plan.rotation:g}" if plan.rotation else ", no rotation"
        return f"energy {plan.energy:g}{rotation}"
    unit = "" if style == "lj" else " K"
    own = "" if plan.rotation == plan.temperature else f", rotation at {plan.rotation:g}{unit}"
    return f"temperature {plan.temperature:g}{unit}{own}"


def _distance(farthest, unit):
    words = f"Largest impact parameter: {f'{farthest.value:g} {unit}'.strip()}"
    if not farthest.left:
        return f"{words}, as stated; what is beyond it is not in the averages, and has not been estimated"
    left = max(farthest.left.values())
    return f"{words}; what is beyond it is {left:.1e} of the whole, by {farthest.pilots} pilot flights"


def as_json(settings, found):
    """Everything that is known, ready for JSON; not a number is None."""
    style = settings["pair"]["style"]
    quantities = {
        name: {
            "value": estimate.value,
            "error": estimate.error if np.isfinite(estimate.error) else None,
            "unit": _with_units(estimate.unit, style),
            "about": estimate.about,
        }
        for name, estimate in found.estimates.items()
    }
    rows = np.atleast_2d(found.correlations).tolist()
    matrix = [[value if np.isfinite(value) else None for value in row] for row in rows]
    errors = {words: {"largest": values[0], "median": values[1]} for words, values in found.errors.items()}
    return {
        "settings": settings,
        "units": {"style": style, "length": UNITS[style].length, "time": UNITS[style].time},
        "quantities": quantities,
        "correlations": {"of": list(found.correlated), "matrix": matrix},
        "flights": found.counts,
        "unfinished": found.unfinished,
        "errors": errors,
    }
