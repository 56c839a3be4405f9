"""The pictures of ``gearquat analyze``, and how all pictures are made.  Nothing is computed here."""

from contextlib import contextmanager

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from .style import COLOR, STYLE

PRINCIPAL_AXES = ("#0072b2", "#d55e00", "#009e73")


@contextmanager
def picture(path, title="", figsize=None, **layout):
    """(figure, axes) in the common style, saved at the end; ``layout`` goes to Figure.subplots."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=figsize, layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
        yield figure, figure.subplots(**layout)
        figure.savefig(path)


def named(quantity, unit):
    return f"{quantity} ({unit})" if unit else quantity


ENERGIES = {"ke_translation": "translation", "ke_rotation": "rotation", "potential": "potential"}
RESIDUALS = {"residual": "sites", "velocity_residual": "velocities"}


def draw_totals(path, poses, totals):
    """Energies of all bodies, and how far they are from rigid, against time."""
    time = poses.results.time
    residuals = {name: label for name, label in RESIDUALS.items() if totals.get(name, np.zeros(1)).any()}
    panels = [(named("energy", poses.units and f"units {poses.units}"), ENERGIES)]
    panels += [("largest deviation\nfrom a rigid body", residuals)]
    panels = [(title, [n for n in labels if n in totals], labels) for title, labels in panels]
    panels = [panel for panel in panels if panel[1]]
    shape = {"nrows": len(panels), "figsize": (8, 2.7 * len(panels)), "sharex": True, "squeeze": False}
    with picture(path, **shape) as (_, axes):
        for axis, (title, names, labels) in zip(axes[:, 0], panels):
            for name in names:
                label = labels[name]
                axis.plot(time, totals[name], color=COLOR.get(label), label=label)
            axis.set_ylabel(title)
            if labels is residuals:
                axis.set_yscale("log")
            axis.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3)
        axes[-1, 0].set_xlabel("time")


def draw_correlations(path, functions):
    """Mean squares, autocorrelations of velocities and of axes, against the lag on a logarithmic axis."""
    lag = functions["lag"]
    # at later lags there are too few origins
    shown = slice(1, max(2, 2 * len(lag) // 3))
    panels = {"mean square": [], "normalized autocorrelation": [], "correlation of the principal axes": []}
    squares, velocities, axes_in_space = panels.values()
    for name, values in functions.items():
        kind = COLOR["rotation" if "rotation" in name or "omega" in name else "translation"]
        if name.startswith("mean_square"):
            unit = "rad²" if "rotation" in name else "length²"
            squares.append((values, {"color": kind, "label": f"{name.split('_')[-1]} ({unit})"}))
        elif name.endswith("autocorrelation") and values[0] > 0:
            label = "angular velocity" if "omega" in name else "velocity"
            velocities.append((values / values[0], {"color": kind, "label": label}))
        elif name.startswith("axis"):
            number, order = name[4], name[-1]
            look = {"color": PRINCIPAL_AXES[int(number) - 1], "linestyle": "-" if order == "1" else "--"}
            axes_in_space.append((values, {"label": f"axis {number}, P{order}", **look}))
    panels = {title: curves for title, curves in panels.items() if curves}
    shape = {"ncols": len(panels), "figsize": (4 * len(panels), 3.8), "squeeze": False}
    with picture(path, **shape) as (_, axes):
        for axis, (title, curves) in zip(axes[0], panels.items()):
            for values, look in curves:
                axis.plot(lag[shown], values[shown], **look)
            axis.set_title(title, fontsize=10, loc="left")
            axis.set_xscale("log")
            axis.set_yscale("log" if curves is squares else "linear")
            axis.set_xlabel("lag")
            axis.legend(fontsize=8)
