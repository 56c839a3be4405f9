"""Forces and potential energy from LAMMPS itself, in this process, for any input script.

The script is read with LAMMPS' own switch -skiprun, so it ends without a single step, as if every ``run`` and
``minimize`` were left out.  The fixes that integrate are then deleted, and every evaluation consists of

    place atoms -> run 1 pre no post no -> read forces

with the neighbor list checked at every evaluation: LAMMPS rebuilds it when an atom has moved half
the skin, and the forces are computed at exactly the given positions, rounded to double.  An atom is
put at the periodic image nearest to where LAMMPS has it, so unwrapped positions may lie anywhere.
"""

import contextlib
import os
import re
import tempfile
from pathlib import Path

import numpy as np

from lammps_gearquat.launch import open_library

from .equations import Problem, bodies_from_sites

#: fixes that integrate; they are deleted, because the reference integrates instead
INTEGRATORS = re.compile(r"(gear/quat|rigid(/nve)?(/small)?(/omp)?|nve(/\w+)?)$")
#: fixes with which a trajectory is not the solution of Newton's equations in a field
NO_REFERENCE = re.compile(
    r"(rigid\S*/(nvt|npt|nph)|nvt|npt|nph|langevin|temp/|press/|shake|rattle|box/relax|deform|move)"
)


class DeckError(ValueError):
    """Raised for an input script that cannot serve as a field; the message states what is required."""


@contextlib.contextmanager
def _inside(folder):
    """Work in ``folder``: scripts name their files relative to it."""
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


