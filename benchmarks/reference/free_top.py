"""Exact motion of a free rigid body, by Jacobi elliptic functions; mpmath, 40 digits.

Moments I_1, I_2, I_3 in rising or falling order, so that omega_3 never changes sign (Landau and
Lifshitz, Mechanics, section 37).  L is the angular momentum, 2T twice the kinetic energy:

    omega_1 = A_1 cn u,  omega_2 = A_2 sn u,  omega_3 = A_3 dn u,   u = rate (t - t_0)

The body's axis 3 goes round L at the rate

    (L/I_3) (1 + (2T I_3 - L^2) / (L^2 - (I_3 omega_3)^2))

and so, with n = -I_3 (I_2 - I_1) / (I_1 (I_3 - I_2)), by the angle

    (L/I_3) (t + (I_3 - I_1) / (I_1 rate) [Pi(n; am u, m)])

with the bracket taken from u(0) to u(t).  This and the direction of L in body axes, known from
omega_body, give the orientation.
"""

from dataclasses import dataclass

import mpmath as mp
import numpy as np

from . import quaternion as qt
from .equations import State

DIGITS = 40
_PARITY_EVEN = {(0, 1, 2), (1, 2, 0), (2, 0, 1)}


def _mpf(values):
    """Array of mpf of an array of any float type, exactly."""
    high = [float(v) for v in values]
    return np.array([mp.mpf(h) + mp.mpf(float(v - type(v)(h))) for v, h in zip(values, high)])


def _to_float(values, dtype):
    """Array of mpf in a float type, correctly rounded for one of 64 bits' precision or fewer."""
    return np.array([dtype(mp.nstr(v, 25)) for v in values], dtype=dtype)


def _length(a):
    return mp.sqrt(a @ a)


def _uniform(moments, omega):
    """True if omega is constant: I omega parallel to omega, to the last digits of the data."""
    momentum = moments * omega
    torque, size = qt.cross(omega, momentum), _length(omega) * _length(momentum)
    return (abs(torque) <= size * mp.mpf(10) ** (8 - DIGITS)).all()


@dataclass(frozen=True)
class _Wave:
    """Elliptic solution in permuted axes; moments and signed amplitudes A in their order.

    ``order`` are the body's axes 1, 2, 3 of the formulas; u is ``u0`` at t = 0.
    """

    order: tuple
    moments: tuple
    amplitudes: tuple
    rate: mp.mpf
    m: mp.mpf
    u0: mp.mpf

    def omega(self, time):
        """omega_body, in the body's own order of axes."""
        u, omega = self.u0 + self.rate * time, np.empty(3, dtype=object)
        for axis, amplitude, function in zip(self.order, self.amplitudes, ("cn", "sn", "dn")):
            omega[axis] = amplitude * mp.ellipfun(function, u, m=self.m)
        return omega

    def _third(self, u):
        """Pi(n; am u, m), continuous in u."""
        i1, i2, i3 = self.moments
        period = 4 * mp.ellipk(self.m)
        turns = mp.nint(u / period)
        rest = u - period * turns
        angle = mp.atan2(mp.ellipfun("sn", rest, m=self.m), mp.ellipfun("cn", rest, m=self.m))
        n = -i3 * (i2 - i1) / (i1 * (i3 - i2))
        return mp.re(mp.ellippi(n, angle + 2 * mp.pi * turns, self.m))

    def turned(self, time):
        """Angle by which axis 3 has gone round L, divided by the length of L."""
        i1, _, i3 = self.moments
        integral = self._third(self.u0 + self.rate * time) - self._third(self.u0)
        return (time + (i3 - i1) / (i1 * self.rate) * integral) / i3


