"""The paper's Figures 2 to 13, and two others.  Nothing is computed here.

Each figure of the paper has the consistent body on the left and the unrotated body on the right, both
with the paper's choices (zero start, no projection).
"""

from functools import partial

import matplotlib.pyplot as plt
import numpy as np

from benchmarks.engine.panels import RECONSTRUCTED, Curve, Panel, draw, draw_panel
from benchmarks.reference import Cage
from gearquat_analysis.style import STYLE

from . import accuracy
from . import divergence as dv
from .claims import THRESHOLDS
from .plan import ACCURACY_END, ACCURACY_STEPS, ACCURATE, AS_PRINTED, FORMULATIONS, ROWS
from .view import Camera, Stage

AS_PAPER = f"zero start and nothing projected, as the paper ran; {RECONSTRUCTED}"

ENERGIES = {"potential": "potential", "kinetic": "kinetic", "total": "total"}
KINETIC = {"translation": "translational", "rotation": "rotational", "kinetic": "total kinetic"}
X = "x of the center of mass"
PLUS, MINUS, EDGE = "#d55e00", "#0072b2", "#c4c4c4"
CAGE, SPACING, CAGE_RADIUS = Cage(float), 100.0, 5.0
#: number in the paper -> (quantity, axis, test case, formulation or None for both)
FIGURES = {
    2: ("energies", "energy", 1, "first"),
    3: ("energies", "energy", 1, "second"),
    4: ("x", X, 1, None),
    5: ("energies", "energy", 2, "first"),
    6: ("energies", "energy", 2, "second"),
    7: ("x", X, 2, None),
    8: ("kinetic energies", "energy", 3, "first"),
    9: ("kinetic energies", "energy", 3, "second"),
    10: ("energies", "energy", 3, "first"),
    11: ("energies", "energy", 3, "second"),
    12: ("trajectory", "center of mass", 3, "first"),
    13: ("trajectory", "center of mass", 3, "second"),
}


def add_cage(stage, width=1.1):
    """The 26 fixed spheres, joined along the edges of the cage."""
    for sign, color in ((1, PLUS), (-1, MINUS)):
        stage.spheres(CAGE.positions[CAGE.charges == sign], CAGE_RADIUS, color)
    for k, one in enumerate(CAGE.positions):
        for other in CAGE.positions[:k]:
            if np.linalg.norm(one - other) < 1.01 * SPACING:
                stage.rod(one, other, EDGE, width, (CAGE_RADIUS, CAGE_RADIUS))


def curves(what, runs):
    """Curves of one panel; ``runs``: formulation -> Series."""
    if what == "x":
        return tuple(
            Curve(f"{f} formulation", run.time, run.center[:, 0], f) for f, run in runs.items()
        )
    (run,) = runs.values()
    if what == "trajectory":
        return tuple(Curve(x, run.time, run.center[:, k], x) for k, x in enumerate("xyz"))
    kinds = ENERGIES if what == "energies" else KINETIC
    return tuple(Curve(label, run.time, getattr(run, kind), kind) for kind, label in kinds.items())


def paper_figure(results, number):
    """The function that draws a figure of the paper into a path."""
    what, ylabel, case, formulation = FIGURES[number]
    formulations = (formulation,) if formulation else FORMULATIONS
    dt, panels = results.fine if case == 1 else None, []
    words = f"Fig. {number}, test case {case}"
    if formulation:
        words += f", {formulation} formulation"
    for row in AS_PRINTED:
        runs = {form: results.get(case, row, form, dt) for form in formulations}
        title, label = f"{words}, {ROWS[row].body} body", "" if panels else ylabel
        panels.append(Panel(title, "time", label, curves(what, runs), log="", legend=False))
    return partial(draw, panels=panels, note=AS_PAPER, share_y=True)


def parting_figure(results):
    """Distance between the formulations for every start, one panel per case (not in the paper)."""
    colors, panels = ("#d55e00", "#e69f00", "#009e73", "#0072b2"), []
    for case, dt in results.step.items():
        shown = []
        for row, color in zip(ROWS.values(), colors):
            pair = [results.get(case, row.key, formulation) for formulation in FORMULATIONS]
            gap = dv.separation(*pair)
            shown.append(Curve(row.label, pair[0].time[: len(gap)][1:], gap[1:], color))
        ends = np.array([0.0, shown[0].x[-1]])
        for apart in THRESHOLDS:
            shown.append(Curve("", ends, 0 * ends + apart, "#888888", ":", width=0.6))
        label = "" if panels else "distance between the centers of mass"
        title = f"case {case}, step {dt:g}"
        panels.append(Panel(title, "time", label, tuple(shown), ylim=(1e-15, 1e4), legend=False))
    return partial(draw, panels=panels, note=RECONSTRUCTED, share_y=True)


