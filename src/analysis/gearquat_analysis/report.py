"""Results of an analysis as CSV files and as text."""

import numpy as np

from .averages import weights_of
from .kinds import kinds
from .tables import write_columns, write_rows


def write_totals(path, poses):
    """Write sums over all bodies for each frame, and return them, name -> (F,) or (F, 3)."""
    totals = poses.totals()
    write_columns(path, {"step": poses.results.step, "time": poses.results.time, **totals})
    return totals


def write_bodies(path, poses):
    """Write a row for each body: ID, number of sites, shape (general, linear, point), mass, principal moments, species.

    The species is written for mixtures only.
    """
    bodies = poses.bodies
    shapes = np.where(bodies.point, "point", np.where(bodies.linear, "linear", "general"))
    header = ["body", "sites", "kind", "mass", "moment_1", "moment_2", "moment_3"]
    columns = [bodies.ids, bodies.counts, shapes, bodies.mass, *bodies.moments.T]
    if (found := kinds(poses))[0].name:
        names = np.empty(len(bodies), dtype=object)
        for kind in found:
            names[kind.bodies] = kind.name
        header, columns = [*header, "species"], [*columns, names]
    rows = zip(*columns)
    return write_rows(path, header, rows)


def write_averages(path, averages):
    """Write a row for each Average: name, value, standard error, unit, and the reason if an error is unknown."""
    blank = [[*row[:1], *("" if np.isnan(x) else x for x in row[1:3]), *row[3:]] for row in averages]
    write_rows(path, ["average", "value", "standard error", "unit", "error unknown because"], blank)


def average_lines(averages):
    """Text for a terminal: a line for each Average with a value, and a line for each reason why others are missing."""
    lines, missing = [], {}
    for one in averages:
        if one.known:
            lines.append(f"The {one.name} is {one.text()}.")
        elif np.isfinite(one.value):
            lines.append(f"The {one.name} is {one.text()}, with an unknown error: {one.why}.")
        else:
            missing.setdefault(one.why, []).append(one.name)
    for why, names in missing.items():
        lines.append(f"No {' and no '.join(names)}: {why or 'the run is too short'}.")
    return "\n".join(lines)


def counted(number, noun, many=None):
    """ "1 frame", "2 frames"; ``many``: the plural, by default the noun with an s."""
    return f"{number} {noun if number == 1 else many or noun + 's'}"


def summary(poses, totals):
    """A summary of the analysis in a few lines for a terminal."""
    time, (frames, number) = poses.results.time, poses.results.table.shape
    many = f"{counted(frames, 'frame')} of {counted(number, 'body', 'bodies')}"
    lines = [f"{many} {'was' if frames == 1 else 'were'} read, from time {time[0]:g} to {time[-1]:g}."]
    if "residual" in totals:
        worst = totals["residual"].max()
        lines.append(f"Sites deviate by at most {worst:.2g} from the rigid reference.")
    if "velocity_residual" in totals:
        worst = totals["velocity_residual"].max()
        lines.append(f"Velocities of sites deviate by at most {worst:.2g} from rigid motion.")
    without = "in mass x velocity^2, without --units"
    for name in ("ke_translation", "ke_rotation", "potential"):
        if name in totals:
            mean = np.average(totals[name], weights=weights_of(time))
            lines.append(f"The mean of {name} is {mean:.6g} {poses.unit(name) or without}.")
    return "\n".join(lines)
