"""The answers as text for the terminal and as CSV."""

import math

from gearquat_analysis.tables import aligned, rounded, with_error, write_rows

from . import NORMS, drift
from .evaluate import usable_step
from .methods import named, stated
from .script import conserved


def _quantity(value, unit, digits=3):
    return rounded(value, digits) + (f" {unit}" if unit else "")


def _count(number, word):
    return f"{number} {word}" + "s" * (number != 1)


def _scene(deck):
    bodies, end = len(deck.scene.bodies), _quantity(deck.end, deck.time_unit, 6)
    many = "body" if bodies == 1 else "bodies"
    return [
        f"{deck.path.name} has {bodies} rigid {many} of {len(deck.scene.ids)} atoms, moved by",
        *(f"    {line}" for line in deck.fix_lines(None)),
        f"    timestep {deck.dt:g}, run {deck.start.steps} (t = {end})",
    ]


# --- cost -----------------------------------------------------------------------------------------
def cost_text(deck, costs):
    """The answer of ``gearquat cost``."""
    unit = deck.length_unit if costs.norm < 2 else "rad"
    end = _quantity(costs.end, deck.time_unit)
    reference, confirmation = costs.reference, costs.confirmation
    lines = _scene(deck)
    if deck.start.checkpoints:
        lines.append(
            f"The runs before it were executed once, and all trials start from their end"
            f" ({costs.before:.1f} s of the budget)."
        )
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
    header = ["error", "fix line", "timestep", seconds, "speed-up", "start (s)", f"drift ({_drift_unit(deck)})"]
    lines += ["", aligned(header, [_cost_cells(costs, row) for row in costs.rows])]
    lines += ["", *_explained(costs), "", *_script_lines(deck, costs), *_drift_lines(deck, costs)]
    return "\n".join(lines)


def _cost_cells(costs, row):
    price, cells = row.choice, [f"{row.error:.1e}"]
    if price is None:
        if row.error <= costs.doubt_limit:
            return cells + ["cannot be judged", *"-----"]
        refused = _refused(costs).values()
        known = "drifts" if any(not found.fails for found in refused) else "ends with an error" if refused else "is not reached"
        return cells + [known, *"-----"]
    speed_up = "-"
    if row.own and not row.keep:
        speed_up = "~" * (row.own.kind != "measured") + rounded(row.own.seconds / price.seconds)
    found = costs.drifts.get(row.recommended, drift.Drift())
    return cells + [
        "keep your fix" if row.keep else named(price.method),
        f"{usable_step(price.dt):g}",
        ("<= " if price.kind == "at most" else "") + f"{rounded(price.seconds / costs.end)}",
        speed_up,
        rounded(price.start_seconds, 2),
        with_error(found.rate, found.error) if found.known else "not known",
    ]


# --- the drift ------------------------------------------------------------------------------------
def _drift_unit(deck):
    return f"kT/{'ns' if deck.time_unit else '1000 time units'}/dof"


def _drift(deck, found):
    return with_error(found.rate, found.error, _drift_unit(deck))


def _drift_lines(deck, costs):
    """Notes on steps rejected for energy drift, warnings of possible drift, and how to measure it."""
    lines, doubtful, failures = [], [], {}
    recommended = {row.recommended for row in costs.rows if row.choice}
    for (keywords, dt), found in costs.drifts.items():
        name = f"{named(keywords)}, timestep {dt:g}"
        measured = f"{_drift(deck, found)} over {_quantity(found.time, deck.time_unit)}"
        if found.drifts:
            lines.append(f"Not recommended: {name}, because the energy drifts by {measured}.")
        elif found.failure:
            failures.setdefault(("Not recommended" if found.fails else "WARNING", found.failure), []).append(name)
        elif not found.holds and (keywords, dt) in recommended:
            doubtful.append(keywords)
            lines += [
                f"WARNING: {name}: whether the energy drifts in long runs has not been measured:",
                f"    {found.reason or f'{measured} do not tell whether it is above {found.bound:g}'}.",
            ]
    for (beginning, failure), names in failures.items():
        lines += [f"{beginning}: {'; '.join(names)}: a run that was longer than the trials ended with an error:", f"    {failure}"]
    return ["", *lines, *_how_to_measure(deck, doubtful)] if lines else []


