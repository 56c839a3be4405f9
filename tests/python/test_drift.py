"""Energy over long runs: slopes and their uncertainty."""

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import linregress

from benchmarks.engine.statistics import slope
from benchmarks.studies import drift

TIME = np.arange(2001.0)


# --- the slope ----------------------------------------------------------------------------------
def test_slope_does_not_see_an_oscillation():
    rate, error = slope(TIME, 3e-9 * TIME - 1.0)
    assert rate == pytest.approx(3e-9, rel=1e-6) and error < 1e-6 * rate
    for expected in (0.0, 1e-3):
        rate, error = slope(TIME, np.sin(TIME * 0.7) + expected * TIME)
        assert abs(rate - expected) < drift.SIGNIFICANT * error
        assert (abs(rate) > drift.SIGNIFICANT * error) == (expected > 0)


def correlated(rng, memory):
    """Noise of variance 1 whose correlation falls by ``memory`` from sample to sample."""
    kicks = np.sqrt(1 - memory**2) * rng.normal(size=len(TIME))
    return lfilter([1.0], [1.0, -memory], kicks, zi=[memory * rng.normal()])[0]


@pytest.mark.parametrize("memory", [0.0, 0.95])
def test_uncertainty_is_the_scatter_of_repeated_slopes(memory):
    """The error is correct also with correlated noise, for which the textbook formula gives far too small an error."""
    rng = np.random.default_rng(20251121)
    series_of_noise = [correlated(rng, memory) for _ in range(200)]
    found, told = np.array([slope(TIME, noise) for noise in series_of_noise]).T
    assert np.mean(told) == pytest.approx(np.std(found), rel=0.3)
    naive = np.mean([linregress(TIME, noise).stderr for noise in series_of_noise])
    assert (naive == pytest.approx(np.std(found), rel=0.3)) == (memory == 0.0)
    significant = np.abs(found) > drift.SIGNIFICANT * told
    assert significant.mean() < 0.03
