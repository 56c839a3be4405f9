"""Properties of coefficients: linear ones (an oscillation, responses, changing steps) and motions of bodies."""

from dataclasses import dataclass

import mpmath
import numpy as np

from benchmarks.reference.stability import linear_limit

from .kernel import LOST, gear
from .prediction import open_loop, response
from .search import Search, spectrum

#: value of omega h for properties that are a single number; decimal digits of the principal root
AT, DIGITS = 0.3, 40
#: ratios of a step to the step before
RATIOS = (0.8, 0.9, 1.1, 1.25)
#: radians per step at which responses are given
RESPONSES = (0.8, 1.0, 1.2)
#: steps of the librations and of bodies in the cage
LIBRATIONS, CAGES = (0.2, 0.35), (0.4, 0.2, 0.1)
#: other starts in the cage: their seeds, time and step
SEEDS, SHORT, START_STEPS = range(1001, 1009), 40.0, (0.4, 0.2)


# --- linear ---------------------------------------------------------------------------------------
def principal(corrector, omega_h):
    """Damping |lambda| - 1 and phase error of the principal root of x'' = -omega^2 x, in DIGITS."""
    with mpmath.workdps(DIGITS):
        z = mpmath.mpf(str(omega_h))
        step = mpmath.matrix(corrector.step(z, number=mpmath.mpmathify).tolist())
        unit, exact = mpmath.eye(step.rows), mpmath.expj(z)
        near = exact * (1 + z ** (corrector.values + 1) / 1000)
        found = mpmath.findroot(lambda root: mpmath.det(root * unit - step), (exact, near))
        return float(abs(found) - 1), float(mpmath.arg(found) - z)


def radius(corrector, ratio):
    """Largest spurious root without forces if each step is ``ratio`` times the one before."""
    scaled = float(ratio) ** np.arange(corrector.values)
    spurious = (scaled[:, None] * open_loop(corrector.floats))[2:, 2:]
    return abs(np.linalg.eigvals(spurious)).max()


@dataclass(frozen=True)
class Linear:
    """Linear properties of a Corrector.

    * ``error``: largest (|damping| + PHASE |phase|)/(omega h)^N in the range of the search
    * ``damping``, ``phase``: at AT
    * ``memory``: largest spurious root without forces; ``limit``: largest stable omega h
    * ``noise``: see Corrector; ``radii``: at RATIOS; ``responses``: imaginary parts at RESPONSES
    """

    error: float
    damping: float
    phase: float
    memory: float
    limit: float
    noise: float
    radii: tuple
    responses: tuple

    @classmethod
    def of(cls, corrector):
        """Properties of a Corrector."""
        return cls(
            float(10 ** Search(corrector.values).oscillation(corrector)[0]),
            *principal(corrector, AT),
            float(radius(corrector, 1.0)),
            float(linear_limit(corrector.step)),
            corrector.noise,
            tuple(float(radius(corrector, ratio)) for ratio in RATIOS),
            tuple(map(float, response(corrector, RESPONSES).imag)),
        )


def curves(corrector, z):
    """Arrays (n,) at each omega h: damping, phase error / (omega h)^N, largest spurious root, and the
    imaginary part of the response at the same radians per step."""
    damping, phase = np.array([principal(corrector, x) for x in z]).T
    of_force = response(corrector, z).imag
    return damping, phase / z**corrector.values, spectrum(corrector, z)[:, 2], of_force


# --- motions --------------------------------------------------------------------------------------
class Flights:
    """Errors of bodies in the cage, relative to a run of Gear's method with eleven values and a short step."""

    def __init__(self):
        exact = gear(11)
        self._paper = exact.cage(0.0125, compensate=True)
        self._others = {seed: exact.cage(0.0125, seed, SHORT, True) for seed in SEEDS}

    def error(self, corrector, h):
        """Error of the center of mass in test case 1 at t = 200, at most LOST."""
        return min(LOST, float(np.linalg.norm(corrector.cage(h) - self._paper)))

    def others(self, corrector):
        """Geometric mean of the errors of the other starts, at each of START_STEPS."""
        errors = [
            [np.linalg.norm(corrector.cage(h, seed, SHORT) - end) for h in START_STEPS]
            for seed, end in self._others.items()
        ]
        return tuple(map(float, np.exp(np.mean(np.log(errors), axis=0))))


@dataclass(frozen=True)
class Motions:
    """``librations``: energy changes at LIBRATIONS; ``cages``: errors of test case 1 at CAGES; ``starts``: errors of
    the other starts at START_STEPS."""

    librations: tuple
    cages: tuple
    starts: tuple

    @classmethod
    def of(cls, corrector, flights):
        """Motions with a Corrector."""
        return cls(
            tuple(corrector.libration(h, (1.0, 0.8, 0.6), 0.4, 4000) for h in LIBRATIONS),
            tuple(flights.error(corrector, h) for h in CAGES),
            flights.others(corrector),
        )
