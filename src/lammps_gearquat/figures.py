"""The pictures of ``gearquat cost`` and ``scatter``. This module computes nothing."""

import numpy as np

from gearquat_analysis.pictures import named, picture
from gearquat_analysis.units import UNITS

from .trials import NORMS
from .trials.methods import named as named_method
from .trials.methods import stated

STAR = {"color": "black", "markersize": 9, "zorder": 4, "label": "recommended"}


# --- cost -----------------------------------------------------------------------------------------
def draw_cost(path, deck, costs):
    """Error against seconds per unit of time, by method; trials that ran once are not drawn beside the shortest of several."""
    methods = costs.points()
    least = min(2, max((point.timings for points in methods.values() for point in points), default=1))
    chosen = [row for row in costs.rows if row.choice]
    title = "no error was reached"
    if chosen:
        title = f"{named_method(chosen[-1].recommended[0])} takes the least time for an error of {chosen[-1].error:.0e}"
    with picture(path, f"{deck.path.name}: {title}", figsize=(8, 5)) as (figure, axis):
        for keywords, points in methods.items():
            drawn = [(point.seconds / costs.end, point.error) for point in points if point.timings >= least]
            if drawn:
                axis.plot(*np.transpose(drawn), "o-", markersize=3, label=stated(keywords))
        axis.plot([row.choice.seconds / costs.end for row in chosen], [row.choice.error for row in chosen], "*", **STAR)
        for row in costs.rows:
            axis.axhline(row.error, color="#999999", linewidth=0.5, zorder=0)
        if costs.doubt > 0.0:
            axis.axhspan(costs.doubt / 4, costs.doubt, color="#dddddd", zorder=0, label="uncertainty of the reference")
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.set_xlabel(f"seconds per {deck.time_unit or 'time unit'}, to t = {costs.end:.6g}")
        axis.set_ylabel(named(f"{NORMS[costs.norm]} error", deck.length_unit if costs.norm < 2 else "rad"))
        figure.legend(loc="outside lower center", ncols=4, fontsize=8)


def draw_drifts(path, deck, answer):
    """Energy drift against the step, by method, with the bound, from an answer of the module sampling."""
    rows = [run for run in answer.rows if run.drift.known]
    title = "no step is known to keep the energy"
    if answer.choice:
        title = f"{named_method(answer.choice.keywords)} keeps the energy at a step of {answer.choice.dt:g} {deck.time_unit}"
    with picture(path, f"{deck.path.name}: {title}", figsize=(8, 5)) as (figure, axis):
        for keywords in dict.fromkeys(run.keywords for run in rows):
            values = [[run.dt, run.drift.rate, run.drift.error] for run in rows if run.keywords == keywords]
            axis.errorbar(*np.transpose(values), fmt="o-", capsize=2, markersize=3, label=stated(keywords))
        axis.axhspan(-answer.bound, answer.bound, color="#dddddd", zorder=0, label="bound")
        if answer.choice:
            axis.plot([answer.choice.dt], [answer.choice.drift.rate], "*", **STAR)
        axis.set_yscale("symlog", linthresh=answer.bound)
        axis.set_xlabel(named("time step", deck.time_unit))
        axis.set_ylabel(f"drift ({'kT/ns/dof' if deck.time_unit else 'kT/1000 time units/dof'})")
        figure.legend(loc="outside lower center", ncols=4, fontsize=8)


# --- scatter --------------------------------------------------------------------------------------
#: dots of a picture at most
DOTS = 20_000


def draw_deflection(path, name, columns, plan, style):
    """Deflection against impact parameter, by energy."""
    parted = np.flatnonzero(columns["fate"] == "parted")[:DOTS]
    b, angle, energy = (columns[key][parted] for key in ("b", "angle", "energy"))
    title = f"{name}: half of {len(parted)} flights are turned by more than {np.degrees(np.median(angle)):.0f} degrees"
    with picture(path, title, figsize=(8, 5)) as (figure, axis):
        dots = axis.scatter(b, np.degrees(angle), s=3, c=energy, cmap="viridis")
        if not plan.energy:
            figure.colorbar(dots, ax=axis, label="energy of the relative translation (units of the script)")
        axis.set_xlim(0, min(3 * plan.size(plan.scale), plan.largest))
        axis.set_ylim(0, 180)
        axis.set_xlabel(named("impact parameter", UNITS[style].length))
        axis.set_ylabel("deflection (degrees)")
