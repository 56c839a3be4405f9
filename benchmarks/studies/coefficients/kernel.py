"""The kernel with any coefficients: kernel.cpp, compiled and loaded."""

import ctypes
import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.engine import compiled
from benchmarks.reference.correctors import completed
from benchmarks.reference.stability import second_order_coefficients, second_step

#: error of a motion that does not stay finite
LOST = 1e3
MOST = 12
VALUES = range(4, MOST + 1)
_ROWS = ctypes.c_double * MOST


class _Corrector(ctypes.Structure):
    _fields_ = [("values", ctypes.c_int), ("compensate", ctypes.c_int), ("c", _ROWS)]


@cache
def library():
    """The compiled kernel.cpp."""
    loaded = compiled.load(Path(__file__).with_name("kernel.cpp"))
    real, whole = ctypes.c_double, ctypes.c_int
    numbers, corrector = ctypes.POINTER(real), ctypes.POINTER(_Corrector)
    loaded.libration.argtypes = [corrector, real, whole, numbers, real]
    loaded.cage.argtypes = [corrector, real, whole, real, numbers]
    loaded.noise.argtypes = [corrector]
    loaded.tuned_tail.argtypes = [whole, numbers, numbers]
    loaded.libration.restype = loaded.noise.restype = real
    return loaded


@dataclass(frozen=True)
class Corrector:
    """Coefficients ``c``, c_0 ... c_(N-1), fractions or numbers.

    The motions have formulation momentum; they return LOST if they do not stay finite.
    """

    c: tuple

    @property
    def values(self):
        """N."""
        return len(self.c)

    def step(self, omega_h, rate=0.0, number=float):
        """Matrix of one step, see stability.py; ``number``: type of its elements."""
        return second_step(np.array([number(x) for x in self.c]), omega_h, rate)

    def moved(self, by):
        """The Corrector with a number added to c_0."""
        return Corrector((self.c[0] + by, *self.c[1:]))

    @property
    def floats(self):
        """The coefficients as an array of floats."""
        return np.array(self.c, dtype=float)

    def _passed(self, compensate=False):
        return ctypes.byref(_Corrector(self.values, compensate, _ROWS(*self.floats)))

    def libration(self, h, frequency, amplitude, steps):
        """Energy change of a body in potential wells, relative to its initial kinetic energy."""
        return library().libration(
            self._passed(), h, steps, (ctypes.c_double * 3)(*frequency), amplitude
        )

    def cage(self, h, seed=0, time=200.0, compensate=False):
        """Center of mass (3,) in the paper's cage; ``seed``: seed of another start, 0 for the paper's start."""
        center = (ctypes.c_double * 3)()
        library().cage(self._passed(compensate), time / round(time / h), seed, time, center)
        return np.array(center)

    @property
    def noise(self):
        """Noise gain: mean square effect of random forces on the velocity, relative to the exact one."""
        return library().noise(self._passed())


def gear(values):
    """The Corrector with Gear's coefficients."""
    return Corrector(tuple(second_order_coefficients(values)))


def tuned(values):
    """The Corrector of src/GEARQUAT/gear_quat_coefficients.cpp, None if it has none."""
    tail, c0 = _ROWS(), ctypes.c_double()
    length = library().tuned_tail(values, tail, ctypes.byref(c0))
    if not length:
        return None
    # the header has the shortest decimal of a number
    solved, *rest = completed([Fraction(1), *(Fraction(repr(x)) for x in tail[:length])])
    return Corrector((solved if math.isnan(c0.value) else Fraction(repr(c0.value)), *rest))
