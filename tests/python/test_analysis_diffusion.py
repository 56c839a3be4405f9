"""Diffusion coefficients of motions whose coefficients are known: right within their errors, or left out."""

import numpy as np
import pytest
from scipy.signal import lfilter

from gearquat_analysis.blocks import of_series
from gearquat_analysis.diffusion import LAGS, brownian_covariance, diffusion

SEEDS = range(20)
#: 99.9 % of the root mean squares of 20 normal deviates
LEAST, MOST = 0.53, 1.55


def brownian(rng, frames, bodies, coefficient=0.5):
    return rng.normal(size=(frames, bodies, 3)).cumsum(axis=0) * np.sqrt(2.0 * coefficient)


def bound(rng, frames, bodies, time):
    """In a harmonic well, with friction: a stationary process with variance 1 and correlation time ``time``."""
    forget = np.exp(-1.0 / time)
    kicks = rng.normal(size=(frames, bodies, 3)) * np.sqrt(1.0 - forget**2)
    kicks[0] /= np.sqrt(1.0 - forget**2)
    return lfilter([1.0], [1.0, -forget], kicks, axis=0)


def langevin(rng, frames, bodies, time):
    """Langevin's equation with kT / m = 1 and friction 1 / time, whose coefficient is ``time``; exact at the frames."""
    forget = np.exp(-1.0 / time)
    both, squares = time * (1.0 - forget) ** 2, 2.0 * time - time**2 * (3.0 - 4.0 * forget + forget**2)
    kicks = np.linalg.cholesky([[1.0 - forget**2, both], [both, squares]]) @ rng.normal(size=(2, frames * bodies * 3))
    kicks = kicks.reshape(2, frames, bodies, 3)
    kicks[0, 0] = rng.normal(size=(bodies, 3))
    velocity = lfilter([1.0], [1.0, -forget], kicks[0], axis=0)
    return np.cumsum(time * (1.0 - forget) * velocity[:-1] + kicks[1, 1:], axis=0)


def hopping(rng, frames, bodies, rate):
    """Rare jumps of a variance of 1 in each direction, between which bodies rattle in cages."""
    jumps = (rng.random((frames, bodies)) < rate)[..., None] * rng.normal(size=(frames, bodies, 3))
    return jumps.cumsum(axis=0) + 0.3 * bound(rng, frames, bodies, 3.0)


def found(motion, seed, *arguments):
    center = motion(np.random.default_rng(seed), *arguments)
    return diffusion(np.arange(float(len(center))), center)


@pytest.mark.parametrize(
    ("motion", "arguments", "expected"),
    [
        (brownian, (400, 1), 0.5),
        (brownian, (2000, 3), 0.5),
        (brownian, (101, 50), 0.5),
        (brownian, (400, 50), 0.5),
        (langevin, (4000, 2, 5.0), 5.0),
        (langevin, (2000, 20, 5.0), 5.0),
        (langevin, (800, 64, 5.0), 5.0),
        (hopping, (6000, 10, 0.05), 0.025),
    ],
)
def test_errors_hold(motion, arguments, expected):
    """Tested over 20 seeds; most have a coefficient, and a value that is 10 % larger is refused if the error is below 3
    %."""
    known = [one for one in (found(motion, seed, *arguments) for seed in SEEDS) if not np.isnan(one.value)]
    assert len(known) >= 15
    deviations = np.array([(one.value - expected) / one.error for one in known])
    assert LEAST < np.sqrt(np.mean(deviations**2)) < MOST
    if np.mean([one.error for one in known]) < 0.03 * expected:
        off = np.array([(one.value - 1.1 * expected) / one.error for one in known])
        assert np.sqrt(np.mean(off**2)) > MOST


def test_errors_of_short_runs_hold():
    """As in the tutorial: motion is diffusive only from a sixtieth of the run on, where no blocks have an error."""
    time = 4.0
    known = [one for one in (found(langevin, seed, 800, 64, time) for seed in range(60)) if not np.isnan(one.value)]
    assert len(known) >= 55
    assert 0.7 < np.sqrt(np.mean([((one.value - time) / one.error) ** 2 for one in known])) < 1.4


