"""Prediction of the energy drift of a method from its coefficients and a spectrum of the motion.

For a coordinate that oscillates with omega, the force is evaluated at the predicted value, which is H(omega h)
times the true one.  H follows from the coefficients c: predict, then correct row j by c_j times the
residual.  The imaginary part of H does work, so the energy of the oscillation, kT in equilibrium, changes
at the relative rate -omega Im H.  Averaged over the normalized power spectrum rho of velocities (for rotation, of
angular velocities in the body frame), the drift per degree of freedom is

    -sum over omega of rho(omega) omega Im H(omega h) kT.

No quantity is fitted.  The theory is linear: it does not include instability, and forces that are not smooth.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import pascal
from scipy.signal import welch

#: of a nanosecond
FEMTOSECONDS = 1e6
#: samples of a window; its side lobes are far below the drift from high frequencies at long steps
SEGMENT, WINDOW = 1024, "blackmanharris"
#: an axis with less than this fraction of the total power has no moment of inertia
AT_REST = 1e-9


def open_loop(c):
    """Step (N, N) of rows whose right side is zero."""
    predict = pascal(len(c), "upper").astype(float)
    return predict - np.outer(c, predict[2])


def response(corrector, omega_h):
    """H at each omega h (n,): ratio of predicted to true value for the force exp(i omega t), complex (n,).

    An oscillation has the root exp(i y) with y^2 = (omega h)^2 H(y).
    """
    y, c = np.asarray(omega_h), corrector.floats
    free = np.exp(1j * y)[:, None, None] * np.eye(len(c)) - open_loop(c)
    rows = np.linalg.solve(free, c[:, None])[..., 0]
    return -(y**2) / 2 * rows.sum(axis=1)  # a prediction is the sum of all rows


@dataclass(frozen=True)
class Spectrum:
    """Normalized power spectra of a liquid: ``omega`` (n,) in 1/fs, ``translation`` and ``rotation`` (n,).

    The sum of each is 1.  ``axes``: number of axes about which a molecule rotates.
    """

    omega: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    axes: int

    @classmethod
    def of(cls, velocities, rotations, dt):
        """Spectrum of velocities and angular velocities in the body frame, each (samples, bodies, 3).

        ``dt``: time between samples, fs.  All axes have equal weight because of equipartition.  An axis without a moment
        of inertia, where the angular velocity is zero within round-off, is left out.
        """
        omega, translation = _power(velocities, dt)
        _, rotation = _power(rotations, dt)
        return cls(omega, translation.mean(axis=1), rotation.mean(axis=1), rotation.shape[1])

    @property
    def density(self):
        """Mean spectrum (n,) of a degree of freedom."""
        return np.average([self.translation, self.rotation], axis=0, weights=(3, self.axes))

    def drift(self, corrector, dt):
        """Drift of the energy with a step ``dt`` in fs, kT per ns and degree of freedom."""
        slow = self.omega * dt < np.pi
        omega = self.omega[slow]
        gain = -omega * response(corrector, omega * dt).imag
        return FEMTOSECONDS * float(gain @ self.density[slow])


def _power(series, dt):
    """omega (n,), without omega = 0, and the normalized power (n, axes) for each axis with motion."""
    options = {"window": WINDOW, "nperseg": SEGMENT, "detrend": False, "axis": 0}
    frequency, power = welch(series, 1 / dt, **options)
    power = power.sum(axis=1)[1:]
    power = power[:, power.sum(axis=0) > AT_REST * power.sum()]
    return 2 * np.pi * frequency[1:], power / power.sum(axis=0)


def read(path, dt):
    """Spectrum from the file that in.liquid writes with ``bodies`` = yes; ``dt``: step of the run, fs."""
    lines = (line for line in path.open(encoding="utf-8") if not line.startswith("#"))
    first = next(lines).split()
    rows, columns = int(first[1]), 7
    numbers = np.fromstring(" ".join([*first, *lines]), sep=" ")
    frames = numbers.reshape(-1, 2 + rows * columns)[:, 2:].reshape(-1, rows, columns)
    return Spectrum.of(frames[..., 1:4], frames[..., 4:7], dt)


# --- the spectra that searches use ----------------------------------------------------------------
#: table of the study liquids
RECORDED = Path(__file__).with_name("spectra.csv")
#: largest omega of recorded spectra, 1/fs; higher frequencies have no effect at steps of 2 fs or more
FASTEST = 0.95


def table(spectra):
    """Header and rows of the table of ``spectra``, name of liquid -> Spectrum; all have the same omega."""
    header, columns = ["omega, 1/fs"], []
    for name, own in spectra.items():
        columns = columns or [own.omega]
        header += [f"{name}, translation", f"{name}, rotation about {own.axes} axes"]
        columns += [own.translation, own.rotation]
    kept = np.transpose(columns)[columns[0] < FASTEST]
    return header, [[f"{x:.6g}" if k == 0 else f"{x:.3e}" for k, x in enumerate(row)] for row in kept]


def recorded(path=RECORDED):
    """Name of liquid -> Spectrum, of such a table."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    omega, *columns = np.array(rows, dtype=float).T
    spectra = {}
    for k in range(0, len(columns), 2):
        name, axes = header[k + 1].split(",")[0], int(header[k + 2].split()[-2])
        spectra[name] = Spectrum(omega, *columns[k : k + 2], axes)
    return spectra
