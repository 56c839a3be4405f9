"""What follows from the samples of a Run: drift, fluctuation, temperatures, pressure."""

import numpy as np
from scipy.stats import linregress

from benchmarks.engine.statistics import Mean, blocks_of, mean_of_series

BOLTZMANN, FEMTOSECONDS = 0.0019872067, 1e6  # kcal/mol/K; in a nanosecond
BLOCKS = 10


def unit(liquid):
    """1 kT per ns and degree of freedom, in kcal/mol and fs."""
    return BOLTZMANN * liquid.temperature * sum(liquid.freedoms) / FEMTOSECONDS


def drift(run, liquid):
    """Slope of the total energy and its standard error, kT per ns and degree of freedom.

    Both are those of a least-squares line through means of blocks, which are nearly independent where
    samples are not.  kT is that of the liquid's temperature, whatever becomes of it.
    """
    line = linregress(blocks_of(run.time, BLOCKS), blocks_of(run.total, BLOCKS))
    return line.slope / unit(liquid), line.stderr / unit(liquid)


def fluctuation(run):
    """Root mean square of the total energy about its least-squares line, kcal/mol."""
    line = np.polynomial.Polynomial.fit(run.time, run.total, 1)
    return float(np.std(run.total - line(run.time)))


def temperatures(run, liquid):
    """Temperatures of translation and of rotation, each an array (n,), kelvin."""
    energies = run.translation, run.rotation
    return tuple(2 * k / (n * BOLTZMANN) for k, n in zip(energies, liquid.freedoms))


def block_mean(series):
    """Mean of a series without its first sample, with a standard error from blocks."""
    return mean_of_series([series], BLOCKS)


def cooler(run, liquid) -> Mean:
    """Temperature of rotation less that of translation, kelvin."""
    translation, rotation = temperatures(run, liquid)
    return block_mean(rotation - translation)
