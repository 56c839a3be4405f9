"""A head-on collision with a steep wall and a very fast spin: energy against the error estimate.

An error of a position made within a step is an error of the velocity, dx/h, and worth |p| dx/h in
energy; one of an orientation is worth |L| da/h.  The largest of their sums over a run is its
``worth``, and the energy error should be a small multiple of it.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor

TITLE, SECONDS = "Collision with a steep wall, and a very fast spin", 8.0
MOST = 100.0
EVENTS = {"wall": "collision with a wall", "spin": "spin a hundred times thermal"}
END, STEPS = 2.0, (0.004, 0.002, 0.001, 0.0005)
MASS = 9.0
#: further columns of the log: estimates of the fix, velocity and angular momentum of the body
COLUMNS = [f"f_move[{k}]" for k in (5, 7)] + [f"f_move[1][{k}]" for k in (4, 5, 6, 23, 24, 25)]


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


def read(finished):
    """Fast of a run whose log has COLUMNS."""
    thermo = finished.thermo
    values = [thermo[name] for name in COLUMNS]
    momentum = MASS * np.linalg.norm(values[2:5], axis=0)
    spin = np.linalg.norm(values[5:8], axis=0)
    dt = thermo["Time"][-1] / thermo["Step"][-1]
    worth = (momentum * values[0] + spin * values[1]) / dt
    total, kinetic = thermo["v_total"], float(thermo["v_kerot"][0])
    return Fast(thermo["Time"], total - total[0], worth, thermo["c_potential"], kinetic)


def measure(lab, events=tuple(EVENTS), steps=STEPS, **options):
    """(event, formulation, dt) -> Fast."""
    axes = {"event": events, "formulation": FORMULATIONS, "dt": steps}

    def settings(run):
        return {"steps": round(END / run["dt"]), "every": 1, "more": " ".join(COLUMNS)} | options

    return lab.sweep("fast", deck("hard/fast"), axes, read, settings)


def find(results):
    """Finding of what ``measure`` returns."""
    steps = sorted({dt for *_, dt in results}, reverse=True)
    measurements, curves, styles = [], [], {"wall": "-", "spin": "--"}
    for event, formulation in dict.fromkeys(key[:2] for key in results):
        runs = [results[event, formulation, dt] for dt in steps]
        errors = [np.abs(run.error).max() for run in runs]
        what = f"{EVENTS[event]}, {formulation} formulation: error of the energy over the worth"
        what += f" of the estimates, at the worst of {len(steps)} steps"
        remark = f"error of the energy at step {steps[-1]:g}: {errors[-1]:.1e}"
        worst = max(run.ratio for run in runs)
        measurements.append(Measurement(what, worst, spec=".2g", remark=remark, most=MOST))
        label = f"{event}, {formulation}"
        curves.append(Curve(label, np.array(steps), errors, formulation, styles[event], "o"))
        label = "worth of the estimates" if label == "spin, first" else ""
        worth = [run.worth.max() for run in runs]
        curves.append(Curve(label, np.array(steps), worth, "rigid", "", "x"))
    largest = {"log": "xy", "xticks": tuple(steps)}
    panels = (Panel("largest error of the energy", "step", "energy", tuple(curves), **largest),)
    if ("wall", "second", STEPS[1]) in results:
        panels += (_collision(results["wall", "second", STEPS[1]]),)
    spins = [run.kinetic for (event, *_), run in results.items() if event == "spin"]
    context = {"end": END, "steps": STEPS, "spin": spins[0] if spins else None}
    return Finding(measurements, pictures={"fast": panels}, context=context)


def _collision(hit):
    """The collision itself."""
    curves = (
        Curve("error of the energy", hit.time, floor(hit.error, 1e-13), "second"),
        Curve("worth of the estimate", hit.time[1:], floor(hit.worth[1:], 1e-13), "rigid"),
        Curve("potential energy", hit.time, floor(hit.potential, 1e-13), "potential", ":"),
    )
    return Panel(f"wall, second, step {STEPS[1]:g}", "time", "energy", curves)
