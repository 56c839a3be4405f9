"""Pose, velocity, energy and momentum of every body in every frame, as an MDAnalysis analysis.

    universe = open_dump("water.dump", timestep=1.0)
    poses = Poses(universe.atoms, units="real").run(verbose=True)
    poses.results.center, poses.results.q                    # (F, B, 3), (F, B, 4)
    Poses(universe.atoms).run(backend="multiprocessing", n_workers=2)
    Poses(universe.atoms, out="poses.npy").run()             # limited by disk space, not by memory

All frames of all bodies are in one structured array, ``results.table`` (F, B).  With ``out`` it is a memory-mapped
file, into which each frame is written as soon as it is read.
"""

import csv
import warnings

import numpy as np
from MDAnalysis.analysis.base import AnalysisBase
from MDAnalysis.analysis.results import Results, ResultsGroup
from MDAnalysis.exceptions import NoDataError

from .tables import flat
from .units import UNITS, style_of, unit_of
from . import export
from .bodies import Bodies
from .box import carried
from .report import counted
from .superposition import rotate, superpose

VECTOR, ONE = (float, (3,)), (float,)
POSE = {"center": VECTOR, "q": (float, (4,)), "residual": ONE}
MOTION = {
    "velocity": VECTOR,
    "omega_space": VECTOR,
    "angular_momentum_space": VECTOR,
    "ke_translation": ONE,
    "ke_rotation": ONE,
    "velocity_residual": ONE,
}
POTENTIAL = {"potential": ONE}
#: a body is not rigid if its residual is above this fraction of its size and above this fraction of its coordinates, the
#: largest effect of six digits: 5e-6 of a coordinate in each direction, for a site and its center, in two frames
NOT_RIGID, ROUNDED = 0.05, 4e-5


class _NoResults(Results):
    """Results before a run; any access raises NoDataError."""

    def __getattr__(self, name):
        try:
            return super().__getattr__(name)
        except AttributeError:
            raise NoDataError(f"results.{name} does not exist yet: call run() first") from None


def _flat(records):
    """Fields of records (n,) as columns."""
    return flat({name: records[name] for name in records.dtype.names})


def _require_whole(atoms):
    """Raises ValueError unless ``atoms`` are all atoms of their bodies."""
    left_out = atoms.residues.atoms - atoms
    left_out = left_out[left_out.resids != 0]
    if len(left_out):
        body = left_out[0].residue
        own = len(left_out[left_out.resids == body.resid])
        number = counted(len(left_out.residues), "body", "bodies")
        raise ValueError(
            f"parts of bodies are selected: {counted(len(left_out), 'atom')} of {number} left out, {own} of the"
            f" {len(body.atoms)} of body {body.resid}; whole bodies are required: put the selection between the parentheses of"
            " 'same residue as (...)'"
        )