def _how_to_measure(deck, doubtful):
    """Lines for a script, from whose log the drift of the ``doubtful`` keywords can be computed."""
    if not doubtful:
        return []
    energy, kinetic, rows = conserved(deck.fix_lines_of(next(filter(None, doubtful), None)), deck.partial)
    rows += [f"variable conserved equal {energy}", f"variable kinetic equal {kinetic}"]
    # LAMMPS computes the terms of the sum only if they are printed themselves
    rows += ["thermo_style custom step time pe ecouple v_conserved v_kinetic", "thermo_modify norm no format float %.15g"]
    rows += ["thermo 100"]
    time = deck.time_unit or "time unit"
    long_enough = _quantity(drift.LONGEST * drift.nanosecond(deck), deck.time_unit)
    return [
        f"To measure a drift, write these lines below its fix, and run {long_enough} or more:",
        *(f"    {row}" for row in rows),
        f"The slope of v_conserved against time, divided by twice the mean of v_kinetic, is the drift in kT per {time} and",
        f"degree of freedom, and {rounded(drift.nanosecond(deck), 6)} times that the one in {_drift_unit(deck)}.",
    ]


# --- what else is said of the cost ----------------------------------------------------------------


def _explained(costs):
    lines = [
        "Every method evaluates the forces once per step.  Seconds are wall times of the steps.  The start,",
        "which is LAMMPS' set-up and, with fix gear/quat, the evaluations of the forces for its first",
        "derivatives, takes place once per run and is not included.",
        "Each timestep is measured: a trial at this step or a longer one had at most this error, with the",
        "uncertainty of the reference included.  <= marks an upper bound of the cost: a slightly longer step was not",
        "tried.  Speed-up is relative to the deck's own fix at the same error; ~ marks an approximate one.",
        "If the step for a smaller error is cheaper, the table has it for the larger error, too.  Drift is the slope of",
        "the conserved energy over a further run, in kT of the mean kinetic energy.  A step at which it is larger than",
        f"{costs.bound:g} (--drift) is not recommended.",
    ]
    starts = {stated(p.method): p for row in costs.rows for p in (row.own, row.best) if p}
    words = [
        f"{rounded(p.start_seconds, 2)} s and {_count(p.start_evaluations, 'evaluation')} with {name}"
        for name, p in starts.items()
    ]
    lines += [f"A start takes {', '.join(words)}."] if words else []
    timings = [trial.seconds for trial, _ in costs.trials if len(trial.seconds) > 1]
    if not timings:
        return [*lines, "Each trial was timed once: a longer --budget leaves time for repetitions."]
    spread = sorted(max(seconds) / min(seconds) for seconds in timings)
    return lines + [
        f"Times are the shortest of at least {min(map(len, timings))} interleaved timings; the slowest timing"
        f" of a trial is {spread[len(spread) // 2]:.2f} times the",
        f"fastest in the middle trial, and {spread[-1]:.2f} times at most.",
    ]


