"""The drift predicted from a spectrum: the response compared with measured damping, and spectra of known motions."""

from fractions import Fraction

import numpy as np
import pytest

from benchmarks.studies.coefficients.kernel import Corrector, gear, tuned
from benchmarks.studies.coefficients.prediction import SEGMENT, Spectrum, response
from benchmarks.studies.coefficients.search import spectrum as roots

PHASES = (0.2, 0.3, 0.4, 0.5)
EVERY = [pytest.param(tuned(n), id=f"tuned-{n}") for n in (6, 7, 8, 10)]
EVERY += [pytest.param(gear(n), id=f"gear-{n}") for n in (5, 6, 7)]


def one_percent_off(corrector):
    """The Corrector with a wrong c_1."""
    c = list(corrector.c)
    c[1] *= Fraction(101, 100)
    return Corrector(tuple(c))


@pytest.mark.parametrize("corrector", EVERY)
def test_damping_of_an_oscillator_is_that_of_the_response(corrector):
    """The amplitude is multiplied by the principal root in each step; a wrong coefficient is detected."""
    damping = 2 * np.log1p(roots(corrector, PHASES)[:, 0]) / PHASES
    np.testing.assert_allclose(-response(corrector, PHASES).imag, damping, rtol=0.01)
    wrong = -response(one_percent_off(corrector), PHASES).imag
    assert np.all(abs(wrong / damping - 1) > 0.05)


@pytest.mark.parametrize("omega_h", PHASES)
@pytest.mark.parametrize("corrector", [one for one in EVERY if one.id.startswith("tuned")])
def test_a_body_in_wells_loses_what_the_response_says(corrector, omega_h):
    """Small librations with the kernel itself, quaternions and all."""
    short, long, amplitude, frequency = 2000, 6000, 1e-3, (1.0, 1.0, 1.0)
    before, after = (corrector.libration(omega_h, frequency, amplitude, n) for n in (short, long))
    damping = np.log((1 + after) / (1 + before)) / (long - short) / omega_h
    assert -response(corrector, [omega_h])[0].imag == pytest.approx(damping, rel=0.01)


# --- spectra --------------------------------------------------------------------------------------
def oscillations(omega, axes=3, bodies=5, dt=1.0):
    """Velocities (samples, bodies, 3) that oscillate with ``omega``; other axes are zero within round-off."""
    random = np.random.default_rng(1)
    phases = random.uniform(0, 2 * np.pi, (bodies, 3))
    series = np.cos(omega * dt * np.arange(3 * SEGMENT)[:, None, None] + phases)
    return np.where(np.arange(3) < axes, series, 1e-12 * random.normal(size=series.shape))


@pytest.mark.parametrize("axes", (2, 3))
def test_drift_of_a_single_frequency(axes):
    """The drift of each degree of freedom is -omega Im H; axes without rotation do not count."""
    slow, fast, dt, own = 0.05, 0.1, 4.0, tuned(7)
    found = Spectrum.of(oscillations(slow), oscillations(fast, axes), 1.0)
    rates = [-1e6 * omega * response(own, [omega * dt])[0].imag for omega in (slow, fast)]
    expected = np.average(rates, weights=(3, axes))
    assert found.axes == axes
    # a line is as wide as the window, and H rises with a high power of the frequency
    assert found.drift(own, dt) == pytest.approx(expected, rel=0.1)
    assert found.drift(own, 1.02 * dt) != pytest.approx(expected, rel=0.1)
