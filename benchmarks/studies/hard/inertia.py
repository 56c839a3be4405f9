"""Small, equal and vanishing moments: full order where the error estimate calls a step right.

Every site is on a spring to where it started, so force and torque act on every body.  The answer is
that of the reference integrator in long double; bodies that it does not know are solved exactly:
equal sites in a line are a pendulum whose centre is a harmonic oscillator, one site is the latter.
"""

from dataclasses import dataclass

import mpmath as mp
import numpy as np

from benchmarks.reference import Problem, State, integrators
from benchmarks.reference.fields import LennardJonesUnits
from benchmarks.engine.tables import Row
from benchmarks.studies.workprecision.judge import pose_errors
from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most

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
#: what is asked an order: position (0), orientation (1); thin bodies go nowhere while they spin
PARTS = {"thin3": (1,), "thin6": (1,), "one": (0,)}
WORDS = {(0,): "position", (1,): "orientation", (0, 1): "position and orientation"}
WITHOUT_AXIS = ("two", "three", "one")
SPRING = 1.0
#: fastest rate of a body: runs have that many radians, in 10, 20, 40 ... steps
RADIANS, COARSEST, HALVINGS = 20.0, 10, 8
#: order with 8 and 6 values, that of the orientation, on which forces depend; how far slopes may fall
ORDERS, LESS = {"second": 7, "first": 6}, 0.4
#: estimates that add up to less call a step right; where they do, errors may not be larger than
RIGHT, WRONG = 1e-3, 1e-2
#: errors below are rounding, (position, orientation): sites of thin6, 0.004 from its axis, turn at 700
ROUNDING = (1e-12, 3e-11)


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
    centre, velocity = start.mean(axis=0), sites.velocities[0].mean(axis=0)
    centre_then = centre + velocity * np.sin(rate * time) / rate
    if len(start) == 1:
        return centre_then[None]
    arms, relative = start - centre, sites.velocities[0] - velocity
    place = np.linalg.norm(arms[0])
    along, swing = arms[0] / place, relative[0] / place
    speed = np.linalg.norm(swing)
    k = mp.mpf(speed / rate) / 2
    half = mp.asin(k * mp.ellipfun("sn", mp.mpf(rate * time), m=k * k))
    angle = float(2 * half)
    turned = np.cos(angle) * along + np.sin(angle) * swing / speed
    return centre_then + np.outer(arms @ along, turned)


def exact(body, sites, time):
    """Sites (n, 3) of a body at ``time``; ``sites``: its Sites, the first frame is the start."""
    if body in WITHOUT_AXIS:
        return _line(sites, time)
    shapes, start = sites.start()
    field = Springs(sites.positions[0].astype(np.longdouble))
    problem = Problem(body, shapes, field, start)
    packed = integrators.integrate(problem, [time]).states[0]
    return problem.site_positions(State.of(packed)).astype(float)


def off(masses, positions, others):
    """(distance of the centres of mass, angle in radians) between two poses of a body, (n, 3).

    The angle of a linear body is that between its axes, a single site has none.
    """
    return pose_errors(masses, np.ones(len(masses), dtype=int), positions, others, positions)


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


def slopes(measured, k):
    """Order of position (k = 0) or orientation (k = 1): slopes between halvings of the step.

    Only pairs count whose coarser step the estimates call right and whose errors are above rounding.
    """
    return [
        float(np.log2(coarse.error[k] / fine.error[k]))
        for coarse, fine in zip(measured, measured[1:])
        if coarse.right and fine.error[k] > ROUNDING[k]
    ]


def order(measured, k):
    """The finest of ``slopes``, NaN if there are none."""
    return (slopes(measured, k) or [float("nan")])[-1]


