"""Arrays in memory-mapped files, processed with only a few pages in memory."""

import mmap

import numpy as np

#: rows that are processed before their pages are released
ROWS = 20
#: rows that are read before their pages are released, if only a few columns are read
BLOCK = 500


def release(array):
    """Release the pages of a memory-mapped array, or of a field of one; the file keeps the data.

    Does nothing to an array in memory.
    """
    mapped = getattr(array, "_mmap", None)
    if mapped is not None:
        mapped.madvise(mmap.MADV_DONTNEED)


def rows(array, begin=0):
    """Iterate over the indices of rows of an array, releasing its pages regularly."""
    for k in range(begin, len(array)):
        yield k
        if k % ROWS == 0:
            release(array)
    release(array)


class Part:
    """Some columns of an array (F, B, ...), which ``columns`` reads on demand.

    ``own`` (b,): numbers of the columns.  Rows are selected by a slice: ``part[10:20]``.
    """

    def __init__(self, array, own):
        nested = isinstance(array, Part)
        self.array, self.own = (array.array, array.own[own]) if nested else (array, np.asarray(own))
        self.shape = len(self.array), len(self.own), *self.array.shape[2:]

    def __len__(self):
        return self.shape[0]

    def __getitem__(self, frames):
        return Part(self.array[frames], self.own)


def carried(x, before, after):
    """Positions x (..., 3) after the box changes from ``before`` to ``after`` (4, 3), each an origin and three edges.

    LAMMPS may flip a tilted box to other edges of the same lattice.  The edges used are vectors of the new lattice that
    are nearest to the edges before.
    """
    nearest = np.rint(before[1:] @ np.linalg.inv(after[1:]))
    edges = nearest @ after[1:] if np.isclose(abs(np.linalg.det(nearest)), 1.0) else after[1:]
    return after[0] + (x - before[0]) @ (np.linalg.inv(before[1:]) @ edges)


class OwnMotion:
    """Centers (F, B, 3), an array or a Part, without their displacement by a changing box since the first frame.

    ``cell`` (F, 4, 3): origins and edges of the box.  ``columns`` reads it like a Part.

    >>> import numpy as np
    >>> from gearquat_analysis.mapped import OwnMotion, columns
    >>> cell = np.array([np.vstack([np.zeros(3), size * np.eye(3)]) for size in (1.0, 1.1)])
    >>> bool(np.allclose(columns(OwnMotion(np.array([[[5.0] * 3], [[5.6] * 3]]), cell), slice(0, 1))[1], 5.1))
    True
    """

    def __init__(self, array, cell):
        self.array, self.cell, self.shape = array, cell, array.shape

    def __len__(self):
        return self.shape[0]


def own_motion(results):
    """Centers (F, B, 3) of results, or their OwnMotion if results contain ``cell`` (F, 4, 3) and the box changes."""
    center, cell = results.center, results.cell if "cell" in results else None
    same = cell is None or np.allclose(cell[:, 1:], cell[0, 1:], rtol=1e-6, equal_nan=True)
    return center if same else OwnMotion(center, cell)


def columns(array, own):
    """Read columns ``own`` (a slice) of all rows of an array (F, B, ...), Part or OwnMotion into an array of floats."""
    if isinstance(array, OwnMotion):
        held = columns(array.array, own)
        moved = [x - carried(last, *cells) for x, last, *cells in zip(held[1:], held, array.cell, array.cell[1:])]
        held[1:] = held[0] + np.cumsum(moved, axis=0)
        return held
    if isinstance(array, Part):
        own, array = array.own[own], array.array
    number = len(own) if isinstance(own, np.ndarray) else own.stop - own.start
    held = np.empty((len(array), number, *array.shape[2:]))
    for begin in range(0, len(array), BLOCK):
        held[begin : begin + BLOCK] = array[begin : begin + BLOCK, own]
        release(array)
    return held
