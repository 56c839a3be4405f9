"""Trajectories for other viewers: VMD, OVITO, PyMOL and whatever else reads what MDAnalysis writes."""

import warnings
from pathlib import Path

import MDAnalysis
import numpy as np
from MDAnalysis.lib.util import guess_format

from .bodies import Bodies

#: formats that say themselves what their atoms are
SELF_CONTAINED = {"PDB", "XPDB", "PQR", "GRO", "XYZ", "MOL2", "LAMMPS"}


def convert(atoms, path, wrap=False, frames=None, progress=None):
    """Write ``atoms`` in all frames to ``path``; its suffix names the format (dcd, xtc, trr, xyz, pdb, ...).

    Bodies are whole.  ``wrap`` puts their centres into the box; otherwise they go on beyond it as far as the dump
    tells.  Along periodic directions the origin is the corner of the box.  ``frames``: a slice; ``progress``: wraps the iterator,
    such as tqdm.  Formats that hold only positions get a PDB file of the first frame beside them.

    Returns the files written.  Raises ValueError for a format that MDAnalysis does not write.
    """
    path, trajectory = Path(path), atoms.universe.trajectory
    try:
        kind = guess_format(str(path))
        writer = MDAnalysis.Writer(str(path), n_atoms=len(atoms), multiframe=True)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: MDAnalysis writes no such format; dcd is one it does") from error
    bodies = _bodies(atoms)
    written = [path]
    iterator = trajectory[frames or slice(None)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what a dump does not tell and a PDB file has room for
        with writer:
            for number, ts in enumerate(progress(iterator) if progress else iterator):
                ts.positions = _placed(ts, bodies, wrap)
                if number == 0 and kind not in SELF_CONTAINED:
                    written.append(path.with_suffix(".pdb"))
                    atoms.write(str(written[-1]))
                writer.write(atoms)
    return written


def _bodies(atoms):
    """Bodies of all atoms of the universe; atoms that are in none are bodies of their own."""
    everything = atoms.universe.atoms
    numbers = everything.resids.copy()
    alone = numbers == 0
    numbers[alone] = numbers.max() + 1 + np.arange(alone.sum())
    # centres are only for wrapping: masses do not matter, and not all trajectories have them
    return Bodies(numbers, np.ones(len(everything)))


def _placed(ts, bodies, wrap):
    """Positions of all atoms, bodies whole, from the corner of the box."""
    box = ts.data.get("box", ts.triclinic_dimensions)
    periodic = ts.data.get("periodic", np.ones(3))
    if "x" in ts.data:
        x = ts.data["x"] - ts.data["origin"] * periodic
    else:
        x = ts.positions.astype(float)
    if box is None or not periodic.any():
        ts.dimensions = None
        return x
    own = x[bodies.index]
    if not ts.data.get("whole", False):
        own = bodies.whole(own, box, periodic)
    if wrap:
        images = np.floor(bodies.centre(own) @ np.linalg.inv(box)) * periodic
        own = own - (images @ box)[bodies.of]
    placed = np.empty_like(x)
    placed[bodies.index] = own
    return placed
