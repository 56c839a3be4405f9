"""Gragg-Bulirsch-Stoer extrapolation in any NumPy float type, meant for 80-bit long double.

One step of size H from y:

    midpoint     for n = 2, 4, ..., 2K:  h = H / n,  z_0 = 0,  z_1 = h f(y),
                 z_{m+1} = z_{m-1} + 2 h f(y + z_m);  T_n = z_n, the change of y, has an
                 error in even powers of h
    extrapolate  T = sum_n w_n T_n: h -> 0 by exact rational weights; order 2K
    judge        |T - T'| with T' from all but n = 2, against tolerance x size of the state

Changes, not values, are extrapolated, and they are added up with a carry (Kahan): rounding is relative to a small
number, and the sum of a long run keeps the digits of the float type. W. B. Gragg, SIAM J. Numer. Anal. 2, 384 (1965);
R. Bulirsch and J. Stoer, Numer. Math. 8, 1 (1966).
"""

from fractions import Fraction
from math import prod

import numpy as np

from .equations import State
from .fields import FreeField

#: columns K of the extrapolation, order 2K; its weights enlarge rounding of the rates 56 times ...
COLUMNS = 7
#: ... and 12 times: for forces that are double in a state that is extended
COLUMNS_DOUBLE_FORCES = 5
#: smallest step tolerances that gain something
TOLERANCE, TOLERANCE_DOUBLE_FORCES = 1e-17, 1e-14
#: a step shrinks to at least, grows to at most, this multiple; the rest is a margin
SHRINK, GROW, MARGIN = 0.2, 4.0, 0.9
#: a step below this fraction of the first step means that rounding or a jump of the forces prevents the tolerance
SMALLEST = 1e-6


class NotReached(RuntimeError):
    """Raised if the tolerance is below the precision of the float type or of the forces."""


def extrapolation_weights(counts):
    """Weights w_n, as Fractions, that take T_n(h = H/n), even in h, to h = 0."""
    return [prod(Fraction(n * n, n * n - m * m) for m in counts if m != n) for n in counts]


def _as_float(fraction, dtype):
    """A Fraction in a float type, rounded once or twice."""
    return dtype(str(fraction.numerator)) / dtype(str(fraction.denominator))


