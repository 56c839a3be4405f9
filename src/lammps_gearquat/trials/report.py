"""What was found, as text for the console and as CSV."""

import csv
import math

from . import evaluate
from .cost import NORMS


def _quantity(value, unit, digits=3):
    """A number with its unit."""
    return f"{value:.{digits}g}" + (f" {unit}" if unit else "")


def table(header, rows):
    """Columns of text, aligned; ``rows`` are lists of strings."""
    lines = [header, *rows]
    widths = [max(len(line[column]) for line in lines) for column in range(len(header))]
    return "\n".join(
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip()
        for line in lines
    )


def _scene(deck):
    """What is in the deck, in a few lines."""
    scene, time = deck.scene, deck.time_unit
    bodies = int(scene.bodies.max()) + 1
    many = "body" if bodies == 1 else "bodies"
    lines = [f"{deck.path.name}: {bodies} rigid {many} of {len(scene.ids)} atoms, moved by"]
    lines += [f"    {line}" for line in deck.fix_lines(None)]
    lines.append(
        f"    timestep {scene.dt:g}, run {scene.start.steps} (t = {_quantity(deck.end, time, 6)})"
    )
    return lines


def usable_step(dt):
    """A time step cut to two digits, downwards, for a script."""
    unit = 10.0 ** (math.floor(math.log10(dt)) - 1)
    return float(f"{math.floor(dt / unit * (1 + 1e-9)) * unit:.2g}")


# --- cost -----------------------------------------------------------------------------------------
def _speed_up(own, best):
    """Ratio of wall times as text, with ~ if the deck's own cost is extrapolated."""
    if own is None or best is None:
        return "-"
    sign = "~" if own.kind == "extrapolated" else ""
    return f"{sign}{own.seconds / best.seconds:.3g}"


def _cost_cells(costs, row):
    """The cells of one row of the table of costs."""
    error, own, best = row
    cells = [f"{error:.1e}"]
    if best is None:
        known = "not reached" if error > costs.doubt_limit else "cannot be judged"
        return cells + [known, "-", "-", "-", "-"]
    return cells + [
        "gear/quat " + best.method,
        f"{usable_step(best.dt):g}",
        ("<= " if best.kind == "at most" else "") + f"{best.evaluations / costs.end:.3g}",
        f"{best.seconds / costs.end:.3g}",
        _speed_up(own, best),
    ]


def cost_text(deck, costs):
    """The answer of ``gearquat cost``."""
    time, length = deck.time_unit, deck.length_unit
    unit = length if costs.norm < 2 else "rad"
    end = _quantity(costs.end, time)
    reference, other = costs.reference, costs.confirmation
    lines = _scene(deck)
    lines.append(
        f"Error: {NORMS[costs.norm]} of the bodies at t = {end}"
        + (f", in {unit}" if unit else "")
        + f", against gear/quat {reference.label}, step {reference.dt:.3g};"
    )
    lines.append(
        f"    gear/quat {other.label}, step {other.dt:.3g}, confirms it to"
        f" {_quantity(costs.doubt, unit, 2)}."
    )
    lines += [f"Note: {note}" for note in costs.notes]
    own = costs.points().get(None, [])
    as_it_is = [point for point in own if abs(point.dt / deck.dt - 1) < 0.01]
    if as_it_is:
        lines.append(f"As it is, the deck ends with an error of {as_it_is[0].error:.2g}.")
    per = f"per {time or 'time unit'}"
    header = ["error", "fix line", "timestep", f"evaluations {per}", f"seconds {per}", "speed-up"]
    lines += ["", table(header, [_cost_cells(costs, row) for row in costs.rows])]
    lines += ["", *_explained(costs), "", *_front_text(costs), "", *_script_lines(deck, costs)]
    return "\n".join(lines)


def _explained(costs):
    """What the numbers in the table are."""
    timings = [trial.seconds for trial, _ in costs.trials if len(trial.seconds) > 1]
    spread = [max(s) / min(s) for s in timings]
    lines = [
        "Evaluations are those of the forces, those of the start included; seconds are of whole run",
        "commands, set-up included; speed-up is in seconds, over the deck's own fix at the same error",
        "(~: its cost extrapolated; "
        "<=: the coarsest trial was better than asked).  The cost of the start is shared by the time"
        f" measured, {costs.end:g}.",
    ]
    if spread:
        count = min(len(s) for s in timings)
        lines.append(
            f"Medians of at least {count} interleaved timings; slowest over fastest of one trial:"
            f" {sorted(spread)[len(spread) // 2]:.2f} in the middle, {max(spread):.2f} at most."
        )
    else:
        lines.append("Each trial was timed once: a longer --budget leaves time for repetitions.")
    return lines


