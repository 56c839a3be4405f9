"""A random collision of tests/unit/collisions.h, for solvers.py and under a tolerance."""

import ctypes
from collections import namedtuple
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.engine import compiled
from benchmarks.reference.equations import State

#: permutations of columns from the kernel to a packed State, and back
KERNEL = np.r_[0:3, 6:10, 3:6, 10:13]
STATE = np.argsort(KERNEL)
#: a collision with more steps is lost
MOST_STEPS = 100_000
#: ``error``: largest energy error, NaN if the scene is lost; ``depth``: largest potential energy, or initial kinetic
#: energy if it is larger; the others are integers
Followed = namedtuple("Followed", "evaluations error depth steps repeated")


@cache
def library():
    """The compiled kernel.cpp."""
    loaded = compiled.load(Path(__file__).with_name("kernel.cpp"))
    real, whole, place = ctypes.c_double, ctypes.c_int, ctypes.c_void_p
    loaded.collision.argtypes, loaded.collision.restype = [whole, place, place], place
    loaded.calls.argtypes, loaded.calls.restype = [place], ctypes.c_long
    loaded.discard.argtypes = [place]
    loaded.rates.argtypes = loaded.energies.argtypes = [place] * 3
    loaded.follow.argtypes = [place, real, whole, whole, place]
    return loaded


class Scene:
    """Collision number ``which`` in reduced units, from ``start``, a State, until ``time``.

    It has the interface of a Problem of solvers.py, in double precision.
    """

    def __init__(self, which):
        packed, time = np.empty((2, 13)), np.empty(1)
        self._own = library().collision(which, packed.ctypes.data, time.ctypes.data)
        self.start, self.time = State.of(packed[:, STATE]), float(time[0])

    def __del__(self):
        library().discard(self._own)

    def astype(self, _dtype):
        """The scene itself."""
        return self

    @property
    def calls(self):
        """Number of evaluations of forces or energies."""
        return library().calls(self._own)

    def rates(self, _time, y):
        """Time derivative of a packed state, shape (2, 13)."""
        y, found = y.take(KERNEL, axis=1), np.empty((2, 13))
        library().rates(self._own, y.ctypes.data, found.ctypes.data)
        return found.take(STATE, axis=1)

    def energies(self, state):
        """Potential and kinetic energy, shape (2,), of a State."""
        packed, found = state.packed().take(KERNEL, axis=1), np.empty(2)
        library().energies(self._own, packed.ctypes.data, found.ctypes.data)
        return found

    def scales(self, y):
        """Units of absolute tolerances, shape (13,), without the initial distance, at which there is no force."""
        return np.ones(y.shape[1])

    def follow(self, eps, energy):
        """Followed of a run with the tolerance ``eps``, which is an ``energy`` or a length."""
        found = np.empty(5)
        task = (eps, energy, MOST_STEPS, found.ctypes.data)
        library().follow(self._own, *task)
        return Followed(*found.tolist())
