"""Periodic and triclinic boundaries: the trajectory is that in an open box."""

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor

TITLE, SECONDS = "Periodic and triclinic boundaries", 20.0
MOST = 1e-10
STEP = 0.01
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


def measure(lab, places=tuple(PLACES), steps=40_000, **options):
    """(place, box, formulation) -> (time (F,), difference (F,), crossings)."""
    axes = {"place": places, "box": ("open", *CELLS), "formulation": FORMULATIONS}
    settings = {"compensate": "yes", "dt": STEP, "steps": steps, "every": steps // 20, "dump": 50}
    sites = lab.sweep(
        "boundaries", deck("hard/boundaries"), axes, lambda run: run.sites, settings | options
    )
    results = {}
    for (place, box, formulation), there in sites.items():
        if box != "open":
            here = sites[place, "open", formulation]
            off = difference(there.positions, here.positions, CELLS[box])
            count = crossings(here.positions, CELLS[box])
            results[place, box, formulation] = STEP * here.step, off, count
    return results


def find(results):
    """Finding of what ``measure`` returns."""
    measurements = []
    for place, box in dict.fromkeys((place, box) for place, box, _ in results):
        runs = [results[place, box, formulation] for formulation in FORMULATIONS]
        worst = max(off.max() for _, off, _ in runs)
        count = f"{min(number for *_, number in runs):,} crossings or more".replace(",", " ")
        what = f"{PLACES[place]}, {box} box: largest distance of a site from that in an open box"
        measurements.append(Measurement(what, worst, remark=count, most=MOST))
    panels = tuple(_panel(results, box) for box in CELLS)
    return Finding(measurements, pictures={"boundaries": panels}, context={"step": STEP})


def _panel(results, of_box):
    """Differences over time in one box."""
    colors = dict(zip(PLACES, ("potential", "translation", "kinetic")))
    lines = dict(zip(FORMULATIONS, "-:"))
    curves = []
    for (place, box, formulation), (time, off, _) in results.items():
        if box == of_box:
            label = f"{PLACES[place]}, {formulation}"
            curves.append(Curve(label, time, floor(off), colors[place], lines[formulation]))
    return Panel(f"{of_box} box", "time", "distance of a site", tuple(curves))
