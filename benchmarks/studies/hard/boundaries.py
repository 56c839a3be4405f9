"""Periodic and triclinic boundaries: the trajectory is that in an open box."""

import numpy as np

from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

ASKED = 1e-10
#: edge vectors of the boxes as columns, as in make_boundaries.py
CELLS = {
    "periodic": np.diag([10.0, 10.0, 10.0]),
    "triclinic": np.array([[10.0, 3.0, 2.5], [0.0, 10.0, -2.0], [0.0, 0.0, 10.0]]),
}
PLACES = {"corner": "over a corner", "edge": "over an edge", "flight": "in flight"}
#: LAMMPS writes unwrapped positions with image flags that begin again after so many boxes
TURN = 1024


def difference(there, here, cell):
    """Largest distance of a site in two trajectories (F, n, 3), by frame; turns of flags left out."""
    away = there - here
    turns = TURN * cell
    away = away - np.rint(away @ np.linalg.inv(turns).T) @ turns.T
    return np.linalg.norm(away, axis=2).max(axis=1)


def crossings(positions, cell):
    """How often sites go through a boundary from one frame (F, n, 3) to the next, in all."""
    boxes = np.floor(positions @ np.linalg.inv(cell).T)
    return int(np.abs(np.diff(boxes, axis=0)).sum())


def judge(results):
    """Rows; ``results``: (place, box, formulation) -> (time, difference (F,), crossings)."""
    rows = []
    for place, words in PLACES.items():
        for box in CELLS:
            if (place, box, FORMULATIONS[0]) not in results:
                continue
            found = [results[place, box, f] for f in FORMULATIONS]
            worst = max(off.max() for _, off, _ in found)
            count = min(number for _, _, number in found)
            said = f"{count:,} crossings or more".replace(",", " ")
            what = f"{words}, {box} box: sites against those in an open box, both formulations"
            rows.append(at_most(what, ASKED, worst, said))
    return tuple(rows)


def panels(results):
    """Differences over time, by box."""
    colours = dict(zip(PLACES, ("potential", "translation", "kinetic")))
    shown = []
    for box in CELLS:
        curves = []
        for place, words in PLACES.items():
            for formulation, line in zip(FORMULATIONS, "-:"):
                time, off, _ = results[place, box, formulation]
                label = f"{words}, {formulation}"
                curves.append(Curve(label, time, floor(off), colours[place], line))
        shown.append(Panel(f"{box} box", "time", "distance of a site", tuple(curves), ASKED))
    return tuple(shown)


def measure(runs, places=tuple(PLACES), steps=40_000, **options):
    """(place, box, formulation) -> (time, difference, crossings)."""
    variables = {
        f"{place}-{box}-{formulation}": {
            "place": place,
            "box": box,
            "formulation": formulation,
            "compensate": "yes",
            "dt": 0.01,
            "steps": steps,
            "every": steps // 20,
            "dump": 50,
        }
        | options
        for place in places
        for formulation in FORMULATIONS
        for box in ("open", *CELLS)
    }
    found = runs.many("boundaries", variables)
    results = {}
    for place in places:
        for formulation in FORMULATIONS:
            open_box = found[f"{place}-open-{formulation}"].sites
            time, here = 0.01 * open_box.step, open_box.positions
            for box, cell in CELLS.items():
                there = found[f"{place}-{box}-{formulation}"].sites.positions
                off = difference(there, here, cell)
                results[place, box, formulation] = time, off, crossings(here, cell)
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    text = (
        "Two bodies tied by a bond, t = 400 at a step of 0.01, both formulations with compensated sums. "
        "In flight they are more than 13 000 units away at the end, where the last digit of a position is 1.8e-12. "
        "LAMMPS' image flags count 512 boxes to either side and begin again; the fix does not mind, "
        "unwrapped positions in LAMMPS' dumps do."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "boundaries",
    "Periodic and triclinic boundaries",
    "Sites of one body are wrapped one by one; the body is one all the same.",
    20.0,
    run,
)
