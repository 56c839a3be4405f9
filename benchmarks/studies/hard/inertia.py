"""Small, equal and vanishing moments: full order where the error estimate calls a step right.

Every site is on a spring to where it started, so force and torque act on every body.  The answer is
that of the reference integrator in long double; bodies that it does not know are solved exactly:
equal sites in a line are a pendulum whose center is a harmonic oscillator, one site is the latter.
"""

from dataclasses import dataclass

import mpmath as mp
import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck
from benchmarks.engine.sites import pose_errors
from benchmarks.reference import Problem, integrators
from benchmarks.reference.fields import LennardJonesUnits

TITLE, SECONDS = "Small, equal and vanishing moments of inertia", 45.0
BODIES = {
    "thin3": "I_min/I_max = 1e-3",
    "thin6": "I_min/I_max = 1e-6",
    "two": "two sites, linear",
    "three": "three sites, linear",
    "one": "one site",
    "ball": "spherical top",
    "rod": "symmetric top, prolate",
    "disc": "symmetric top, oblate",
    "flat": "planar",
}
#: parts that have an order: position (0), orientation (1); thin bodies go nowhere while they spin
PARTS = {"thin3": (1,), "thin6": (1,), "one": (0,)}
WORDS = ("position", "orientation")
#: columns of the log: estimated errors of position and orientation in a step
ESTIMATES = ("f_move[5]", "f_move[7]")
WITHOUT_AXIS = ("two", "three", "one")
SPRING = 1.0
#: fastest rate of a body: runs have that many radians, in 10, 20, 40 ... steps
RADIANS, COARSEST, HALVINGS = 20.0, 10, 8
#: order with the defaults in both formulations, and how far slopes may fall
ORDER, LESS = 8, 0.7
#: estimates that add up to less call a step right; where they do, errors may not be larger than
RIGHT, WRONG = 1e-3, 1e-2
#: errors below are rounding, (position, orientation)
ROUNDING = (1e-13, 3e-13)
#: the same of bodies where it is more: sites of thin6, 0.004 from its axis, turn at 700
MORE_ROUNDING = {"thin6": (1e-13, 1e-11)}


class Springs(LennardJonesUnits):
    """Every site on a spring to its anchor; ``anchors`` (S, 3)."""

    def __init__(self, anchors, constant=SPRING):
        self.anchors, self.constant = anchors, constant

    def energy_and_forces(self, positions):
        """Energy, and forces (S, 3) at ``positions`` (S, 3)."""
        away = positions - self.anchors
        return self.constant / 2 * (away * away).sum(), -self.constant * away

    def astype(self, dtype):
        """The same in another float type."""
        return Springs(self.anchors.astype(dtype), self.constant)


def _line(sites, time):
    """Exact sites of equal masses in a line, or of one, at ``time``."""
    mass, start = sites.masses[0], sites.positions[0]
    rate = np.sqrt(SPRING / mass)
    center, velocity = start.mean(axis=0), sites.velocities[0].mean(axis=0)
    center_then = center + velocity * np.sin(rate * time) / rate
    if len(start) == 1:
        return center_then[None]
    arms, relative = start - center, sites.velocities[0] - velocity
    place = np.linalg.norm(arms[0])
    along, swing = arms[0] / place, relative[0] / place
    speed = np.linalg.norm(swing)
    k = mp.mpf(speed / rate) / 2
    angle = float(2 * mp.asin(k * mp.ellipfun("sn", mp.mpf(rate * time), m=k * k)))
    turned = np.cos(angle) * along + np.sin(angle) * swing / speed
    return center_then + np.outer(arms @ along, turned)


def exact(body, sites, time):
    """Sites (n, 3) of a body at ``time``; ``sites``: its Sites, the first frame is the start."""
    if body in WITHOUT_AXIS:
        return _line(sites, time)
    shapes, start = sites.start()
    field = Springs(sites.positions[0].astype(np.longdouble))
    problem = Problem(body, shapes, field, start)
    return problem.site_positions(integrators.integrate(problem, [time])[0]).astype(float)


@dataclass(frozen=True)
class Measured:
    """One run: ``error`` and ``promise``, each (position, orientation); promise: its estimates,
    added up over all steps.  Errors are infinite if the run failed."""

    steps: int
    error: tuple
    promise: tuple

    @property
    def right(self):
        """Whether the estimates call the step right."""
        return max(self.promise) <= RIGHT