def judge(results):
    """Rows; ``results``: (body, formulation) -> list of Measured, steps rising."""
    rows = []
    for body, words in BODIES.items():
        if (body, FORMULATIONS[0]) not in results:
            continue
        parts = PARTS.get(body, (0, 1))
        asked = [ORDERS[f] - LESS for f in FORMULATIONS]
        found = [order(results[body, f], k) for f in FORMULATIONS for k in parts]
        least = np.repeat(asked, len(parts))
        rows.append(
            Row(
                f"{words}: order of {WORDS[parts]}, second and first formulation",
                "≥ {:g} and {:g}".format(*asked),
                ", ".join(f"{slope:.1f}" for slope in found),
                bool(np.all(found >= least)),
            )
        )
    right = [m for found in results.values() for m in found if m.right]
    worst = max(max(m.error) for m in right)
    what = f"largest error where the estimates of all steps add up to at most {RIGHT:.0e}"
    rows.append(at_most(what, WRONG, worst, f"{len(right)} runs"))
    return tuple(rows)


def panels(results):
    """Errors of orientation against steps, and against what the estimates add up to."""
    against, promised = [], []
    colours = ("potential", "kinetic", "translation", "rotation", "total", "rigid")
    for (body, formulation), found in results.items():
        kept = [m for m in found if np.isfinite(m.error[1]) and m.error[1] > 0]
        if formulation == "second" and body in ("thin3", "thin6", "two", "ball", "disc", "flat"):
            colour = colours[("thin3", "thin6", "two", "ball", "disc", "flat").index(body)]
            x, y = np.array([(m.steps, m.error[1]) for m in kept]).T
            against.append(Curve(BODIES[body], x, y, colour, "-", "o"))
        if kept:
            x, y = np.array([(m.promise[1], m.error[1]) for m in kept]).T
            label = formulation if body == "thin3" else ""
            promised.append(Curve(label, np.clip(x, 1e-16, 1e2), y, formulation, "", "."))
    line = np.array([1e-15, 1e1])
    promised.append(Curve("equal", line, line, "rigid", ":"))
    return (
        Panel("second formulation", "steps", "error of orientation", tuple(against), log="xy"),
        Panel(
            "all bodies", "estimated, all steps", "error of orientation", tuple(promised), log="xy"
        ),
    )


def measure(runs, bodies=tuple(BODIES), rates=None, **options):
    """(body, formulation) -> list of Measured."""
    rates = rates or {"thin3": 0.7 / 1e-3**0.5, "thin6": 0.7 / 1e-6**0.5}
    variables, times = {}, {}
    for body in bodies:
        times[body] = RADIANS / rates.get(body, 1.0)
        for formulation in FORMULATIONS:
            for steps in (COARSEST * 2**k for k in range(HALVINGS)):
                variables[f"{body}-{formulation}-{steps}"] = {
                    "body": body,
                    "formulation": formulation,
                    "steps": steps,
                    "dt": f"{times[body] / steps:.17g}",
                    "every": 1,
                    "dump": steps,
                    "more": "f_move[5] f_move[7]",
                } | options
    found = runs.many("inertia", variables, may_fail=True)
    results, answers = {}, {}
    for name, v in variables.items():
        finished = found[name]
        estimates = [finished.thermo[column] for column in v["more"].split()]
        promise = tuple(float(np.nan_to_num(e, nan=np.inf).sum()) for e in estimates)
        error = (float("inf"), float("inf"))
        if finished.error:
            promise = error  # the fix has ended the run: it has promised nothing
        else:
            sites = finished.sites
            if v["body"] not in answers:
                answers[v["body"]] = exact(v["body"], sites, times[v["body"]])
            error = off(sites.masses, answers[v["body"]], sites.positions[-1])
        results.setdefault((v["body"], v["formulation"]), []).append(
            Measured(v["steps"], error, promise)
        )
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    text = (
        f"Every site is on a spring; {RADIANS:g} radians of the fastest motion in {COARSEST} to "
        f"{COARSEST * 2 ** (HALVINGS - 1)} steps, defaults of the fix. A step is called right where "
        f"the estimated errors of all steps (columns 5 and 7 of the fix's vector) add up to at most "
        f"{RIGHT:g}; an order is the last slope above rounding. Force and torque depend on orientation, so its order, one less than the number of values in the second formulation, is asked of positions too. The motion of the thin "
        "bodies has equal energy about each axis."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "inertia",
    "Small, equal and vanishing moments of inertia",
    "Thin bodies spin fast about their thin axis; linear ones and single sites lack degrees of "
    "freedom; where moments are equal, principal axes are not unique.",
    45.0,
    run,
)
