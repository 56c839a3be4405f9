"""The search for tuned coefficients: differential evolution over spurious roots, then Nelder-Mead.

Parameters are the spurious roots without forces, inside the circle of radius INNER.  All other coefficients follow from
the order conditions, except c_0 for an odd number of values: c_0 is chosen such that an oscillation at half of the
reach keeps its energy.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import differential_evolution, minimize

from benchmarks.reference.correctors import completed, decimals, placed

from .kernel import LOST, VALUES, Corrector

#: limits of roots without forces, and of roots with forces up to MARGIN beyond the range of omega h
INNER, OUTER, MARGIN = 0.94, 0.955, 0.1
#: largest distance of a free c_0 from the value of highest order
C0_RANGE, C0_TRIED, SECANTS = 0.2, (-0.06, -0.1), 4
#: weight of the phase error relative to damping
PHASE = 0.05
#: number of values -> largest omega h of the search; five values are for long steps
REACH = dict(zip(VALUES, (0.9, 0.96, 0.7, 0.6, 0.55, 0.42, 0.45, 0.4, 0.36)))
#: largest noise gain, and the fraction of a momentum that friction removes in a step
NOISE, FRICTION = 8.0, 0.05
#: omega h with this friction: almost a free body, and an oscillation
DAMPED = (0.02, 0.2)
#: omega h of the librations relative to the reach
LIBRATIONS = np.array([0.2, 0.35, 0.5, 0.65, 0.8, 0.9])
#: (factor of the step, frequencies, amplitude in radians) of the librations
WELLS = ((1.0, (1.0, 0.8, 0.6), 0.3), (1.03, (0.9, 1.0, 0.5), 0.2))


def spectrum(corrector, omega_h):
    """Damping |lambda| - 1, phase error and largest spurious root at each omega h (n,): (n, 3)."""
    found = []
    for z in omega_h:
        roots = np.linalg.eigvals(corrector.step(z))
        own, other = (np.argmin(abs(roots - np.exp(s * z))) for s in (1j, -1j))
        rest = abs(np.delete(roots, [own, other]))
        found.append((abs(roots[own]) - 1.0, np.angle(roots[own]) - z, rest.max()))
    return np.array(found)


@dataclass(frozen=True)
class Search:
    """A search for coefficients with N ``values``."""

    values: int

    @property
    def free_c0(self):
        """True if the order conditions leave c_0 free."""
        return self.values % 2 == 1

    @property
    def reach(self):
        """Largest omega h of the search."""
        return REACH[self.values]

    @property
    def bounds(self):
        """(low, high) of each parameter: moduli and angles (in pi) of pairs, a real root."""
        count = self.values - 3
        return [(0, INNER), (0, 1)] * (count // 2) + [(-INNER, INNER)] * (count % 2)

    def placed(self, x):
        """Corrector of full order with the spurious roots ``x``."""
        pairs = x[: len(x) - len(x) % 2].reshape(-1, 2)
        roots = pairs[:, 0] * np.exp(1j * np.pi * pairs[:, 1])
        roots = np.concatenate([roots, roots.conj(), x[len(x) - len(x) % 2 :]])
        return Corrector(tuple(completed([1.0, *placed(roots)[1:]])))

    def corrector(self, x):
        """Corrector of the parameters ``x``."""
        corrector = self.placed(x)
        return self.balanced(corrector) if self.free_c0 else corrector

    def balanced(self, corrector):
        """The Corrector with the c_0 for which an oscillation keeps its energy."""

        def gain(by):
            return spectrum(corrector.moved(by), [self.reach / 2])[0, 0]

        last, by = C0_TRIED
        before, now = gain(last), gain(by)
        for _ in range(SECANTS):
            if now == before:
                break
            last, by, before = by, by - now * (by - last) / (now - before), now
            by = np.clip(by, -C0_RANGE, C0_RANGE)
            now = gain(by)
        return corrector.moved(by)

    def written(self, corrector):
        """The Corrector with rounded decimals; c_0 and c_1 are recomputed exactly from the other coefficients."""
        c = completed(decimals(corrector.c[2:]))
        if self.free_c0:
            c[:1] = decimals(corrector.c[:1])
        return Corrector(tuple(c))

    @cached_property
    def _grids(self):
        return np.linspace(0.08, self.reach, 9), np.linspace(0.05, self.reach + MARGIN, 6)

    def oscillation(self, corrector):
        """log10 of the largest (|damping| + PHASE |phase error|) / (omega h)^N; largest root."""
        counted, stable = self._grids
        found = spectrum(corrector, [*counted, *stable])
        damping, phase, _ = abs(found[: len(counted)].T)
        error = (damping + PHASE * phase) / counted**self.values
        return np.log10(error.max() + 1e-30), found[:, 2].max()

    def librations(self, corrector):
        """log10 of the energy changes of librations, relative to a typical change at each step."""
        usual = 10.0 ** (1 - self.values) * (LIBRATIONS * self.reach / 0.1) ** (self.values + 1)
        changes = [
            np.mean(
                [
                    abs(corrector.libration(z * part, frequency, amplitude, 600)) / amplitude
                    for part, frequency, amplitude in WELLS
                ]
            )
            for z in LIBRATIONS * self.reach
        ]
        levels = np.log10(np.maximum(1.7 * np.array(changes), 1e-14) / usual)
        return np.clip(levels, -2.5, 4.0)

    def disturbances(self, corrector):
        """log2 of the noise gain over NOISE; excess of the largest root with FRICTION over 1."""
        roots = [np.linalg.eigvals(corrector.step(z, -FRICTION)) for z in DAMPED]
        gain = np.log2(corrector.noise / NOISE)
        return max(0.0, gain), max(0.0, np.abs(roots).max() - 1.0)

    def cost(self, corrector):
        """Cost function."""
        error, root = self.oscillation(corrector)
        if root > OUTER + 0.05:
            return 20.0 + 50.0 * (root - OUTER)
        noise, friction = self.disturbances(corrector)
        error += 0.5 * noise + 60.0 * friction
        librations = self.librations(corrector)
        motions = 0.5 * librations.mean() + 0.1 * librations.max()
        return error + motions + 50.0 * max(0.0, root - OUTER)

    def run(self, seed=1, iterations=60):
        """The best Corrector found, with rounded decimals, and its cost."""

        def of(x):
            corrector = self.corrector(x)
            return self.cost(corrector) if np.all(np.isfinite(corrector.c)) else LOST

        options = {"maxiter": iterations, "popsize": 7, "seed": seed, "polish": False, "tol": 1e-9}
        rough = differential_evolution(of, self.bounds, **options).x
        most = {"maxfev": 17 * iterations, "fatol": 1e-5, "xatol": 1e-6}
        best = minimize(of, rough, method="Nelder-Mead", bounds=self.bounds, options=most).x
        corrector = self.written(self.corrector(best))
        return corrector, self.cost(corrector)
