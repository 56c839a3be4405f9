"""The answer of ``gearquat cost`` for a scene whose trajectory diverges, as text for the terminal and as CSV."""

import math

from gearquat_analysis.tables import aligned, rounded, with_error, write_rows

from . import drift
from .methods import named, stated
from .report import _drift_unit, _quantity, _scene, map_lines


def text(deck, answer):
    """The answer as text."""
    unit = _drift_unit(deck)
    header = ["fix line", "timestep", _seconds(deck), "speed-up", f"run ({deck.time_unit or 'time'})"]
    header += [f"drift ({unit})", f"T trans - T rot ({_kelvin(deck)})", ""]
    lines = _scene(deck)
    if deck.start.checkpoints:
        lines.append(
            f"The runs before it were executed once, and all trials start from their end ({answer.before:.1f} s of the budget)."
        )
    lines += [f"Note: {note}." for note in answer.notes]
    lines += ["", aligned(header, [_cells(answer, run, drift.nanosecond(deck)) for run in answer.rows]), "", *_explained(answer), ""]
    return "\n".join([*lines, *_advice(deck, answer), *_failures(answer)])


def _seconds(deck):
    return f"seconds per {'ns' if deck.time_unit else '1000 time units'}"


def _kelvin(deck):
    return "K" if deck.time_unit else "T*"


def verdict(run):
    """The verdict of a LongRun on its step, in a few words."""
    found = run.drift
    if found.fails:
        return "ends with an error"
    if found.drifts:
        return "drifts"
    if found.unbalanced:
        return "temperatures differ"
    return "holds" if found.holds else "not known"


def _cells(answer, run, nanosecond):
    found, difference = run.drift, run.drift.difference
    name = named(run.keywords) + (", as it is" if run is answer.own else "")
    ratio = answer.own.seconds / run.seconds if answer.own else math.nan
    return [
        name,
        f"{run.dt:g}",
        rounded(run.seconds * nanosecond),
        rounded(ratio) if math.isfinite(ratio) and run is not answer.own else "-",
        rounded(found.time) if found.time else "-",
        with_error(found.rate, found.error) if found.known else "not known",
        with_error(difference.value, difference.error) if math.isfinite(difference.error) else "not known",
        verdict(run) + ", recommended" * (run is answer.choice),
    ]


def _explained(answer):
    return [
        "Drift is the slope of the conserved energy over the longest run at this step, in kT of the mean kinetic energy",
        f"and per degree of freedom.  A step holds if that is below {answer.bound:g}, with {drift.SURE:g} standard errors added, and if",
        f"the temperatures of translation and rotation do not differ significantly by more than {100 * drift.BALANCE:g} %.  Seconds",
        "are wall times of the steps.  Speed-up is relative to the deck as it is.",
    ]


def _advice(deck, answer):
    """Lines to put into the script, or a note that no step meets the bound."""
    choice, unit = answer.choice, _drift_unit(deck)
    longer = _longer(deck, answer)
    if choice:
        found = choice.drift
        lines = map_lines(deck) if choice.keywords is not None else ["# keep your fix: no other is faster"]
        return [
            f"For runs such as this one, measured over {_quantity(found.time, deck.time_unit)}"
            f" (drift {with_error(found.rate, found.error, unit)}):",
            *(f"    {line}" for line in [*lines, *deck.fix_lines(choice.keywords), f"timestep {choice.dt:g}"]),
            *longer,
        ]
    lines = [f"Nothing is recommended: no step is known to keep the drift below {answer.bound:g} {unit} (--drift)."]
    least = answer.least
    if least:
        lines.append(
            f"The smallest drift seen is {with_error(least.drift.rate, least.drift.error, unit)}, with"
            f" {named(least.keywords)}, timestep {least.dt:g},\nover {_quantity(least.drift.time, deck.time_unit)}."
        )
    if all(run.drift.refused for run in answer.rows):
        return lines + [
            "Forces that jump at a cut-off and those that are no gradient of a potential, such as friction, change the energy",
            "at every step.",
        ]
    return [*lines, *longer]


def _longer(deck, answer):
    """A note on the use of a longer budget, if one helps."""
    if math.isnan(answer.enough):
        return []
    what = f"A run of {_quantity(drift.longest(deck), deck.time_unit)}" if answer.choice else "A run that is long enough to tell"
    return [f"{what} needs --budget {rounded(answer.enough, 2)} or more, according to the trials."]


def _failures(answer):
    """The errors that ended runs, each once."""
    said = {}
    for run in answer.rows:
        if run.drift.failure:
            said.setdefault(run.drift.failure, f"{named(run.keywords)}, timestep {run.dt:g}")
    return [line for error, where in said.items() for line in ("", f"A run with {where} ended with an error:", f"    {error}")]


def write(folder, answer):
    """cost.csv, the table, and trials.csv, every run."""
    header = ["keywords", "timestep", "seconds_per_time", "time", "drift", "drift_error", "temperature"]
    header += ["temperature_difference", "temperature_difference_error", "verdict", "recommended"]

    def cells(run):
        found = run.drift
        numbers = [found.rate, found.error, found.temperature, found.difference.value, found.difference.error]
        numbers = ["" if math.isnan(number) else number for number in numbers]
        words = [verdict(run), "yes" if run is answer.choice else "no"]
        return [stated(run.keywords), run.dt, run.seconds, found.time or "", *numbers, *words]

    write_rows(folder / "cost.csv", header, map(cells, answer.rows))
    write_rows(folder / "trials.csv", header, map(cells, answer.runs))
