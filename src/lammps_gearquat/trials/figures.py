"""The pictures of ``gearquat cost`` and ``gearquat horizon``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from ..style import STYLE  # noqa: E402
from . import evaluate  # noqa: E402
from .cost import NORMS  # noqa: E402

OWN = "#666666"
FORMULATION = {"second": "Blues", "first": "Oranges"}


def _rank(keywords):
    """Sorts methods by formulation and number of values, the deck's own before all."""
    numbers = [int(word) for word in (keywords or "").split() if word.isdigit()]
    return (keywords is not None, "formulation first" in (keywords or ""), numbers)


def _look(keywords, methods):
    """Colour and label of a method: darker for more values."""
    if keywords is None:
        return {"color": OWN, "marker": "s", "label": "the deck's own fix", "zorder": 3}
    family = next((name for name in FORMULATION if f"formulation {name}" in keywords), "second")
    kin = [other for other in methods if other and f"formulation {family}" in other]
    kin.sort(key=_rank)
    place = kin.index(keywords) / max(len(kin) - 1, 1) if keywords in kin else 0.5
    colour = plt.get_cmap(FORMULATION[family])(0.35 + 0.6 * place)
    return {"color": colour, "marker": "o", "label": keywords.replace("formulation ", "")}


def draw_cost(path, deck, costs):
    """Error against evaluations and against seconds, both per unit of time."""
    points = costs.points()
    every = [point for found in points.values() for point in found]
    per = f"per {deck.time_unit or 'time unit'}"
    unit = deck.length_unit if costs.norm < 2 else "rad"
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), sharey=True, layout="constrained")
        for axis, name in zip(axes, ("evaluations", "seconds")):
            for keywords, found in sorted(points.items(), key=lambda item: _rank(item[0])):
                x = [getattr(point, name) / costs.end for point in found]
                look = _look(keywords, points)
                axis.loglog(x, [point.error for point in found], markersize=3, **look)
            best = evaluate.front(every, lambda point: getattr(point, name))
            axis.step(
                [getattr(point, name) / costs.end for point in best],
                [point.error for point in best],
                where="post",
                color="black",
                linewidth=1.2,
                linestyle=":",
                label="Pareto front",
            )
            for error, _, _ in costs.rows:
                axis.axhline(error, color="#999999", linewidth=0.5, zorder=0)
            axis.axhspan(1e-300, costs.doubt, color="#dddddd", zorder=0)
            axis.set_xlabel(f"{'evaluations of the forces' if name[0] == 'e' else name} {per}")
        smallest = min([costs.doubt] + [row[0] for row in costs.rows])
        axes[0].set_ylim(smallest / 3, 3 * max(point.error for point in every))
        axes[0].set_ylabel(f"error: {NORMS[costs.norm]}" + (f" ({unit})" if unit else ""))
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", fontsize=8)
        end = f"{costs.end:.3g} {deck.time_unit}".strip()
        title = f"What accuracy costs: {deck.path.name}, at t = {end}"
        figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
        figure.supxlabel(
            "grey: the reference is not known better",
            x=0.01,
            ha="left",
            fontsize=7,
            color="#666666",
        )
        figure.savefig(path)
        plt.close(figure)


def draw_horizon(path, deck, horizon):
    """Differences against time, with the thresholds and the fitted growth."""
    time = horizon.time
    with plt.rc_context(STYLE):
        figure, axis = plt.subplots(figsize=(8, 4.4), layout="constrained")
        axis.semilogy(time, horizon.largest, color="#0072b2", label="largest distance of a body")
        axis.semilogy(time, horizon.rms, color="#56b4e9", label="rms distance")
        axis.semilogy(time, horizon.angle, color="#d55e00", label="largest angle (radians)")
        growth = horizon.growth
        if growth:
            chosen = (time >= growth.begin) & (time <= growth.end)
            label = f"Lyapunov time {growth.lyapunov_time:.3g} {deck.time_unit}".strip()
            axis.semilogy(
                time[chosen], growth.at(time[chosen]), color="black", linestyle="--", label=label
            )
        for level, parted in horizon.parting:
            axis.axhline(level, color="#888888", linewidth=0.6, linestyle=":")
            if np.isfinite(parted):
                axis.axvline(parted, color="#888888", linewidth=0.6, linestyle=":")
        axis.set_xlabel("time" + (f" ({deck.time_unit})" if deck.time_unit else ""))
        axis.set_ylabel("difference" + (f" ({deck.length_unit})" if deck.length_unit else ""))
        names = [trial.label if trial.keywords else "as it is" for trial in horizon.trials]
        steps = [f"{name}, step {trial.dt:g}" for name, trial in zip(names, horizon.trials)]
        figure.suptitle(
            f"{deck.path.name}: {steps[0]}\nagainst {steps[1]}",
            x=0.01,
            ha="left",
            fontsize=10,
            fontweight="bold",
        )
        axis.legend(fontsize=8)
        figure.savefig(path)
        plt.close(figure)