# --- the overview -------------------------------------------------------------------------------
LOOKS = {
    accuracy.RIGID: {"color": "#888888", "marker": "s"},
    accuracy.PAPER_SECOND: {"color": "#009e73", "marker": "o", "line": "--"},
    accuracy.PAPER_FIRST: {"color": "#d55e00", "marker": "o", "line": "--"},
    accuracy.FIRST: {"color": "#d55e00", "marker": "o"},
    accuracy.SECOND: {"color": "#009e73", "marker": "o"},
    accuracy.DEFAULT: {"color": "#0072b2", "marker": "o"},
}
PATHS = {1: "#009e73", 3: "#222222"}


def error_panel(results):
    """Error of the center of mass against the step, a curve per method."""
    errors, steps = accuracy.position_errors(results), np.array(ACCURACY_STEPS)
    shown = tuple(
        Curve(label, steps, np.array(errors[label]), **look) for label, look in LOOKS.items()
    )
    title = f"test case 1: error of the center of mass at t = {ACCURACY_END:g}"
    look = {"log": "xy", "xticks": ACCURACY_STEPS, "ylim": (1e-18, 1.0), "legend": False}
    return Panel(title, "step (one evaluation of the forces)", "", shown, **look)


def _paths(stage, results, reach, width):
    """The paths of test cases 1 and 3 with the defaults of the fix, as far as ``reach``."""
    for case, color in PATHS.items():
        path = results.get(case, ACCURATE, "momentum").center
        near = (np.abs(path) < reach).all(axis=1).cumprod().astype(bool)
        stage.lines(path[near], color, width, 1 + len(path[near]) // 4)


def _add_inset(axis, whole, run):
    """A magnified path beside the cage, as seen by the camera of ``whole``."""
    middle, reach = 0.5 * (run.center.min(axis=0) + run.center.max(axis=0)), 18.0
    near = Stage(Camera(tuple(middle), -62.0, 17.0, 150.0), haze=(10.0, 60.0))
    near.lines(run.center, PATHS[1], 1.0, 1 + len(run.center) // 4)
    near.spheres([[SPACING, 0.0, 0.0]], CAGE_RADIUS, PLUS)
    inset = axis.inset_axes((0.66, 0.6, 0.34, 0.4))
    near.draw(inset, reach, reach)
    inset.set(xticks=[], yticks=[], title=f"test case 1 to t = {run.time[-1]:g}")
    inset.title.set_fontsize(8)
    inset.set_axis_on()
    inset.spines[:].set_visible(True)
    (x, y), _, scale = whole.camera.project(middle)
    shown = 2 * reach * scale
    axis.indicate_inset((x - shown / 2, y - shown / 2, shown, shown), inset)


def draw_overview(path, results, until=1000.0):
    """The cage with the two paths, the first also magnified, and errors by step (not in the paper)."""
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(10.4, 4.4), layout="constrained")
        cage, errors = figure.subplots(1, 2, width_ratios=(1.25, 1))
        whole = Stage(Camera((50.0, 0.0, 0.0), -62.0, 17.0, 700.0), haze=(20.0, 260.0))
        add_cage(whole)
        _paths(whole, results, 230.0, 0.8)
        whole.draw(cage, 205.0, 165.0)
        _add_inset(cage, whole, results.get(1, ACCURATE, "momentum").until(until))
        draw_panel(errors, error_panel(results))
        errors.legend(fontsize=7.5, loc="lower right")
        figure.supxlabel(RECONSTRUCTED, x=0.995, ha="right", fontsize=7, color="#666666")
        figure.savefig(path)
        plt.close(figure)


def pictures(results):
    """Name -> function that draws the picture into a path."""
    drawn = {f"figure{number:02d}": paper_figure(results, number) for number in FIGURES}
    overview = partial(draw_overview, results=results)
    return drawn | {"parting": parting_figure(results), "overview": overview}
