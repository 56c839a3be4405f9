"""The kernel with any coefficients: kernel.cpp, compiled and loaded."""

import ctypes
import math
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.engine import compiled
from benchmarks.reference.correctors import completed
from benchmarks.reference.stability import (
    first_order_coefficients,
    first_step,
    second_order_coefficients,
    second_step,
)

#: error of a motion that does not stay finite
LOST = 1e3
MOST = 12
VALUES = {"first": range(3, 9), "second": range(4, 13)}
#: numbers of values of the second formulation for runs without a projection
NO_PROJECTION = (5, 7, 9)
_ROWS = ctypes.c_double * MOST


class _Corrector(ctypes.Structure):
    _fields_ = [(name, ctypes.c_int) for name in ("second", "values", "passes", "compensate", "any_norm")]
    _fields_ += [("sets", _ROWS * 2)]


@cache
def library():
    """The compiled kernel.cpp."""
    loaded = compiled.load(Path(__file__).with_name("kernel.cpp"))
    real, whole = ctypes.c_double, ctypes.c_int
    numbers, corrector = ctypes.POINTER(real), ctypes.POINTER(_Corrector)
    loaded.libration.argtypes = [corrector, real, whole, numbers, real]
    loaded.free_top.argtypes = [corrector, real, real]
    loaded.cage.argtypes = [corrector, real, whole, real, numbers]
    loaded.noise.argtypes = [corrector]
    loaded.tuned_tail.argtypes = [whole, whole, whole, whole, numbers, numbers]
    for function in (loaded.libration, loaded.free_top, loaded.noise):
        function.restype = real
    return loaded


@dataclass(frozen=True)
class Corrector:
    """Two ``sets`` of coefficients c_0 ... c_(N-1) of a ``formulation``, fractions or numbers.

    The first set is for rows that forces drive, the second for rows that integrate these; in the second
    formulation both are equal.  The motions return LOST if they do not stay finite.  ``passes``: number of corrections of
    the rotation, 0 for corrections until convergence.  ``any_norm``: without a projection; the second formulation
    then has 5, 7 or 9 values.
    """

    formulation: str
    sets: tuple
    passes: int = 2
    any_norm: bool = False

    @property
    def values(self):
        """N."""
        return len(self.sets[0])

    @property
    def order(self):
        """Order of the equations."""
        return 2 if self.formulation == "second" else 1

    def step(self, omega_h, rate=0.0, passes=1, number=float):
        """Matrix of one step, see stability.py; ``number``: type of its elements."""
        sets = [np.array([number(x) for x in c]) for c in self.sets]
        if self.order == 2:
            return second_step(sets[0], omega_h, rate, passes)
        return first_step(*sets, omega_h, rate=rate, passes=passes)

    def moved(self, by):
        """The Corrector with a number added to c_0 of both sets."""
        return replace(self, sets=tuple((c[0] + by, *c[1:]) for c in self.sets))

    @property
    def floats(self):
        """The sets as arrays of floats."""
        return [np.array(c, dtype=float) for c in self.sets]

    def _passed(self, compensate=False):
        sets = (_ROWS * 2)(*(_ROWS(*c) for c in self.floats))
        words = self.order == 2, self.values, self.passes, compensate, self.any_norm
        return ctypes.byref(_Corrector(*words, sets))

    def libration(self, h, frequency, amplitude, steps):
        """Energy change of a body in potential wells, relative to its initial kinetic energy."""
        return library().libration(
            self._passed(), h, steps, (ctypes.c_double * 3)(*frequency), amplitude
        )

    def free_top(self, h, time):
        """Relative energy change of a free top with an angular velocity of 1.2."""
        return library().free_top(self._passed(), h, time)

    def cage(self, h, seed=0, time=200.0, compensate=False):
        """Center of mass (3,) in the paper's cage; ``seed``: seed of another start, 0 for the paper's start."""
        center = (ctypes.c_double * 3)()
        library().cage(self._passed(compensate), time / round(time / h), seed, time, center)
        return np.array(center)

    @property
    def noise(self):
        """Noise gain: mean square effect of random forces on the velocity, relative to the exact one."""
        return library().noise(self._passed())


def gear(formulation, values):
    """The classical Corrector."""
    made = second_order_coefficients if formulation == "second" else first_order_coefficients
    return Corrector(formulation, (tuple(made(values)),) * 2)


def tuned(formulation, values, any_norm=False):
    """The Corrector of src/GEARQUAT/gear_quat_tuned.h, None if it has none; ``any_norm``: see Corrector."""
    order, sets = 2 if formulation == "second" else 1, []
    for which in (0, 1):
        tail, c0 = _ROWS(), ctypes.c_double()
        length = library().tuned_tail(order == 2, values, which, any_norm, tail, ctypes.byref(c0))
        if not length:
            return None
        # the header has the shortest decimal of a number
        c = completed(order, [Fraction(1), *(Fraction(repr(x)) for x in tail[:length])])
        c[0] = c[0] if math.isnan(c0.value) else Fraction(repr(c0.value))
        sets.append(tuple(c))
    return Corrector(formulation, tuple(sets), 0 if any_norm else 2, any_norm)
