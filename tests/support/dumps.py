"""Made-up dumps of rigid bodies whose motion is known."""

import numpy as np
from click.testing import CliRunner
from scipy.spatial.transform import Rotation

from gearquat_analysis import command

COLUMNS = "id mol type mass xu yu zu vx vy vz"


class Motion:
    """Bodies that move along straight lines and rotate uniformly about a fixed axis in space; all arrays are over
    bodies.

    ``shape`` (n, 3) of the sites from the center of mass, ``of`` (n,) and ``masses`` (n,).
    """

    def __init__(self, counts, seed=1, omega=0.02, linear=(), spread=20.0):
        rng = np.random.default_rng(seed)
        self.of = np.repeat(np.arange(len(counts)), counts)
        self.masses = rng.uniform(1.0, 4.0, len(self.of))
        shape = rng.normal(size=(len(self.of), 3))
        for body in linear:
            shape[self.of == body] *= [0.0, 0.0, 1.0]
        total = np.bincount(self.of, self.masses)
        mean = [np.bincount(self.of, self.masses * x) / total for x in shape.T]
        self.shape = shape - np.transpose(mean)[self.of]
        self.start = Rotation.random(len(counts), rng)
        self.omega = omega * rng.normal(size=(len(counts), 3))
        self.center = rng.uniform(-spread, spread, (len(counts), 3))
        self.velocity = 0.1 * rng.normal(size=(len(counts), 3))

    def centers(self, time):
        return self.center + self.velocity * time

    def turns(self, time):
        """Rotations body -> space."""
        return Rotation.from_rotvec(self.omega * time) * self.start

    def sites(self, time):
        """Positions and velocities (n, 3)."""
        arms = self.turns(time)[self.of].apply(self.shape)
        x = self.centers(time)[self.of] + arms
        return x, self.velocity[self.of] + np.cross(self.omega[self.of], arms)

    def rows(self, time):
        """Columns COLUMNS of all sites, (n, 10)."""
        n = len(self.of)
        keys = np.column_stack([np.arange(n) + 1, self.of + 1, np.ones(n), self.masses])
        return np.hstack([keys, *self.sites(time)])


def frame(step, rows, columns=COLUMNS, box="-50 50", bounds="pp pp pp"):
    """Text of a frame."""
    body = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in rows)
    return (
        f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n{len(rows)}\n"
        f"ITEM: BOX BOUNDS {bounds}\n{box}\n{box}\n{box}\nITEM: ATOMS {columns}\n{body}\n"
    )


def write(path, motion, times, change=None, **header):
    """A dump of a Motion at ``times``; ``change(time, rows)`` may change the rows."""
    change = change or (lambda time, rows: rows)
    path.write_text(
        "".join(frame(k, change(t, motion.rows(t)), **header) for k, t in enumerate(times))
    )
    return path


def analyze(path, out, *arguments):
    """Runs ``gearquat analyze`` with a dump."""
    return CliRunner().invoke(command.analyze, [*map(str, [path, "--out", out, *arguments])])


def columns(path):
    """Columns of a CSV file, by their names."""
    return np.genfromtxt(path, delimiter=",", names=True)
