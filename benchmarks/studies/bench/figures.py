"""Draw many_bodies.png from the results of ``benchmarks/run bench``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from . import judge  # noqa: E402
from .runs import COMPARED, GEAR, NVE_SMALL, SMALL, bodies_of  # noqa: E402
from lammps_gearquat.style import COLOUR, STYLE  # noqa: E402

#: method -> colour and marker
LOOK = {
    "second": (COLOUR["second"], "o"),
    "first": (COLOUR["first"], "s"),
    NVE_SMALL.key: (COLOUR["rigid"], "D"),
    SMALL.key: (COLOUR["translation"], "^"),
}
RACE = (*GEAR, NVE_SMALL)


def _look(method, **more):
    colour, marker = LOOK[method.key]
    return {"color": colour, "marker": marker, "markersize": 4, "label": method.label, **more}


def _bars(median, least, largest):
    """Error bars from least to largest, shape (2, n)."""
    return np.array([np.subtract(median, least), np.subtract(largest, median)])


def _time(axis, results):
    ranks = results.plan.ranks
    width = 0.8 / len(RACE)
    for k, method in enumerate(RACE):
        spreads = [
            judge.spread(1e3 * np.array(results.fix_seconds(method, results.plan.headline, n)))
            for n in ranks
        ]
        median, least, largest = np.transpose(spreads)
        at = np.arange(len(ranks)) + (k - 1) * width
        bars = _bars(median, least, largest)
        axis.bar(at, median, width, yerr=bars, color=LOOK[method.key][0], capsize=2)
    axis.set_xticks(range(len(ranks)), [f"{n} rank" + "s" * (n > 1) for n in ranks])
    bodies = bodies_of(results.plan.headline)
    axis.set(ylabel="ms a step", title=f"Time in the fix, {bodies} molecules")


def _memory(axis, results):
    scenes = list(results.plan.growth)
    sizes = [bodies_of(cells) for cells in scenes]
    for method in RACE:
        found = judge.memory(results, method)
        for kind, line in (("reported", "--"), ("allocated", "-")):
            values = [found[cells, kind] for cells in scenes]
            axis.plot(sizes, values, line, **_look(method))
    axis.set(xscale="log", xlabel="bodies", ylabel="bytes a body")
    axis.set_title("Memory on the heap; dashed: LAMMPS' sum")
    axis.set_xticks(sizes, map(str, sizes))
    axis.minorticks_off()
    axis.set_ylim(bottom=0)


def _growth(axis, results):
    for method in RACE:
        found = judge.per_body(results, method)
        median, least, largest = np.transpose(list(found.values()))
        axis.errorbar(list(found), median, _bars(median, least, largest), **_look(method))
    axis.set(xscale="log", xlabel="bodies", ylabel="µs a body and step", title="Growth, one rank")
    axis.set_xticks(list(found), [str(n) for n in found])
    axis.minorticks_off()
    axis.set_ylim(bottom=0)


def _steps(axis, dts):
    axis.set_xticks(np.arange(len(dts)), [f"{dt:g}" for dt in dts])
    axis.set_xlabel("step, fs")


def _pressure(axis, results):
    dts = results.plan.pressure_dts
    for k, method in enumerate(COMPARED):
        means = judge.mean_pressures(results, method).values()
        at = np.arange(len(dts)) + (k - 1.5) * 0.12
        values, errors = zip(*((m.value, m.error) for m in means))
        axis.errorbar(at, values, errors, linestyle="", **_look(method))
    _steps(axis, dts)
    axis.set(ylabel="atm", title="Mean pressure, one standard error")


def _instant(axis, results):
    dts = results.plan.pressure_dts
    for method in COMPARED:
        values = [after for _, after in judge.instants(results, method).values()]
        axis.plot(values, **_look(method))
    _steps(axis, dts)
    axis.set(ylabel="atm", title=f"Pressure at {results.plan.interval:g} fs, no statistics in it")


def _partition(axis, results):
    for k, method in enumerate(GEAR):
        parts = judge.partition(results.temperatures[method.key])
        values, errors = zip(*((m.value, m.error) for m in parts.values()))
        at = np.arange(len(parts)) + (k - 0.5) * 0.12
        axis.errorbar(at, values, errors, linestyle="", **_look(method))
    names = [name.removeprefix("axis ").replace(" the ", "\nthe ") for name in parts]
    axis.set_xticks(range(len(parts)), names, fontsize=7)
    axis.axhline(0.0, color="black", linewidth=0.7)
    axis.set(ylabel="K", title="Temperature less that of all")


def draw(path, results):
    """Six panels: time, growth, memory; pressure, pressure of one configuration, equipartition."""
    panels = (_time, _growth, _memory, _pressure, _instant, _partition)
    with plt.rc_context(STYLE | {"axes.titlesize": 10}):
        figure, axes = plt.subplots(2, 3, figsize=(12, 7), layout="constrained")
        for axis, panel in zip(axes.flat, panels):
            panel(axis, results)
        handles, labels = axes[1, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=4, fontsize=8)
        figure.savefig(path)
        plt.close(figure)
