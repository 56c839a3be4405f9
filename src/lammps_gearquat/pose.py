"""Poses of rigid bodies, recovered from a LAMMPS dump that MDAnalysis reads.

The dump needs the columns ``id mol mass x y z`` (and ``vx vy vz`` for kinetic energies), written
with ``dump_modify ... format float %.17g``.  MDAnalysis keeps positions in single precision; the
same columns are therefore read a second time as additional columns, kept in double precision.

A pose is the rigid motion that carries a reference shape onto the dumped sites with the least
mass-weighted squares (Kabsch's superposition by singular value decomposition: W. Kabsch, Acta
Cryst. A32, 922 (1976)).  Frames: ``body`` is that of the reference shape, ``space`` the dump's.
"""

from dataclasses import dataclass

import numpy as np

COLUMNS = ("mol", "mass")
WRAPPED, UNWRAPPED = ("x", "y", "z"), ("xu", "yu", "zu")
VELOCITIES = ("vx", "vy", "vz")


@dataclass(frozen=True)
class Sites:
    """The n sites of one body in F frames; units of the run.

    ``step`` (F,); ``masses`` (n,); ``positions`` (F, n, 3); ``velocities`` (F, n, 3) or None.
    """

    step: np.ndarray
    masses: np.ndarray
    positions: np.ndarray
    velocities: np.ndarray


@dataclass(frozen=True)
class Pose:
    """Where a body is and how far it is from rigid, in one frame.

    ``centre`` (3,), centre of mass; ``rotation`` (3, 3), body -> space, determinant +1;
    ``residual``, largest distance of a site from where the rigid reference would have it.
    """

    centre: np.ndarray
    rotation: np.ndarray
    residual: float


def read_bodies(path, coordinates=WRAPPED):
    """Bodies of a dump: dictionary molecule ID -> Sites; molecule 0 is in no body and left out.

    ``coordinates``: the columns that are positions, WRAPPED or UNWRAPPED.
    """
    from MDAnalysis.coordinates.LAMMPS import DumpReader

    columns = [*COLUMNS, *coordinates, *VELOCITIES]
    with DumpReader(str(path), dt=1.0, additional_columns=columns) as reader:
        frames = [{name: np.array(value) for name, value in frame.data.items()} for frame in reader]
    missing = [name for name in (*COLUMNS, *coordinates) if name not in frames[0]]
    if missing:
        raise ValueError(f"{path}: the dump lacks the column(s) {' '.join(missing)}")

    def gather(names, chosen):
        return np.array([np.column_stack([f[n][chosen] for n in names]) for f in frames])

    bodies = {}
    moving = all(name in frames[0] for name in VELOCITIES)
    step = np.array([frame["step"] for frame in frames])
    for molecule in sorted(set(frames[0]["mol"]) - {0.0}):
        chosen = frames[0]["mol"] == molecule
        velocities = gather(VELOCITIES, chosen) if moving else None
        masses = frames[0]["mass"][chosen]
        bodies[int(molecule)] = Sites(step, masses, gather(coordinates, chosen), velocities)
    return bodies


def centre_of_mass(masses, vectors):
    """Mass-weighted mean of vectors of shape (..., n, 3); shape (..., 3)."""
    return np.einsum("i,...ij->...j", masses, vectors) / masses.sum()


def superpose(masses, reference, positions):
    """Pose that carries ``reference`` (n, 3) onto ``positions`` (n, 3).

    The origin of ``reference`` does not matter; its centre of mass becomes the origin of the body
    frame.  At least three sites that are not on a line make the rotation unique.
    """
    shape = reference - centre_of_mass(masses, reference)
    centre = centre_of_mass(masses, positions)
    arms = positions - centre
    left, _, right = np.linalg.svd((masses[:, None] * arms).T @ shape)
    mirror = np.diag([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation = left @ mirror @ right
    residual = np.linalg.norm(arms - shape @ rotation.T, axis=1).max()
    return Pose(centre, rotation, float(residual))


def inertia_tensor(masses, arms):
    """Inertia tensor (3, 3) of point masses at ``arms`` (n, 3) from their centre of mass."""
    square = np.einsum("ij,ij->i", arms, arms)
    return np.einsum("i,i->", masses, square) * np.eye(3) - (masses[:, None] * arms).T @ arms


@dataclass(frozen=True)
class Motion:
    """Velocity of a body as far as its sites move rigidly, and how far they do not.

    ``velocity`` (3,); ``omega_space`` (3,); ``residual``, largest deviation of a site's velocity
    from v + omega x r; ``translation`` and ``rotation``, kinetic energies.
    """

    velocity: np.ndarray
    omega_space: np.ndarray
    residual: float
    translation: float
    rotation: float


def rigid_motion(masses, positions, velocities):
    """Motion of a body from site positions and velocities, both (n, 3).

    The angular velocity solves I omega = sum m r x v, with the inertia of the sites themselves, so
    the rotational energy is that of a body whose inertia is not overridden by an infile.
    """
    centre, velocity = centre_of_mass(masses, positions), centre_of_mass(masses, velocities)
    arms, relative = positions - centre, velocities - velocity
    momentum = (masses[:, None] * np.cross(arms, relative)).sum(axis=0)
    omega = np.linalg.solve(inertia_tensor(masses, arms), momentum)
    residual = np.linalg.norm(relative - np.cross(omega, arms), axis=1).max()
    translation = 0.5 * masses.sum() * float(velocity @ velocity)
    return Motion(velocity, omega, float(residual), translation, 0.5 * float(omega @ momentum))