class LammpsForces:
    """The field of an input script; see fields.py for what a field is.

    ``ids`` are the atom IDs of the sites, shape (S,), in the order of all positions and forces:
    every atom, rising, until ``choose`` is called.  Atoms not chosen stay where they are.
    ``variables`` as for ``-var``; ``evaluations`` counts.  Close it, or use it as a context.
    """

    dtype = np.float64

    def __init__(self, deck, variables=None):
        self.deck = Path(deck).resolve()
        if not self.deck.is_file():
            raise DeckError(f"{deck}: an input script of LAMMPS is required, there is no such file")
        self.evaluations = 0
        self.lmp = open_library((variables or {}).items(), words=["-skiprun"])
        try:
            self._read()
        except BaseException:
            self.close()
            raise

    def close(self):
        """End LAMMPS; the field is of no use afterwards."""
        if self.lmp is not None:
            self.lmp.close()
        self.lmp = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    # --- the script -----------------------------------------------------------------------------

    def _run(self, action, argument):
        """Call LAMMPS; the plain Exception of its module becomes a DeckError."""
        try:
            action(argument)
        except Exception as error:
            raise DeckError(f"{self.deck.name}: {str(error).strip()}") from error

    def _read(self):
        """Read the script, delete the fixes that integrate, and evaluate once."""
        with _inside(self.deck.parent):
            self._run(self.lmp.file, self.deck.name)
        if not self.lmp.extract_setting("box_exist") or self.lmp.get_natoms() < 1:
            raise DeckError(f"{self.deck.name}: a script that makes a box and atoms is required")
        for dump in self.lmp.available_ids("dump"):
            self._run(self.lmp.command, f"undump {dump}")
        for fix, style in self._fixes().items():
            if NO_REFERENCE.match(style):
                raise DeckError(
                    f"{self.deck.name}: bodies in a fixed field of force are required; with"
                    f" fix {fix} ({style}) there is no reference trajectory"
                )
            if INTEGRATORS.match(style):
                self._run(self.lmp.command, f"unfix {fix}")
        # thermo output with a single keyword, so that only forces and energy are computed
        self._run(
            self.lmp.commands_string,
            "timer timeout off\nrun_style verlet\nthermo_style custom step\nthermo 0\n"
            "neigh_modify once no every 1 delay 0 check yes",
        )
        lo, hi, xy, yz, xz, periodic, _ = self.lmp.extract_box()
        self._periodic = np.array(periodic, dtype=bool)
        self._box = np.diag(np.subtract(hi, lo)) + np.array([[0, xy, xz], [0, 0, yz], [0, 0, 0]])
        self._from_box = np.linalg.inv(self._box)
        self.force_to_acceleration = self.lmp.extract_global("ftm2v")
        self.kinetic_to_energy = self.lmp.extract_global("mvv2e")
        self._all_ids = np.sort(self.per_atom("id", sort=False))
        self._start = self._unwrapped()
        self._run(self.lmp.command, "run 0 post no")
        self.choose(self._all_ids)
        self._refuse_motion()

    def _fixes(self):
        """Style of every fix, by its ID."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "fixes"
            self._run(self.lmp.command, f"info fixes out overwrite {path}")
            text = path.read_text()
        return dict(re.findall(r"^\s*Fix\[.*?\]:\s*(\S+?),\s*style = (\S+?),", text, re.MULTILINE))

    def _refuse_motion(self):
        """Check that no remaining fix moves an atom."""
        self.energy_and_forces(self._start)
        moved = self.per_atom("x") - self._start
        periods = np.where(self._periodic, np.rint(moved @ self._from_box.T), 0)
        distance = np.abs(moved - periods @ self._box.T).max()
        if distance > 1e-9 * max(1.0, np.abs(self._start).max()):
            left = ", ".join(f"{fix} ({style})" for fix, style in self._fixes().items())
            raise DeckError(
                f"{self.deck.name}: only fix gear/quat, fix rigid* and fix nve* may move atoms;"
                f" one of these does: {left}"
            )

    # --- atoms ----------------------------------------------------------------------------------

    def per_atom(self, name, sort=True):
        """A per-atom quantity of LAMMPS, shape (n,) or (n, 3), by rising ID; a copy."""
        values = self._local(name)
        if values is None:
            raise DeckError(f"{self.deck.name}: an atom style with the property {name} is required")
        return values[np.argsort(self._local("id"))] if sort else values.copy()

    def _local(self, name):
        """View of a per-atom array of LAMMPS, in its own order; None if the atoms have none."""
        values = self.lmp.numpy.extract_atom(name)
        return None if values is None else values[: self.lmp.extract_setting("nlocal")]

    def _unwrapped(self):
        """Unwrapped positions of all atoms, shape (n, 3), by rising ID."""
        flags = [self.lmp.decode_image_flags(int(image)) for image in self.per_atom("image")]
        return self.per_atom("x") + np.array(flags) @ self._box.T

    def masses(self):
        """Masses of all atoms, shape (n,), by rising ID."""
        if self.lmp.extract_setting("rmass_flag"):
            return self.per_atom("rmass")
        return self.lmp.numpy.extract_atom("mass")[self.per_atom("type")]

    def start_positions(self):
        """Unwrapped positions of the sites in the script, shape (S, 3)."""
        return self._start[np.searchsorted(self._all_ids, self.ids)]

    def choose(self, ids):
        """Make the atoms with these IDs, in this order, the sites."""
        self.ids = np.asarray(ids)
        unknown = np.setdiff1d(self.ids, self._all_ids)
        if len(unknown):
            raise DeckError(f"{self.deck.name}: there is no atom {unknown[0]}")
        self._row = np.full(len(self._all_ids), -1)
        self._row[np.searchsorted(self._all_ids, self.ids)] = np.arange(len(self.ids))

    # --- the field ------------------------------------------------------------------------------

    def _site_rows(self):
        """Local indices of the sites in LAMMPS, and their rows in the positions."""
        rows = self._row[np.searchsorted(self._all_ids, self._local("id"))]
        here = np.flatnonzero(rows >= 0)
        return here, rows[here]

    def energy_and_forces(self, positions):
        """Potential energy of the whole scene, and forces (S, 3) at unwrapped positions (S, 3)."""
        if positions.shape != (len(self.ids), 3):
            raise ValueError(f"positions of shape {(len(self.ids), 3)} are required")
        self.evaluations += 1
        forces = np.full(positions.shape, np.nan)
        if not np.isfinite(positions).all():  # LAMMPS would never find these atoms again
            return np.nan, forces
        here, rows = self._site_rows()
        x, wanted = self._local("x"), positions[rows]
        away = (wanted - x[here]).astype(np.float64) @ self._from_box.T
        # the shift is taken off before rounding to double: wanted may be of a wider type
        x[here] = wanted - np.where(self._periodic, np.rint(away), 0) @ self._box.T
        self._run(self.lmp.command, "run 1 pre no post no")
        here, rows = self._site_rows()  # a new neighbor list may have sorted the atoms
        forces[rows] = self._local("f")[here]
        return self.lmp.extract_compute("thermo_pe", 0, 0), forces

    def astype(self, _dtype):
        """The field itself: its forces are double whatever the positions are."""
        return self


def deck_problem(deck, variables=None, name=None, dtype=np.longdouble):
    """The Problem of an input script: every molecule (ID above 0) a rigid body, in LAMMPS' field.

    Shapes and start follow from the atoms of the script, exactly as given; atoms without a molecule
    stay fixed.  Bodies that an ``infile`` states otherwise are not known here.
    ``problem.field.ids`` are the atom IDs of the sites.
    """
    field = LammpsForces(deck, variables)
    try:
        molecule = field.per_atom("molecule")
        order = np.argsort(molecule, kind="stable")
        order = order[molecule[order] > 0]
        if not len(order):
            raise DeckError(f"{field.deck.name}: atoms with a molecule ID above 0 are required")
        _, body = np.unique(molecule[order], return_inverse=True)
        velocities, masses = field.per_atom("v")[order], field.masses()[order]
        field.choose(field.per_atom("id")[order])
        bodies, start = bodies_from_sites(masses, field.start_positions(), velocities, body, dtype)
        return Problem(name or field.deck.name, bodies, field, start)
    except BaseException:
        field.close()
        raise
