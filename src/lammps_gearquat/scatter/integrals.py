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

Flights that have not parted count as isotropic scattering without transfer of energy.  Errors include all
contributions of these flights.
"""

from dataclasses import dataclass

import numpy as np

from gearquat_analysis.units import UNITS

from ..trials.script import DeckError
from . import gas
from .sampling import REPLICAS

#: mean of sin^2 and of cos over all directions
ISOTROPIC = (2.0 / 3.0, 0.0)
#: energy that a flight may lose or gain, as a part of the initial one
WORST = 0.05


@dataclass(frozen=True)
class Quantity:
    """A ``value`` with its standard ``error``, in ``unit``; ``about`` describes the quantity."""

    name: str
    value: float
    error: float
    unit: str
    about: str


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


def quantities(columns, plan, facts):
    """List of Quantity; the first two are those that --error refers to.

    Raises DeckError if no flight has parted, or if one has not kept its energy.
    """
    parted = columns["fate"] == "parted"
    if not parted.any():
        raise DeckError(
            f"none of the {len(parted)} flights has parted: more --steps are required ({columns['message'][0]})"
        )
    worst = columns["error_energy"][parted].max()
    if not worst < WORST:
        raise DeckError(f"a flight has changed its energy by {worst:.2g} of the initial one: use a smaller tolerance")
    area = plan.weights(columns["b"], columns["energy"])
    pairs = Collisions.of(columns, plan.scale, plan.balanced or not any(facts.freedoms) and not plan.energy)
    means = {"11": pairs.change(0), "22": pairs.f22, "12": pairs.change(1), "transfer": pairs.gain**2, "gain": pairs.gain}
    means = {name: area * values for name, values in means.items()}
    rows = gas.at_one_energy() if plan.energy else gas.at_temperature(facts, plan.temperature)
    if any(facts.freedoms):
        rows["transfer"] = (lambda m: m["transfer"], "length^2", "of the squared energy given to rotation")
        rows["gain"] = (lambda m: m["gain"], "length^2", "of the energy given to rotation")
    functions = [function for function, *_ in rows.values()]
    found = estimates(means, columns["flight"] % REPLICAS, parted, functions)
    return [
        Quantity(name, *both, _with_units(unit, facts.style), about)
        for (name, (_, unit, about)), both in zip(rows.items(), found)
    ]


def estimates(integrands, replica, parted, functions):
    """(value, standard error) of each of the functions of the dictionary name -> mean.

    ``integrands``: name -> (n,); ``replica`` (n,), from 0 to REPLICAS - 1, equally many of each.  Errors are those of the
    jackknife over replicas; the factor (R - 1) / (R - 3) makes them the variance of Student's distribution with R - 1
    degrees of freedom, which value / jackknife error follows.  The contributions of
    flights that have not ``parted`` (n,) are added to them.
    """
    values = np.column_stack(list(integrands.values()))
    whole, ended = values.mean(axis=0), (values * parted[:, None]).mean(axis=0)
    left_out = [values[replica != k].mean(axis=0) for k in range(REPLICAS)]
    rows = [dict(zip(integrands, row)) for row in (whole, ended, *left_out)]
    found = []
    for function in functions:
        value, other, *some = map(function, rows)
        error = np.std(some) * np.sqrt((REPLICAS - 1) * (REPLICAS - 1) / (REPLICAS - 3))
        found.append((float(value), float(np.hypot(error, other - value))))
    return found


def _with_units(unit, style):
    """A unit with the names of lengths and times in the style; in units lj only those that are not obvious."""
    if style == "lj":
        return "" if unit in ("length^2", "length^3/time") else unit
    return unit.replace("length", UNITS[style].length).replace("time", UNITS[style].time)
