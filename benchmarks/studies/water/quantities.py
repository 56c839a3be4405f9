"""Averages, fluctuations and motion of water from samples, with standard errors from the scatter of the samples."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.constants import Avogadro, calorie

from gearquat_analysis.tables import with_error
from gearquat_analysis.units import UNITS

from .plan import MODELS, TEMPERATURE

REAL = UNITS["real"]
KT = REAL.boltzmann * TEMPERATURE
#: A^3/(kcal/mol) in 1/GPa
PER_GPA = 1.0 / (1e30 * 1e3 * calorie / Avogadro * 1e-9)
#: energy of the charges of a rigid molecule of SPC/E, which its forces include, kcal/mol: two O-H of 1 A and one H-H
WITHIN_MOLECULE = {
    "spce": REAL.coulomb * 0.4238**2 * (1 / (2 * math.sin(math.radians(109.47) / 2)) - 4),
    "tip4p": 0.0,
}


def average(samples, name):
    """Mean of one value of the samples, weighted equally: they have equal lengths."""
    return float(np.mean([getattr(sample, name) for sample in samples]))


def energy(samples):
    """Potential energy per molecule without the energy within it, kcal/mol."""
    return average(samples, "energy") - WITHIN_MOLECULE[samples[0].model]


def warmer(samples):
    """Temperature of translation minus temperature of rotation."""
    return average(samples, "translation") - average(samples, "rotation")


def compressibility(samples):
    """Isothermal, from the variance of the volume, 1/GPa."""
    volume = average(samples, "volume")
    return (average(samples, "volume2") - volume**2) / (volume * KT) * PER_GPA


def mean_of(name, factor=1.0):
    """A function of samples: the mean of one value."""
    return lambda samples: factor * average(samples, name)


@dataclass(frozen=True)
class Quantity:
    """A quantity that is read from samples: ``name`` and ``unit``; ``read(list of samples)``; ``sign``: "+" for differences."""

    name: str
    unit: str
    read: Callable
    sign: str = ""

    def of(self, samples):
        """(value, standard error); NaN without samples, and for an error from fewer than three."""
        return jackknife(samples, self.read)

    def text(self, samples):
        """Value and error as a cell."""
        return cell(self.of(samples), self.sign)

    @property
    def title(self):
        """With its unit."""
        return f"{self.name}, {self.unit}" if self.unit else self.name


def jackknife(samples, read):
    """(value, error) of ``read(list of samples)`` from all samples and from all but each."""
    n = len(samples)
    if not n:
        return math.nan, math.nan
    value = read(samples)
    if n < 3:
        return value, math.nan
    others = np.array([read(samples[:k] + samples[k + 1 :]) for k in range(n)])
    return value, float(np.sqrt((n - 1) / n * np.sum((others - others.mean()) ** 2)))


def cell(found, sign=""):
    """A (value, error) as a cell."""
    value, error = found
    if math.isnan(value):
        return "–"
    return with_error(value, error, sign=sign) if error > 0 else f"{value:{sign}.4f}"


DENSITY = Quantity("density", "g/mL", mean_of("density"))
ENERGY = Quantity("potential energy", "kcal/mol", energy)
WARMER = Quantity("T translation − T rotation", "K", warmer, "+")
COMPRESSIBILITY = Quantity("compressibility", "1/GPa", compressibility)
#: of the conserved energy, of molecules with the total momentum of zero
DRIFT = Quantity("drift", "kT/ns/dof", mean_of("drift", 1e3 / (KT * (6 * MODELS["tip4p"].molecules - 3))), "+")
PRESSURE = Quantity("pressure", "atm", mean_of("measured"))
AVERAGES = [DENSITY, ENERGY, WARMER]
FLUCTUATIONS = [
    COMPRESSIBILITY,
    Quantity("diffusion", "1e-9 m²/s", mean_of("diffusion", 10.0)),
    Quantity("rotation time", "ps", mean_of("turning")),
]


def extrapolated(fine, coarse, quantity):
    """(value, error) of a quantity without the error of second order, from steps h and 2 h (Richardson)."""
    (value, error), (other, apart) = quantity.of(fine), quantity.of(coarse)
    return (4 * value - other) / 3, math.hypot(4 * error, apart) / 3


def difference(one, other):
    """(value, error) of the difference of two (value, error)."""
    return one[0] - other[0], math.hypot(one[1], other[1])