def _script_lines(deck, costs):
    """Lines to put into the script for each error that was reached, and advice for the other errors."""
    lines, reached = [], [row for row in costs.rows if row.choice]
    if not all(row.keep for row in reached):
        lines += map_lines(deck)
    for row in reached:
        lines.append(f"For an error of {row.error:.1e} at t = {costs.end:g}:")
        keeping = ["# keep your fix: no other is faster"] if row.keep else []
        if costs.drifts.get(row.recommended, drift.Drift()).failure:
            keeping.append("# for short runs: a longer one ended with an error, see the warning below")
        line = None if row.keep else row.best.method
        words = [*keeping, *deck.fix_lines(line), f"timestep {usable_step(row.choice.dt):g}"]
        lines += [f"    {word}" for word in words]
    missing = [row for row in costs.rows if not row.choice and row.error > costs.doubt_limit]
    lines += _nothing_holds(deck, costs, missing)
    for row in missing:
        if not _refused(costs):
            remedy = "try a longer --budget, a shorter --time or a larger --error."
            lines.append(f"No trial within the budget had an error of {row.error:.1e}: {remedy}")
            if row.own:
                lines.append(f"    Your own fix would need timestep {rounded(row.own.dt, 2)}, as extrapolated.")
    return lines or ["None of the errors can be judged: try a longer --budget, a shorter --time or a larger --error."]


def _refused(costs):
    """The drifts of the steps that are not recommended because of their drift."""
    return {pair: found for pair, found in costs.drifts.items() if found.refused}


def _nothing_holds(deck, costs, rows):
    """A note that the energy drifts at the steps that reach the errors of these rows, with a lower bound of the
    drift."""
    refused = _refused(costs)
    if not rows or not refused:
        return []
    errors = ", ".join(f"{row.error:.1e}" for row in rows)
    kept = f"has a drift below {costs.bound:g} {_drift_unit(deck)} (--drift)"
    if all(found.fails for found in refused.values()):
        kept = "was kept up in a longer run without an error"
    lines = [f"Nothing is recommended for an error of {errors}: no step that reaches it {kept}."]
    known = {pair: found for pair, found in costs.drifts.items() if found.known}
    if known:
        (keywords, dt), least = min(known.items(), key=lambda item: abs(item[1].rate))
        lines.append(f"    The smallest drift seen is {_drift(deck, least)}, with {named(keywords)}, timestep {dt:g}.")
    return lines


def map_lines(deck):
    """Lines that fix gear/quat needs above the box of the deck."""
    if not deck.map_missing:
        return []
    return ["Above the command that makes the box (read_data, create_box):", "    atom_modify map yes", ""]


def write_costs(folder, deck, costs):
    """cost.csv, the table, and trials.csv, every trial."""
    fields = ["timestep", "evaluations", "seconds", "kind", "start_evaluations", "start_seconds"]
    rows = []
    for row in costs.rows:
        cells = [row.error, stated(row.best.method) if row.best else ""]
        for price in (row.best, row.own):
            names = ["dt", *fields[1:]]
            cells += [getattr(price, name) if price else "" for name in names]
        ratio = row.own.seconds / row.best.seconds if row.own and row.best else ""
        found = costs.drifts.get(row.recommended) if row.choice else None
        drifts = [found.rate, found.error, found.time] if found and found.time else [""] * 3
        rows.append([*cells, ratio, "yes" if row.keep else "no", costs.end, *drifts])
    own = [f"own_{name}" for name in fields]
    header = ["error", "keywords", *fields, *own, "speed_up", "keep", "time", "drift", "drift_error", "drift_time"]
    write_rows(folder / "cost.csv", header, rows)
    header = ["keywords", "timestep", "steps", "start_evaluations"]
    header += [norm.replace(" ", "_") for norm in NORMS]
    header += ["seconds_least", "seconds_most", "timings", "start_seconds"]
    rows = [
        [stated(trial.keywords), trial.dt, trial.steps, trial.start_evaluations, *errors]
        + [trial.fastest, max(trial.seconds), len(trial.seconds), trial.fastest_start]
        for trial, errors in costs.trials
    ]
    write_rows(folder / "trials.csv", header, rows)


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


def write_parting(folder, found):
    """until.csv: the differences of the two runs in time."""
    header = ["time", "largest_position", "rms_position", "largest_orientation"]
    write_rows(folder / "until.csv", header, zip(found.time, found.largest, found.rms, found.angle))
