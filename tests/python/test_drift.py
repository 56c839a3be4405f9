"""Energy over long runs: slopes and their uncertainty, judging of made-up numbers, a small run."""


import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import linregress

from benchmarks.engine.methods import gear
from benchmarks.engine.statistics import slope
from benchmarks.reference import paper_problem, solvers, splittings
from benchmarks.studies import drift

TIME = np.arange(2001.0)
DEFAULT, HIGH, NO_SQUISH = drift.DEFAULT.label, gear("second", 10).label, drift.NO_SQUISH.label
NVE, VERLET = "fix rigid/nve", drift.VERLET.label


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
    """With correlated noise too, where the textbook formula is far too sure."""
    rng = np.random.default_rng(20251121)
    series_of_noise = [correlated(rng, memory) for _ in range(200)]
    found, told = np.array([slope(TIME, noise) for noise in series_of_noise]).T
    assert np.mean(told) == pytest.approx(np.std(found), rel=0.3)
    naive = np.mean([linregress(TIME, noise).stderr for noise in series_of_noise])
    assert (naive == pytest.approx(np.std(found), rel=0.3)) == (memory == 0.0)
    significant = np.abs(found) > drift.SIGNIFICANT * told
    assert significant.mean() < 0.03


# --- one run ------------------------------------------------------------------------------------


# --- comparing ----------------------------------------------------------------------------------


# --- running ------------------------------------------------------------------------------------


def test_a_splitting_holds_the_energy_and_a_solver_does_not():
    """Test case 1 to t = 200 and 400 at 0.1 per evaluation: the error of RKN6 stays."""
    kept, lost = (
        [work(paper_problem(1), end, *own)[1] for end, own in zip((200.0, 400.0), settings)]
        for work, settings in (
            (splittings.largest_energy_error, [(splittings.SPLITTINGS[1], n) for n in (182, 364)]),
            (solvers.largest_energy_error, [("DOP853", 1e-7)] * 2),
        )
    )
    assert kept[0] == kept[1] < 1e-5
    assert 1e-6 < 1.2 * lost[0] < lost[1]
