"""Trajectories for VMD, OVITO, PyMOL and other viewers, written by MDAnalysis.

LAMMPS' units are converted to Å and ps; MDAnalysis converts these to the units of each format.  Units *lj* have no
such scale: 1 sigma becomes 1 Å and 1 tau becomes 1 ps, and a remark in the file says so.
"""

import warnings
from fractions import Fraction
from pathlib import Path

import MDAnalysis
import numpy as np
from MDAnalysis.core._get_readers import get_writer_for
from MDAnalysis.lib.util import guess_format

from .units import UNITS, style_of
from .bodies import Bodies

#: formats that contain the names of their atoms
SELF_CONTAINED = {"PDB", "ENT", "XYZ"}
#: formats with a single time between frames
EVEN = {"DCD", "LAMMPS"}
#: the writer's keyword for a line of text
REMARK = {"XYZ": "remark", "TRZ": "title"}
REMARK |= dict.fromkeys(["DCD", "LAMMPS", "PDB", "ENT"], "remarks")
#: a frame may deviate from even spacing by this fraction of the spacing
UNEVEN = 1e-4
#: largest position in an xtc file, Å: positions are integers in thousandths of a nm, which overflow silently
XTC_MOST = 2e7
#: largest integer in the files
MOST = 2**31 - 1


def remark(units):
    """A line of text with the length and time of one LAMMPS unit in the files written."""
    length, time = UNITS[units].angstrom, UNITS[units].ps
    length_name, time_name = ("1 sigma", "1 tau") if units == "lj" else ("length 1", "time 1")
    return f"LAMMPS units {units}: {length_name} is {length:g} Angstrom here, {time_name} is {time:g} ps"


def has_times(path):
    """True if the format of ``path`` stores times; formats with names of atoms do not."""
    return guess_format(str(path)) not in SELF_CONTAINED


def require_format(path):
    """Raises ValueError if MDAnalysis does not write trajectories in the format that the suffix of ``path`` names."""
    try:
        get_writer_for(str(path), multiframe=True)
    except (TypeError, ValueError) as error:
        known = "one such as dcd, xtc, trr, nc, xyz or pdb is required"
        raise ValueError(f"{path}: MDAnalysis writes no trajectories in this format; {known}") from error


def written_by(path):
    """Files that ``convert`` writes for ``path`` if coordinates fit into a PDB file."""
    return [path] if not has_times(path) else [path, path.with_suffix(".pdb")]


def convert(atoms, path, units, wrap=False, frames=None, times=None, progress=None):
    """Write ``atoms`` in all frames to ``path``; its suffix names the format (dcd, xtc, pdb, ...).

    ``atoms`` are atoms of a dump, in LAMMPS' ``units``.  Bodies are whole.  With ``wrap`` their centers are in the box;
    otherwise positions are unwrapped as far as the dump allows.  Along periodic directions the origin is the corner of
    the box.  ``frames``: a slice; ``times`` (F,): times of these frames, if known; ``progress`` wraps the iterator, as
    tqdm does.  For formats without names of atoms, the first frame is also written to a file of the same name, as PDB, or
    as XYZ if coordinates do not fit into PDB's columns.

    Returns the files written.  Raises ValueError for a format that MDAnalysis does not write, and for
    frames that the format cannot store.

    >>> from gearquat_analysis import open_dump
    >>> from gearquat_analysis.convert import convert
    >>> [str(path) for path in convert(open_dump("nitrogen.dump").atoms, "nitrogen.dcd", "real", frames=slice(10))]
    ['nitrogen.dcd', 'nitrogen.pdb']
    """
    require_format(path)
    path, trajectory = Path(path), atoms.universe.trajectory
    units = style_of(trajectory, units)
    length, time = UNITS[units].angstrom, UNITS[units].ps
    iterator = trajectory[frames or slice(None)]
    kind = guess_format(str(path))
    options = {REMARK[kind]: remark(units)} if kind in REMARK else {}
    if kind in EVEN:
        times = [ts.time for ts in iterator] if times is None else times
        options |= _spacing(np.array(times) * time, path)
    if kind in ("NC", "NCDF"):
        options["velocities"] = trajectory.ts.has_velocities
    bodies = _bodies(atoms)
    written = [path]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about fields of a PDB file that are missing in a dump
        try:
            with MDAnalysis.Writer(str(path), n_atoms=len(atoms), multiframe=True, **options) as writer:
                for number, ts in enumerate(progress(iterator) if progress else iterator):
                    ts.positions = _placed(ts, bodies, wrap) * length
                    if kind == "XTC" and np.abs(ts.positions).max() > XTC_MOST:
                        raise ValueError(
                            f"{path}: xtc stores positions up to {XTC_MOST:g} Å (2 mm) only; use trr or dcd"
                        )
                    _rescale(ts, length, time)
                    if number == 0 and kind not in SELF_CONTAINED:
                        written.append(_first_frame(atoms, path, units))
                    writer.write(atoms)
        except (NotImplementedError, OSError, RuntimeError) as error:
            raise ValueError(f"{path}: MDAnalysis cannot write it: {error}") from error
    return written