def _wave(moments, omega):
    """The _Wave through omega at t = 0."""
    rising = sorted(range(3), key=lambda k: moments[k])

    def excess(axis):
        """2T I_axis - L^2, without cancellation."""
        return (moments * omega**2) @ (moments[axis] - moments)

    middle = excess(rising[1])
    if abs(middle) < excess(rising[2]) * mp.mpf(10) ** (8 - DIGITS):
        raise ValueError(
            "a motion off the separatrix is required: here L^2 = 2 T I of the middle axis"
        )
    order = tuple(rising) if middle < 0 else tuple(reversed(rising))
    i1, i2, i3 = (moments[k] for k in order)
    w1, w2, w3 = (omega[k] for k in order)
    near, far = excess(order[2]), -excess(order[0])  # both positive, or both negative
    a1 = mp.sqrt(near / (i1 * (i3 - i1)))
    a2 = mp.sqrt(near / (i2 * (i3 - i2)))
    a3 = mp.sqrt(far / (i3 * (i3 - i1)))
    a3 = a3 if w3 > 0 else -a3
    # Euler's equation of axis 2 at cn = dn = 1: I_2 A_2 rate = parity (I_3 - I_1) A_3 A_1
    parity = 1 if order in _PARITY_EVEN else -1
    a2 = a2 if parity * (i3 - i1) * a3 > 0 else -a2
    rate = mp.sqrt((i3 - i2) * far / (i1 * i2 * i3))
    m = (i2 - i1) * near / ((i3 - i2) * far)
    u0 = mp.ellipf(mp.atan2(w2 / a2, w1 / a1), m)
    return _Wave(order, (i1, i2, i3), (a1, a2, a3), rate, m, u0)


class FreeTop:
    """One free body; ``moments`` (3,), ``omega_body`` (3,) and ``q`` (4,) at t = 0."""

    def __init__(self, moments, omega_body, q):
        with mp.workdps(DIGITS):
            self.moments, self._omega = _mpf(moments), _mpf(omega_body)
            self._q = qt.normalised(_mpf(q))
            self._length = _length(self.moments * self._omega)
            self._uniform = _uniform(self.moments, self._omega)
            if not self._uniform:
                self._wave = _wave(self.moments, self._omega)
                self._frame0 = self._frame(self._omega)

    def _frame(self, omega):
        """Quaternion of the axes (e_3 - part along L, L x that, L), seen from the body."""
        z = self.moments * omega
        y = qt.cross(z, np.eye(3, dtype=int)[self._wave.order[2]])
        axes = [axis / _length(axis) for axis in (qt.cross(y, z), y, z)]
        return qt.of_rotation(np.transpose(axes))

    def at(self, time, dtype=np.longdouble):
        """(q, omega_body) at ``time``, shapes (4,) and (3,)."""
        with mp.workdps(DIGITS):
            t = _mpf([np.longdouble(time)])[0]
            if self._uniform:
                q, omega = qt.product(self._q, _spin(self._omega, t)), self._omega
            else:
                omega = self._wave.omega(t)
                half = self._length * self._wave.turned(t) / 2
                about = np.array([mp.mpf(0), mp.mpf(0), mp.sin(half), mp.cos(half)])
                # space <- body(0) <- axes at L -> turned about L -> axes at L <- body(t)
                q = qt.product(self._q, qt.product(self._frame0, about))
                q = qt.product(q, qt.conjugate(self._frame(omega)))
            return _to_float(q, dtype), _to_float(omega, dtype)


def _spin(omega, t):
    """Quaternion of a uniform rotation for the time t."""
    half = _length(omega) * t / 2
    return np.append(omega * t / 2 * mp.sinc(half), mp.cos(half))


def exact_state(problem, time):
    """State at ``time`` of a Problem without forces."""
    start, dtype = problem.start, problem.dtype.type
    poses = [
        FreeTop(moments, omega, q).at(time, dtype)
        for moments, omega, q in zip(problem.bodies.moments, start.omega_body, start.q)
    ]
    q, omega = (np.array(values) for values in zip(*poses))
    return State(start.center + start.velocity * dtype(time), start.velocity, q, omega)
