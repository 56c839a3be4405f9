"""A charge passes a bare charge of the other sign: the step has to follow the error."""

import numpy as np

from benchmarks.engine.tables import Row
from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

ASKED = 1e-8
DISTANCES = ("0.02", "0.002")
TOLERANCE, STEP, END = 1e-15, 0.001, 8.0
#: method -> variables of the deck
METHODS = {f"tolerance, {f}": {"formulation": f, "tolerance": TOLERANCE} for f in FORMULATIONS}
METHODS |= {f"step {STEP:g}, {f}": {"formulation": f, "tolerance": 0} for f in FORMULATIONS}
RIGID = "fix rigid/nve/small"
METHODS[RIGID] = {"method": "rigid", "tolerance": 0}


def judge(results):
    """Rows; ``results``: (distance, method) -> thermo table, energy at every step.

    Errors are relative to the depth of the potential that the runs with a tolerance meet.
    """
    rows = []
    for distance in dict.fromkeys(distance for distance, _ in results):
        off = {m: relative_error(results, distance, m).max() for m in METHODS}
        for formulation in FORMULATIONS:
            method = f"tolerance, {formulation}"
            steps = len(results[distance, method]["Step"]) - 1
            what = (
                f"distance {distance}, {method}: error of the energy at every step over the depth"
            )
            rows.append(at_most(what, ASKED, off[method], f"{steps} steps"))
        fixed = [off[f"step {STEP:g}, {formulation}"] for formulation in FORMULATIONS]
        rows.append(
            Row(
                f"distance {distance}, fixed step of {STEP:g} ({END / STEP:.0f} steps), second, first "
                f"formulation and `{RIGID}`: the same",
                f"fails: > {ASKED:.0e}".replace("e-0", "e-"),
                ", ".join(f"{error:.1e}" for error in (*fixed, off[RIGID])),
                bool(min(fixed) > ASKED),
            )
        )
    return tuple(rows)


def depth(results, distance):
    """Depth of the potential met: the smaller one of both runs with a tolerance."""
    found = (results[distance, f"tolerance, {f}"]["c_potential"] for f in FORMULATIONS)
    return min(-float(potential.min()) for potential in found)


def relative_error(results, distance, method):
    """|E(t) - E(0)| over the depth, (n,); infinite where the energy is no number."""
    total = results[distance, method]["v_total"]
    return np.nan_to_num(np.abs(total - total[0]), nan=np.inf) / depth(results, distance)


def panels(results):
    """Errors over time, by distance."""
    looks = {m: (m.split(", ")[-1], "-" if "tol" in m else ":") for m in METHODS}
    looks[RIGID] = ("rigid", ":")
    shown = []
    for distance in DISTANCES:
        curves = []
        for method, (colour, line) in looks.items():
            time, off = results[distance, method]["Time"], relative_error(results, distance, method)
            worst = np.maximum.accumulate(floor(off))[1:]
            kept = np.isfinite(worst)
            curves.append(Curve(method, time[1:][kept], worst[kept], colour, line))
        title = f"distance {distance}: largest error so far"
        shown.append(Panel(title, "time", "energy / depth", tuple(curves), ASKED))
    return tuple(shown)


def measure(runs, distances=DISTANCES, **options):
    """(distance, method) -> thermo table."""
    variables = {}
    for distance in distances:
        for number, own in enumerate(METHODS.values()):
            fixed = {"dt": STEP, "steps": round(END / STEP), "more": "", "until": 0}
            free = {"steps": 1_000_000, "until": END}
            lines = free if own["tolerance"] else fixed
            variables[f"{distance}-{number}"] = {"distance": distance} | lines | own | options
    found = runs.many("encounter", variables, may_fail=True)
    keys = [(distance, method) for distance in distances for method in METHODS]
    return {key: finished.thermo for key, finished in zip(keys, found.values())}


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    depths = " and ".join(f"{depth(results, distance):.0f}" for distance in DISTANCES)
    text = (
        f"`tolerance {TOLERANCE:g}`; the potential energy falls to {depths} below zero. The charges of "
        "the cage are reconstructed."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "encounter",
    "Near-singular encounter",
    "A charge of the body flies by a sphere of the cage with nothing but 1/r between them.",
    8.0,
    run,
)
