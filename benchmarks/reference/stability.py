"""One step of the methods for the linear test equation as a matrix, and their largest stable steps.

Test equation: x'' = -omega^2 x, one force evaluation a step, at the predicted position.  One step is a linear map of
the history y_j = h^j x^(j) / j!.  Spurious roots are eigenvalues farther than OWN from exp(+-i omega h).  A step
counts as stable if no spurious root lies outside of the unit circle.  The oscillation itself may grow or decay, which
is error, not instability.  Source of the analysis: C. W. Gear,
"Numerical Initial Value Problems in Ordinary Differential Equations" (1971).

Gear's coefficients, for N values (rows j = 0 ... N-1), from the polynomial P_n(s) = (1+s)(1+s/2)...(1+s/n):
  first-order equation    sum_j j c_j s^(j-1) = P_(N-2)(s),  c_0 = integral of P_(N-1) over (-1, 0)
  second-order equation   c_(j+1) = 2 a_j / (j+1), a_j from a first-order equation with N-1 values;
                          c_0 = C = 2 times the integral of -s P_(N-2)(s) over (-1, 0) for "velocity",
                          c_0 = C (N-2)/(N-1) for "position"
"""

import ctypes
import math
from fractions import Fraction
from pathlib import Path

import numpy as np
from scipy.linalg import pascal

from benchmarks.engine import compiled

OWN = 0.15
#: values of omega h that are tried, and how close the limit is found between two of them
SCAN, RESOLUTION = np.linspace(0.0, 4.0, 801), 1e-5


def _rising(n):
    """Coefficients of P_n(s), ascending, as fractions."""
    product = [Fraction(1)]
    for i in range(1, n + 1):
        shifted = [Fraction(0)] + [c / i for c in product]
        product = [a + b for a, b in zip(product + [Fraction(0)], shifted)]
    return product


def _integral(polynomial):
    """Integral over (-1, 0) of a polynomial with ascending coefficients."""
    return sum(c * Fraction((-1) ** k, k + 1) for k, c in enumerate(polynomial))


def first_order_coefficients(values):
    """c_0 ... c_(N-1) for a first-order equation, as fractions."""
    tail = [c / (k + 1) for k, c in enumerate(_rising(values - 2))]
    return [_integral(_rising(values - 1)), *tail]


def second_order_coefficients(values, c0="position"):
    """c_0 ... c_(N-1) for a second-order equation, as fractions."""
    tail = [2 * a / (j + 1) for j, a in enumerate(first_order_coefficients(values - 1))]
    moment = [Fraction(0)] + [-c for c in _rising(values - 2)]
    head = 2 * _integral(moment)
    return [head * Fraction(values - 2, values - 1) if c0 == "position" else head, *tail]


def second_step(c, omega_h):
    """Matrix (N, N) of one step of x'' = -omega^2 x with coefficients ``c`` (N,)."""
    predict = pascal(len(c), "upper").astype(float)
    return predict - np.outer(c, omega_h**2 / 2 * predict[0] + predict[2])


def second_order_step(values, omega_h, c0="position"):
    """``second_step`` with Gear's coefficients."""
    return second_step(np.array(second_order_coefficients(values, c0), dtype=float), omega_h)


def momentum_step(values, omega_h):
    """``second_step`` with the coefficients of the kernel for formulation momentum."""
    c = np.empty(values)
    kernel = compiled.load(Path(__file__).with_name("kernel.cpp"))
    kernel.tuned(values, ctypes.c_void_p(c.ctypes.data))
    return second_step(c, omega_h)


def first_order_step(n, omega_h, momentum="corrected"):
    """Matrix (2N, 2N) of one step of x' = v, v' = -omega^2 x with Gear's coefficients for ``n`` values.

    Histories of position and of velocity; the position is corrected with the corrected velocity, or with the predicted
    one.
    """
    c = np.array(first_order_coefficients(n), dtype=float)
    # units: velocity history in omega times length, so that only omega h appears
    predict = np.kron(np.eye(2), pascal(n, "upper"))
    velocity = predict[n:] - np.outer(c, omega_h * predict[0] + predict[n + 1])
    of = velocity[0] if momentum == "corrected" else predict[n]
    return np.concatenate([predict[:n] + np.outer(c, omega_h * of - predict[1]), velocity])


def linear_limit(step_matrix):
    """Largest omega h up to which ``step_matrix(omega_h)`` is stable, found by scan and bisection.

    The scan goes up from zero, so that stable islands beyond the first limit do not count; infinite if
    all of it is stable.
    """

    def stable(omega_h):
        roots = np.linalg.eigvals(step_matrix(omega_h))
        exact = np.exp(omega_h * np.array([[1j], [-1j]]))
        return np.all((np.abs(roots) <= 1.0) | (np.abs(roots - exact).min(axis=0) <= OWN))

    high = next((x for x in SCAN[1:] if not stable(x)), math.inf)
    if math.isinf(high):
        return high
    low = high - SCAN[1]
    while high - low > RESOLUTION:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low
