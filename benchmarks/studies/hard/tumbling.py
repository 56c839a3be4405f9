"""A free top near its intermediate axis, for ten million steps, against Jacobi's functions."""

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor
from benchmarks.reference import quaternion as qt
from benchmarks.reference.free_top import FreeTop
from gearquat_analysis import Poses, open_dump

TITLE, SECONDS = "Spin about the intermediate axis", 15.0
MOST = 1e-6
STEP, STEPS, SAMPLES = 0.01, 10_000_000, 200
VALUES = {"second": 10, "first": 8}


def errors(finished, dt):
    """Errors of a dumped free top at its frames after the first, whose motion is the exact one.

    Returns time, angle (radians) between exact and computed orientation, relative errors of the energy
    and of the length of L, each (F - 1,).
    """
    bodies, start = finished.sites.start()
    top = FreeTop(bodies.moments[0], start.omega_body[0], start.q[0])
    momentum = float(np.linalg.norm((bodies.moments * start.omega_body).astype(float)))
    energy = float((bodies.moments * start.omega_body**2).sum()) / 2
    poses = Poses(open_dump(finished.dump, timestep=dt).atoms).run().results
    exact = np.array([top.at(np.longdouble(dt) * step)[0] for step in poses.step])
    turned = np.roll(poses.q[:, 0], -1, axis=1)  # since the first frame; scalar last
    angle = qt.angle_between(turned, qt.product(exact, qt.conjugate(start.q))).astype(float)
    length = np.linalg.norm(poses.angular_momentum_space[:, 0], axis=1)
    off = [np.abs(poses.ke_rotation[:, 0] / energy - 1), np.abs(length / momentum - 1)]
    return np.array([poses.time, angle, *off])[:, 1:]


def measure(lab, steps=STEPS, samples=SAMPLES, **options):
    """formulation -> what ``errors`` returns; ``options``: variables of the deck."""
    every = steps // samples

    def settings(run):
        own = {"values": VALUES[run["formulation"]], "compensate": "yes", "dt": STEP}
        return own | {"steps": steps, "every": every, "dump": every} | options

    axes = {"formulation": FORMULATIONS}
    return lab.sweep(
        "tumbling", deck("hard/tumbling"), axes, lambda run: errors(run, STEP), settings
    )


def find(results, most=MOST):
    """Finding of what ``measure`` returns."""
    measurements, phase, kept = [], [], []
    for formulation, (time, angle, energy, momentum) in results.items():
        name = f"{formulation} formulation: largest"
        measurements += [
            Measurement(f"{name} phase error", angle.max(), unit="rad", most=most),
            Measurement(f"{name} relative error of the energy", energy.max(), most=most),
            Measurement(f"{name} relative error of |L|", momentum.max(), most=most),
        ]
        worst = np.maximum.accumulate(angle)
        phase.append(Curve(formulation, time, floor(worst), formulation))
        kept.append(Curve(f"energy, {formulation}", time, floor(energy), formulation))
        kept.append(Curve(f"|L|, {formulation}", time, floor(momentum), formulation, ":"))
    panels = (
        Panel("largest phase error so far", "time", "radians", tuple(phase), log="xy"),
        Panel("energy and angular momentum", "time", "relative error", tuple(kept), log="xy"),
    )
    context = {"values": VALUES, "steps": STEPS, "step": STEP}
    return Finding(measurements, pictures={"tumbling": panels}, context=context)
