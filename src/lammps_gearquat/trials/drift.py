"""Energy drift at a step, and the difference between the temperatures of translation and rotation."""

import math
from dataclasses import dataclass, replace

from gearquat_analysis.blocks import Estimate, of_series
from gearquat_analysis.units import UNITS

from ..launch import LammpsError
from . import BOUND, evaluate
from .worker import NOT_FINISHED

#: allowed difference of the temperatures of translation and rotation, relative to the temperature
BALANCE = 0.01
#: number of times at which a run is sampled, if it has that many steps, and number of their means for the slope of the
#: energy
SAMPLES, MEANS = 400, 100
#: longest run, in ns
LONGEST = 0.1
#: number of standard errors between a drift and the bound that is required for a judgment
SURE = 2.0


@dataclass(frozen=True)
class Drift:
    """Drift of the conserved energy over a run of length ``time``, in units of the deck.

    ``rate`` and its standard ``error`` are in kT per degree of freedom and ns (in units lj: 1000 time units), with
    the kT of the mean kinetic energy.  Both are NaN if they are unknown, and then ``reason`` says why.
    ``failure`` is the error that ended a run, if there was one.
    ``difference``, Estimate of T translation - T rotation in kelvin over the second half, and ``temperature``, their mean, likewise.
    ``bound``: the largest ``rate`` that is allowed.
    """

    rate: float = math.nan
    error: float = math.nan
    time: float = 0.0
    reason: str = ""
    failure: str = ""
    difference: Estimate = Estimate.missing("not measured")
    temperature: float = math.nan
    bound: float = BOUND

    @property
    def known(self):
        return not math.isnan(self.rate)

    @property
    def drifts(self):
        """True if the drift certainly exceeds the bound."""
        return abs(self.rate) - SURE * self.error > self.bound

    @property
    def unbalanced(self):
        """True if the temperatures of translation and rotation certainly differ by more than the fraction BALANCE."""
        return abs(self.difference.value) - SURE * self.difference.error > BALANCE * self.temperature

    @property
    def fails(self):
        """True if a run ended with an error caused by the step."""
        return bool(self.failure)

    @property
    def refused(self):
        """True if the step must not be recommended."""
        return self.drifts or self.unbalanced or self.fails

    @property
    def holds(self):
        """True if the drift is certainly within the bound, and nothing else rules out the step."""
        return abs(self.rate) + SURE * self.error < self.bound and not self.refused


def nanosecond(deck):
    """A nanosecond in the unit of time of the deck; 1000 in units lj."""
    return 1000.0 / UNITS[deck.units].ps


def longest(deck):
    """The longest time over which drifts are measured, in the unit of time of the deck."""
    return LONGEST * nanosecond(deck)


def of_trial(trial, nanosecond, freedoms=None, boltzmann=1.0, bound=BOUND):
    """Drift of a trial with energies (S, 2), or (S, 4) where there are ``freedoms`` of translation and rotation."""
    energy, kinetic, *parts = trial.energies.T
    thermal = 2.0 * kinetic.mean()  # kT times the number of degrees of freedom
    if not thermal > 0.0:
        return Drift(time=float(trial.time[-1]), reason="there is no kinetic energy", bound=bound)
    # means over equal times contain all information on the slope, for white noise and a random walk
    many = len(energy) // min(len(energy), MEANS)
    time, energy = (values[: len(values) // many * many].reshape(-1, many).mean(axis=1) for values in (trial.time, energy))
    rate, error = (nanosecond * number / thermal for number in evaluate.trend(time, energy))
    found = Drift(rate, error, float(trial.time[-1]), bound=bound)
    if freedoms is None or not parts:
        return found
    translation, rotation = (2.0 * part / (number * boltzmann) for part, number in zip(parts, freedoms))
    mean = float(0.5 * (translation + rotation).mean())
    # the first half may come to equilibrium, after a start with other temperatures
    later = (translation - rotation)[len(translation) // 2 :]
    return replace(found, difference=of_series(later), temperature=mean)


def run(inquiry, keywords, dt, steps, timeout, bound=BOUND, balance=False):
    """Drift in a run of about this number of ``steps``; NaN, with a reason, if the run was not finished or ended with
    an error.

    ``balance``: whether the temperatures of translation and rotation are compared, as in a liquid in equilibrium.
    """
    deck = inquiry.deck
    if deck.partial and deck.others:
        reason = "LAMMPS does not print the whole kinetic energy of these bodies and of the other atoms"
        return Drift(reason=reason, bound=bound)
    stride = max(int(steps) // SAMPLES, 1)
    samples = int(steps) // stride
    if samples < evaluate.FEWEST:
        return Drift(reason="no run was long enough", bound=bound)
    inquiry.budget.say(f"drift of {keywords or ('own fix' if keywords is None else 'default settings')}, step {dt:g}")
    try:
        trial = deck.run(keywords, [stride] * samples, dt, timeout, energies=True)
    except LammpsError as error:
        said = str(error)
        if said.startswith(NOT_FINISHED):
            return Drift(reason=f"a run was {said}", bound=bound)
        return Drift(failure=said, bound=bound)
    finally:
        inquiry.budget.spent()
    inquiry.pace[keywords] = trial.seconds[0] / trial.steps
    freedoms = deck.freedoms if balance else None
    return of_trial(trial, nanosecond(deck), freedoms, UNITS[deck.units].boltzmann, bound)
