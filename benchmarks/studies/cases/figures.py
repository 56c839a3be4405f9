"""Three of the paper's figures, and another one.  Nothing is computed here.

Each figure of the paper has the consistent body on the left and the unrotated body on the right, both
with the paper's choices (zero start, no projection).
"""

from functools import partial

import numpy as np

from benchmarks.engine.panels import RECONSTRUCTED, Curve, Panel, draw

from . import divergence as dv
from .plan import AS_PRINTED, FORMULATIONS, ROWS

AS_PAPER = f"zero start and nothing projected, as the paper ran; {RECONSTRUCTED}"

ENERGIES = {"potential": "potential", "kinetic": "kinetic", "total": "total"}
KINETIC = {"translation": "translational", "rotation": "rotational", "kinetic": "total kinetic"}
X = "x of the center of mass"
#: distance at which the titles call two runs different
APART = 1.0
#: test cases of the picture that is not in the paper, and what it shows
PARTING = {
    1: "In test case 1, an accurate start delays the divergence",
    3: "In test case 3, an accurate start prevents the divergence",
}
#: number in the paper -> (quantity, axis, test case, formulation or None for both)
FIGURES = {
    4: ("x", X, 1, None),
    6: ("energies", "energy", 2, "second"),
    9: ("kinetic energies", "energy", 3, "second"),
}


def curves(what, runs):
    """Curves of one panel; ``runs``: formulation -> Series."""
    if what == "x":
        return tuple(
            Curve(f"{f} formulation", run.time, run.center[:, 0], f) for f, run in runs.items()
        )
    (run,) = runs.values()
    kinds = ENERGIES if what == "energies" else KINETIC
    return tuple(Curve(label, run.time, getattr(run, kind), kind) for kind, label in kinds.items())


def outcome(row, runs):
    """A sentence about the body of a row: when the formulations diverge, or when the only run leaves the cage."""
    name = ROWS[row].body
    if len(runs) > 1:
        time = dv.parting_time(*runs.values(), APART)
        return f"{name.capitalize()} body: the formulations differ by {APART:g} at t = {time:.0f}"
    (time,) = map(dv.leaving_time, runs.values())
    body = f"The {name} body"
    return f"{body} leaves the cage by t = {time:.0f}" if np.isfinite(time) else f"{body} stays in the cage"


def paper_figure(results, number):
    """The function that draws a figure of the paper into a path."""
    what, ylabel, case, formulation = FIGURES[number]
    formulations = (formulation,) if formulation else FORMULATIONS
    panels = []
    for row in AS_PRINTED:
        runs = {form: results.get(case, row, form) for form in formulations}
        label = "" if panels else ylabel
        panels.append(Panel(outcome(row, runs), "time", label, curves(what, runs), log="", legend=False))
    return partial(draw, panels=panels, note=AS_PAPER, share_y=True)


def parting_figure(results):
    """Distance between the formulations for every start in two of the cases (not in the paper)."""
    colors, panels = ("#d55e00", "#e69f00", "#009e73", "#0072b2"), []
    for case, title in PARTING.items():
        shown = []
        for row, color in zip(ROWS.values(), colors):
            pair = [results.get(case, row.key, formulation) for formulation in FORMULATIONS]
            gap = dv.separation(*pair)
            shown.append(Curve(row.label, pair[0].time[: len(gap)][1:], gap[1:], color))
        label = "" if panels else "distance between the centers of mass"
        panels.append(Panel(title, "time", label, tuple(shown), ylim=(1e-15, 1e4), legend=False))
    return partial(draw, panels=panels, note=RECONSTRUCTED, share_y=True)


def pictures(results):
    """Name -> function that draws the picture into a path."""
    drawn = {f"figure{number:02d}": paper_figure(results, number) for number in FIGURES}
    return drawn | {"parting": parting_figure(results)}
