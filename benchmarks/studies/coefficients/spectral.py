"""The search for coefficients without a projection: the least drift in liquids.

Parameters are the spurious roots without forces, of a modulus of at most INNER, and c_0.  What is minimized is
the drift that prediction.py foresees from recorded spectra of liquids.  It would favor roots that let noise,
friction or fast vibrations grow, so these are constraints.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from . import prediction
from .search import DAMPED, FRICTION, Search, spectrum

#: kernel and search of quaternions of any length: numbers of values
VALUES = (5,)
#: largest modulus of a root without forces, and largest gain of noise
INNER, NOISE = 0.98, 5.0
#: oscillations with up to so many radians in a step are stable
REACH = 0.96
#: step in fs -> drift that counts as much as those at the other steps, kT/ns/dof
USUAL = {2.5: 0.01, 3.0: 0.015, 4.0: 0.5}
#: largest c_0
MOST_C0 = 0.05
#: weight of what is beyond a constraint, by the constraint
WEIGHT = 100.0


@dataclass(frozen=True)
class SpectralSearch(Search):
    """What is searched for: N ``values``, an odd number, of the second formulation."""

    formulation: str = "second"
    values: int = 5

    @property
    def reach(self):
        """Largest omega h that counts."""
        return REACH

    @property
    def bounds(self):
        """(low, high) of each parameter: moduli and angles (in pi) of pairs, and c_0."""
        return [(0, INNER), (0, 1)] * ((self.values - 3) // 2) + [(0, MOST_C0)]

    def corrector(self, x):
        """Corrector of the parameters ``x``."""
        placed = replace(self.placed(x[:-1]), passes=0, any_norm=True)
        return placed.moved(x[-1] - placed.sets[0][0])

    @cached_property
    def _spectra(self):
        return prediction.recorded().values()

    def drifts(self, corrector):
        """Drift (liquids, steps) at the steps of USUAL, kT/ns/dof."""
        return np.array([[own.drift(corrector, dt) for dt in USUAL] for own in self._spectra])

    def excess(self, corrector):
        """By how much noise, friction and vibrations are beyond what is allowed, as parts of it."""
        damped = [np.linalg.eigvals(corrector.step(z, -FRICTION)) for z in DAMPED]
        roots = spectrum(corrector, np.linspace(0.5 * self.reach, self.reach, 4))[:, 2]
        sizes = corrector.noise / NOISE, np.abs(damped).max(), roots.max()
        return [max(0.0, size - 1.0) for size in sizes]

    def cost(self, corrector):
        """What is minimized: the largest drift by the usual one at the step."""
        drift = abs(self.drifts(corrector)) / list(USUAL.values())
        return float(drift.max() + WEIGHT * sum(self.excess(corrector)))
