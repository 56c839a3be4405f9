"""Averages over flights with their standard errors: cross sections and collision integrals.

Energies are divided by kT: x of the relative translation before the collision, y after it, and d = x - y, what
rotation has gained; chi is the angle between the relative velocities.  A bar is the integral over all impact
parameters, 2 pi b db, averaged over orientations and angular momenta.  With the momentum flux of the
relative velocity (C. S. Wang Chang and G. E. Uhlenbeck, University of Michigan Report CM-681 (1951); N. Taxman,
Phys. Rev. 110, 1235 (1958)) the collision integrals are

    Omega(l,s) = (k T / (2 pi mu))^(1/2) 1/2 integral of x exp(-x) bar(F_ls) dx,

    F_11 = x - (x y)^(1/2) cos chi,    F_12 = x F_11,    F_22 = x y sin^2 chi + 2 x d / 3.

If no energy goes to rotation, these integrals reduce to the integrals of J. O. Hirschfelder, C. F. Curtiss and R. B.
Bird, Molecular Theory of Gases and Liquids, Wiley (1954), eq. (8.2-3), with F_ls = x^s (1 - cos^l chi).

If rotation has the temperature of translation, then by detailed balance the mean of a function of x and y does not
change if x and y are exchanged.  Means of both have much smaller errors, because what is of
first order in d cancels:

    F_11 = (x + y) / 2 - (x y)^(1/2) cos chi,    F_22 = x y sin^2 chi + d^2 / 3,
    F_12 = (x^2 + y^2) / 2 - (x + y) / 2 (x y)^(1/2) cos chi.

The mean of this F_22 equals the mean of x^2 sin^2 chi + d^2 / 3 - d^2 sin^2 chi / 2, the form of L. Monchick, K. S.
Yun and E. A. Mason, J. Chem. Phys. 39, 654 (1963).

Flights that have not parted count as isotropic scattering without transfer of energy.  Errors
include all contributions of these flights, and the part beyond the largest impact parameter.
"""

from dataclasses import dataclass

import numpy as np

from gearquat_analysis.units import UNITS

from .sampling import REPLICAS

#: least number of replicas for a standard error
LEAST = 4
#: the loss that a mean is proportional to; see pilots.py
LOSS = {
    **dict.fromkeys(("Q(1)", "cross section", "Omega(1,1)", "Omega(1,2)"), "momentum"),
    **dict.fromkeys(("Q(2)", "Omega(2,2)"), "viscosity"),
    **dict.fromkeys(("transfer", "gain"), "rotation"),
}
#: mean of sin^2 and of cos over all directions
ISOTROPIC = (2.0 / 3.0, 0.0)


@dataclass(frozen=True)
class Estimate:
    """A ``value`` with its standard ``error``, in ``unit``; ``about`` describes the quantity."""

    value: float
    error: float
    unit: str
    about: str

    @property
    def relative(self):
        """Standard error divided by the value."""
        return abs(self.error / self.value) if self.value else np.inf


@dataclass(frozen=True)
class Collisions:
    """Columns (n,) of flights: ``x``, ``y``, ``cosine`` and ``sine2`` = sin^2 chi; ``balanced``: detailed balance holds."""

    x: np.ndarray
    y: np.ndarray
    cosine: np.ndarray
    sine2: np.ndarray
    balanced: bool = False

    @classmethod
    def of(cls, columns, scale, balanced=False):
        """From the columns of flights, with ``scale`` the unit of energy."""
        parted = columns["fate"] == "parted"
        x = columns["energy"] / scale
        y = np.where(parted, columns["energy_after"] / scale, x)
        sine2 = np.where(parted, np.sin(columns["angle"]) ** 2, ISOTROPIC[0])
        return cls(x, y, np.where(parted, np.cos(columns["angle"]), ISOTROPIC[1]), sine2, balanced)

    @property
    def gain(self):
        """The energy gained by rotation."""
        return self.x - self.y

    def change(self, power):
        """F_11 for ``power`` 0, and F_12 for 1: the change of the velocity along itself, times x^power."""
        turned = np.sqrt(self.x * self.y) * self.cosine
        if not self.balanced:
            return self.x**power * (self.x - turned)
        before, after = self.x**power, self.y**power
        return 0.5 * (self.x * before + self.y * after - (before + after) * turned)

    @property
    def f22(self):
        """Change of the momentum flux."""
        rest = self.gain**2 / 3.0 if self.balanced else 2.0 * self.x * self.gain / 3.0
        return self.x * self.y * self.sine2 + rest


def thermal_speed(facts, temperature):
    """(k T / (2 pi mu))^(1/2) in units of the deck."""
    units = UNITS[facts.style]
    return np.sqrt(units.boltzmann * temperature / (2.0 * np.pi * facts.reduced_mass * units.energy))


def integrands(columns, plan, facts, temperature):
    """Name -> (integrand (n,), unit, description); the quantities are the means of the integrands over flights.

    ``temperature``, a temperature of the plan; None for one energy.
    """
    area = weights(columns, plan, facts, temperature)
    if temperature is None:
        pairs = Collisions.of(columns, plan.energy)
        found = {
            "Q(1)": (area * pairs.change(0), "length^2", "momentum-transfer cross section"),
            "Q(2)": (area * pairs.f22, "length^2", "viscosity cross section"),
        }
        return found | _of_rotation(area, pairs, facts)
    pairs = Collisions.of(columns, UNITS[facts.style].boltzmann * temperature, plan.balanced(facts.freedoms))
    speed = thermal_speed(facts, temperature)
    part, unit = 0.5 * area, "length^3/time"
    found = {
        "cross section": (part * pairs.change(0), "length^2", "averaged over energies and orientations"),
        "Omega(1,1)": (speed * part * pairs.change(0), unit, "collision integral of diffusion"),
        "Omega(2,2)": (speed * part * pairs.f22, unit, "collision integral of viscosity"),
        "Omega(1,2)": (speed * part * pairs.change(1), unit, "collision integral of thermal diffusion"),
    }
    return found | _of_rotation(area, pairs, facts)


