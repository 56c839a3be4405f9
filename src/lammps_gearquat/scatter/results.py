"""The results of flights: Estimates, counts, and the convergence of the estimates."""

from dataclasses import dataclass

import numpy as np

from ..trials.script import DeckError
from . import gas
from .integrals import Averages, estimates, integrands

#: the quantities that --error refers to, by the kind of plan
AIMS = {"temperature": ("Omega(1,1)", "Omega(2,2)"), "energy": ("Q(1)", "Q(2)")}
#: the most flights that a message names
NAMED = 10
#: the smallest number of flights at which convergence is shown
FIRST_SHOWN = 128
#: energy that a flight may lose or gain, as a part of the initial one
WORST = 0.05
ERRORS = {"error_energy": "energy", "error_momentum": "momentum", "error_angular": "angular momentum"}


@dataclass(frozen=True)
class Answer:
    """Results of flights at one ``temperature``, None for one energy.

    ``estimates``: name -> Estimate; ``aims``, names of those that --error is about; ``correlations`` (k, k) of
    the errors of ``correlated`` (k,); ``unfinished``, the largest part of an aim that comes from flights that have not
    parted."""

    temperature: float
    estimates: dict
    aims: tuple
    correlated: tuple
    correlations: np.ndarray
    unfinished: float

    @property
    def relative(self):
        """The largest relative standard error of the aims."""
        return max(self.estimates[name].relative for name in self.aims)


@dataclass(frozen=True)
class Results:
    """``answers``, an Answer for each temperature; ``counts`` and ``errors``: name -> number; ``unfinished``:
    fate -> numbers of flights that have not parted; ``message`` of LAMMPS at the first flight that it ended."""

    answers: tuple
    counts: dict
    errors: dict
    unfinished: dict
    message: str = ""

    @property
    def relative(self):
        """The largest relative standard error of all aims."""
        return max(answer.relative for answer in self.answers)

    @property
    def guessed(self):
        """The largest fraction of any aim that comes from unparted flights."""
        return max(answer.unfinished for answer in self.answers)


def results(columns, plan, facts, sigma=None, left=None):
    """Results of the columns of flights; ``sigma``, the diameter of the rigid spheres to divide by; ``left`` as in
    ``pilots.Largest``.  Raises DeckError if no flight has parted, or if one has not kept its
    energy."""
    fate = columns["fate"]
    message = next(iter(columns["message"][fate == "lost"].tolist()), "")
    if not (fate == "parted").any():
        why = f"LAMMPS ended them ({message})" if message else "more --steps are required, with another --out"
        raise DeckError(f"none of the {len(fate)} flights has parted, so there is nothing to average: {why}")
    worst = errors(columns)["energy"][0]
    if not worst < WORST:
        raise DeckError(
            f"a flight has changed its energy by {worst:.2g} of the initial one, so the averages would be wrong: "
            "use a smaller tolerance, or a shorter time step, with another --out"
        )
    answers = [
        _answer(columns, plan, facts, temperature, sigma, own)
        for temperature, own in zip(plan.conditions, left or [{}] * len(plan.conditions))
    ]
    return Results(tuple(answers), counts(columns), errors(columns), unfinished(columns), message)


def _answer(columns, plan, facts, temperature, sigma, left):
    found, aims = integrands(columns, plan, facts, temperature), AIMS[plan.kind]
    averages = Averages(columns["flight"], found, columns["fate"] == "parted", left)
    correlated = tuple(name for name in averages.names if name != "cross section")
    every = estimates(averages, found) | gas.derived_estimates(averages, facts, temperature, sigma)
    guessed = max(averages.unfinished[name] for name in aims)
    return Answer(temperature, every, aims, correlated, averages.correlations(correlated), guessed)


def counts(columns):
    """Numbers of all flights, of flights with a repeated step, of orbiting flights and of unparted flights."""
    fate = columns["fate"]
    return {
        "flights": len(fate),
        "repeated": int(np.count_nonzero(columns["repeats"])),
        "orbiting": int(np.count_nonzero(columns["turnings"] > 1)),
        "unparted": int(np.count_nonzero(fate == "unparted")),
        "lost": int(np.count_nonzero(fate == "lost")),
        "steps": int(columns["steps"].sum()),
        "repeats": int(columns["repeats"].sum()),
    }


def errors(columns):
    """Name -> (largest, median) of the errors of flights that have parted."""
    parted = columns["fate"] == "parted"
    kept = {words: columns[name][parted] for name, words in ERRORS.items()}
    return {words: (float(values.max()), float(np.median(values))) for words, values in kept.items()}


def unfinished(columns):
    """Fate -> numbers of the flights with it."""
    return {fate: columns["flight"][columns["fate"] == fate].tolist() for fate in ("unparted", "lost")}


def convergence(columns, plan, facts, temperature):
    """Numbers of flights (k,), and name of an aim -> (values (k,), statistical errors (k,)) from this number of
    flights."""
    number = len(columns["flight"])
    shown = [n for n in FIRST_SHOWN * 2 ** np.arange(40) if n < number] + [number]
    found = integrands(columns, plan, facts, temperature)
    found = {name: found[name] for name in AIMS[plan.kind]}
    rows = []
    for n in shown:
        part = {name: (values[:n], *words) for name, (values, *words) in found.items()}
        rows.append(estimates(Averages(columns["flight"][:n], part), part))
    return np.array(shown), {
        name: (np.array([row[name].value for row in rows]), np.array([row[name].error for row in rows]))
        for name in AIMS[plan.kind]
    }
