"""The pictures.  Only positions of labels are computed here."""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np

from benchmarks.engine import Curve, Panel, draw
from benchmarks.engine.methods import DEFAULTS, gear, looks
from benchmarks.engine.panels import RECONSTRUCTED
from gearquat_analysis.style import COLOR, STYLE

from . import plan, tables
from .evaluate import fitted_order, price

AXIS = {"seconds": "wall time of the run, ms", "evaluations": "force evaluations, start included"}
#: smallest value in a logarithmic panel
TINY = 1e-17


def points(results, scene, method, unit, quantity):
    """x and y of the runs of a method that were not lost; wall times in ms."""
    x = results.column(scene, method, unit) * (1e3 if unit == "seconds" else 1.0)
    y = results.column(scene, method, quantity)
    good = np.isfinite(x) & np.isfinite(y)
    return x[good], np.maximum(y[good], TINY)


# --- the main picture -----------------------------------------------------------------------------
def _label(axis, x, y, level, text, color, offset):
    """Write a label beside the first point of a line with a value of at most ``level``."""
    for at in np.flatnonzero(y <= level)[:1]:
        look = {"color": color, "fontsize": 9.5, "textcoords": "offset points"}
        axis.annotate(text, (x[at], y[at]), xytext=offset, **look)


def _arrow(axis, results, target):
    """Draw the speed-up at one error as an arrow from fix rigid/nve/small to the cheapest settings."""
    _, best = tables.cheapest_setting(results, "case1", target)
    theirs = price(results, "case1", plan.RIGID_NVE, target)
    if best and theirs:
        ends = 1e3 * best.value, 1e3 * theirs.value
        look = {"arrowstyle": "<->", "color": "#555555"}
        axis.annotate("", (ends[0], target), (ends[1], target), arrowprops=look)
        text = tables.ratio_text(theirs.over(best), error=False)
        place = {"xytext": (0, 4), "textcoords": "offset points", "ha": "center"}
        place["bbox"] = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
        axis.annotate(text, (np.prod(ends) ** 0.5, target), **place, fontweight="bold", fontsize=12)


def draw_main(path, results):
    """Error in test case 1 against wall time, and against force evaluations."""
    best, _ = tables.cheapest_setting(results, "case1", 1e-8)
    shown = {plan.RIGID_NVE: ("fix rigid/nve/small", "#444444", "D", 2e-7, (8, 6))}
    shown[DEFAULTS["second"]] = ("formulation\nsecond", COLOR["second"], "s", 2e-9, (10, -8))
    shown[plan.DEFAULT] = ("fix gear/quat,\ndefaults", COLOR["momentum"], "o", 1e-11, (40, -24))
    if best not in (None, plan.DEFAULT):
        shown[best] = ("cheapest\nsettings", "#56b4e9", "v", 3e-11, (-62, -26))
    with plt.rc_context(STYLE | {"font.size": 9.5, "lines.linewidth": 1.7}):
        figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), sharey=True, layout="constrained")
        for axis, unit in zip(axes, AXIS):
            for method, (label, color, marker, level, offset) in shown.items():
                x, y = points(results, "case1", method, unit, "position")
                axis.plot(x, y, color=color, marker=marker, markersize=3.5)
                _label(axis, x, y, level, label, color, offset)
            axis.set(xscale="log", yscale="log", xlabel=AXIS[unit], ylim=(1e-13, 1))
            axis.set_xlim(left=0.6 * axis.get_xlim()[0])
        for target in tables.TARGETS:
            _arrow(axes[0], results, target)
        axes[0].set_ylabel("error of the center of mass at the end")
        heading = results.scenes["case1"].heading
        figure.suptitle(heading, x=0.01, ha="left", fontsize=10)
        figure.supxlabel(RECONSTRUCTED, x=0.995, ha="right", fontsize=7, color="#666666")
        figure.savefig(path)
        plt.close(figure)


# --- panels ---------------------------------------------------------------------------------------
def _few(scene):
    """Method -> color, marker and line, the same in all scenes, for the methods in the panels."""
    few = {*plan.FEW_METHODS, *plan.ROUGH_METHODS, gear("momentum", 12)}
    look = looks([method for method in plan.ALL_METHODS if method in few])
    look[plan.RIGID_SMALL]["line"] = ":"
    return {method: own for method, own in look.items() if method in scene.methods}