def order(measured, k, rounding=ROUNDING):
    """Order of position (k = 0) or orientation (k = 1): slope between the last two steps.

    Only pairs count whose coarser step the estimates call right and whose errors are above rounding;
    NaN if there are none.
    """
    slopes = [
        float(np.log2(coarse.error[k] / fine.error[k]))
        for coarse, fine in zip(measured, measured[1:])
        if coarse.right and fine.error[k] > rounding[k]
    ]
    return slopes[-1] if slopes else float("nan")


def measure(lab, bodies=tuple(BODIES), **options):
    """(body, formulation) -> list of Measured, steps rising."""
    rates = {"thin3": 0.7 / 1e-3**0.5, "thin6": 0.7 / 1e-6**0.5}
    times = {body: RADIANS / rates.get(body, 1.0) for body in bodies}
    answers = {}

    def settings(run):
        dt = f"{times[run['body']] / run['steps']:.17g}"
        return {"dt": dt, "every": 1, "dump": run["steps"], "more": " ".join(ESTIMATES)} | options

    steps = [COARSEST * 2**k for k in range(HALVINGS)]
    axes = {"body": bodies, "formulation": FORMULATIONS, "steps": steps}
    runs = lab.sweep("inertia", deck("hard/inertia"), axes, lambda run: run, settings, may_fail=True)
    results = {}
    for (body, formulation, steps), finished in runs.items():
        promise = error = (float("inf"), float("inf"))
        if not finished.error:  # else the fix has ended the run: it has promised nothing
            promise = tuple(float(finished.thermo[column].sum()) for column in ESTIMATES)
            sites = finished.sites
            if body not in answers:
                answers[body] = exact(body, sites, times[body])
            # the angle of a linear body is that between its axes, a single site has none
            poses, one_body = (answers[body], sites.positions[-1]), np.ones(len(sites.masses), int)
            error = pose_errors(sites.masses, one_body, *poses, answers[body])
        results.setdefault((body, formulation), []).append(Measured(steps, error, promise))
    return results


def find(results):
    """Finding of what ``measure`` returns."""
    measurements = []
    for body in dict.fromkeys(body for body, _ in results):
        for formulation in FORMULATIONS:
            for k in PARTS.get(body, (0, 1)):
                what = f"{BODIES[body]}, {formulation} formulation: order of the {WORDS[k]}"
                rounding = MORE_ROUNDING.get(body, ROUNDING)
                slope = order(results[body, formulation], k, rounding)
                measurements.append(Measurement(what, slope, spec=".1f", least=ORDER - LESS))
    right = [run for runs in results.values() for run in runs if run.right]
    worst = max(max(run.error) for run in right)
    what = f"largest error where the estimates of all steps add up to at most {RIGHT:g}"
    measurements.append(Measurement(what, worst, remark=f"{len(right)} runs", most=WRONG))
    context = {"radians": RADIANS, "coarsest": COARSEST, "right": RIGHT}
    context["finest"] = COARSEST * 2 ** (HALVINGS - 1)
    return Finding(measurements, pictures={"inertia": _panels(results)}, context=context)


def _panels(results):
    """Errors of orientation against steps, and against what the estimates add up to."""
    against, promised = [], []
    shown = ("thin3", "thin6", "two", "ball", "disc", "flat")
    colors = dict(zip(shown, ("potential", "kinetic", "translation", "rotation", "total", "rigid")))
    for (body, formulation), runs in results.items():
        kept = [run for run in runs if np.isfinite(run.error[1]) and run.error[1] > 0]
        if formulation == "second" and body in shown:
            x, y = np.array([(run.steps, run.error[1]) for run in kept]).T
            against.append(Curve(BODIES[body], x, y, colors[body], "-", "o"))
        if kept:
            x, y = np.array([(run.promise[1], run.error[1]) for run in kept]).T
            label = formulation if body == "thin3" else ""
            promised.append(Curve(label, np.clip(x, 1e-16, 1e2), y, formulation, "", "."))
    line = np.array([1e-15, 1e1])
    promised.append(Curve("equal", line, line, "rigid", ":"))
    error, estimate = "error of orientation", "estimated, all steps"
    return (
        Panel("second formulation", "steps", error, tuple(against), log="xy"),
        Panel("all bodies", estimate, error, tuple(promised), log="xy"),
    )