def test_free_flight():
    for bodies in (1, 3, 60):
        velocity = np.random.default_rng(bodies).normal(size=(bodies, 3))
        one = diffusion(np.arange(400.0), np.arange(400.0)[:, None, None] * velocity)
        assert np.isnan(one.value) and np.isnan(one.error) and "not linear" in one.why


@pytest.mark.parametrize(("frames", "bodies", "time"), [(400, 60, 5.0), (2000, 20, 50.0), (2000, 3, 20.0)])
def test_bodies_that_stay_where_they_are(frames, bodies, time):
    """As in ice, none of 20 seeds has a coefficient."""
    for seed in SEEDS:
        one = found(bound, seed, frames, bodies, time)
        assert np.isnan(one.value) and one.why


def test_runs_that_are_too_short():
    """For Langevin's motion in fewer than 30 times of its friction; with fewer than 101 frames there is no error."""
    for seed in SEEDS:
        assert np.isnan(found(langevin, seed, 150, 50, 5.0).value)
        assert np.isnan(found(brownian, seed, 100, 50).value)


def test_bodies_that_move_together():
    """The scatter of the bodies is not informative, but blocks of the run are: errors agree with a single body."""
    deviations = []
    for seed in SEEDS:
        one = np.random.default_rng(seed).normal(size=(2000, 1, 3)).cumsum(axis=0)
        center = one + 0.01 * brownian(np.random.default_rng(seed + 100), 2000, 30)
        estimate = diffusion(np.arange(2000.0), center)
        deviations.append((estimate.value - 0.5) / estimate.error)
    assert np.sqrt(np.nanmean(np.square(deviations))) < MOST


def test_time_and_dimensions():
    """The unit of time, and two dimensions: the same walk has the same coefficient in its plane."""
    walk = brownian(np.random.default_rng(1), 1000, 50)
    one = diffusion(np.arange(1000.0), walk)
    half = diffusion(0.5 * np.arange(1000.0), walk)
    assert half.value == pytest.approx(2.0 * one.value, rel=1e-12)
    plane = diffusion(np.arange(1000.0), walk * [1.0, 1.0, 0.0], 2)
    assert abs(plane.value - 0.5) < 4.0 * plane.error < 0.1


def test_covariance_of_a_brownian_motion():
    """The covariance agrees with mean squares over 4000 walks."""
    steps, lags = 60, LAGS[:4]
    walks = np.random.default_rng(3).normal(size=(steps + 1, 4000)).cumsum(axis=0)
    squares = np.array([((walks[lag:] - walks[:-lag]) ** 2).mean(axis=0) for lag in lags])
    assert brownian_covariance(steps, lags) == pytest.approx(np.cov(squares), rel=0.1)
    # exact for one lag of one step: 2 / steps
    assert brownian_covariance(steps, [1]) == pytest.approx(2.0 / steps, rel=1e-12)


@pytest.mark.parametrize("time", [0.1, 3.0, 10.0])
def test_errors_of_series_hold(time):
    """Of a series with a correlation time of ``time`` frames."""
    known = [of_series(bound(np.random.default_rng(seed), 2000, 1, time)[:, 0, 0]) for seed in SEEDS]
    deviations = [one.value / one.error for one in known if not np.isnan(one.error)]
    assert len(deviations) >= 15
    assert LEAST < np.sqrt(np.mean(np.square(deviations))) < MOST


def test_series_without_independent_blocks():
    """One with a drift, and one with a correlation time of a tenth of the run."""
    rng = np.random.default_rng(1)
    drifting = rng.normal(size=2000) + np.linspace(0.0, 0.7, 2000)
    slow = bound(rng, 2000, 1, 200.0)[:, 0, 0]
    for series, why in ((drifting, "drifts"), (slow, "blocks that are independent"), (slow[:5], "5 frames are too few")):
        one = of_series(series)
        assert np.isnan(one.error) and why in one.why and one.value == pytest.approx(series.mean())
