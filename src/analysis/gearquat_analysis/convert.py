"""Trajectories for other viewers: VMD, OVITO, PyMOL and whatever else reads what MDAnalysis writes.

MDAnalysis counts in Å and ps and knows what each format counts in; LAMMPS' units are brought to the
former.  Units *lj* have no such scale: 1 sigma becomes 1 Å and 1 tau 1 ps, and what is written says so.
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

#: formats that say themselves what their atoms are
SELF_CONTAINED = {"PDB", "ENT", "XYZ"}
#: formats with one distance of time for all frames
EVEN = {"DCD", "LAMMPS"}
#: how a writer is told a line of text
REMARK = {"XYZ": "remark", "TRZ": "title"}
REMARK |= dict.fromkeys(["DCD", "LAMMPS", "PDB", "ENT"], "remarks")
#: a frame may be off an even spacing by this part of it
UNEVEN = 1e-4
#: largest position in an xtc file, Å: thousandths of a nm are integers there, and wrap silently
XTC_MOST = 2e7
#: largest integer in the files
MOST = 2**31 - 1


def remark(units):
    """What one unit of LAMMPS is in the files written."""
    length, time = UNITS[units].angstrom, UNITS[units].ps
    length_name, time_name = ("1 sigma", "1 tau") if units == "lj" else ("length 1", "time 1")
    return f"LAMMPS units {units}: {length_name} is {length:g} Angstrom here, {time_name} is {time:g} ps"


def has_times(path):
    """Whether the format of ``path`` holds times; those that say what their atoms are do not."""
    return guess_format(str(path)) not in SELF_CONTAINED


def require_format(path):
    """Raises ValueError if MDAnalysis does not write trajectories in the format that the suffix of ``path`` names."""
    try:
        get_writer_for(str(path), multiframe=True)
    except (TypeError, ValueError) as error:
        known = "one such as dcd, xtc, trr, nc, xyz or pdb is required"
        raise ValueError(f"{path}: MDAnalysis writes no trajectories in this format; {known}") from error


def written_by(path):
    """Files that ``convert`` to ``path`` writes, if coordinates fit into a PDB file."""
    return [path] if not has_times(path) else [path, path.with_suffix(".pdb")]


def convert(atoms, path, units, wrap=False, frames=None, times=None, progress=None):
    """Write ``atoms`` in all frames to ``path``; its suffix names the format (dcd, xtc, pdb, ...).

    ``atoms`` of a dump, in LAMMPS' ``units``.  Bodies are whole.  ``wrap`` puts their centers into the
    box; otherwise they go on beyond it as far as the dump tells.  Along periodic directions the origin
    is the corner of the box.  ``frames``: a slice; ``times`` (F,): of these frames, if known;
    ``progress``: wraps the iterator, such as tqdm.  Formats that hold only positions get a file of the
    first frame beside them: PDB, or XYZ where coordinates do not fit into PDB's columns.

    Returns the files written.  Raises ValueError for a format that MDAnalysis does not write, and for
    frames that it cannot hold.

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
        warnings.simplefilter("ignore")  # of what a dump does not tell and a PDB file has room for
        try:
            with MDAnalysis.Writer(str(path), n_atoms=len(atoms), multiframe=True, **options) as writer:
                for number, ts in enumerate(progress(iterator) if progress else iterator):
                    ts.positions = _placed(ts, bodies, wrap) * length
                    if kind == "XTC" and np.abs(ts.positions).max() > XTC_MOST:
                        raise ValueError(
                            f"{path}: xtc holds positions up to {XTC_MOST:g} Å (2 mm); trr and dcd hold these"
                        )
                    _rescale(ts, length, time)
                    if number == 0 and kind not in SELF_CONTAINED:
                        written.append(_first_frame(atoms, path, units))
                    writer.write(atoms)
        except (NotImplementedError, OSError, RuntimeError) as error:
            raise ValueError(f"{path}: MDAnalysis cannot write it: {error}") from error
    return written


def _rescale(ts, length, time):
    """Everything but the positions of a frame, to MDAnalysis' units."""
    if ts.dimensions is not None:
        ts.dimensions = ts.dimensions * ([length] * 3 + [1.0] * 3)
    if ts.has_velocities:
        ts.velocities = ts.velocities * (length / time)
    ts.data["time"] *= time
    if ts.data["step"] > MOST:  # more than xtc and trr can count
        ts.data["step"] = ts.frame


def _first_frame(atoms, path, units):
    pdb, xyz = path.with_suffix(".pdb"), path.with_suffix(".xyz")
    try:
        atoms.write(str(pdb), remarks=remark(units))
    except ValueError:  # coordinates of more digits than its columns have
        pdb.unlink(missing_ok=True)
        atoms.write(str(xyz), remark=remark(units))
        return xyz
    return pdb


def _spacing(times, path):
    """Options of the writer of a format that keeps the time of its first frame and one distance; ps."""
    dt = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else 1.0
    even = times[0] + dt * np.arange(len(times))
    if dt == 0.0 or np.abs(times - even).max() > UNEVEN * abs(dt):
        raise ValueError(
            f"{path}: this format has one distance of time for all frames, and these are not evenly"
            " spaced: xtc and trr keep the time of each"
        )
    # the first time is istart / nsavc distances
    start = times[0] / dt
    start = Fraction(start).limit_denominator(max(1, min(10**6, int(MOST / (abs(start) + 1)))))
    return {"dt": dt, "istart": start.numerator, "nsavc": start.denominator}


def _bodies(atoms):
    """Bodies of all atoms of the universe; atoms that are in none are bodies of their own."""
    everything = atoms.universe.atoms
    numbers = everything.resids.copy()
    alone = numbers == 0
    numbers[alone] = numbers.max() + 1 + np.arange(alone.sum())
    # centers are only for wrapping: masses do not matter, and not all trajectories have them
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
