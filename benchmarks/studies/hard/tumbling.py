"""A free top near its intermediate axis, for ten million steps, against Jacobi's functions."""

import numpy as np

from lammps_gearquat.analysis import Poses, open_dump
from benchmarks.reference import quaternion as qt
from benchmarks.reference.free_top import FreeTop
from .case import FORMULATIONS, Case, Curve, Finding, Panel, at_most, floor

ASKED = 1e-6
STEP, STEPS, SAMPLES = 0.01, 10_000_000, 200
VALUES = {"second": 10, "first": 8}


def errors(finished, dt):
    """Errors of a free top that was dumped, at its frames after the first, whose motion is the exact one.

    Returns time, angle (radians) between exact and found orientation, relative error of the energy
    and of the length of L, each (F - 1,).
    """
    bodies, start = finished.sites.start()
    top = FreeTop(bodies.moments[0], start.omega_body[0], start.q[0])
    momentum = float(np.linalg.norm((bodies.moments * start.omega_body).astype(float)))
    energy = float((bodies.moments * start.omega_body**2).sum()) / 2
    found = Poses(open_dump(finished.dump, timestep=dt).atoms).run().results
    exact = np.array([top.at(np.longdouble(dt) * step)[0] for step in found.step])
    turned = np.roll(found.q[:, 0], -1, axis=1)  # since the first frame; scalar last
    angle = qt.angle_between(turned, qt.product(exact, qt.conjugate(start.q))).astype(float)
    length = np.linalg.norm(found.angular_momentum_space[:, 0], axis=1)
    off = [np.abs(found.ke_rotation[:, 0] / energy - 1), np.abs(length / momentum - 1)]
    return np.array([found.time, angle, *off])[:, 1:]


def judge(results, asked=ASKED):
    """Rows; ``results``: formulation -> what ``errors`` returns."""
    rows = []
    for formulation, (_, angle, energy, momentum) in results.items():
        name = f"{formulation} formulation"
        rows += [
            at_most(f"phase error, radians, {name}", asked, angle.max()),
            at_most(f"relative error of the energy, {name}", asked, energy.max()),
            at_most(f"relative error of |L|, {name}", asked, momentum.max()),
        ]
    return tuple(rows)


def panels(results):
    """Phase over time, and energy and |L| over time."""
    phase, kept = [], []
    for formulation, (time, angle, energy, momentum) in results.items():
        worst = np.maximum.accumulate(angle)
        phase.append(Curve(formulation, time, floor(worst), formulation))
        kept.append(Curve(f"energy, {formulation}", time, floor(energy), formulation))
        kept.append(Curve(f"|L|, {formulation}", time, floor(momentum), formulation, ":"))
    return (
        Panel("largest phase error so far", "time", "radians", tuple(phase), ASKED, "xy"),
        Panel("energy and angular momentum", "time", "relative error", tuple(kept), ASKED, "xy"),
    )


def measure(runs, steps=STEPS, samples=SAMPLES, **options):
    """formulation -> what ``errors`` returns; ``options``: variables of the deck."""
    every = steps // samples
    variables = {
        formulation: {
            "formulation": formulation,
            "values": VALUES[formulation],
            "compensate": "yes",
            "dt": STEP,
            "steps": steps,
            "every": every,
            "dump": every,
        }
        | options
        for formulation in FORMULATIONS
    }
    found = runs.many("tumbling", variables)
    return {name: errors(finished, STEP) for name, finished in found.items()}


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    values = " and ".join(f"{VALUES[f]} values in the {f} formulation" for f in FORMULATIONS)
    text = (
        f"{values}, `compensate yes`, {STEPS:,} steps of {STEP:g}, against the solution by Jacobi's "
        "elliptic functions from the dumped start. Without compensated sums rounding of the energy "
        "shifts the period, and the phase error grows with the square of time."
    ).replace(",000", " 000")
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "tumbling",
    "Spin about the intermediate axis",
    "The top turns over again and again; how long it waits in between depends on the last digits of "
    "its energy and angular momentum.",
    15.0,
    run,
)
