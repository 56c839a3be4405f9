"""The pictures of ``gearquat analyze``, and the common layout of all pictures.  Nothing is computed here.

Each function returns a matplotlib Figure, and saves it if a path is given.
"""

from contextlib import contextmanager

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatter, MaxNLocator

from .bodies import axes_named
from .style import COLOR, STYLE

PRINCIPAL_AXES = ("#0072b2", "#d55e00", "#009e73")
#: in a picture of averages, the height of a row and of the space above and below the rows
ROW, AROUND = 0.24, 0.75


@contextmanager
def picture(path=None, title="", figsize=None, **layout):
    """(figure, axes) in the common style, saved at the end; ``layout`` is passed to Figure.subplots."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=figsize, layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
        yield figure, figure.subplots(**layout)
        if path:
            figure.savefig(path)


def named(quantity, unit):
    return f"{quantity} ({unit})" if unit else quantity


ENERGIES = {"ke_translation": "translation", "ke_rotation": "rotation", "potential": "potential"}
RESIDUALS = {"residual": "sites", "velocity_residual": "velocities"}


def draw_totals(poses, totals, path=None):
    """Energies of all bodies, and their largest deviation from a rigid body, against time; ``totals`` from ``poses.totals()``."""
    residuals = {
        name: named(label, poses.unit(name)) for name, label in RESIDUALS.items() if totals.get(name, np.zeros(1)).any()
    }
    panels = [(named("energy", poses.unit("potential")), ENERGIES)]
    panels += [("largest deviation\nfrom a rigid body", residuals)]
    panels = [(title, [n for n in labels if n in totals], labels) for title, labels in panels]
    panels = [panel for panel in panels if panel[1]]
    shape = {"nrows": len(panels), "figsize": (8, 2.7 * len(panels)), "sharex": True, "squeeze": False}
    with picture(path, **shape) as (figure, axes):
        for axis, (title, names, labels) in zip(axes[:, 0], panels):
            for name in names:
                color = COLOR.get(ENERGIES.get(name))
                axis.plot(poses.results.time, totals[name], color=color, label=labels[name])
            axis.set_ylabel(title)
            if labels is residuals:
                axis.set_yscale("log")
            axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
        axes[-1, 0].set_xlabel(named("time", poses.unit("time")))
    return figure


def _panels(functions, units, kind, known):
    """Title -> curves (values, style) of the nonempty panels with functions of one kind of bodies.

    ``known``: averages by name.
    """
    of, ending = (f" of {kind}", f"_{kind}") if kind else ("", "")
    panels = {"mean square": [], "normalized autocorrelation": [], "correlation of the principal axes": []}
    squares, velocities, axes_in_space = panels.values()

    def label(text, symbol, name):
        return f"{text}\n{symbol} = {known[name].text()}" if name in known else text

    for name, values in functions.items():
        color = COLOR["rotation" if "rotation" in name or "omega" in name else "translation"]
        if name.startswith("mean_square"):
            text = named(name.split("_")[-1], units[name + ending])
            if name == "mean_square_displacement":
                text = label(text, "D", f"diffusion coefficient{of}")
            squares.append((values, {"color": color, "label": text}))
        elif name.endswith("autocorrelation") and values[0] > 0:
            text, look = "angular velocity" if "omega" in name else "velocity", {"color": color}
            if name.startswith("omega_ax"):
                group = [int(digit) - 1 for digit in name.split("_")[1][4:]]
                text, look = f"{text}, {axes_named(group)}", {"color": PRINCIPAL_AXES[group[0]], "linestyle": ":"}
            velocities.append((values / values[0], {"label": text, **look}))
        elif name.startswith(("axis", "axes")):
            group, order = [int(digit) - 1 for digit in name[4:].split("_")[0]], name[-1]
            look = {"color": PRINCIPAL_AXES[group[0]], "linestyle": "-" if order == "1" else "--"}
            time = f"correlation time{of + ',' if of else ' of'} {axes_named(group)}, order {order}"
            axes_in_space.append((values, {"label": label(f"{axes_named(group)}, P{order}", f"τ{order}", time), **look}))
    return {f"{title}{of}": curves for title, curves in panels.items() if curves}


def draw_correlations(correlations, averages=(), path=None):
    """Mean squares and autocorrelations of velocities and axes against the lag, on a logarithmic axis.

    There is a row of panels for each kind of bodies.  ``averages``: diffusion coefficients and correlation times that are
    written beside their curves.
    """
    lag = correlations.functions["lag"]
    # later lags have too few origins
    shown = slice(1, max(2, 2 * len(lag) // 3))
    known = {one.name: one for one in averages if one.known}
    rows = [_panels(correlations.of_kind(kind), correlations.units, kind, known) for kind in correlations.kinds]
    columns = max(map(len, rows))
    shape = {"nrows": len(rows), "ncols": columns, "figsize": (4.2 * columns, 4 * len(rows)), "squeeze": False}
    with picture(path, **shape) as (figure, axes):
        for row, panels in zip(axes, rows):
            for axis, (title, curves) in zip(row, panels.items()):
                _draw_functions(axis, title, lag[shown], [(values[shown], look) for values, look in curves])
                axis.set_xlabel(named("lag", correlations.units["lag"]))
            for axis in row[len(panels) :]:
                axis.remove()
    return figure


def _draw_functions(axis, title, lag, curves):
    for values, look in curves:
        axis.plot(lag, values, **look)
    axis.set_title(title, fontsize=10, loc="left")
    axis.set_xscale("log")
    axis.xaxis.set_minor_formatter(LogFormatter())  # short labels, only if the axis has few decades
    axis.set_yscale("log" if title.startswith("mean square") else "linear")
    axis.legend(fontsize=7)


def draw_averages(averages, path=None):
    """Every known Average with its standard error: temperatures, diffusion coefficients, correlation times.

    Returns None if no Average is known.

    >>> from gearquat_analysis import Poses, averages, open_dump, pictures
    >>> found = averages.averages(Poses(open_dump("nitrogen.dump").atoms).run())
    >>> pictures.draw_averages(found, "averages.png").axes[0].get_xlabel()
    'temperature (K)'
    """
    groups = {}
    for one in averages:
        if not one.known:
            continue
        quantity, _, row = one.name.partition(" of ")
        groups.setdefault(quantity, []).append((row or "center of mass", one))
    if not groups:
        return None
    heights = [AROUND + ROW * len(rows) for rows in groups.values()]
    shape = {"nrows": len(groups), "figsize": (7, sum(heights)), "height_ratios": heights, "squeeze": False}
    with picture(path, **shape) as (figure, axes):
        for axis, (quantity, rows) in zip(axes[:, 0], groups.items()):
            for place, (_, one) in enumerate(rows):
                look = {"fmt": "o", "color": COLOR["total"], "markersize": 4, "capsize": 3}
                axis.errorbar(one.value, place, xerr=one.error, **look)
                note = {"fontsize": 8, "va": "center", "transform": axis.get_yaxis_transform()}
                axis.text(1.02, place, one.text(), **note)
            axis.set_yticks(range(len(rows)), [row for row, _ in rows])
            axis.set_ylim(len(rows) - 0.5, -0.5)
            axis.margins(x=0.15)
            axis.xaxis.set_major_locator(MaxNLocator(5))
            axis.set_xlabel(named(quantity, rows[0][1].unit))
    return figure
