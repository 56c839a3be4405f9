"""The pictures of `benchmarks/run workprecision`.  Nothing is computed here but where labels go."""

import textwrap

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib import ticker  # noqa: E402

from lammps_gearquat.style import RECONSTRUCTED, STYLE  # noqa: E402
from . import plan, tables  # noqa: E402
from .evaluate import RULE, fitted_order  # noqa: E402
from .results import facts  # noqa: E402

SECOND, FIRST, RIGID = "#0072b2", "#d55e00", "#444444"
BEST = "#2a86b8"
SOLVER = {"DOP853": "#009e73", "LSODA": "#cc79a7"}
FAMILY = {plan.SECOND: SECOND, plan.FIRST: FIRST, plan.RIGID: RIGID}
LOOK = {**STYLE, "font.size": 9, "axes.titlesize": 9.5, "lines.linewidth": 1.3, "savefig.dpi": 130}
AXIS = {"evaluations": "force evaluations, start included", "seconds": "wall time of the run, ms"}
#: what counts as zero in a logarithmic panel
TINY = 1e-17


def colour_of(row):
    """Colour of a method: hue for the family, lighter for fewer values."""
    base = np.array(matplotlib.colors.to_rgb(FAMILY[row.family]))
    values = plan.VALUES.get(row.family)
    if values is None:
        return "#aaaaaa" if row.method == plan.RIGID_SMALL.key else RIGID
    share = (values[-1] - row.values) / (values[-1] - values[0])
    return tuple(base + (1 - base) * 0.65 * share)


def _curve(results, scene, method, unit, quantity):
    """x and y of a method without runs that went astray; wall times in ms."""
    x = results.column(scene, method, unit) * (1e3 if unit == "seconds" else 1.0)
    y = results.column(scene, method, quantity)
    good = np.isfinite(x) & np.isfinite(y)
    return x[good], np.maximum(y[good], TINY)


def _draw(axis, results, scene, method, unit, quantity, **line):
    """One method as a line with markers; whiskers are quartiles of wall times."""
    row = results.curve(scene, method)[0]
    x, y = _curve(results, scene, method, unit, quantity)
    look = {"color": colour_of(row), "marker": "o", "markersize": 3, **line}
    if row.method == plan.RIGID_SMALL.key:
        look = {"ls": ":", "zorder": 4, **look}
    elif row.values and row.passes != plan.DEFAULT_PASSES:
        look.setdefault("ls", "--")
    if unit == "seconds" and len(x):
        good = [r for r in results.curve(scene, method) if np.isfinite(r.seconds)]
        spread = 1e3 * np.abs([[r.seconds - r.low, r.high - r.seconds] for r in good]).T
        axis.errorbar(x, y, xerr=spread, **look, elinewidth=0.8)
        return x, y
    axis.plot(x, y, **look)
    return x, y


def _log(axis, xlabel, ylabel):
    """Logarithmic axes; a short one has its ticks at 1, 2, 5."""
    axis.set(xscale="log", yscale="log", xlabel=xlabel)
    axis.set_title(ylabel, loc="left")
    low, high = axis.get_xlim()
    axis.xaxis.set_minor_formatter(ticker.NullFormatter())
    if high / low < 200:
        axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_major_formatter(ticker.StrMethodFormatter("{x:g}"))


def _name(axis, x, y, level, text, colour, offset=(5, 3), **how):
    """A label beside the point of a line whose value is nearest to ``level``."""
    if len(x):
        at = np.abs(np.log(y / level)).argmin()
        look = {"color": colour, "fontsize": 8, "textcoords": "offset points"}
        axis.annotate(text, (x[at], y[at]), xytext=offset, **look, **how)


def _unit(name, unit):
    return f"{name}, {unit}" if unit else name


def _save(figure, path, title, note=""):
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
    if note:
        lines = textwrap.fill(note, round(figure.get_figwidth() * 18))
        figure.supxlabel(lines, x=0.995, ha="right", fontsize=7, color="#666666")
    figure.savefig(path)
    plt.close(figure)


def _note(scene):
    return RECONSTRUCTED if scene == "case1" else ""