def _curves(results, scene, unit, quantity, label=False):
    """One Curve per method of the panels."""
    return tuple(
        Curve(method.label * label, *points(results, scene.key, method, unit, quantity), **own)
        for method, own in _few(scene).items()
    )


def _fits(results, scene):
    """Broad lines of fitted order, against force evaluations."""
    found = []
    for method, own in _few(scene).items():
        steps, errors = results.errors(scene.key, method)
        limit = results.limits.get((scene.key, method.key), np.inf)
        fit = fitted_order(steps, errors, limit) if len(steps) else None
        if fit:
            line = np.array([steps[fit.used].max() * 1.15, steps[fit.used].min() / 1.15])
            x = scene.end / line + 1 + results.curve(scene.key, method)[0].start
            found.append(Curve("", x, fit.at(line), own["color"] + "40", width=5))
    return tuple(found)


def top_panels(results, scene):
    """Errors of orientation and energy, drift and constraints of the free top."""
    calls = AXIS["evaluations"]

    def panel(title, quantity, unit="evaluations", more=()):
        curves = _curves(results, scene, unit, quantity) + more
        return Panel(title, AXIS[unit], "", curves, "xy", legend=False)

    orientation = _curves(results, scene, "evaluations", "orientation", label=True)
    orientation += _fits(results, scene)
    dots = [
        Curve("", curve.x, curve.y, curve.color, "", marker, hollow=name == "tangency")
        for name, marker in (("norm", "o"), ("tangency", "s"))
        for curve in _curves(results, scene, "evaluations", name)
        if len(curve.x)
    ]
    constraints = "constraints: ||q|² − 1| filled, |q·q̇| hollow, zero at the edge"
    return (
        Panel("error of the orientation, radians", calls, "", orientation, "xy", legend=False),
        panel("the same error against wall time", "orientation", "seconds"),
        panel("largest error of the energy", "energy"),
        panel("drift of the energy per unit of time", "drift"),
        Panel(constraints, calls, "", dots, "xy", ylim=(TINY / 3, 1), legend=False),
    )


def order_panels(results):
    """Error against step for every N with compensated sums, fitted lines, largest usable steps."""
    fits, panels = tables.order_fits(results), []
    for name, numbers in plan.VALUES.items():
        colors, curves = looks([gear(name, n) for n in numbers]), []
        for n, (method, own) in zip(numbers, colors.items()):
            steps, errors, fit = fits[name, n]
            curves.append(Curve("", steps, errors, own["color"], "", "o"))
            if fit:
                used = steps[fit.used]
                label = f"N = {n}: {fit.order:.1f}"
                curves.append(Curve(label, used, fit.at(used), own["color"], width=1.6))
            limit = results.limits.get(("case1", method.key))
            if limit:
                curves.append(Curve("", np.array([limit]), np.array([0.2]), own["color"], "", "v"))
        scales = {"log": "xy", "xticks": (1, 0.5, 0.2, 0.1, 0.05, 0.02), "ylim": (1e-14, 1)}
        title, error = f"formulation {name}, compensated sums", "error of the center of mass"
        panels.append(Panel(title, "step", error, curves, **scales))
    return panels


def cutoff_panels(results):
    """The same water with forces smooth at the cutoff, and with a plain cutoff."""
    error, panels = "error of the centers of mass (rms), Å", []
    look = {"log": "xy", "xticks": (5, 10, 20, 50, 100, 200, 400), "legend": False}
    for scene in map(results.scenes.get, ("water", "water-plain")):
        curves = _curves(results, scene, "evaluations", "position", label=True)
        panels.append(Panel(scene.heading, AXIS["evaluations"], error, curves, **look))
    return panels


def pictures(results):
    """Name -> picture, for all pictures that can be drawn from the results."""
    found, scenes = {}, results.scenes
    if "case1" in scenes:
        found["main"] = partial(draw_main, results=results)
        note = f"lines: fitted orders; triangles: largest usable steps; {RECONSTRUCTED}"
        found["orders"] = partial(draw, panels=order_panels(results), note=note)
    if "top" in scenes:
        panels = top_panels(results, scenes["top"])
        found["top"] = partial(draw, panels=panels, columns=3, note="broad: lines of fitted order")
    if {"water", "water-plain"} <= set(scenes):
        found["cutoff"] = cutoff_panels(results)
    return found
