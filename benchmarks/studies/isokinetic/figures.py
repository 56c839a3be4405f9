"""Draw isokinetic.png from finished runs of ``benchmarks/run isokinetic``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from . import judge  # noqa: E402
from .runs import CONSTRAINTS, THERMOSTAT, TITLES, DriftRun  # noqa: E402
from lammps_gearquat.style import STYLE  # noqa: E402

COLOUR = {"total": "#d55e00", "separate": "#0072b2", THERMOSTAT: "#222222"}


def _title(method):
    return TITLES[method].strip("`")


def _history(axis, results):
    """Relative change of the kinetic energy against time, every step and constraint."""
    plan = results.plan
    for constraint in CONSTRAINTS:
        for dt, width in zip(plan.dts, np.linspace(0.6, 1.8, len(plan.dts))):
            kept = results.kept[DriftRun(constraint, False, dt)]
            label = _title(constraint) if dt == plan.dts[-1] else None
            error = np.abs(kept.error[1:])
            axis.plot(kept.time[1:], error, color=COLOUR[constraint], lw=width, label=label)
        kept = results.kept[DriftRun(constraint, True, plan.rescaled_dt)]
        error = np.maximum(np.abs(kept.error[1:]), 1e-17)
        axis.plot(kept.time[1:], error, ".", ms=2, color=COLOUR[constraint])
    axis.set(xscale="log", yscale="log", xlabel="time", ylabel="|K/K(0) − 1|")
    axis.set_title("kinetic energy; dots: rescaled", loc="left", fontsize=9)
    axis.legend(fontsize=8)


def _order(axis, results):
    """Drift against step."""
    dts = results.plan.dts
    for constraint in CONSTRAINTS:
        found = [judge.drift_rate(results.kept[DriftRun(constraint, False, dt)])[0] for dt in dts]
        label = f"{_title(constraint)}, order {judge.order(results, constraint):.1f}"
        axis.plot(dts, np.abs(found), "o-", color=COLOUR[constraint], label=label)
    axis.set(xscale="log", yscale="log", xlabel="step", ylabel="drift of K/K(0), per unit of time")
    axis.set_xticks(dts, [f"{dt:g}" for dt in dts])
    axis.minorticks_off()
    axis.legend(fontsize=8)


def _distribution(axis, difference, results):
    """g(r) of all methods, and differences from the thermostat with one standard error."""
    _, theirs = judge.distribution(results, THERMOSTAT)
    for method in (THERMOSTAT, *CONSTRAINTS):
        r, g = judge.distribution(results, method)
        axis.plot(r, g.value, color=COLOUR[method], label=_title(method))
        if method != THERMOSTAT:
            bars = {"fmt": ".", "ms": 3, "lw": 0.7, "color": COLOUR[method]}
            error = np.hypot(g.error, theirs.error)
            difference.errorbar(r, g.value - theirs.value, yerr=error, **bars)
    axis.set(ylabel="g(r), O and O", xlim=(2, None))
    axis.legend(fontsize=8)
    difference.axhline(0.0, color="#888888", lw=0.6)
    difference.set(xlabel="r, Å", ylabel="difference", xlim=(2, None))


def draw(path, results):
    """Kinetic energy over time, its drift by step, and the pair distribution of water."""
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(12, 4.2), layout="constrained")
        grid = figure.add_gridspec(2, 3, height_ratios=(2, 1))
        _history(figure.add_subplot(grid[:, 0]), results)
        _order(figure.add_subplot(grid[:, 1]), results)
        _distribution(figure.add_subplot(grid[0, 2]), figure.add_subplot(grid[1, 2]), results)
        figure.savefig(path)
        plt.close(figure)
