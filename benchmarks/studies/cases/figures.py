"""Draw the paper's Figures 2 to 13, and two of our own, from finished runs.

Nothing is computed here.  Each figure of the paper shows the consistent body left and the unrotated
body right, both as the paper ran them (zero start, nothing projected).
"""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from benchmarks.engine import divergence as dv  # noqa: E402
from lammps_gearquat.style import COLOUR, RECONSTRUCTED, STYLE  # noqa: E402
from . import accuracy  # noqa: E402
from .claims import CAGE, CAGE_CHARGES, CAGE_SPACING  # noqa: E402
from .runs import (  # noqa: E402
    ACCURACY_END,
    ACCURACY_STEPS,
    ACCURATE,
    AS_PRINTED,
    FINE_STEP,
    FORMULATIONS,
    ROWS,
    STEP,
)

AS_PAPER = f"zero start and nothing projected, as the paper ran; {RECONSTRUCTED}"

ENERGIES = {"potential": "potential", "kinetic": "kinetic", "total": "total"}
KINETIC = {"translation": "translational", "rotation": "rotational", "kinetic": "total kinetic"}


def _note(figure, text):
    """A small line at the lower right: what has to be known about the data."""
    figure.supxlabel(text, x=0.995, ha="right", fontsize=7, color="#666666")


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
    _note(figure, AS_PAPER)
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
    """Distance between the formulations for every start, one panel a case (not in the paper)."""
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
    _note(figure, RECONSTRUCTED)
    figure.savefig(path)
    plt.close(figure)


METHOD_LINES = {
    "fix rigid/nve/small": {"color": "#888888", "marker": "s"},
    "the paper's choices, second formulation": {"color": "#56b4e9", "marker": "o", "ls": "--"},
    "the paper's choices, first formulation": {"color": "#e69f00", "marker": "o", "ls": "--"},
    "fix gear/quat, first formulation": {"color": "#d55e00", "marker": "o"},
    "fix gear/quat, second formulation": {"color": "#0072b2", "marker": "o"},
}


def _draw_errors(axis, results):
    """Error of the centre of mass against the step, a line a method."""
    errors = accuracy.position_errors(results)
    for label, line in METHOD_LINES.items():
        axis.loglog(ACCURACY_STEPS, errors[label], label=label, markersize=4, **line)
    axis.invert_xaxis()
    axis.set_xticks(ACCURACY_STEPS, [f"{step:g}" for step in ACCURACY_STEPS])
    axis.minorticks_off()
    axis.set_xlabel("step (one evaluation of the forces each)")
    axis.set_title(
        f"error of the centre of mass at t = {ACCURACY_END:g}, test case 1", fontsize=9, loc="left"
    )
    axis.legend(fontsize=7.5, loc="lower left", handlelength=2.5)
    axis.set_ylim(bottom=1e-15)


def _draw_cage(axis, results):
    """The cage, and the paths of test cases 1 and 3 with the defaults of the fix."""
    for one in CAGE:
        for other in CAGE:
            if np.linalg.norm(one - other) < 1.01 * CAGE_SPACING:
                axis.plot(*np.transpose([one, other]), color="#dddddd", linewidth=0.6)
    for sign, colour in ((-1, "#0072b2"), (1, "#d55e00")):
        spheres = CAGE[CAGE_CHARGES == sign]
        label = "charge +1" if sign > 0 else "charge −1"
        axis.scatter(*spheres.T, s=40, color=colour, linewidths=0, depthshade=False, label=label)
    for case, colour, width in ((1, "#009e73", 0.4), (3, "#222222", 1.0)):
        path = results.get(case, ACCURATE, "second").centre
        near = (abs(path) < 230).all(axis=1).cumprod().astype(bool)
        axis.plot(*path[near].T, color=colour, linewidth=width, label=f"test case {case}")
    axis.set(xlim=(-110, 230), ylim=(-110, 110), zlim=(-110, 110))
    axis.set_box_aspect((3.4, 2.2, 2.2), zoom=1.1)
    axis.set_axis_off()
    axis.view_init(elev=20, azim=-70)
    legend = axis.legend(fontsize=8, loc="lower center", ncols=2, bbox_to_anchor=(0.5, -0.08))
    for line in legend.get_lines():
        line.set_linewidth(2.0)


def draw_overview(path, results):
    """The scene, and what accuracy costs in it (not in the paper)."""
    figure = plt.figure(figsize=(9.6, 4.2), layout="constrained")
    grid = figure.add_gridspec(1, 2, width_ratios=(1, 1.35))
    scene = figure.add_subplot(grid[0], projection="3d")
    errors = figure.add_subplot(grid[1])
    _draw_cage(scene, results)
    _draw_errors(errors, results)
    _note(figure, RECONSTRUCTED)
    figure.savefig(path)
    plt.close(figure)


def draw_all(folder, results):
    """Figures 2 to 13 as ``figure02.png`` …, ``parting.png`` and ``overview.png`` in ``folder``."""
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
        draw_overview(folder / "overview.png", results)
