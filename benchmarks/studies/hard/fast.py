"""A head-on collision with a steep wall and a very fast spin: energy against the error estimate.

An error of a position made within a step is an error of the velocity, dx/h, and worth |p| dx/h in
energy; one of an orientation is worth |L| da/h.  The largest of their sums over a run is its
``worth``, and the energy error is asked to be a small multiple of it.
"""

from dataclasses import dataclass

import numpy as np

from .case import FORMULATIONS, Case, Curve, Finding, Panel, floor
from benchmarks.engine.tables import Row

ASKED = 100.0
EVENTS = {"wall": "collision with a wall", "spin": "spin a hundred times thermal"}
END, STEPS = 2.0, (0.004, 0.002, 0.001, 0.0005)
MASS = 9.0
COLUMNS = {"estimates": (5, 7), "velocity": (4, 5, 6), "momentum": (23, 24, 25)}


@dataclass(frozen=True)
class Fast:
    """One run: ``time``, ``error`` of the energy and the energy ``worth`` of its estimates, (n,).

    ``potential`` (n,); ``kinetic``: of the rotation at the start.
    """

    time: np.ndarray
    error: np.ndarray
    worth: np.ndarray
    potential: np.ndarray
    kinetic: float

    @property
    def ratio(self):
        """Largest error of the energy over the largest worth of the estimates."""
        return float(np.abs(self.error).max() / self.worth.max())


def columns():
    """Further columns of the log."""
    body = [f"f_move[1][{k}]" for name in ("velocity", "momentum") for k in COLUMNS[name]]
    return [f"f_move[{k}]" for k in COLUMNS["estimates"]] + body


def of_thermo(thermo, dt):
    """Fast of a log with ``columns``."""
    values = [thermo[name] for name in columns()]
    momentum = MASS * np.linalg.norm(values[2:5], axis=0)
    spin = np.linalg.norm(values[5:8], axis=0)
    worth = (momentum * values[0] + spin * values[1]) / dt
    total = thermo["v_total"]
    kinetic = float(thermo["v_kerot"][0])
    return Fast(thermo["Time"], total - total[0], worth, thermo["c_potential"], kinetic)


def judge(results):
    """Rows; ``results``: (event, formulation, dt) -> Fast."""
    rows = []
    steps = sorted({dt for _, _, dt in results}, reverse=True)
    for event, words in EVENTS.items():
        for formulation in FORMULATIONS:
            if (event, formulation, steps[-1]) not in results:
                continue
            ratios = [results[event, formulation, dt].ratio for dt in steps]
            best = results[event, formulation, steps[-1]]
            error = np.abs(best.error).max()
            rows.append(
                Row(
                    f"{words}, {formulation} formulation: error of the energy over the worth of the "
                    f"estimates, at the worst of {len(steps)} steps",
                    f"≤ {ASKED:g}",
                    f"{max(ratios):.2g} (energy at step {steps[-1]:g}: {error:.1e})",
                    bool(max(ratios) <= ASKED),
                )
            )
    return tuple(rows)


def panels(results):
    """Errors and worth against the step, and the collision itself."""
    curves, styles = [], {"wall": "-", "spin": "--"}
    for event in EVENTS:
        for formulation in FORMULATIONS:
            found = [results[event, formulation, dt] for dt in STEPS]
            errors = [np.abs(f.error).max() for f in found]
            label, line = f"{event}, {formulation}", styles[event]
            curves.append(Curve(label, np.array(STEPS), errors, formulation, line, "o"))
            worth = [f.worth.max() for f in found]
            label = "worth of the estimates" if label == "spin, first" else ""
            curves.append(Curve(label, np.array(STEPS), worth, "rigid", "", "x"))
    hit = results["wall", "second", STEPS[1]]
    collision = (
        Curve("error of the energy", hit.time, floor(hit.error, 1e-13), "second"),
        Curve("worth of the estimate", hit.time[1:], floor(hit.worth[1:], 1e-13), "rigid"),
        Curve("potential energy", hit.time, floor(hit.potential, 1e-13), "potential", ":"),
    )
    return (
        Panel("largest error of the energy", "step", "energy", tuple(curves), log="xy"),
        Panel(f"wall, second, step {STEPS[1]:g}", "time", "energy", collision),
    )


def measure(runs, events=tuple(EVENTS), steps=STEPS, **options):
    """(event, formulation, dt) -> Fast."""
    variables = {}
    for event in events:
        for formulation in FORMULATIONS:
            for dt in steps:
                variables[f"{event}-{formulation}-{dt:g}"] = {
                    "event": event,
                    "formulation": formulation,
                    "dt": dt,
                    "steps": round(END / dt),
                    "every": 1,
                    "more": " ".join(columns()),
                } | options
    found = runs.many("fast", variables)
    return {
        (v["event"], v["formulation"], v["dt"]): of_thermo(found[name].thermo, v["dt"])
        for name, v in variables.items()
    }


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    spin = results["spin", "second", STEPS[-1]].kinetic
    text = (
        f"Free top thrown at a Lennard-Jones wall, t = {END:g} at steps of {STEPS[0]:g} to "
        f"{STEPS[-1]:g}; rotational energy of the spin: {spin:.0f} kT, {np.sqrt(spin / 1.5):.0f} times "
        "a thermal angular velocity. The worth of the estimates is |p| dx/dt + |L| da/dt, with the "
        "errors of a step that the fix estimates, dx and da, at its largest."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "fast",
    "Collision with a steep wall, and a very fast spin",
    "Forces and spin change within a few steps.",
    8.0,
    run,
)