def _rescale(ts, length, time):
    """Convert a frame, except its positions, to MDAnalysis' units."""
    if ts.dimensions is not None:
        ts.dimensions = ts.dimensions * ([length] * 3 + [1.0] * 3)
    if ts.has_velocities:
        ts.velocities = ts.velocities * (length / time)
    ts.data["time"] *= time
    if ts.data["step"] > MOST:  # larger step numbers than xtc and trr can store
        ts.data["step"] = ts.frame


def _first_frame(atoms, path, units):
    pdb, xyz = path.with_suffix(".pdb"), path.with_suffix(".xyz")
    try:
        atoms.write(str(pdb), remarks=remark(units))
    except ValueError:  # coordinates have more digits than PDB's columns
        pdb.unlink(missing_ok=True)
        atoms.write(str(xyz), remark=remark(units))
        return xyz
    return pdb


def _spacing(times, path):
    """Options for the writer of a format that stores the time of its first frame and one spacing; ps."""
    dt = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else 1.0
    even = times[0] + dt * np.arange(len(times))
    if dt == 0.0 or np.abs(times - even).max() > UNEVEN * abs(dt):
        raise ValueError(
            f"{path}: this format needs frames that are evenly spaced in time, and these are not:"
            " xtc and trr store the time of each frame"
        )
    # the first time is istart / nsavc spacings
    start = times[0] / dt
    start = Fraction(start).limit_denominator(max(1, min(10**6, int(MOST / (abs(start) + 1)))))
    return {"dt": dt, "istart": start.numerator, "nsavc": start.denominator}


def _bodies(atoms):
    """Bodies of all atoms of the universe; each atom outside of bodies is a separate body."""
    everything = atoms.universe.atoms
    numbers = everything.resids.copy()
    alone = numbers == 0
    numbers[alone] = numbers.max() + 1 + np.arange(alone.sum())
    # centers are only used for wrapping, so equal masses suffice; not all trajectories have masses
    return Bodies(numbers, np.ones(len(everything)))


def _placed(ts, bodies, wrap):
    """Positions of all atoms, bodies whole, from the corner of the box."""
    box, periodic = ts.data["box"], ts.data["periodic"]
    x = ts.data["x"] - ts.data["origin"] * periodic
    if not periodic.any():
        ts.dimensions = None
        return x
    own = x[bodies.index]
    if not ts.data["whole"]:
        own = bodies.whole(own, box, periodic)
    if wrap:
        images = np.floor(bodies.center(own) @ np.linalg.inv(box)) * periodic
        own = own - (images @ box)[bodies.of]
    placed = np.empty_like(x)
    placed[bodies.index] = own
    return placed
