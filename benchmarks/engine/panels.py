"""Pictures made of panels: a study defines their contents, and draw() draws all of them in the same way."""

from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from gearquat_analysis.style import COLOR, STYLE  # noqa: E402

#: note on the cage in pictures of the paper's cases
RECONSTRUCTED = "charges of the cage: reconstructed"


@dataclass(frozen=True)
class Curve:
    """One line of a panel: ``x``, ``y`` and, for error bars, ``error``, each (n,).

    ``color``: a name of style.COLOR or a color of matplotlib; ``line`` ("" for none) and ``marker``
    are matplotlib's; ``width``: of the line; ``hollow``: markers are not filled.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    color: str
    line: str = "-"
    marker: str = ""
    error: np.ndarray = None
    width: float = None
    hollow: bool = False


@dataclass(frozen=True)
class Bars:
    """Horizontal bars: ``names`` from top to bottom, ``below`` in gray, and ``more`` on top."""

    names: tuple
    below: np.ndarray
    more: np.ndarray
    color: str = "momentum"


@dataclass(frozen=True)
class Panel:
    """One pair of axes with ``curves``, which are a sequence of Curve or Bars.

    ``log``: "x", "y" or "xy".  ``linear``: y is linear up to this size and logarithmic beyond, for
    values of both signs.  ``ticks``: words for x = 0, 1, 2, ...; ``xticks``: the values at which x
    is labeled.  ``xlim``, ``ylim``: ends of the axes.  ``lost``: (x, color) of runs that ended early,
    drawn as crosses at the top.  ``legend``: whether the panel has its own legend, with this number of ``columns``.
    """

    title: str
    xlabel: str
    ylabel: str
    curves: list
    log: str = "y"
    ticks: tuple = ()
    xticks: tuple = ()
    xlim: tuple = None
    ylim: tuple = None
    lost: tuple = ()
    legend: bool = True
    columns: int = 3
    linear: float = None


def floor(values, least=1e-17):
    """Sizes of values that can be drawn on a logarithmic axis."""
    return np.maximum(np.abs(values), least)


def _curve(axis, curve):
    look = {"color": COLOR.get(curve.color, curve.color), "label": curve.label}
    look |= {"linestyle": curve.line, "linewidth": curve.width, "marker": curve.marker}
    look |= {"markersize": 3.5, "markerfacecolor": "white" if curve.hollow else None}
    if curve.error is None:
        axis.plot(curve.x, curve.y, **look)
    else:
        axis.errorbar(curve.x, curve.y, yerr=curve.error, capsize=2, **look)


def _bars(axis, bars):
    axis.barh(bars.names, bars.below, color="#cccccc")
    axis.barh(bars.names, bars.more, left=bars.below, color=COLOR[bars.color])
    for k, (start, length) in enumerate(zip(bars.below, bars.more)):
        text = f" {length:+.0f}" if k else f" {length:.0f}"
        axis.annotate(text, (start + max(length, 0), k), va="center")
    axis.invert_yaxis()
    axis.set_xlim(right=1.2 * max(a + b for a, b in zip(bars.below, bars.more)))


def _scales(axis, panel):
    if "x" in panel.log:
        axis.set_xscale("log")
    if "y" in panel.log:
        axis.set_yscale("log")
    if panel.linear:
        axis.set_yscale("symlog", linthresh=panel.linear, linscale=0.6)
        axis.axhline(0.0, color="#666666", linewidth=0.6)
    if panel.ticks:
        axis.set_xticks(range(len(panel.ticks)), panel.ticks)
        axis.margins(x=0.15)
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
    if isinstance(panel.curves, Bars):
        return _bars(axis, panel.curves)
    for curve in panel.curves:
        _curve(axis, curve)
    for x, color in panel.lost:
        axis.plot(x, 0.99, "x", color=color, transform=axis.get_xaxis_transform())
    _scales(axis, panel)
    if panel.legend and any(curve.label for curve in panel.curves):
        place = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.2), "ncols": panel.columns}
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
            place = {"loc": "outside upper center", "ncols": 5, "fontsize": 8}
            figure.legend(shared.values(), shared.keys(), **place)
        if note:
            figure.supxlabel(note, x=0.995, ha="right", fontsize=7, color="#666666")
        figure.savefig(path)
        plt.close(figure)
