"""Sites of a dump, all frames at once, and errors of the poses of bodies."""

from dataclasses import dataclass

import numpy as np

from scipy.spatial.transform import Rotation

from gearquat_analysis import open_dump
from gearquat_analysis.bodies import Bodies
from gearquat_analysis.superposition import superpose


@dataclass(frozen=True)
class Sites:
    """The n sites of a dump in F frames; units of the run.

    ``step`` (F,); ``masses`` (n,); ``positions`` and ``velocities`` (F, n, 3).
    """

    step: np.ndarray
    masses: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray


def read_sites(path):
    """Sites of a dump with velocities, in double precision; see analysis.open_dump."""
    universe = open_dump(path)
    frames = [[ts.data[name] for name in ("step", "x", "v")] for ts in universe.trajectory]
    step, positions, velocities = (np.array(column) for column in zip(*frames))
    return Sites(step, universe.atoms.masses, positions, velocities)


def pose_errors(masses, molecules, before, after, reference):
    """Root mean squares over the bodies: distance of the centers of mass, angle of orientations.

    ``masses`` and ``molecules`` (n,), 0 for sites in no body; unwrapped positions (n, 3) ``before``,
    which give the shapes, ``after`` and in the ``reference``.  Radians; infinite if a body is
    lost.
    """
    if not np.isfinite(after).all():
        return np.inf, np.inf
    bodies = Bodies(molecules, masses)
    bodies.set_shape(before[bodies.index])
    centers, turns = [], []
    for sites in (reference[bodies.index], after[bodies.index]):
        centers.append(bodies.center(sites))
        q, _ = superpose(bodies, sites - centers[-1][bodies.of])
        turns.append(Rotation.from_quat(q, scalar_first=True))
    shifts = np.linalg.norm(centers[1] - centers[0], axis=1)
    angles = (turns[1] * turns[0].inv()).magnitude()
    return tuple(float(np.sqrt(np.mean(np.square(x)))) for x in (shifts, angles))
