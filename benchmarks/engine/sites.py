"""Sites of a dump, all frames at once."""

from dataclasses import dataclass

import numpy as np

from lammps_gearquat.analysis import open_dump
from benchmarks.reference import bodies_from_sites


@dataclass(frozen=True)
class Sites:
    """The n sites of a dump in F frames; units of the run.

    ``step`` (F,); ``masses`` (n,); ``positions`` and ``velocities`` (F, n, 3).
    """

    step: np.ndarray
    masses: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray

    def start(self):
        """(RigidBodies, State) of the first frame, where all sites are one body."""
        same_body = np.zeros(len(self.masses), dtype=int)
        return bodies_from_sites(self.masses, self.positions[0], self.velocities[0], same_body)


def read_sites(path):
    """Sites of a dump with velocities, in double precision; see analysis.open_dump."""
    universe = open_dump(path)
    frames = [[ts.data[name] for name in ("step", "x", "v")] for ts in universe.trajectory]
    step, positions, velocities = (np.array(column) for column in zip(*frames))
    return Sites(step, universe.atoms.masses, positions, velocities)
