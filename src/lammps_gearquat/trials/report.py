"""The answers as text for the terminal, and as rows for CSV and JSON."""

import math

from gearquat_analysis.tables import aligned, rounded, with_error

from . import NORMS, drift
from .evaluate import usable_step
from .methods import named, stated


def _drift_unit(deck):
    return f"kT/{'ns' if deck.time_unit else '1000 time units'}/dof"


def _quantity(value, unit, digits=3):
    return rounded(value, digits) + (f" {unit}" if unit else "")


#: seconds of earlier runs
BEFORE = "The runs before it were executed once, and all trials start from their end ({:.1f} s of the budget)."


def _scene(deck, before=0.0):
    bodies, end = len(deck.scene.bodies), _quantity(deck.end, deck.time_unit, 6)
    many = "body" if bodies == 1 else "bodies"
    return [
        f"{deck.path.name} has {bodies} rigid {many} of {len(deck.scene.ids)} atoms, moved by",
        *(f"    {line}" for line in deck.fix_lines(None)),
        f"    timestep {deck.dt:g}, run {deck.start.steps} (t = {end})",
        *([BEFORE.format(before)] if deck.start.checkpoints else []),
    ]


# --- cost -----------------------------------------------------------------------------------------
def cost_text(deck, costs):
    """The answer of ``gearquat cost``."""
    unit = deck.length_unit if costs.norm < 2 else "rad"
    end = _quantity(costs.end, deck.time_unit)
    reference, confirmation = costs.reference, costs.confirmation
    lines = [*_scene(deck, costs.before)]
    lines += [
        f"The error is the {NORMS[costs.norm]} error of the bodies at t = {end}"
        + (f", in {unit}," if unit else ",")
        + f" against\n    gear/quat {reference.label}, step {rounded(reference.dt)};",
        f"    gear/quat {confirmation.label}, step {rounded(confirmation.dt)}, confirms that reference to"
        f" {_quantity(costs.doubt, unit, 2)}.",
    ]
    lines += [f"Note: {note}" for note in costs.notes]
    own = costs.points().get(None, []) if deck.own == deck.lines else []
    as_it_is = [point for point in own if abs(point.dt / deck.dt - 1) < 0.01]
    if as_it_is:
        lines.append(f"As it is, the deck ends with an error of {rounded(as_it_is[0].error, 2)}.")
    seconds = f"seconds per {deck.time_unit or 'time unit'}"
    header = ["error", "fix line", "timestep", seconds, "speed-up", "start (s)"]
    lines += ["", aligned(header, [_cost_cells(costs, row) for row in costs.rows])]
    lines += ["", *EXPLAINED, "", *_script_lines(deck, costs)]
    return "\n".join(lines)


def _cost_cells(costs, row):
    price, cells = row.choice, [f"{row.error:.1e}"]
    if price is None:
        return cells + ["cannot be judged" if row.error <= costs.doubt_limit else "is not reached", *"----"]
    return cells + [
        "keep your fix" if row.keep else named(price.method),
        f"{usable_step(price.dt):g}",
        rounded(price.seconds / costs.end),
        rounded(row.own.seconds / price.seconds) if row.own and not row.keep else "-",
        rounded(price.start_seconds, 2),
    ]


#: what the columns are
EXPLAINED = (
    "Every method evaluates the forces once per step.  Seconds are the shortest of repeated wall times of the steps, without the",
    "start.  Each timestep was tried: it had at most this error, with the uncertainty of the reference included.  Speed-up is",
    "relative to the deck's own fix at the same error.  A longer run may drift: see the conserved energy.",
)


def _script_lines(deck, costs):
    """Lines to put into the script for each error that was reached, and advice for the other errors."""
    lines, reached = [], [row for row in costs.rows if row.choice]
    if not all(row.keep for row in reached):
        lines += map_lines(deck)
    for row in reached:
        lines.append(f"For an error of {row.error:.1e} at t = {costs.end:g}:")
        keeping = ["# keep your fix: no other is faster"] if row.keep else []
        line = None if row.keep else row.best.method
        words = [*keeping, *deck.fix_lines(line), f"timestep {usable_step(row.choice.dt):g}"]
        lines += [f"    {word}" for word in words]
    missing = [row for row in costs.rows if not row.choice and row.error > costs.doubt_limit]
    for row in missing:
        lines.append(f"No trial within the budget had an error of {row.error:.1e}: try a longer --budget or a shorter --time.")
    return lines or ["None of the errors can be judged: try a longer --budget, a shorter --time or a larger --error."]


def map_lines(deck):
    """Lines that fix gear/quat needs above the box of the deck."""
    if not deck.map_missing:
        return []
    return ["Above the command that makes the box (read_data, create_box):", "    atom_modify map yes", ""]