# --- the main picture -----------------------------------------------------------------------------
def shown_settings(results, scene):
    """Methods that stand out, key -> label: cheapest setting at 1e-8, defaults, fix rigid's."""
    best = tables.cheapest_setting(results, scene, 1e-8, "seconds")
    chosen = {best[0].method: best[0].label} if best else {}
    chosen |= {method.key: method.label for method in plan.DEFAULTS.values()}
    chosen[plan.DEFAULT.key] += " (default)"
    chosen |= {method.key: method.label for method in (plan.RIGID_NVE, plan.RIGID_SMALL)}
    return {key: label for key, label in chosen.items() if results.curve(scene, key)}


def _arrow(axis, results, scene, target):
    """The speed-up at one error, as an arrow from fix rigid/nve/small to the cheapest setting."""
    best = tables.cheapest_setting(results, scene, target, "seconds")
    theirs = tables.price(results, scene, plan.RIGID_NVE.key, target, "seconds")
    if not best or not theirs:
        return
    left, right = 1e3 * best[1].value, 1e3 * theirs.value
    axis.annotate(
        "", (left, target), (right, target), arrowprops={"arrowstyle": "<->", "color": "#555555"}
    )
    text = tables.ratio(theirs, best[1])[1]
    axis.annotate(
        text,
        (np.sqrt(left * right), target),
        xytext=(0, 3),
        textcoords="offset points",
        ha="center",
        fontweight="bold",
    )


def draw_main(path, results, scene="case1"):
    """Error against force evaluations, and against wall time."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.6), sharey=True, layout="constrained")
    measure, shown = facts(scene).measure, shown_settings(results, scene)
    for axis, unit in zip(axes, AXIS):
        for method in results.methods(scene):
            if method not in shown:
                x, y = _curve(results, scene, method, unit, measure)
                colour = colour_of(results.curve(scene, method)[0])
                axis.plot(x, y, color=colour, linewidth=0.5, alpha=0.45, zorder=1)
        for method, label in shown.items():
            row = results.curve(scene, method)[0]
            look = {"linewidth": 1.8, "zorder": 3, "label": label, "color": FAMILY[row.family]}
            if method == plan.RIGID_SMALL.key:
                look |= {"color": "#aaaaaa"}
            elif method not in {m.key for m in plan.DEFAULTS.values()} and row.values:
                look |= {"color": BEST, "marker": "D", "ls": "-", "linewidth": 1.2}
            _draw(axis, results, scene, method, unit, measure, **look)
        _log(axis, AXIS[unit], "")
    for solver, colour in SOLVER.items():
        x, y = results.solver(scene, solver)
        look = {"color": colour, "marker": "^", "markersize": 3, "ls": "-."}
        axes[0].plot(x, y, **look, label=f"SciPy's {solver}")
    for target in tables.TARGETS:
        _arrow(axes[1], results, scene, target)
    _name_settings(axes[1], results, scene, shown, measure)
    name = "centre of mass" if measure == "position" else "orientation"
    axes[0].set_ylabel(_unit(f"error of the {name} at the end", facts(scene).length))
    axes[0].set_ylim(1e-13, 1)
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    axes[1].set_title(
        "faint: all other N and passes; whiskers: quartiles", loc="right", fontsize=7.5
    )
    _save(figure, path, f"What accuracy costs: {results.title(scene)}", _note(scene))


def _name_settings(axis, results, scene, shown, measure):
    """Labels beside the lines against wall time."""
    best, *_ = shown
    second, first = (plan.DEFAULTS[name].key for name in tables.FORMULATIONS)
    places = {
        second: (1e-11, (6, -3)),
        first: (3e-10, (6, 2)),
        plan.RIGID_NVE.key: (1e-7, (6, 5)),
    }
    for method, (level, offset) in places.items():
        if method in shown:
            x, y = _curve(results, scene, method, "seconds", measure)
            at = np.arange(len(y))[-3:] if method == second else np.arange(len(y))
            colour = FAMILY[results.curve(scene, method)[0].family]
            _name(axis, x[at], y[at], level, shown[method], colour, offset)
    if best not in places:
        x, y = _curve(results, scene, best, "seconds", measure)
        line = {"arrowstyle": "-", "color": BEST, "linewidth": 0.7}
        look = {"textcoords": "axes fraction", "arrowprops": line, "color": BEST, "fontsize": 8}
        at = np.flatnonzero(y <= 1e-10)[:1]
        for x_at, y_at in zip(x[at], y[at]):
            axis.annotate(shown[best], (x_at, y_at), xytext=(0.01, 0.03), **look)


# --- all panels of a scene ------------------------------------------------------------------------
def _panel_methods(results, scene):
    """Methods of the six panels: few N of each formulation, the defaults, fix rigid's."""
    few = {plan.gear(name, n).key for name, ns in plan.FEW_VALUES.items() for n in ns}
    few |= {m.key for m in (*plan.FEW_METHODS, plan.gear(plan.SECOND, 12, 2))}
    return {key: label for key, label in results.methods(scene).items() if key in few}


