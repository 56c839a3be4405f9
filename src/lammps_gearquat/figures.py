"""The pictures of ``gearquat cost`` and ``scatter``. This module computes nothing."""

import matplotlib
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from gearquat_analysis.pictures import named, picture
from gearquat_analysis.tables import rounded
from gearquat_analysis.units import UNITS

from .trials import NORMS

OWN = "#666666"
FORMULATION = {"momentum": "Blues", "second": "Greens", "first": "Oranges"}
#: with more decades than this on an axis, powers of ten are sufficient as ticks
FEW_DECADES = 2.5


def _ticks(axis):
    """Sets ticks of a logarithmic Axis, with a few labels that do not collide."""
    low, high = axis.get_view_interval()
    if np.log10(high / low) < FEW_DECADES:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: rounded(value)))
    axis.set_minor_formatter(NullFormatter())


# --- cost -----------------------------------------------------------------------------------------
def _rank(keywords):
    """Sorts methods by formulation and number of values; the fix of the deck comes first."""
    numbers = [int(word) for word in (keywords or "").split() if word.isdigit()]
    return (keywords is not None, _family(keywords or ""), numbers)


def _family(keywords):
    """The formulation of a method."""
    return next((name for name in FORMULATION if f"formulation {name}" in keywords), "momentum")


def _look(keywords, methods):
    """Color and label of a method: darker for more values."""
    if keywords is None:
        return {"color": OWN, "marker": "s", "label": "the deck's own fix", "zorder": 3}
    family = _family(keywords)
    kin = [method for method in methods if method and _family(method) == family]
    kin.sort(key=_rank)
    place = kin.index(keywords) / max(len(kin) - 1, 1) if keywords in kin else 0.5
    color = matplotlib.colormaps[FORMULATION[family]](0.35 + 0.6 * place)
    return {"color": color, "marker": "o", "label": keywords.replace("formulation ", "") or "no keyword"}


def draw_cost(path, deck, costs):
    """Error against evaluations and against seconds, both per unit of time."""
    time = deck.time_unit or "time unit"
    title = f"The cost of accuracy: {deck.path.name}, errors at t = {costs.end:.6g} {deck.time_unit}"
    panels = {"evaluations": "evaluations of the forces", "seconds": "seconds"}
    with picture(path, title, ncols=2, figsize=(11, 4.8), sharey=True) as (figure, axes):
        for axis, (name, words) in zip(axes, panels.items()):
            _draw_prices(axis, name, costs)
            axis.set_xlabel(f"{words} per {time}")
            _ticks(axis.xaxis)
        points = [point for mine in costs.points().values() for point in mine]
        errors = [row.error for row in costs.rows]
        largest = max(errors + [point.error for point in points])
        axes[0].set_ylim(min([costs.doubt, *errors]) / 4, 4 * largest)
        unit = deck.length_unit if costs.norm < 2 else "rad"
        axes[0].set_ylabel(named(f"{NORMS[costs.norm]} error", unit))
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", fontsize=8)


def _draw_prices(axis, name, costs):
    """One panel; ``name`` is the field of a Point that is the cost.  Times of one run are not drawn beside the shortest of several."""
    methods = costs.points()
    timings = [point.timings for points in methods.values() for point in points]
    least = min(2, max(timings, default=1)) if name == "seconds" else 1
    for keywords, points in sorted(methods.items(), key=lambda item: _rank(item[0])):
        drawn = [(getattr(point, name) / costs.end, point.error) for point in points if point.timings >= least]
        axis.loglog(*(np.transpose(drawn) if drawn else ([], [])), markersize=3, **_look(keywords, methods))
    chosen = [row for row in costs.rows if row.choice]
    axis.plot(
        [getattr(row.choice, name) / costs.end for row in chosen],
        [row.choice.error for row in chosen],
        "*",
        color="black",
        markersize=9,
        zorder=4,
        label="recommended",
    )
    edge = axis.get_yaxis_transform()
    for row in costs.rows:
        axis.axhline(row.error, color="#999999", linewidth=0.5, zorder=0)
        if name == "seconds":  # beside the last panel
            note = {"fontsize": 7, "color": OWN, "va": "center", "ha": "left"}
            axis.text(1.01, row.error, f"target {row.error:.0e}", transform=edge, **note)
    axis.axhspan(1e-300, costs.doubt, color="#dddddd", zorder=0)
    note = {"fontsize": 7, "color": OWN, "va": "top", "ha": "left", "clip_on": True}
    axis.text(0.01, costs.doubt, "below the uncertainty of the reference", transform=edge, **note)


def draw_drifts(path, deck, answer):
    """Energy drift against the step, by method, with the bound, from an answer of the module sampling."""
    title = f"Drift of the energy: {deck.path.name}"
    rows = [run for run in answer.rows if run.drift.known]
    names = list(dict.fromkeys(run.keywords for run in rows))
    with picture(path, title, figsize=(8, 5)) as (figure, axis):
        for keywords in names:
            mine = [run for run in rows if run.keywords == keywords]
            values = [[run.dt, run.drift.rate, run.drift.error] for run in mine]
            dt, rate, error = np.transpose(values)
            look = _look(keywords, names)
            axis.errorbar(dt, rate, error, capsize=2, markersize=3, **look)
        axis.axhspan(-answer.bound, answer.bound, color="#dddddd", zorder=0, label="bound")
        if answer.choice:
            star = {"color": "black", "markersize": 9, "zorder": 4, "label": "recommended"}
            axis.plot([answer.choice.dt], [answer.choice.drift.rate], "*", **star)
        axis.set_yscale("symlog", linthresh=answer.bound)
        axis.set_xlabel(named("time step", deck.time_unit))
        axis.set_ylabel(f"drift ({'kT/ns/dof' if deck.time_unit else 'kT/1000 time units/dof'})")
        figure.legend(fontsize=8, loc="outside right upper")


# --- scatter --------------------------------------------------------------------------------------
#: dots of a picture at most
DOTS = 20_000


def draw_deflection(path, name, columns, plan, style):
    """Deflection against impact parameter, by energy."""
    parted = np.flatnonzero(columns["fate"] == "parted")[:DOTS]
    b, angle, energy = (columns[key][parted] for key in ("b", "angle", "energy"))
    with picture(path, f"Deflection: {name}", figsize=(8, 5)) as (figure, axis):
        dots = axis.scatter(b, np.degrees(angle), s=3, c=energy, cmap="viridis")
        if not plan.energy:
            figure.colorbar(dots, ax=axis, label="energy of the relative translation (units of the script)")
        axis.set_xlim(0, min(3 * plan.size(plan.scale), plan.largest))
        axis.set_ylim(0, 180)
        axis.set_xlabel(named("impact parameter", UNITS[style].length))
        axis.set_ylabel("deflection (degrees)")
