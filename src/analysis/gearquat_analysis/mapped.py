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


def columns(array, own):
    """Columns ``own`` (a slice) of all rows of an array (F, B, ...), in memory, as floats."""
    held = np.empty((len(array), own.stop - own.start, *array.shape[2:]))
    for begin in range(0, len(array), BLOCK):
        held[begin : begin + BLOCK] = array[begin : begin + BLOCK, own]
        release(array)
    return held
