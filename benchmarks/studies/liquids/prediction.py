"""The drift of the energy that a method will have, from its coefficients and a spectrum of the motion.

A coordinate that oscillates with omega is driven by the force at its predicted value, which is H(omega h)
times the true one.  H follows from the coefficients c: predict, then correct row j by c_j times the
residual, in one pass.  The imaginary part of H does work, so that the energy of the oscillation, kT
in equilibrium, changes by -omega Im H of itself per unit of time.  Averaged over the normalized power
spectrum rho of velocities, for rotation of those in the body frame, the drift per degree of freedom is

    -sum over omega of rho(omega) omega Im H(omega h) kT.

With forces, no quantity is fitted.  The equations are linear in it: it knows nothing of stability, of
projections, of passes and of rough forces.
"""

from dataclasses import dataclass

import numpy as np
from scipy.signal import welch

from .quantities import FEMTOSECONDS

#: samples of a window; its side lobes are far below what long steps make of high frequencies
SEGMENT, WINDOW = 1024, "blackmanharris"
#: an axis with less than this part of the power of all is one without a moment of inertia
AT_REST = 1e-9


def response(corrector, omega_h):
    """H at each omega h (n,): predicted by true value of an oscillation, complex (n,).

    ``corrector``: a Corrector of the second formulation (coefficients/kernel.py).
    """
    c, free, z = corrector.floats[0], corrector.step(0.0), np.asarray(omega_h, dtype=float)
    turns = np.exp(1j * z)[:, None, None] * np.eye(len(c))
    # the predicted value is the sum of the history of the step before, which y_2 = -z^2/2 e^(i z n) drives
    histories = np.linalg.solve(turns - free, c[:, None])[..., 0]
    return -(z**2) / 2 * histories.sum(axis=1)


@dataclass(frozen=True)
class Spectrum:
    """Normalized power spectra of a liquid: ``omega`` (n,) in 1/fs, ``translation`` and ``rotation`` (n,).

    The sum of each is 1.  ``axes``: about how many a molecule rotates.
    """

    omega: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    axes: int

    @classmethod
    def of(cls, velocities, rotations, dt):
        """Spectrum of velocities and angular velocities in the body frame, each (samples, bodies, 3).

        ``dt``: time between samples, fs.  Each axis counts alike, as equipartition has it; about one
        without a moment of inertia the angular velocity is zero to rounding, and it does not count.
        """
        omega, translation = _power(velocities, dt)
        _, rotation = _power(rotations, dt)
        return cls(omega, translation.mean(axis=1), rotation.mean(axis=1), rotation.shape[1])

    def drift(self, corrector, dt):
        """Drift of the energy with a step ``dt`` in fs, kT per ns and degree of freedom."""
        slow = self.omega * dt < np.pi
        omega = self.omega[slow]
        gain = -omega * response(corrector, omega * dt).imag
        parts = [gain @ rho[slow] for rho in (self.translation, self.rotation)]
        return FEMTOSECONDS * np.average(parts, weights=(3, self.axes))


def _power(series, dt):
    """omega (n,), and for each axis that moves the normalized power (n, axes), without omega = 0."""
    options = {"window": WINDOW, "nperseg": SEGMENT, "detrend": False, "axis": 0}
    frequency, power = welch(series, 1 / dt, **options)
    power = power.sum(axis=1)[1:]
    power = power[:, power.sum(axis=0) > AT_REST * power.sum()]
    return 2 * np.pi * frequency[1:], power / power.sum(axis=0)


def read(path, dt):
    """Spectrum of the file that in.liquid writes with ``bodies`` = yes; ``dt``: its step, fs."""
    lines = (line for line in path.open(encoding="utf-8") if not line.startswith("#"))
    first = next(lines).split()
    rows, columns = int(first[1]), 7
    numbers = np.fromstring(" ".join([*first, *lines]), sep=" ")
    frames = numbers.reshape(-1, 2 + rows * columns)[:, 2:].reshape(-1, rows, columns)
    return Spectrum.of(frames[..., 1:4], frames[..., 4:7], dt)
