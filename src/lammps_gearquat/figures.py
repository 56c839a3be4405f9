"""Draw the paper's Figures 2 to 13 from finished runs.  Nothing is computed here.

Each figure shows the consistent body left and the unrotated body right, both as the paper ran them
(zero start, nothing projected).
"""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from . import divergence as dv  # noqa: E402
from .cases import AS_PRINTED, FINE_STEP, FORMULATIONS, ROWS, STEP  # noqa: E402

COLOUR = {
    "potential": "#0072b2",
    "kinetic": "#d55e00",
    "total": "#222222",
    "translation": "#009e73",
    "rotation": "#cc79a7",
    "first": "#d55e00",
    "second": "#0072b2",
    "rigid": "#888888",
    "x": "#0072b2",
    "y": "#d55e00",
    "z": "#009e73",
}
STYLE = {
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "lines.linewidth": 0.9,
    "legend.frameon": False,
}

ENERGIES = {"potential": "potential", "kinetic": "kinetic", "total": "total"}
KINETIC = {"translation": "translational", "rotation": "rotational", "kinetic": "total kinetic"}


def _finish(figure, axes, title, ylabel, path):
    """Labels, one legend above the panels, file."""
    for axis in axes:
        axis.set_xlabel("time")
    axes[0].set_ylabel(ylabel)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.suptitle(title, x=0.01, ha="left", fontsize=11, fontweight="bold")
    legend = figure.legend(handles, labels, loc="outside upper right", ncols=len(labels))
    for line in legend.get_lines():
        line.set_linewidth(2.0)
    figure.savefig(path)
    plt.close(figure)


def _panels():
    """Two panels that share their axes."""
    figure, axes = plt.subplots(1, 2, figsize=(10, 3.8), sharey=True, layout="constrained")
    for axis, row in zip(axes, AS_PRINTED):
        axis.set_title(f"{ROWS[row].variables['body']} body", fontsize=10, loc="left")
    return figure, axes


def draw_energies(path, results, case, formulation, kinds, title, dt=None):
    """Energies against time: Figs. 2, 3, 5, 6 and 8 to 11."""
    figure, axes = _panels()
    for axis, row in zip(axes, AS_PRINTED):
        values = results.get(case, row, formulation, dt)
        for kind, label in kinds.items():
            axis.plot(values.time, getattr(values, kind), color=COLOUR[kind], label=label)
    _finish(figure, axes, title, "energy", path)


def draw_x(path, results, case, title, dt=None):
    """x of the centre of mass, both formulations: Figs. 4 and 7."""
    figure, axes = _panels()
    for axis, row in zip(axes, AS_PRINTED):
        for formulation in FORMULATIONS:
            values = results.get(case, row, formulation, dt)
            axis.plot(
                values.time, values.centre[:, 0], color=COLOUR[formulation], label=formulation
            )
    _finish(figure, axes, title, "x of the centre of mass", path)


def draw_trajectory(path, results, case, formulation, title):
    """x, y and z of the centre of mass: Figs. 12 and 13."""
    figure, axes = _panels()
    for axis, row in zip(axes, AS_PRINTED):
        values = results.get(case, row, formulation)
        for column, name in enumerate("xyz"):
            axis.plot(values.time, values.centre[:, column], color=COLOUR[name], label=name)
    _finish(figure, axes, title, "centre of mass", path)


def draw_parting(path, results):
    """Distance between the two formulations for every start, one panel a case (not in the paper)."""
    figure, axes = plt.subplots(1, 3, figsize=(12, 4.2), sharey=True, layout="constrained")
    colours = ("#d55e00", "#e69f00", "#009e73", "#0072b2")
    for axis, (case, dt) in zip(axes, STEP.items()):
        for row, colour in zip(ROWS.values(), colours):
            pair = [results.get(case, row.key, formulation) for formulation in FORMULATIONS]
            gap = dv.separation(*pair)
            label = row.label.split(" (")[0]
            axis.semilogy(pair[0].time[: len(gap)][1:], gap[1:], color=colour, label=label)
        for threshold in (0.1, 1.0, 3.0):
            axis.axhline(threshold, color="#888888", linewidth=0.6, linestyle=":")
        axis.set_title(f"case {case}, step {dt:g}", fontsize=10, loc="left")
        axis.set_xlabel("time")
    axes[0].set_ylim(bottom=1e-15)
    axes[0].set_ylabel("distance between the centres of mass")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.suptitle(
        "How far the two formulations are apart", x=0.01, ha="left", fontsize=11, fontweight="bold"
    )
    figure.legend(handles, labels, loc="outside lower center", ncols=2)
    figure.savefig(path)
    plt.close(figure)


def draw_all(folder, results):
    """Figures 2 to 13 as ``figure02.png`` … and ``parting.png`` in ``folder``."""
    folder.mkdir(parents=True, exist_ok=True)
    fine = FINE_STEP if results.has_full() else None

    def path(number):
        return folder / f"figure{number:02d}.png"

    with plt.rc_context(STYLE):
        for offset, formulation in enumerate(FORMULATIONS):
            name = f"{formulation} formulation"
            title = f"Fig. {2 + offset}  Energies, test case 1, {name}"
            draw_energies(path(2 + offset), results, 1, formulation, ENERGIES, title, fine)
            title = f"Fig. {5 + offset}  Energies, test case 2, {name}"
            draw_energies(path(5 + offset), results, 2, formulation, ENERGIES, title)
            title = f"Fig. {8 + offset}  Kinetic energies, test case 3, {name}"
            draw_energies(path(8 + offset), results, 3, formulation, KINETIC, title)
            title = f"Fig. {10 + offset}  Energies, test case 3, {name}"
            draw_energies(path(10 + offset), results, 3, formulation, ENERGIES, title)
            title = f"Fig. {12 + offset}  Trajectory, test case 3, {name}"
            draw_trajectory(path(12 + offset), results, 3, formulation, title)
        draw_x(path(4), results, 1, "Fig. 4  x, test case 1", fine)
        draw_x(path(7), results, 2, "Fig. 7  x, test case 2")
        draw_parting(folder / "parting.png", results)
