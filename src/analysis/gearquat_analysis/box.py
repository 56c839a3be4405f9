"""Motion of bodies relative to a box that changes."""

import numpy as np


def carried(x, before, after):
    """Positions x (..., 3) after the box changes from ``before`` to ``after`` (4, 3), each an origin and three edges.

    LAMMPS may flip a tilted box to other edges of the same lattice.  Of the new lattice, the
    vectors that are nearest to the previous edges are used.
    """
    nearest = np.rint(before[1:] @ np.linalg.inv(after[1:]))
    edges = nearest @ after[1:] if np.isclose(abs(np.linalg.det(nearest)), 1.0) else after[1:]
    return after[0] + (x - before[0]) @ (np.linalg.inv(before[1:]) @ edges)


def changes(results):
    """True if results contain boxes, ``cell`` (F, 4, 3), that differ."""
    return "cell" in results and not np.allclose(results.cell[:, 1:], results.cell[0, 1:], rtol=1e-6, equal_nan=True)


def own_motion(results):
    """Centers (F, B, 3) of results, without their displacement by a changing box since the first frame."""
    center = results.center
    if not changes(results):
        return center
    moved = [x - carried(last, *cells) for x, last, *cells in zip(center[1:], center, results.cell, results.cell[1:])]
    return center[0] + np.concatenate([np.zeros((1, *center.shape[1:])), np.cumsum(moved, axis=0)])