def cost_tables(costs):
    """Name -> (header, rows) of cost.csv, the table, and of trials.csv, every trial."""
    fields = ["timestep", "evaluations", "seconds", "start_evaluations", "start_seconds"]
    rows = []
    for row in costs.rows:
        cells = [row.error, stated(row.best.method) if row.best else ""]
        for price in (row.best, row.own):
            cells += [getattr(price, name) if price else "" for name in ["dt", *fields[1:]]]
        ratio = row.own.seconds / row.best.seconds if row.own and row.best else ""
        rows.append([*cells, ratio, "yes" if row.keep else "no", costs.end])
    header = ["error", "keywords", *fields, *(f"own_{name}" for name in fields), "speed_up", "keep", "time"]
    every = ["keywords", "timestep", "steps", "start_evaluations", *(norm.replace(" ", "_") for norm in NORMS)]
    every += ["seconds_least", "seconds_most", "timings", "start_seconds"]
    trials = [
        [stated(trial.keywords), trial.dt, trial.steps, trial.start_evaluations, *errors]
        + [trial.fastest, max(trial.seconds), len(trial.seconds), trial.fastest_start]
        for trial, errors in costs.trials
    ]
    return {"cost": (header, rows), "trials": (every, trials)}


# --- until ----------------------------------------------------------------------------------------
def parting_text(deck, found):
    """The answer of ``gearquat cost --until``."""
    time, length = deck.time_unit, deck.length_unit
    lines = [*_scene(deck), "Two runs of it were compared:"]
    for trial in found.trials:
        name = "as it is" if trial.keywords is None else "gear/quat " + trial.label
        lines.append(f"    {name}, timestep {trial.dt:g}")
    lines += [f"Note: {note}" for note in found.notes]
    lines.append("The centers of mass of a body in the two runs are further apart than")
    last = _quantity(float(found.time[-1]), time, 6)
    for level, parted in found.times:
        when = f"from t = {_quantity(parted, time, 6)}" if math.isfinite(parted) else f"not before t = {last}"
        lines.append(f"    {_quantity(level, length):>8s}  {when}")
    return "\n".join(lines)


def parting_tables(found):
    """Name -> (header, rows) of until.csv: the differences of the two runs in time."""
    header = ["time", "largest_position", "rms_position", "largest_orientation"]
    return {"until": (header, list(zip(*(one.tolist() for one in (found.time, found.largest, found.rms, found.angle)))))}


# --- where trajectories diverge -------------------------------------------------------------------
def drift_text(deck, answer):
    """The answer of ``gearquat cost`` where trajectories diverge."""
    unit = _drift_unit(deck)
    header = ["fix line", "timestep", _seconds(deck), "speed-up", f"run ({deck.time_unit or 'time'})"]
    header += [f"drift ({unit})", f"T trans - T rot ({_kelvin(deck)})", ""]
    lines = _scene(deck, answer.before)
    lines += [f"Note: {note}." for note in answer.notes]
    lines += ["", aligned(header, [_drift_cells(answer, run, drift.nanosecond(deck)) for run in answer.rows]), "", *_judged(answer), ""]
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


def _drift_cells(answer, run, nanosecond):
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


def _judged(answer):
    return [
        "Drift is the slope of the conserved energy over the longest run at this step, in kT of the mean kinetic energy",
        f"and per degree of freedom.  A step holds if that is below {answer.bound:g}, with {drift.SURE:g} standard errors added, and if",
        f"the temperatures of translation and rotation do not differ significantly by more than {100 * drift.BALANCE:g} %.  Seconds",
        "are wall times of the steps.  Speed-up is relative to the deck as it is.",
    ]


def _advice(deck, answer):
    """Lines to put into the script, or a note that no step meets the bound."""
    choice, unit = answer.choice, _drift_unit(deck)
    if choice:
        found = choice.drift
        lines = map_lines(deck) if choice.keywords is not None else ["# keep your fix: no other is faster"]
        return [
            f"For runs such as this one, measured over {_quantity(found.time, deck.time_unit)}"
            f" (drift {with_error(found.rate, found.error, unit)}):",
            *(f"    {line}" for line in [*lines, *deck.fix_lines(choice.keywords), f"timestep {choice.dt:g}"]),
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
    return [*lines, "A longer --budget allows longer runs, which tell more."]


def _failures(answer):
    """The errors that ended runs, each once."""
    said = {}
    for run in answer.rows:
        if run.drift.failure:
            said.setdefault(run.drift.failure, f"{named(run.keywords)}, timestep {run.dt:g}")
    return [line for error, where in said.items() for line in ("", f"A run with {where} ended with an error:", f"    {error}")]


def drift_tables(answer):
    """Name -> (header, rows) of cost.csv, the table, and of trials.csv, every run."""
    header = ["keywords", "timestep", "seconds_per_time", "time", "drift", "drift_error", "temperature"]
    header += ["temperature_difference", "temperature_difference_error", "verdict", "recommended"]

    def cells(run):
        found = run.drift
        numbers = [found.rate, found.error, found.temperature, found.difference.value, found.difference.error]
        numbers = ["" if math.isnan(number) else number for number in numbers]
        words = [verdict(run), "yes" if run is answer.choice else "no"]
        return [stated(run.keywords), run.dt, run.seconds, found.time or "", *numbers, *words]

    return {"cost": (header, [*map(cells, answer.rows)]), "trials": (header, [*map(cells, answer.runs)])}