def _of_rotation(area, pairs, facts):
    """Quantities of the energy gained by rotation, if bodies rotate; ``area`` is the area of a flight."""
    if not any(facts.freedoms):
        return {}
    return {
        "transfer": (area * pairs.gain**2, "length^2", "of the squared energy given to rotation"),
        "gain": (area * pairs.gain, "length^2", "of the energy given to rotation"),
    }


def weights(columns, plan, facts, temperature):
    """The area (n,) that each flight represents, times the flux x exp(-x) by the density of its start; see density.py."""
    boltzmann = UNITS[facts.style].boltzmann
    density, energy = plan.density(boltzmann), columns["energy"]
    area = density.area(columns["b"], energy)
    if temperature is None:
        return area
    scale = boltzmann * temperature
    flux, drawn = energy / scale**2 * np.exp(-energy / scale), density.densities(energy)
    if plan.mixes_rotation(facts.freedoms):
        rotation, scales = columns["rotation_1"] + columns["rotation_2"], np.array(density.scales)[:, None]
        # densities of all angular momenta, divided by the density at the highest temperature
        own = (scales / scales[-1]) ** (-0.5 * sum(facts.freedoms))
        own = own * np.exp(-rotation * (1.0 / scales - 1.0 / scales[-1]))
        flux, drawn = flux * own[plan.temperature.index(temperature)], drawn * own
    return area * flux / (density.shares @ drawn)


class Averages:
    """Means of integrands over flights, of all and with one replica left out.

    ``means`` (1 + R, m): the first row is from all flights; ``names`` (m,), in the same order.  ``shifts``: factors
    (m,),
    one array for each systematic error; the changes of the results by these factors are added to the standard errors.
    """

    def __init__(self, numbers, found, finished=None, left=None):
        """``numbers`` (n,) of the flights; ``found``: name -> (integrand (n,), ...); ``finished`` (n,), whether
        flights have parted; ``left``: loss -> part beyond the largest impact parameter, None where it is not known."""
        self.names = list(found)
        values = np.column_stack([entry[0] for entry in found.values()])
        replica = np.asarray(numbers) % REPLICAS
        sums = np.zeros((REPLICAS, values.shape[1]))
        np.add.at(sums, replica, values)
        counts = np.bincount(replica, minlength=REPLICAS)
        kept = counts > 0
        sums, counts = sums[kept], counts[kept][:, None]
        self.replicas = len(counts)
        total, number = sums.sum(axis=0), counts.sum()
        with np.errstate(invalid="ignore", divide="ignore"):
            self.means = np.vstack([total / number, (total - sums) / (number - counts)])
            gone = 0.0 if finished is None else values[~np.asarray(finished)].sum(axis=0) / total
        #: name -> part of the mean that comes from flights that have not parted
        self.unfinished = dict(zip(self.names, np.nan_to_num(np.broadcast_to(gone, total.shape)).tolist()))
        unknown = [*(left or {}).items(), *self._guessed().items()]
        self.shifts = [
            np.array([1.0 + part if LOSS.get(name) == loss else 1.0 for name in self.names])
            for loss, part in unknown
            if part
        ]

    def _guessed(self):
        """Loss -> fraction from unparted flights; for rotation, whose gain is then 0, the largest possible one."""
        parts = {}
        for name, part in self.unfinished.items():
            loss = LOSS.get(name)
            parts[loss] = max(parts.get(loss, 0.0), abs(part))
        return parts | {"rotation": max(parts.values())}

    def of(self, function):
        """(value, standard error) of a function of the dictionary name -> mean, by the jackknife."""
        values = np.array([function(dict(zip(self.names, row))) for row in self.means])
        shifted = [function(dict(zip(self.names, self.means[0] * row))) - values[0] for row in self.shifts]
        return float(values[0]), float(np.linalg.norm([_spread(values[1:]), *shifted]))

    def correlations(self, names):
        """Matrix (k, k) of the correlations between the statistical errors of ``names`` (k,)."""
        if self.replicas < 2:
            return np.full((len(names), len(names)), np.nan)
        kept = self.means[1:, [self.names.index(name) for name in names]]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.corrcoef(kept.T)


def _spread(values):
    """Standard error from values that leave out one replica each, nan for fewer than LEAST of them.

    The factor (R - 1) / (R - 3) makes it the variance of Student's distribution with R - 1 degrees of freedom, which
    value / jackknife error follows.
    """
    number = len(values)
    if number < LEAST:
        return np.nan
    square = (number - 1) / number * ((values - values.mean()) ** 2).sum()
    return float(np.sqrt(square * (number - 1) / (number - 3)))


def estimates(averages, found):
    """Name -> Estimate of all means."""
    return {
        name: Estimate(*averages.of(lambda means, name=name: means[name]), unit, about)
        for name, (_, unit, about) in found.items()
    }
