"""Properties of coefficients: linear ones (model equations, responses, changing steps) and motions of bodies."""

from dataclasses import dataclass
from fractions import Fraction

import mpmath
import numpy as np

from benchmarks.reference.stability import linear_limit

from .kernel import LOST, gear
from .prediction import open_loop, response
from .search import Search, spectrum

#: value of omega h for properties that are a single number; decimal digits of the principal root
AT, DIGITS = 0.3, 40
#: damping rate of the damped oscillator, and driving frequency of the driven one, relative to the natural frequency
DAMPED, DRIVEN = 0.1, 0.5
#: ratios of a step to the step before
RATIOS = (0.8, 0.9, 1.1, 1.25)
#: radians per step at which responses are given
RESPONSES = (0.8, 1.0, 1.2)
#: steps of the librations, free tops and bodies in the cage
LIBRATIONS, TOPS, CAGES = (0.2, 0.35), (0.1, 0.2), (0.4, 0.2, 0.1)
#: other starts in the cage: their seeds, time and step
SEEDS, SHORT, START_STEPS = range(1001, 1009), 40.0, (0.4, 0.2)
#: change of c_0 that shows its effect
MOVED = Fraction(1, 20)


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
    scaled, q = float(ratio) ** np.arange(corrector.values), corrector.order
    spurious = ((scaled[:, None] * open_loop(c, q))[q:, q:] for c in corrector.floats[: 3 - q])
    return max(abs(np.linalg.eigvals(step)).max() for step in spurious)


def models(corrector, z=AT):
    """Errors of damped and driven oscillation and of gyroscopic motion, with steps of z radians.

    For x'' = -x - 2 DAMPED x' and x'' = i x' it is the error of the root, |lambda - exact|, with the velocity term
    computed in two passes.  For x'' = -x + exp(i DRIVEN t) it is the relative error of the steady motion.
    """
    decay = np.exp(z * (-DAMPED + 1j * np.sqrt(1 - DAMPED**2)))
    damped = np.linalg.eigvals(corrector.step(z, -2 * DAMPED * z, passes=2))
    spinning = np.linalg.eigvals(corrector.step(0.0, 1j * z, passes=2))
    of_force = response(corrector, [DRIVEN * z])[0]
    steady = of_force * (DRIVEN**2 - 1) / (DRIVEN**2 - of_force) - 1
    return abs(damped - decay).min(), abs(steady), abs(spinning - np.exp(1j * z)).min()


@dataclass(frozen=True)
class Linear:
    """Linear properties of a Corrector.

    * ``error``: largest (|damping| + PHASE |phase|)/(omega h)^N in the range of the search
    * ``damping``, ``phase``: at AT
    * ``memory``: largest spurious root without forces; ``limit``: largest stable omega h
    * ``noise``: see Corrector; ``radii``: at RATIOS; ``models``: errors of the model equations
    * ``responses``: imaginary parts at RESPONSES
    """

    error: float
    damping: float
    phase: float
    memory: float
    limit: float
    noise: float
    radii: tuple
    models: tuple
    responses: tuple

    @classmethod
    def of(cls, corrector):
        """Properties of a Corrector."""
        search = Search(corrector.formulation, corrector.values)
        return cls(
            float(10 ** search.oscillation(corrector)[0]),
            *principal(corrector, AT),
            float(radius(corrector, 1.0)),
            float(linear_limit(corrector.step)),
            corrector.noise,
            tuple(float(radius(corrector, ratio)) for ratio in RATIOS),
            tuple(map(float, models(corrector))),
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
        exact = gear("second", 11)
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
    """``librations`` and ``tops``: energy changes at LIBRATIONS and TOPS; ``cages``: errors of test case 1 at CAGES;
    ``starts``: errors of the other starts at START_STEPS."""

    librations: tuple
    tops: tuple
    cages: tuple
    starts: tuple

    @classmethod
    def of(cls, corrector, flights):
        """Motions with a Corrector."""
        return cls(
            tuple(corrector.libration(h, (1.0, 0.8, 0.6), 0.4, 4000) for h in LIBRATIONS),
            tuple(corrector.free_top(h, 180.0) for h in TOPS),
            tuple(flights.error(corrector, h) for h in CAGES),
            flights.others(corrector),
        )