class Poses(AnalysisBase):
    """Poses and motion of rigid bodies from the positions and velocities of their sites.

    * ``atoms``: AtomGroup or Universe from ``open_dump`` or another trajectory (such as a DCD with a topology, in single
      precision).  Residues are the bodies; residue 0 is not a body.
    * ``reference``: the body frame.  "first": the pose in the first frame; "principal": the shape of the first frame in its
      principal axes, so that q agrees with the fix (except for bodies with equal moments, whose axes are arbitrary); or
      positions (n_atoms, 3) of all atoms, in their order.
    * ``units``: LAMMPS' style of units, if the dump does not have it; energies are in units of this style, or without a
      style in mass x velocity^2.
    * ``potential``: column with potential energies of atoms, given to ``open_dump`` as well.
    * ``out``: file (.npy) for the table; without it the table is in memory.

    Results after ``run``, for F frames and B bodies, in units of the run; ``results.table`` has all as one array:

    * ``step``, ``time`` (F,); ``ids`` (B,)
    * ``cell`` (F, 4, 3): origin and edges of the box; a unit box along directions that are not periodic
    * ``center`` (F, B, 3): center of mass, unwrapped
    * ``q`` (F, B, 4): quaternion, scalar first, body -> space; its sign is continuous in time
    * ``residual`` (F, B): largest distance of a site from its position in the rigid reference
    * ``velocity`` (F, B, 3), ``omega_space`` (F, B, 3): the rigid motion that fits the velocities of the sites best
      (mass-weighted least squares); omega in radians per unit of time
    * ``angular_momentum_space`` (F, B, 3): about the center of mass
    * ``ke_translation``, ``ke_rotation`` (F, B): kinetic energies of the rigid motion
    * ``velocity_residual`` (F, B): largest deviation of a site's velocity from the rigid motion
    * ``potential`` (F, B)

    The six results from ``velocity`` to ``velocity_residual`` exist if the frames have velocities.  ``bodies`` (Bodies) has
    masses, shapes and principal moments.  Sites are treated as points.  The angle about the axis of a linear body is
    undefined: its q is the shortest rotation from the reference, and its omega has no component along the axis.  A point
    has q = 1 0 0 0 and omega = 0.

    If positions are wrapped, bodies are made whole by nearest images (correct if they are smaller than half the box), and
    centers are unwrapped from frame to frame (correct if they move less than half the box).

    Raises ValueError for parts of bodies, bodies without mass, atoms that are in the group twice, a reference of another
    shape and coordinates that are not finite.  ``run`` warns of bodies that are not rigid: their residual is above 5 % of
    the largest distance of a site from the center of mass, and above 4e-5 of a coordinate, the effect of six digits.
    ``results`` raises MDAnalysis' NoDataError before ``run``.

    >>> from gearquat_analysis import Poses, open_dump
    >>> poses = Poses(open_dump("nitrogen.dump").atoms, reference="principal").run(step=100)
    >>> poses.results.center.shape, poses.results.q.shape, poses.unit("omega_space")
    ((9, 64, 3), (9, 64, 4), 'rad/fs')
    >>> bool(poses.results.residual.max() < 1e-7)
    True
    """

    _analysis_algorithm_is_parallelizable = True

    @classmethod
    def get_supported_backends(cls):
        """The serial backend, and the backends of MDAnalysis that use processes."""
        return ("serial", "multiprocessing", "dask")

    def __init__(self, atoms, reference="first", units=None, potential=None, out=None, **kwargs):
        atoms = atoms.atoms
        _require_whole(atoms)
        trajectory = atoms.universe.trajectory
        if len(np.unique(atoms.ix)) < len(atoms):
            raise ValueError("an atom is in the group twice; each is required once (atoms.unique)")
        self.bodies = Bodies(atoms.resids, atoms.masses)
        self.mass, self.ids = self.bodies.mass, self.bodies.ids
        first = trajectory[0]
        if potential and potential not in first.data:
            raise ValueError(f"no column {potential} was read with the dump")
        self.units = style_of(trajectory, units)
        super().__init__(trajectory, **kwargs)
        self.results = _NoResults()
        self.atoms, self._potential, self._wrapped = atoms, potential, False
        self.periodic = np.asarray(first.data.get("periodic", np.ones(3)), dtype=bool)
        self._counted = getattr(trajectory, "counted", False)
        self._energy = UNITS[self.units or "lj"].energy
        moving = "v" in first.data or first.has_velocities
        fields = POSE | (MOTION if moving else {}) | (POTENTIAL if potential else {})
        self._dtype = np.dtype([(name, *kind) for name, kind in fields.items()])
        self._out = None if out is None else str(out)
        self._set_reference(reference)

    def _set_reference(self, reference):
        if isinstance(reference, str):
            if reference not in ("first", "principal"):
                raise ValueError(f"reference {reference}: first, principal or positions are required")
            self._ts = self._trajectory[0]
            self.bodies.set_shape(self._sites()[0], principal=reference == "principal")
            return
        reference = np.asarray(reference, dtype=float)
        if reference.shape != (len(self.atoms), 3):
            raise ValueError(
                f"reference: positions of shape {(len(self.atoms), 3)} are required, not {reference.shape}"
            )
        if not np.isfinite(reference).all():
            raise ValueError("reference: finite numbers are required")
        self.bodies.set_shape(reference[self.bodies.index])

    def _sites(self):
        """Positions (n, 3) of whole bodies, and velocities (n, 3) or None, in the current frame."""
        ts, own = self._ts, self.atoms.ix[self.bodies.index]
        if "x" in ts.data:
            x, v, whole, box = ts.data["x"][own], ts.data.get("v"), ts.data["whole"], ts.data["box"]
        else:
            x = ts.positions[own].astype(float)
            v = ts.velocities if ts.has_velocities else None
            box = ts.triclinic_dimensions
            whole = box is None
        v = None if v is None else v[own].astype(float)
        for name, values in (("position", x), ("velocity", v)):
            if values is not None:
                self._require_finite(f"a site's {name}", values, self.ids[self.bodies.of])
        if not whole:
            self._wrapped = True
            x = self.bodies.whole(x, box, self.periodic)
        return x, v

    def run(self, start=None, stop=None, step=None, frames=None, **kwargs):
        """Same as MDAnalysis' ``AnalysisBase.run``.

        Raises ValueError if no frame is selected.
        """
        number = len(self._trajectory)
        chosen = slice(start, stop, step) if frames is None else frames
        self._row = {frame: row for row, frame in enumerate(np.arange(number)[chosen].tolist())}
        if not self._row:
            raise ValueError("no frame is selected")
        if self._out:
            shape = len(self._row), len(self.ids)
            np.lib.format.open_memmap(self._out, "w+", self._dtype, shape).flush()
        return super().run(start, stop, step, frames, **kwargs)

    def _prepare(self):
        self.results = Results()
        self.results.step = np.zeros(self.n_frames, dtype=np.int64)
        self.results.cell = np.full((self.n_frames, 4, 3), np.nan)
        if not self._out:
            self.results.table = np.zeros((self.n_frames, len(self.ids)), self._dtype)

    def _single_frame(self):
        self.results.step[self._frame_index] = self._step()
        self.results.cell[self._frame_index] = self._cell()
        if self._out:
            # opened for each frame, because a process cannot inherit it
            table, row = np.load(self._out, mmap_mode="r+"), self._row[self._ts.frame]
        else:
            table, row = self.results.table, self._frame_index
        for name, values in self._frame().items():
            table[name][row] = values

    def _frame(self):
        bodies = self.bodies
        x, v = self._sites()
        center = bodies.center(x)
        arms = x - center[bodies.of]
        q, residual = superpose(bodies, arms)
        fields = {"center": center, "q": q, "residual": residual}
        if v is not None:
            # arms of the rigid shape, not of the sites, which would lose digits for thin bodies
            fields |= self._motion(q, rotate(q[bodies.of], bodies.shape), v)
        if self._potential:
            own = self.atoms.ix[bodies.index]
            fields["potential"] = bodies.sum(self._ts.data[self._potential][own])
        return fields

    def _motion(self, q, arms, v):
        """Velocity, angular velocity and derived fields; ``arms`` and ``v`` (n, 3) of the sites."""
        bodies = self.bodies
        velocity = bodies.center(v)
        relative = v - velocity[bodies.of]
        momentum = bodies.sum(bodies.masses[:, None] * np.cross(arms, relative))
        omega = bodies.divided_by_inertia(q, momentum)
        rest = relative - np.cross(omega[bodies.of], arms)
        square = np.einsum("bi,bi->b", velocity, velocity)
        return {
            "velocity": velocity,
            "omega_space": omega,
            "angular_momentum_space": momentum,
            "ke_translation": 0.5 * self._energy * bodies.mass * square,
            "ke_rotation": 0.5 * self._energy * np.einsum("bi,bi->b", omega, momentum),
            "velocity_residual": bodies.largest(np.linalg.norm(rest, axis=1)),
        }

    def _cell(self):
        """Origin and edges (4, 3) of the box; a unit box along directions that are not periodic; NaN without a box."""
        data, free = self._ts.data, ~self.periodic
        box = data.get("box", self._ts.triclinic_dimensions)
        if box is None:
            return np.full((4, 3), np.nan)
        cell = np.vstack([data.get("origin", np.zeros(3)), box]).astype(float)
        cell[0, free], cell[1:][free] = 0.0, np.eye(3)[free]
        return cell

    def _step(self):
        return self._ts.data.get("step", self._ts.frame)

    def _require_finite(self, name, values, ids):
        """Raises ValueError with the ID, from ``ids`` (n,), of the first body whose values (n, ...) are not all finite."""
        bad = np.flatnonzero(~np.isfinite(values).reshape(len(values), -1).all(axis=1))
        if len(bad):
            raise ValueError(
                f"{self._trajectory.filename}, step {self._step()}: {name} {values[bad[0]]} of body {ids[bad[0]]}:"
                " finite numbers are required"
            )

    def _get_aggregator(self):
        return ResultsGroup(dict.fromkeys(("step", "cell", "table"), np.concatenate))

    def _conclude(self):
        results = self.results
        if self._out:
            results.table = np.load(self._out, mmap_mode="r+")
        self._join()
        results.time, results.ids = self.times, self.ids
        for name in self._dtype.names:
            results[name] = results.table[name]
        self._warn_of_bent_bodies()

    def _join(self):
        """Make signs of quaternions continuous in time, and centers as well if positions are wrapped."""
        q, center, cell = self.results.table["q"], self.results.table["center"], self.results.cell
        periodic = self.periodic if self._wrapped else None
        for k in range(1, len(q)):
            turned = np.einsum("bi,bi->b", q[k], q[k - 1]) < 0.0
            q[k, turned] *= -1.0
            if periodic is not None:
                moved = center[k] - carried(center[k - 1], *cell[k - 1 : k + 1])
                center[k] -= np.round(moved @ np.linalg.inv(cell[k, 1:])) * periodic @ cell[k, 1:]

    def _warn_of_bent_bodies(self):
        bodies, (center, residual) = self.bodies, (self.results.center, self.results.residual)
        size = bodies.largest(np.linalg.norm(bodies.shape, axis=1))
        worst = 0.0, 0, 0
        for k in range(len(residual)):
            rounded = residual[k] <= ROUNDED * np.abs(center[k]).max(axis=1)
            ratio = np.where(rounded, 0.0, residual[k]) / np.where(size > 0.0, size, np.inf)
            worst = max(worst, (ratio.max(), k, int(ratio.argmax())))
        ratio, k, body = worst
        if ratio > NOT_RIGID:
            warnings.warn(
                f"{self._trajectory.filename}: body {self.ids[body]} is not rigid: at step {self.results.step[k]} a site"
                f" deviates by {residual[k, body]:.2g} from the rigid body, {ratio:.0%} of the body's size. Check the IDs of"
                " bodies, and that positions are unwrapped at the boundaries of the box.",
                stacklevel=5,
            )

    # --- uses of the table ------------------------------------------------------------
    def totals(self):
        """Sums over the bodies, name -> (F,) or (F, 3); for residuals, the largest value.

        ``momentum`` and ``angular_momentum_space`` (about the origin) need velocities.
        """
        table, mass = self.results.table, self.mass
        names, known = table.dtype.names, "velocity" in table.dtype.names
        scalars = [n for n in names if n.startswith(("ke_", "potential")) or n.endswith("residual")]
        vectors = ["momentum", "angular_momentum_space"] if known else []
        sums = {name: np.empty(len(table)) for name in scalars}
        sums |= {name: np.empty((len(table), 3)) for name in vectors}
        for k in range(len(table)):
            frame = table[k]
            for name in set(sums) & set(names):
                sums[name][k] = (np.max if name.endswith("residual") else np.sum)(frame[name], axis=0)
            if known:
                momentum = mass[:, None] * frame["velocity"]
                sums["momentum"][k] = momentum.sum(axis=0)
                sums["angular_momentum_space"][k] += np.cross(frame["center"], momentum).sum(axis=0)
        return sums

    def unit(self, result):
        """Unit of a result, such as "Å/fs" for ``velocity``; "" without units.

        Times of frames and results from them (lags, diffusion, correlation times) are in steps if neither the dump nor
        ``timestep`` gives times.
        """
        return unit_of(result, self.units, "step" if self._counted else None)

    def to_dataframe(self):
        """pandas.DataFrame with a row for each frame and body, frame by frame; vectors have columns x, y and z."""
        frames, bodies = self.results.table.shape
        columns = {
            "step": np.repeat(self.results.step, bodies),
            "time": np.repeat(self.results.time, bodies),
            "body": np.tile(self.ids, frames),
        }
        units = {"time": self.unit("time")}
        for name in self._dtype.names:
            parts = _flat(self.results.table[[name]].reshape(-1))
            columns |= parts
            units |= dict.fromkeys(parts, self.unit(name))
        return export.dataframe(columns, units)

    def to_csv(self, path, progress=iter):
        """Write a row for each frame and body, with 17 digits; one frame at a time.

        ``progress`` wraps the iteration over frames, as tqdm does.
        """
        with open(path, "w", newline="", encoding="utf-8") as file:
            names = _flat(self.results.table[0])
            csv.writer(file).writerow(["step", "time", "body", *names])
            for k in progress(range(len(self.results.table))):
                keys = [np.full(len(self.ids), self.results[name][k]) for name in ("step", "time")]
                values = np.column_stack([*keys, self.ids, *_flat(self.results.table[k]).values()])
                np.savetxt(file, values, fmt="%.17g", delimiter=",")
