"""The symmetric multistep method of order 8 by G. D. Quinlan and S. Tremaine, Astron. J. 100, 1694 (1990).

    sum_k a_k y_{n+k} = h^2 sum_k b_k y''_{n+k},    y = centers and quaternions

It has one evaluation of the forces in a step.  The second derivative of a quaternion contains the angular velocity, so
velocities and angular momenta in space follow from forces and torques by the formula of Adams and Moulton with nine
values.  The history at the start is taken from the reference solution, at one evaluation per step.
"""

import numpy as np

from . import quaternion as qt
from .equations import State
from .integrators import reference_states

LABEL, LENGTH = "Quinlan–Tremaine 8", 8
A = np.array([1, -2, 2, -1, 0, -1, 2, -2])
B = np.array([0, 17671, -23622, 61449, -50516, 61449, -23622, 17671]) / 12096


def adams_moulton(count):
    """Weights (count,), the newest last, of the integral over the last of equal intervals."""
    powers, nodes = np.arange(count), np.arange(1 - count, 1)
    integrals = -((-1.0) ** (powers + 1)) / (powers + 1)
    return np.linalg.solve(np.vander(nodes, increasing=True).T.astype(float), integrals)


class _History:
    """The last poses, second derivatives and loads, the newest last; poses are sums in extended precision."""

    def __init__(self, problem):
        self.problem = problem.astype(np.float64)
        self.poses, self.rates, self.loads = [], [], []

    def load(self, pose):
        """Rotation (B, 3, 3), and acceleration and torque in space (B, 2, 3), at a pose (B, 7)."""
        center, q = pose[:, :3].astype(np.float64), pose[:, 3:].astype(np.float64)
        rotation = qt.rotation_space_body(q)
        _, force, torque_body = self.problem.forces(center, rotation)
        acceleration = force / self.problem.bodies.masses[:, None]
        return rotation, np.stack([acceleration, _turned(rotation, torque_body)], axis=1)

    def append(self, pose, rotation, load, momentum):
        """Add a pose; ``momentum`` (B, 2, 3): velocity and angular momentum in space.  Returns omega_body."""
        moments, q = self.problem.bodies.moments, pose[:, 3:].astype(np.float64)
        back = np.swapaxes(rotation, 1, 2)
        omega = _turned(back, momentum[:, 1]) / moments
        rate = (_turned(back, load[:, 1]) - qt.cross(omega, moments * omega)) / moments
        spin, change = (np.concatenate([w, 0 * w[:, :1]], axis=1) for w in (omega, rate))
        second = qt.product(qt.product(q, spin) / 2, spin) / 2 + qt.product(q, change) / 2
        new = pose, np.concatenate([load[:, 0], second], axis=1), load
        for kept, one in zip((self.poses, self.rates, self.loads), new):
            kept.append(one)
            del kept[: -LENGTH - 1]
        return omega


def _turned(rotation, vectors):
    return (rotation * vectors[:, None, :]).sum(axis=2)


def solve(problem, time, steps):
    """State of a Problem at ``time`` after equal ``steps``, at least LENGTH + 1, and the evaluations."""
    step, history = float(time) / steps, _History(problem)
    known = reference_states(problem, [k * step for k in range(1, LENGTH + 1)])
    for state in (problem.start, *known):
        pose = np.concatenate([state.center, state.q], axis=1)
        spin = problem.angular_momentum_space(state)
        momentum = np.stack([state.velocity, spin], axis=1).astype(np.float64)
        omega = history.append(pose, *history.load(pose), momentum)
    newest = step * adams_moulton(LENGTH + 1)
    for _ in range(steps - LENGTH):
        last = zip(A, step**2 * B, history.poses[1:], history.rates[1:])
        pose = sum(b * rate - a * old for a, b, old, rate in last)
        rotation, load = history.load(pose)
        loads = (*history.loads[1:], load)
        momentum = momentum + sum(w * one for w, one in zip(newest, loads))
        omega = history.append(pose, rotation, load, momentum)
    return State(pose[:, :3], momentum[:, 0], qt.normalised(pose[:, 3:]), omega), steps + 1