def _draw_constraints(axis, results, scene, methods):
    """Norm (full) and tangency (open markers) of the quaternion."""
    for method in methods:
        if not results.curve(scene, method)[0].values:
            continue
        _draw(axis, results, scene, method, "evaluations", "norm", ls="none")
        hollow = {"markerfacecolor": "none", "ls": "none", "marker": "s"}
        _draw(axis, results, scene, method, "evaluations", "tangency", **hollow)
    axis.set_ylim(TINY / 3, 1e3)
    words = "filled: |q|² − 1, open: q·q̇; zero is at the lower edge"
    axis.text(0.03, 0.93, words, transform=axis.transAxes, fontsize=8)


def _draw_fit(axis, results, scene, method):
    """The line of fitted order, in force evaluations."""
    steps, errors = results.errors(scene, method)
    fit = fitted_order(steps, errors, results.largest_step(scene, method))
    if fit is None:
        return
    line = np.array([steps[fit.used].max() * 1.15, steps[fit.used].min() / 1.15])
    start = results.curve(scene, method)[0].start
    x, colour = results.end(scene) / line + 1 + start, colour_of(results.curve(scene, method)[0])
    axis.plot(x, fit.error(line), color=colour, linewidth=5, alpha=0.25, solid_capstyle="butt")


def _mark_limits(axis, marks):
    """Triangles at the top, a little lower each, where methods become usable: (x, colour)."""
    for number, (x, colour) in enumerate(marks):
        height = 0.985 - 0.022 * number
        look = {"marker": "v", "markersize": 5, "color": colour}
        axis.plot(x, height, **look, transform=axis.get_xaxis_transform())


def _limits(results, scene, methods):
    """(row, largest usable step) of the methods for which it is known."""
    found = [(results.curve(scene, m)[0], results.largest_step(scene, m)) for m in methods]
    return [(row, step) for row, step in found if 0 < step < np.inf]


def draw_panels(path, results, scene):
    """Position, orientation, energy, drift, constraints against evaluations; the error against time."""
    figure, axes = plt.subplots(2, 3, figsize=(14, 7.4), layout="constrained")
    known, methods = facts(scene), _panel_methods(results, scene)
    panels = {
        "position": _unit("error of the centre of mass", known.length),
        "orientation": "error of the orientation, radians",
        "energy": _unit("largest error of the energy", known.energy),
        "drift": _unit("drift of the energy per unit of time", known.energy),
    }
    places = dict(zip(panels, (axes[0, 0], axes[0, 1], axes[1, 0], axes[1, 1])))
    for quantity, axis in places.items():
        for method, label in methods.items():
            _draw(axis, results, scene, method, "evaluations", quantity, label=label)
        _log(axis, AXIS["evaluations"], panels[quantity])
    for method in methods:
        _draw_fit(places[known.measure], results, scene, method)
    marks = _limits(results, scene, methods)
    marks = [(results.end(scene) / step + 1 + row.start, colour_of(row)) for row, step in marks]
    _mark_limits(places[known.measure], marks)
    for solver, colour in SOLVER.items():
        x, y = results.solver(scene, solver)
        look = {"color": colour, "marker": "^", "markersize": 3, "ls": "-."}
        places[known.measure].plot(x, y, **look)
        down = 4 if solver == "LSODA" else -9
        _name(places[known.measure], x, y, y.min(initial=1.0), solver, colour, (4, down))
    if known.measure == "position":
        places["position"].set_ylim(top=1e1)
    elif not any(0 < row.position < np.inf for row in results.runs if row.scene == scene):
        axes[0, 0].clear()
        axes[0, 0].set_axis_off()
        axes[0, 0].text(0.5, 0.5, "the centre of mass rests", ha="center")
    for method in methods:
        _draw(axes[0, 2], results, scene, method, "seconds", known.measure)
    _log(axes[0, 2], AXIS["seconds"], panels[known.measure] + ", against wall time")
    _draw_constraints(axes[1, 2], results, scene, methods)
    _log(axes[1, 2], AXIS["evaluations"], "constraints of the quaternion, largest violation")
    handles, labels = places["energy"].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center")
    rule = "; ".join([f"broad {RULE}", "▼ largest usable step", *filter(None, [_note(scene)])])
    _save(figure, path, results.title(scene), rule)


