"""Quantities computed from the samples of Runs: drift, fluctuation, temperatures, pressure."""

import numpy as np

from benchmarks.engine.statistics import Mean, mean_of_series, slope

BOLTZMANN, FEMTOSECONDS = 0.0019872067, 1e6  # kcal/mol/K; in a nanosecond
#: blocks of each run for the errors of means
BLOCKS = 10


def unit(liquid):
    """1 kT per ns and degree of freedom, in kcal/mol and fs."""
    return BOLTZMANN * liquid.temperature * sum(liquid.freedoms) / FEMTOSECONDS


def drift(runs, liquid):
    """Mean slope of the total energy of some Runs and its standard error, kT per ns and degree of freedom.

    Slopes are from least-squares lines through all samples, and the error is from their scatter.  The error of a single
    run is from the scatter of its samples about the line.  kT is for the nominal temperature of the liquid.
    """
    rates, errors = np.transpose([slope(run.time, run.total) for run in runs]) / unit(liquid)
    if len(runs) == 1:
        return float(rates[0]), float(errors[0])
    return float(rates.mean()), float(rates.std(ddof=1) / np.sqrt(len(rates)))


def fluctuation(run):
    """Root mean square of the total energy about its least-squares line, kcal/mol."""
    line = np.polynomial.Polynomial.fit(run.time, run.total, 1)
    return float(np.std(run.total - line(run.time)))


def temperatures(run, liquid):
    """Temperatures of translation and of rotation, each an array (n,), kelvin."""
    energies = run.translation, run.rotation
    return tuple(2 * k / (n * BOLTZMANN) for k, n in zip(energies, liquid.freedoms))


def mean(runs, read) -> Mean:
    """Mean of the series ``read(run)`` of Runs without their first samples, with an error from blocks."""
    return mean_of_series([read(run) for run in runs], BLOCKS)


def warmer(runs, liquid) -> Mean:
    """Temperature of translation minus temperature of rotation, kelvin."""

    def difference(run):
        translation, rotation = temperatures(run, liquid)
        return translation - rotation

    return mean(runs, difference)


def of_starts(values):
    """Mean over the starts and its standard error, NaN for a single start."""
    n = len(values)
    return float(np.mean(values)), float(np.std(values, ddof=1) / np.sqrt(n)) if n > 1 else np.nan
