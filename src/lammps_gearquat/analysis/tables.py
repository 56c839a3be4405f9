"""Results as CSV files and as text."""

import csv

import numpy as np


def _split(columns):
    """Columns (F,) of arrays (F,) and (F, 3); the parts get the names of their axes."""
    found = {}
    for name, values in columns.items():
        values = np.asarray(values)
        if values.ndim == 1:
            found[name] = values
        else:
            found |= {f"{name}_{axis}": values[:, k] for k, axis in enumerate("xyz")}
    return found


def write_columns(path, columns):
    """Columns of equal length, name -> (F,) or (F, 3), with 17 digits."""
    columns = _split(columns)
    header = ",".join(columns)
    table = np.column_stack(list(columns.values()))
    np.savetxt(path, table, fmt="%.17g", delimiter=",", header=header, comments="")


def write_totals(path, poses):
    """Sums over all bodies by frame; returns them, name -> (F,) or (F, 3)."""
    totals = poses.totals()
    write_columns(path, {"step": poses.results.step, "time": poses.results.time, **totals})
    return totals


def write_bodies(path, poses):
    """What each body is: ID, number of sites, kind, mass, principal moments; of a table of the fix IDs only."""
    bodies = getattr(poses, "bodies", None)
    if bodies is None:
        return write_columns(path, {"body": poses.ids})
    kinds = np.where(bodies.point, "point", np.where(bodies.linear, "linear", "general"))
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["body", "sites", "kind", "mass", "moment_1", "moment_2", "moment_3"])
        for row in zip(bodies.ids, bodies.counts, kinds, bodies.mass, *bodies.moments.T):
            writer.writerow([value.item() for value in row])


def write_stays(path, stays, ids):
    """A row for each stay: body, place (from 1), times of its first and last frame, whether complete."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["body", "place", "begin", "end", "complete"])
        columns = ids[stays.body], stays.place + 1, stays.time[stays.begin]
        for row in zip(*columns, stays.time[stays.end - 1], stays.complete):
            writer.writerow([value.item() for value in row])


def summary(poses, totals):
    """A few lines for a terminal."""
    results = poses.results
    frames, number = results.table.shape
    lines = [
        f"{frames} frames of {number} bodies, time {results.time[0]:g} to {results.time[-1]:g}."
    ]
    if "residual" in totals:
        worst = totals["residual"].max()
        lines.append(f"Sites are at most {worst:.2g} away from a rigid body (of its first frame).")
    if "velocity_residual" in totals:
        worst = totals["velocity_residual"].max()
        lines.append(
            f"Velocities of sites are at most {worst:.2g} away from those of a rigid body."
        )
    unit = f"units {poses.units}" if poses.units else "mass x velocity^2; --units gives LAMMPS' own"
    for name in ("ke_translation", "ke_rotation", "potential"):
        if name in totals:
            values = totals[name]
            lines.append(
                f"{name}: {values.mean():.6g} on average ({unit if name[0] == 'k' else 'as dumped'})."
            )
    return "\n".join(lines)
