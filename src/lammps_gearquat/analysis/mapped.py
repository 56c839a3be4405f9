"""Arrays in files that are mapped into memory, of which only a little is to be held."""

import mmap

#: rows that are gone over before their pages are let go
ROWS = 20


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