# --- order of each N, rounding, cut-off -------------------------------------------------------------
def draw_orders(path, results):
    """Error against step for every N with compensated sums, fitted lines, stability limits."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 5), sharey=True, layout="constrained")
    fits = tables.order_fits(results)
    for axis, formulation in zip(axes, tables.FORMULATIONS):
        methods = [plan.gear(formulation, n).key for n in plan.VALUES[formulation]]
        limits = _limits(results, "case1", methods)
        _mark_limits(axis, [(step, colour_of(row)) for row, step in limits])
        for method in methods:
            row = results.curve("case1", method)[0]
            steps, errors, fit = fits[formulation, row.values]
            look = {"color": colour_of(row), "markersize": 2.5}
            axis.plot(steps, errors, "o", **look)
            if fit:
                used = np.asarray(steps)[fit.used]
                text = f"N = {row.values}: {fit.order:.1f}"
                axis.plot(used, fit.error(used), color=look["color"], linewidth=1.6, label=text)
        _log(axis, "step", f"{formulation} formulation")
        axis.invert_xaxis()
        axis.set_xticks((1, 0.5, 0.2, 0.1, 0.05, 0.02), "1 0.5 0.2 0.1 0.05 0.02".split())
        axis.minorticks_off()
        axis.legend(loc="lower left", fontsize=8, title="fitted order")
    axes[0].set_ylim(1e-14, 1)
    axes[0].set_ylabel("error of the centre of mass at the end")
    note = f"{RULE}; ▼ largest usable step; " + RECONSTRUCTED
    _save(figure, path, "Order of every N, test case 1, compensated sums", note)


def draw_rounding(path, results):
    """Errors at small steps, plain and compensated."""
    figure, axis = plt.subplots(figsize=(5.6, 3.8), layout="constrained")
    by = {(row.formulation, row.compensate): [] for row in results.rounding}
    for row in results.rounding:
        by[row.formulation, row.compensate].append((row.dt, row.position))
    for (formulation, compensate), points in by.items():
        x, y = np.array(sorted(points, reverse=True)).T
        words = "compensated" if compensate == "yes" else "plain"
        look = {"color": FAMILY[formulation], "marker": "o", "markersize": 4}
        axis.plot(x, y, **look, ls="-" if compensate == "yes" else ":")
        up = 4 if (formulation, compensate) != (plan.SECOND, "yes") else -10
        text = f"{formulation}, {words}"
        _name(axis, x[-1:], y[-1:], y[-1], text, FAMILY[formulation], offset=(5, up))
    _log(axis, "step", "error of the centre of mass at the end")
    axis.invert_xaxis()
    axis.set_xlim(right=min(axis.get_xlim()) / 4)
    _save(figure, path, "Rounding, test case 1", RECONSTRUCTED)


def draw_cutoff(path, results):
    """The same water with forces smooth at the cut-off, and with a plain cut-off."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), sharey=True, layout="constrained")
    for axis, scene in zip(axes, ("water", "water-plain")):
        for method, label in results.methods(scene).items():
            _draw(axis, results, scene, method, "evaluations", "position", label=label)
        _log(axis, AXIS["evaluations"], results.title(scene))
    axes[0].set_ylabel("error of the centres of mass (rms), Å")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    _save(figure, path, "A jump of the forces at the cut-off takes the order away")


def draw_all(folder, results):
    """All pictures that the results allow, as PNG in ``folder``; returns their names."""
    folder.mkdir(parents=True, exist_ok=True)
    jobs = {f"{scene}.png": (draw_panels, scene) for scene in results.scenes}
    if "case1" in results.scenes:
        jobs["main.png"] = (draw_main,)
    if results.orders:
        jobs["orders.png"] = (draw_orders,)
    if results.rounding:
        jobs["rounding.png"] = (draw_rounding,)
    if {"water", "water-plain"} <= set(results.scenes):
        jobs["cutoff.png"] = (draw_cutoff,)
    with plt.rc_context(LOOK):
        for name, (draw, *arguments) in jobs.items():
            draw(folder / name, results, *arguments)
    return list(jobs)
