"""All that flights say, as Estimates, counts and how the estimates have converged."""

from dataclasses import dataclass

import numpy as np

from . import gas
from .integrals import Averages, estimates, integrands

#: what --error is an error of, by the kind of plan
AIMS = {"temperature": ("Omega(1,1)", "Omega(2,2)"), "energy": ("Q(1)", "Q(2)")}
#: flights that are named at most
NAMED = 10
#: numbers of flights at which convergence is shown begin with this one
FIRST_SHOWN = 128
ERRORS = {"error_energy": "energy", "error_momentum": "momentum", "error_angular": "angular momentum"}


@dataclass(frozen=True)
class Results:
    """``estimates``: name -> Estimate; ``aims``, names of those that --error is about; ``correlations`` (k, k) of
    their errors and of those of ``correlated`` (k,); ``counts`` and ``errors``: name -> number; ``unfinished``:
    fate -> numbers of flights that have not parted."""

    estimates: dict
    aims: tuple
    correlated: tuple
    correlations: np.ndarray
    counts: dict
    errors: dict
    unfinished: dict

    @property
    def relative(self):
        """The largest relative standard error of the aims."""
        return max(self.estimates[name].relative for name in self.aims)


def results(columns, plan, facts, sigma=None):
    """Results of the columns of flights; ``sigma``, the diameter of the rigid spheres to divide by."""
    found = integrands(columns, plan, facts)
    averages = Averages(columns["flight"], found)
    aims = AIMS[plan.kind]
    correlated = tuple(name for name in averages.names if name != "cross section")
    every = estimates(averages, found) | gas.derived_estimates(averages, facts, plan, sigma)
    correlations = averages.correlations(correlated)
    return Results(every, aims, correlated, correlations, counts(columns), errors(columns), unfinished(columns))


def counts(columns):
    """Numbers of flights, of those with a repeated step, of orbiting ones, and of those that have not parted."""
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
    if not parted.any():
        return {words: (np.nan, np.nan) for words in ERRORS.values()}
    kept = {words: columns[name][parted] for name, words in ERRORS.items()}
    return {words: (float(values.max()), float(np.median(values))) for words, values in kept.items()}


def unfinished(columns):
    """Fate -> numbers of the flights with it."""
    return {fate: columns["flight"][columns["fate"] == fate].tolist() for fate in ("unparted", "lost")}


def convergence(columns, plan, facts):
    """Numbers of flights (k,), and name of an aim -> (values (k,), errors (k,)) from the first so many."""
    number = len(columns["flight"])
    shown = [n for n in FIRST_SHOWN * 2 ** np.arange(40) if n < number] + [number]
    rows = []
    for n in shown:
        part = {name: values[:n] for name, values in columns.items()}
        found = {name: entry for name, entry in integrands(part, plan, facts).items() if name in AIMS[plan.kind]}
        rows.append(estimates(Averages(part["flight"], found), found))
    return np.array(shown), {
        name: (np.array([row[name].value for row in rows]), np.array([row[name].error for row in rows]))
        for name in AIMS[plan.kind]
    }
