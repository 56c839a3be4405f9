"""Results as text and for JSON."""

import numpy as np

from gearquat_analysis.tables import aligned, error_cells, rounded
from gearquat_analysis.units import UNITS

from .results import NAMED


def _with_units(unit, style):
    """A unit with the names of lengths and times in the style, if it is a unit of the deck."""
    units = UNITS[style]
    if style == "lj":
        return "" if unit in ("length^2", "length^3/time") else unit
    names = {"length": units.length, "time": units.time}
    for name, own in names.items():
        unit = unit.replace(name, own)
    return unit


def quantity(name, estimate, style):
    """Cells of a row."""
    return [name, *error_cells(estimate.value, estimate.error), _with_units(estimate.unit, style), estimate.about]


def text(facts, plan, farthest, found):
    """The printed report of the command."""
    units, counts = UNITS[facts.style], found.counts
    lines = [f"{facts.name}, {_conditions(plan, facts.style)}: {counts['flights']} flights", ""]
    for answer in found.answers:
        rows = [quantity(name, estimate, facts.style) for name, estimate in answer.estimates.items()]
        table = aligned(["quantity", "value", "error", "unit", ""], rows)
        lines += [f"{condition(answer.temperature, facts.style)}:"] * (len(found.answers) > 1) + [table, ""]
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
                f"{fate.capitalize()}: {', '.join(map(str, numbers[:NAMED]))}{more}; averages treat them as isotropic"
                " scattering without transfer of energy, and errors include their whole contribution"
            )
    return "\n".join(lines)


def so_far(found, error):
    """A line about Results when errors are checked against the requested ``error``."""
    worst = max(found.answers, key=lambda answer: answer.relative)
    errors = ", ".join(f"{name} {rounded(worst.estimates[name].relative, 2)}" for name in worst.aims)
    at = "" if len(found.answers) == 1 else f" at temperature {worst.temperature:g}"
    return f"{found.counts['flights']} flights: relative errors {errors}{at}; {error:g} is asked for"


def unfinished(found):
    """Words about flights that have not parted."""
    counts, words = found.counts, []
    if counts["unparted"]:
        words.append(f"{counts['unparted']} of {counts['flights']} flights have not parted within --steps")
    if counts["lost"]:
        words.append(f"{counts['lost']} were ended by LAMMPS ({found.message})")
    return " and ".join(words)


def _conditions(plan, style):
    if plan.energy is not None:
        rotation = f", rotation at temperature {plan.rotation:g}" if plan.rotation else ", no rotation"
        return f"energy {plan.energy:g}{rotation}"
    unit = "" if style == "lj" else " K"
    own = "" if plan.rotation is None else f", rotation at {plan.rotation:g}{unit}"
    several = "s" * (len(plan.temperature) > 1)
    return f"temperature{several} {', '.join(f'{one:g}' for one in plan.temperature)}{unit}{own}"


def condition(temperature, style):
    """Words for one temperature, "" for None."""
    if temperature is None:
        return ""
    return f"temperature {temperature:g}{'' if style == 'lj' else ' K'}"


def _distance(farthest, unit):
    words, left = f"Largest impact parameter: {f'{farthest.value:g} {unit}'.strip()}", farthest.highest()
    if left is None:
        return (
            f"{words}; the part beyond it is not known, because losses do not decay towards the cutoff, and is included"
            " neither in the averages nor in all errors"
        )
    return (
        f"{words}; the part beyond it is {left:.1e} of the loss, according to {farthest.pilots} pilot flights, and errors"
        " include it"
    )


def as_json(settings, found):
    """All results, ready for JSON; NaN becomes None."""
    style = settings["pair"]["style"]
    answers = [_answer_as_json(answer, style) for answer in found.answers]
    errors = {words: {"largest": values[0], "median": values[1]} for words, values in found.errors.items()}
    return {
        "settings": settings,
        "units": {"style": style, "length": UNITS[style].length, "time": UNITS[style].time},
        **(answers[0] if len(answers) == 1 else {"temperatures": answers}),
        "flights": found.counts,
        "unfinished": found.unfinished,
        "errors": errors,
    }


def _answer_as_json(answer, style):
    quantities = {
        name: {
            "value": estimate.value,
            "error": estimate.error if np.isfinite(estimate.error) else None,
            "unit": _with_units(estimate.unit, style),
            "about": estimate.about,
        }
        for name, estimate in answer.estimates.items()
    }
    rows = np.atleast_2d(answer.correlations).tolist()
    matrix = [[value if np.isfinite(value) else None for value in row] for row in rows]
    correlations = {"of": list(answer.correlated), "matrix": matrix}
    return {"temperature": answer.temperature, "quantities": quantities, "correlations": correlations}
