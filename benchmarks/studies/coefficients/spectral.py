"""The search for five values, which are for long steps: the least drift in liquids.

Parameters are the spurious roots without forces, with a modulus of at most INNER, and c_0.  The search minimizes
the drift that prediction.py computes from recorded spectra of liquids.  The drift alone would favor roots with which
noise, motion with friction or fast vibrations grow, so these are constraints.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from . import prediction
from .kernel import Corrector
from .search import DAMPED, FRICTION, Search, spectrum

#: largest modulus of a root without forces, and largest noise gain
INNER, NOISE = 0.98, 5.0
#: step in fs -> typical drift, kT/ns/dof; drifts are divided by it before they are compared
USUAL = {2.5: 0.01, 3.0: 0.015, 4.0: 0.5}
#: largest c_0
MOST_C0 = 0.05
#: weight of a violation of a constraint, relative to the constraint
WEIGHT = 100.0


@dataclass(frozen=True)
class SpectralSearch(Search):
    """A search in which oscillations must be stable up to the reach."""

    values: int = 5

    @property
    def bounds(self):
        """(low, high) of each parameter: modulus and angle (in pi) of the pair of roots, and c_0."""
        return [(0, INNER), (0, 1), (0, MOST_C0)]

    def corrector(self, x):
        """Corrector of the parameters ``x``."""
        return Corrector((x[-1], *self.placed(x[:-1]).c[1:]))

    @cached_property
    def _spectra(self):
        return prediction.recorded().values()

    def drifts(self, corrector):
        """Drift (liquids, steps) at the steps of USUAL, kT/ns/dof."""
        return np.array([[own.drift(corrector, dt) for dt in USUAL] for own in self._spectra])

    def excess(self, corrector):
        """Relative violation of the constraints on noise, friction and vibrations."""
        damped = [np.linalg.eigvals(corrector.step(z, -FRICTION)) for z in DAMPED]
        roots = spectrum(corrector, np.linspace(0.5 * self.reach, self.reach, 4))[:, 2]
        sizes = corrector.noise / NOISE, np.abs(damped).max(), roots.max()
        return [max(0.0, size - 1.0) for size in sizes]

    def cost(self, corrector):
        """Cost function: the largest drift relative to the typical drift at the step."""
        drift = abs(self.drifts(corrector)) / list(USUAL.values())
        return float(drift.max() + WEIGHT * sum(self.excess(corrector)))
