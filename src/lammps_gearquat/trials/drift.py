"""Drift of the energy at the steps that are recommended."""

import math
from dataclasses import dataclass, replace

from gearquat_analysis.units import UNITS

from . import evaluate
from .explain import explained
from .worker import NOT_FINISHED, TrialError

#: kT per degree of freedom and ns above which a step is warned of
BOUND = 0.1
#: the part of the budget that is kept for these runs
SHARE = 0.1
#: times at which a run is sampled
SAMPLES = 100
#: longest run, in ns
LONGEST = 0.1
#: standard errors that a drift has to be away from the bound to be judged
SURE = 2.0


@dataclass(frozen=True)
class Drift:
    """Drift of the conserved energy over a run of length ``time``, in units of the deck.

    ``rate`` and its standard ``error`` are in kT per degree of freedom and ns (in units lj: 1000 time units), with
    the kT of the mean kinetic energy.  Both are NaN if they are unknown, and then ``reason`` says why.
    ``failure`` is the error that ended a longer run, if there was one.
    """

    rate: float = math.nan
    error: float = math.nan
    time: float = 0.0
    reason: str = ""
    failure: str = ""

    @property
    def drifts(self):
        """Whether the drift is beyond BOUND for sure."""
        return abs(self.rate) - SURE * self.error > BOUND

    @property
    def holds(self):
        """Whether the drift is within BOUND for sure."""
        return abs(self.rate) + SURE * self.error < BOUND


def nanosecond(deck):
    """A nanosecond in the unit of time of the deck; 1000 in units lj."""
    return 1000.0 / UNITS[deck.units].ps


def of_trial(trial, nanosecond):
    """Drift of a trial with energies."""
    energy, kinetic = trial.energies.T
    thermal = 2.0 * kinetic.mean()  # kT times the number of degrees of freedom
    if not thermal > 0.0:
        return Drift(time=trial.time[-1], reason="there is no kinetic energy")
    rate, error = (nanosecond * number / thermal for number in evaluate.trend(trial.time, energy))
    return Drift(rate, error, float(trial.time[-1]))


def measure(study, costs):
    """Drift of each recommended step: dictionary (keywords, step) -> Drift.

    What is left of the budget is shared by runs as long as it allows, up to LONGEST or the trials' own length.
    """
    chosen = list(dict.fromkeys(row.recommended for row in costs.rows if row.choice))
    found = {}
    for number, (keywords, dt) in enumerate(chosen):
        found[keywords, dt] = _of_step(study, costs, keywords, dt, study.budget.left() / (len(chosen) - number))
    return found


def _of_step(study, costs, keywords, dt, seconds):
    """Drift at a step, from a run that takes so many seconds at most; from a shorter one where that does not end."""
    if study.deck.partial and study.deck.others:
        return Drift(reason="LAMMPS does not print the whole kinetic energy of these bodies and of the other atoms")
    ns = nanosecond(study.deck)
    longest = max(LONGEST * ns, costs.end) / dt
    affordable = (seconds - study.overhead) / (1.2 * study.pace[keywords])
    whole, judged = (int(steps / SAMPLES) for steps in (min(longest, affordable), min(costs.end / dt, affordable)))
    reason, failure = "no run was long enough", ""
    for stride in dict.fromkeys(filter(None, (whole, judged))):
        timeout = max(min(2.0 * seconds, study.budget.left()), 0.0)
        try:
            trial = study.deck.run(keywords, [stride] * SAMPLES, dt, timeout, energies=True)
            return replace(of_trial(trial, ns), failure=failure)
        except TrialError as error:
            if str(error).startswith(NOT_FINISHED):
                reason = f"a run was {error}"
            else:
                failure = failure or explained(str(error), study.deck, dt)
    return Drift(reason=reason, failure=failure)
