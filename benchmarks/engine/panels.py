"""Pictures made of panels: a study defines their contents, and draw() draws all of them in the same way."""

from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.ticker import NullFormatter  # noqa: E402

from gearquat_analysis.style import COLOR, STYLE  # noqa: E402

#: note on the cage in pictures of the paper's cases
RECONSTRUCTED = "charges of the cage: reconstructed"


@dataclass(frozen=True)
class Curve:
    """One line of a panel: ``x``, ``y`` and, for error bars, ``error``, each (n,).

    ``color``: a name of style.COLOR or a color of matplotlib; ``line`` ("" for none) and ``marker``
    are matplotlib's; ``width``: of the line.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    color: str
    line: str = "-"
    marker: str = ""
    error: np.ndarray = None
    width: float = None


@dataclass(frozen=True)
class Panel:
    """One pair of axes with ``curves``, a sequence of Curve.

    ``log``: "x", "y" or "xy".  ``xticks``: the values at which x is labeled.  ``xlim``, ``ylim``: ends of the axes.
    ``legend``: whether the panel has its own legend.
    """

    title: str
    xlabel: str
    ylabel: str
    curves: list
    log: str = "y"
    xticks: tuple = ()
    xlim: tuple = None
    ylim: tuple = None
    legend: bool = True


def _curve(axis, curve):
    look = {"color": COLOR.get(curve.color, curve.color), "label": curve.label}
    look |= {"linestyle": curve.line, "linewidth": curve.width, "marker": curve.marker}
    look |= {"markersize": 3.5}
    if curve.error is None:
        axis.plot(curve.x, curve.y, **look)
    else:
        axis.errorbar(curve.x, curve.y, yerr=curve.error, capsize=2, **look)


def _scales(axis, panel):
    if "x" in panel.log:
        axis.set_xscale("log")
        axis.xaxis.set_minor_formatter(NullFormatter())
    if "y" in panel.log:
        axis.set_yscale("log")
    if panel.xticks:
        axis.set_xticks(panel.xticks, [f"{x:g}" for x in panel.xticks])
        axis.minorticks_off()
    if panel.xlim:
        axis.set_xlim(panel.xlim)
    if panel.ylim:
        axis.set_ylim(panel.ylim)


def draw_panel(axis, panel):
    """Draw one panel on ``axis``."""
    axis.set(xlabel=panel.xlabel, ylabel=panel.ylabel)
    axis.set_title(panel.title, loc="left", fontsize=9)
    for curve in panel.curves:
        _curve(axis, curve)
    _scales(axis, panel)
    if panel.legend and any(curve.label for curve in panel.curves):
        place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": 3}
        axis.legend(fontsize=7, **place)


def draw(path, panels, columns=None, note="", share_y=False):
    """Draw ``panels`` in rows with this number of ``columns`` (default: one row).

    ``note``: a line below the panels; ``share_y``: whether they share one y axis.
    Panels without their own legends share one legend, which contains every label once.
    """
    columns = columns or len(panels)
    rows, shared = -(-len(panels) // columns), {}
    look = {"figsize": (4.2 * columns + 0.4, 3.4 * rows), "layout": "constrained"}
    with plt.rc_context(STYLE | {"font.size": 8.5}):
        figure, axes = plt.subplots(rows, columns, squeeze=False, sharey=share_y, **look)
        for axis in axes.flat[len(panels) :]:
            axis.set_axis_off()
        for axis, panel in zip(axes.flat, panels):
            draw_panel(axis, panel)
            if not panel.legend:
                handles, labels = axis.get_legend_handles_labels()
                shared |= dict(zip(labels, handles))
        if shared:
            columns = 2 if max(map(len, shared)) > 30 else 5
            place = {"loc": "outside upper center", "ncols": columns, "fontsize": 8}
            figure.legend(shared.values(), shared.keys(), **place)
        if note:
            figure.supxlabel(note, x=0.995, ha="right", fontsize=7, color="#666666")
        figure.savefig(path)
        plt.close(figure)
