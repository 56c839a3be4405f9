"""Coefficients of a corrector from its spurious roots and the order conditions.

The history is y_j = h^j y^(j)/j!, j = 0 ... N-1, of a second-order equation, P is Pascal's triangle, and c the
coefficients.  Without forces a step is (1 - c e_2') P; its roots are 1, twice, and the N-3 spurious roots, zeros of
lambda -> e_2' (lambda - P)^-1 c (lambda - 1)^(N-2).
"""

from fractions import Fraction
from math import comb

import numpy as np
from scipy.linalg import pascal, solve_triangular


def placed(roots):
    """c_2 ... c_(N-1), with c_2 = 1, for N-3 spurious roots, in conjugate pairs or real.

    (lambda - P)^-1 is the sum of (P - 1)^k / (lambda - 1)^(k+1), so that the polynomial of the roots has
    sum_j [(P - 1)^k]_2j c_j in front of (lambda - 1)^(N-3-k).
    """
    values = 3 + len(roots)
    shift = pascal(values, "upper").astype(float) - np.eye(values)
    rows = [np.eye(values)[2]]
    for _ in roots:
        rows.append(rows[-1] @ shift)
    wanted = np.real(np.poly(np.asarray(roots) - 1.0))
    return solve_triangular(np.array(rows)[:, 2:], wanted)


def _sum(j, deviations):
    return sum(comb(k, j) * d for k, d in enumerate(deviations) if k > j)


def _descend(c, degree, residual, slope):
    """Deviations of the rows above row 2 for an exact solution of this degree."""
    d = [0] * len(c)
    for j in range(len(c) - 2, 1, -1):
        d[j + 1] = (comb(degree, j) - c[j] * residual + degree * slope[j] - _sum(j, d)) / (j + 1)
    return d


def completed(rest):
    """All coefficients: ``rest`` is c_2 ... c_(N-1), from which the order determines c_0 and c_1.

    Eqs. (1) and (2) at the head of src/GEARQUAT/gear_quat_coefficients.cpp; fractions give fractions.
    """
    c, n = [0, 0, *rest], 2 + len(rest)
    residual = n / c[-1]
    e = _descend(c, n, residual, [0] * n)
    c[1] = (n - _sum(1, e)) / residual
    s = (comb(n + 1, n - 1) + (n + 1) * e[n - 1]) / c[-1]
    growth = _sum(1, _descend(c, n + 1, s, e)) - (n + 1) + c[1] * s
    c[0] = (1 - _sum(0, e) - growth / (n + 1)) / residual
    return c


def decimals(coefficients, digits=9):
    """The decimals that are written for some coefficients, as fractions."""
    return [Fraction(f"{float(x):.{digits}f}") for x in coefficients]
