"""Coefficients of a corrector from its spurious roots and the order conditions.

The history is y_j = h^j y^(j)/j!, j = 0 ... N-1, P is Pascal's triangle, c the coefficients, and q the
order of the equation.  Without forces a step is (1 - c e_q') P; its roots are 1, q times, and the N-q-1
spurious ones, zeros of lambda -> e_q' (lambda - P)^-1 c (lambda - 1)^(N-q).
"""

from fractions import Fraction
from math import comb

import numpy as np
from scipy.linalg import pascal, solve_triangular


def placed(order, roots):
    """c_q ... c_(N-1), with c_q = 1, for N-q-1 spurious roots, in conjugate pairs or real.

    (lambda - P)^-1 is the sum of (P - 1)^k / (lambda - 1)^(k+1), so that the polynomial of the roots has
    sum_j [(P - 1)^k]_qj c_j in front of (lambda - 1)^(N-q-1-k).
    """
    values = order + 1 + len(roots)
    shift = pascal(values, "upper").astype(float) - np.eye(values)
    rows = [np.eye(values)[order]]
    for _ in roots:
        rows.append(rows[-1] @ shift)
    wanted = np.real(np.poly(np.asarray(roots) - 1.0))
    return solve_triangular(np.array(rows)[:, order:], wanted)


def _sum(j, deviations):
    return sum(comb(k, j) * d for k, d in enumerate(deviations) if k > j)


def _descend(order, c, degree, residual, slope):
    """Deviations of the rows above ``order`` for an exact solution of this degree."""
    d = [0] * len(c)
    for j in range(len(c) - 2, order - 1, -1):
        d[j + 1] = (comb(degree, j) - c[j] * residual + degree * slope[j] - _sum(j, d)) / (j + 1)
    return d


def completed(order, rest):
    """All coefficients: ``rest`` is c_q ... c_(N-1); what order asks for below them is solved for.

    Eqs. (1) and (2) at the head of src/GEARQUAT/gear_quat_tuned.h; fractions give fractions.
    """
    c, n = [0] * order + list(rest), order + len(rest)
    residual = n / c[-1]
    e = _descend(order, c, n, residual, [0] * n)
    c[order - 1] = (comb(n, order - 1) - _sum(order - 1, e)) / residual
    if order == 2:
        s = (comb(n + 1, n - 1) + (n + 1) * e[n - 1]) / c[-1]
        growth = _sum(1, _descend(2, c, n + 1, s, e)) - (n + 1) + c[1] * s
        c[0] = (1 - _sum(0, e) - growth / (n + 1)) / residual
    return c


def decimals(coefficients, digits=9):
    """The decimals that are written for some coefficients, as fractions."""
    return [Fraction(f"{float(x):.{digits}f}") for x in coefficients]
