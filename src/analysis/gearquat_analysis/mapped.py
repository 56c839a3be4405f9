"""Arrays in files that are mapped into memory, of which only a little is to be held."""

import mmap

import numpy as np

#: rows that are gone over before their pages are let go
ROWS = 20
#: rows of which a few columns are read before their pages are let go; each is mapped with its neighbors
BLOCK = 500


def release(array):
    """Let go of the pages of a mapped file, or of a field of one; the file keeps what was written.

    Does nothing to an array in memory.
    """
    mapped = getattr(array, "_mmap", None)
    if mapped is not None:
        mapped.madvise(mmap.MADV_DONTNEED)


def rows(array, begin=0):
    """Numbers of the rows of an array, in turn, letting go of its pages on the way."""
    for k in range(begin, len(array)):
        yield k
        if k % ROWS == 0:
            release(array)
    release(array)


class Part:
    """Some columns of an array (F, B, ...), which are read when they are asked for by ``columns``.

    ``own`` (b,): their numbers.  Rows are chosen by a slice: ``part[10:20]``.
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
    """Positions x (..., 3) when the box of ``before`` (4, 3), its origin and its edges, becomes that of ``after``.

    LAMMPS may flip a tilted box, to other edges of the same lattice.  Those edges of that lattice count that are nearest
    to the ones before.
    """
    nearest = np.rint(before[1:] @ np.linalg.inv(after[1:]))
    edges = nearest @ after[1:] if np.isclose(abs(np.linalg.det(nearest)), 1.0) else after[1:]
    return after[0] + (x - before[0]) @ (np.linalg.inv(before[1:]) @ edges)


class OwnMotion:
    """Centers (F, B, 3), an array or a Part, less what a changing box has carried them since the first frame.

    ``cell`` (F, 4, 3): its origins and edges.  Read by ``columns`` as a Part is.

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
    """Centers (F, B, 3), or OwnMotion of them if the box changes, of results with ``cell`` (F, 4, 3) or without."""
    center, cell = results.center, results.cell if "cell" in results else None
    same = cell is None or np.allclose(cell[:, 1:], cell[0, 1:], rtol=1e-6, equal_nan=True)
    return center if same else OwnMotion(center, cell)


def columns(array, own):
    """Columns ``own`` (a slice) of all rows of an array (F, B, ...), a Part or OwnMotion, in memory, as floats."""
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
