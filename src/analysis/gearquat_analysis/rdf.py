"""Radial distribution functions of sites of different bodies from MDAnalysis' InterRDF, with errors from blocks of the run."""

import numpy as np
from MDAnalysis.analysis.rdf import InterRDF

from .blocks import scatter

#: blocks of the run
BLOCKS = 10


def radial_distribution(atoms, first, second, frames=slice(None), bins=150, longest=None):
    """Distance (n,), g(r) (n,) and its standard error (n,), between two selections of sites in MDAnalysis' syntax.

    Pairs of sites within a body are excluded.  ``longest``: end of the range, by default half of the smallest distance
    between opposite faces of the box.  The error is the scatter of ten blocks of ``frames``; NaN with fewer than ten
    frames.  Raises ValueError if a selection is empty or the box is not periodic in all directions.
    """
    groups = [atoms.select_atoms(words) for words in (first, second)]
    for words, group in zip((first, second), groups):
        if not len(group):
            raise ValueError(f"'{words}' selects no atom")
    trajectory = atoms.universe.trajectory
    if not np.asarray(trajectory[0].data.get("periodic", np.ones(3)), dtype=bool).all():
        raise ValueError("g(r) needs a box that is periodic in all directions")
    if longest is None:
        longest = 0.5 * min(_height(trajectory[k].triclinic_dimensions) for k in (0, -1))
    chosen = np.arange(len(trajectory))[frames]
    parts = [part for part in np.array_split(chosen, min(BLOCKS, len(chosen))) if len(part)]
    found = [_of_frames(*groups, part, bins, longest) for part in parts]
    values = np.array([one.rdf for one in found])
    mean = np.average(values, axis=0, weights=[len(part) for part in parts])
    error = scatter(values) if len(parts) == BLOCKS else np.full(bins, np.nan)
    return found[0].bins, mean, error


def _of_frames(first, second, frames, bins, longest):
    distances = InterRDF(first, second, nbins=bins, range=(0.0, longest), exclude_same="residue")
    return distances.run(frames=frames).results


def _height(box):
    """Smallest distance between opposite faces of a box (3, 3)."""
    return float(np.min(1.0 / np.linalg.norm(np.linalg.inv(box), axis=0)))