def _front_text(costs):
    """The Pareto front by evaluations."""
    points = [point for found in costs.points().values() for point in found]
    rows = [
        [f"{p.error:.1e}", p.method, f"{p.dt:.3g}", f"{p.evaluations:.0f}", f"{p.seconds:.3g}"]
        for p in evaluate.front(points, lambda point: point.evaluations)
        if p.error > costs.doubt
    ]
    header = ["error", "fix", "timestep", "evaluations", "seconds"]
    return ["Pareto front of all trials, by evaluations of the forces:", table(header, rows)]


def _script_lines(deck, costs):
    """What to put into the script, for each error that was reached."""
    lines = []
    if deck.scene.map_missing and any(best for _, _, best in costs.rows):
        lines += ["Above the command that makes the box (read_data, create_box):"]
        lines += ["    atom_modify map yes", ""]
    for error, _, best in costs.rows:
        if best is None:
            continue
        lines.append(f"For an error of {error:.1e} at t = {costs.end:g}:")
        lines += [f"    {line}" for line in deck.fix_lines(best.method)]
        lines.append(f"    timestep {usable_step(best.dt):g}")
    return lines or ["No error asked for was reached: try --budget, --time or a larger --error."]


def write_costs(folder, deck, costs):
    """cost.csv, the table, and trials.csv, every trial."""
    with open(folder / "cost.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(
            ["error", "keywords", "timestep", "evaluations", "seconds", "kind"]
            + ["own_timestep", "own_evaluations", "own_seconds", "own_kind", "speed_up", "time"]
        )
        for error, own, best in costs.rows:
            cells = [f"{error:.17g}", best.method if best else ""]
            for price in (best, own):
                if price is None:
                    cells += ["", "", "", ""]
                else:
                    cells += [price.dt, price.evaluations, price.seconds, price.kind]
            ratio = own.seconds / best.seconds if own and best else ""
            out.writerow([*cells, ratio, costs.end])
    with open(folder / "trials.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        names = [norm.replace(" ", "_") for norm in NORMS]
        out.writerow(
            ["keywords", "timestep", "steps", "evaluations", *names]
            + ["seconds_median", "seconds_least", "seconds_most", "timings"]
        )
        for trial, errors in costs.trials:
            seconds = [trial.median, min(trial.seconds), max(trial.seconds), len(trial.seconds)]
            row = [trial.label, trial.dt, trial.steps, trial.evaluations, *errors, *seconds]
            out.writerow(row)


# --- horizon --------------------------------------------------------------------------------------
def _time_text(time, last, unit):
    """A time, or that it was not reached."""
    if math.isinf(time):
        return f"not before t = {_quantity(last, unit, 6)}"
    return f"t = {_quantity(time, unit, 6)}"


def horizon_text(deck, horizon):
    """The answer of ``gearquat horizon``."""
    time, length = deck.time_unit, deck.length_unit
    first, second = horizon.trials
    last = float(horizon.time[-1])
    lines = _scene(deck)
    lines += ["Side by side:"]
    for trial in (first, second):
        name = "as it is" if trial.keywords is None else "gear/quat " + trial.label
        lines.append(f"    {name}, timestep {trial.dt:g}")
    lines += [f"Note: {note}" for note in horizon.notes]
    lines.append("The centre of mass of a body is further from where the other run has it than")
    lines += [
        (
            f"    {_quantity(level, length):>8s}  from {_time_text(parted, last, time)}"
            if math.isfinite(parted)
            else f"    {_quantity(level, length):>8s}  {_time_text(parted, last, time)}"
        )
        for level, parted in horizon.parting
    ]
    growth = horizon.growth
    if growth is None:
        lines.append(f"There is no Lyapunov time, for {horizon.no_growth}.")
    else:
        spread = growth.lyapunov_time * growth.error / growth.rate
        lines.append(
            f"Lyapunov time {_quantity(growth.lyapunov_time, time)} ± {spread:.1g}: the difference"
            f" grows by e in it, fitted from t = {growth.begin:g} to {growth.end:g}, where the"
            f" exponential grows {growth.factor:.1g} times."
        )
    return "\n".join(lines)


def write_horizon(folder, horizon):
    """horizon.csv: the differences in time; parting.csv: when they pass each threshold."""
    with open(folder / "horizon.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["time", "largest_position", "rms_position", "largest_orientation"])
        for row in zip(horizon.time, horizon.largest, horizon.rms, horizon.angle):
            out.writerow([f"{value:.17g}" for value in row])
    with open(folder / "parting.csv", "w", newline="", encoding="utf-8") as file:
        out = csv.writer(file)
        out.writerow(["threshold", "time"])
        out.writerows(horizon.parting)
