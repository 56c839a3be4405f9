"""Draw drift.png from finished runs of ``benchmarks/run drift``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from .judge import SIGNIFICANT  # noqa: E402
from lammps_gearquat.style import STYLE  # noqa: E402

#: kind of method -> colours from light to dark, marker
KINDS = {
    "second": (plt.cm.Blues, "o"),
    "first": (plt.cm.Oranges, "s"),
    "rigid": (plt.cm.Greys, "D"),
}


def appearance(methods):
    """Method -> keyword arguments of plot: a colour for each kind, a shade for each method."""
    looks = {}
    for kind, (colours, marker) in KINDS.items():
        members = [m for m in methods if m.variables.get("formulation", "rigid") == kind]
        for method, shade in zip(members, np.linspace(0.45, 0.95, len(members))):
            line = "--" if "compensate" in method.variables else "-"
            looks[method] = {
                "color": colours(shade),
                "marker": marker,
                "markersize": 4,
                "linestyle": line,
            }
    return looks


def _found(results, scene, method):
    """Step -> Drift of one method in one scene."""
    return {run.dt: d for run, d in results.items() if (run.scene, run.method) == (scene, method)}


def _panel(axis, scene, results, looks, value, ylabel):
    """``value(drift)``: number to plot and whether it is hollow; lost runs are crosses at the top."""
    for method, look in looks.items():
        found = _found(results, scene, method)
        kept = [dt for dt in scene.dts if found[dt].lost is None]
        gone = [dt for dt in scene.dts if found[dt].lost is not None]
        numbers = [value(found[dt]) for dt in kept]
        axis.plot(kept, [number for number, _ in numbers], label=method.label, **look)
        hollow = [(dt, number) for dt, (number, is_hollow) in zip(kept, numbers) if is_hollow]
        if hollow:
            white = look | {"linestyle": "", "markerfacecolor": "white"}
            axis.plot(*zip(*hollow), **white)
        top = axis.get_xaxis_transform()
        axis.plot(gone, [0.99] * len(gone), "x", color=look["color"], transform=top)
    axis.set(xscale="log", yscale="log", xlabel="step", ylabel=ylabel)
    axis.set_xticks(scene.dts, [f"{dt:g}" for dt in scene.dts])
    axis.minorticks_off()


def _slope(drift):
    """Size of the drift; hollow where there is none to be seen: then its standard error."""
    if abs(drift.slope) > SIGNIFICANT * drift.uncertainty:
        return abs(drift.slope), False
    return drift.uncertainty, True


def _history(axis, scene, results, looks):
    """Largest error so far against time at the second of the scene's steps."""
    dt = scene.dts[1]
    for method, look in looks.items():
        drift = _found(results, scene, method)[dt]
        line = {"color": look["color"], "linestyle": look["linestyle"]}
        axis.plot(drift.time[1:], drift.largest_so_far[1:], **line)
    axis.set(xscale="log", yscale="log", xlabel="time", ylabel="largest error so far")
    axis.set_title(f"{scene.title}, step {dt:g}", loc="left", fontsize=9)


def draw(path, results):
    """A row of panels for each scene: error over time, largest error, and slope against step."""
    scenes = list(dict.fromkeys(run.scene for run in results))
    looks = appearance(list(dict.fromkeys(run.method for run in results)))
    steps = next(iter(results)).steps
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(
            len(scenes), 3, figsize=(12, 3.6 * len(scenes) + 1), layout="constrained", squeeze=False
        )
        for row, scene in zip(axes, scenes):
            _history(row[0], scene, results, looks)
            _panel(row[1], scene, results, looks, lambda d: (d.largest, False), "largest error")
            _panel(row[2], scene, results, looks, _slope, "drift, energy per unit of time")
        handles, labels = axes[0, 1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper center", ncols=5, fontsize=8)
        note = f"{steps:,} steps; crosses: no longer finite; hollow: no drift, one standard error; "
        note += "charges of the cage: reconstructed"
        figure.supxlabel(note, x=0.995, ha="right", fontsize=7, color="#666666")
        figure.savefig(path)
        plt.close(figure)