class GraggBulirschStoer:
    """Extrapolation for y' = rates(t, y); ``rates`` was called ``evaluations`` times so far.

    ``scales(y)`` is the size of y by column, to which the tolerance is relative.
    """

    def __init__(self, rates, scales, tolerance, dtype, columns=COLUMNS):
        if columns < 3:
            raise ValueError(f"at least 3 columns are required, not {columns}")
        counts = [2 * (k + 1) for k in range(columns)]
        self.rates, self.scales, self.tolerance = rates, scales, tolerance
        self.counts, self.order = counts, 2 * columns
        self.weights = np.array([_as_float(w, dtype) for w in extrapolation_weights(counts)])
        lower = [_as_float(w, dtype) for w in (0, *extrapolation_weights(counts[1:]))]
        self.judging = self.weights - np.array(lower)
        self.evaluations = 0

    def _rates(self, t, y):
        self.evaluations += 1
        return self.rates(t, y)

    def _midpoint(self, t, y, slope, step, n):
        """Change of y over ``step`` in n midpoint steps; ``slope`` = f(t, y)."""
        h = step / n
        before, change = 0, h * slope
        for m in range(1, n):
            before, change = change, before + 2 * h * self._rates(t + m * h, y + change)
        return change

    def _change(self, t, y, slope, step):
        """Change of y over ``step`` and its error in units of the tolerance."""
        table = np.array([self._midpoint(t, y, slope, step, n) for n in self.counts])
        change = np.tensordot(self.weights, table, axes=1)
        error = np.abs(np.tensordot(self.judging, table, axes=1))
        scale = np.maximum(self.scales(y), self.scales(change))
        # a part that stays zero (no spin, no force) has zero error
        relative = error / np.where(scale > 0, scale, 1)
        return change, float(relative.max() / self.tolerance)

    def first_step(self, y, slope, span):
        """A step in which no part of the state changes by more than a tenth of its value."""
        scale, speed = self.scales(y), self.scales(slope)
        moving = (speed > 0) & (scale > 0)
        times = scale[moving] / speed[moving]
        return min(times.min() / 10, abs(span)) if len(times) else abs(span)

    def _next_step(self, h, error):
        """The step to follow one of size h whose error, in units of the tolerance, is this."""
        if not np.isfinite(error):
            return abs(h) * SHRINK
        best = MARGIN * max(error, 1e-30) ** (-1 / (self.order - 1))
        return abs(h) * min(GROW, max(SHRINK, best))

    def advance(self, y, times):
        """States at ``times`` (monotonic; y is the state at the first), shape (len(times), *y.shape)."""
        carry, t, states = np.zeros_like(y), times[0], [y]
        slope = self._rates(t, y)
        step = first = self.first_step(y, slope, times[-1] - times[0])
        for stop in times[1:]:
            while t != stop:
                # equal parts of the remaining time, so that the last part is not tiny
                parts = max(np.ceil(abs(stop - t) / step * (1 - 1e-12)), 1)
                h = (stop - t) / parts
                change, error = self._change(t, y, slope, h)
                following = self._next_step(h, error)
                if error <= 1:
                    # Kahan's sum: the rounding error of y is added to the next change
                    change = change + carry
                    after = y + change
                    carry = change - (after - y)
                    y, t = after, stop if parts == 1 else t + h
                    slope = self._rates(t, y)
                    # a step that was shortened to end at a given time does not show how long a step may be
                    step = max(following, step) if error <= 1e-3 else following
                else:
                    step = following
                if step < SMALLEST * first:
                    raise NotReached(
                        f"no step is small enough at t = {float(t):g}: a tolerance above"
                        f" {self.tolerance:.0e} is required, or forces without jumps"
                    )
            states.append(y)
        return np.array(states)


def integrate(problem, times, tolerance=None, columns=None):
    """States of a Problem at ``times``, which rise from 0 or fall from it; 0 need not be listed.

    Everything is done in the float type of the problem.  ``tolerance`` bounds the error estimate of every step,
    relative to the largest position, velocity, ... of any body; it and ``columns`` follow from the float type of the
    field's forces unless given.
    """
    dtype = problem.dtype.type
    times = [dtype(t) for t in times]
    steps = np.diff(np.array([dtype(0), *times]))
    if not times or not ((steps >= 0).all() or (steps <= 0).all()):
        raise ValueError("times are required that rise (or fall) from 0 on")
    extended = problem.field.dtype is None
    if tolerance is None:
        tolerance = TOLERANCE if extended else TOLERANCE_DOUBLE_FORCES
    if columns is None:
        columns = COLUMNS if extended else COLUMNS_DOUBLE_FORCES
    scales = problem.scales
    solver = GraggBulirschStoer(problem.rates, scales, tolerance, dtype, columns)
    states = solver.advance(problem.start.packed(), [dtype(0), *times])[1:]
    return [State.of(packed) for packed in states]


def reference_states(problem, times, tolerance=None):
    """States at ``times``, rising from 0: list of State in long double (``.double`` rounds them).

    Without forces they are exact (free_top.py).  In an extended field they are good to about 1e-14
    of the size of the scene while the motion is not chaotic; in LAMMPS' field, whose forces are double, rounding
    limits them: ten times less accurate in the paper's cage.  Raises RuntimeError if long double is not extended.
    """
    if np.finfo(problem.dtype).eps > 1.1e-19:
        raise RuntimeError(f"a NumPy long double of at least 64 bits' precision is required, not {problem.dtype}")
    if isinstance(problem.field, FreeField):
        from .free_top import exact_state  # needs mpmath

        return [exact_state(problem, time) for time in times]
    return integrate(problem, times, tolerance)


def reference_state(problem, time, tolerance=None):
    """State at ``time``, see ``reference_states``."""
    return reference_states(problem, [time], tolerance)[0]
