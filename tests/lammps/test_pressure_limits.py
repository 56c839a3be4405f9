"""Constant pressure: messages about a box that oscillates too fast."""

import re

import numpy as np
import pytest
from support.constant_pressure import pressed
from support.scenes import largest_change

# --- the frequency of the box --------------------------------------------------------------------

# A crystal of points, in which a strain of the box moves every atom as a lattice does, so that the volume oscillates with a single
# frequency.  No shell of neighbors crosses the cutoff.
PAIR = "pair_style morse 1.68\npair_coeff * * 0.0 2.0 1.0 1.68\npair_coeff 1 1 2.0 4.0 1.0 1.68"
CRYSTAL = """lattice fcc 1.75
region box block 0 3 0 3 0 3
create_box 3 box
create_atoms 1 box
mass * 1.0
variable own atom id
set group all mol v_own
velocity all create 1e-6 87287"""
TARGET = 0.3
#: and the limits in radians per step
SCHEMES = {
    "values 5": 0.96,
    "values 7": 0.70,
    "values 9": 0.60,
    "values 6 corrector gear": 0.42,
}
TOLD = re.compile(r"the angle of the oscillation of the box is (\S+) in a step, and the method follows (\S+);")
LONGER = re.compile(r"use a Pdamp of (\S+) or longer")


def crystal(words, dt, run, pdamp=1.0, last=TARGET, thermo=1000):
    words = f"{words} iso {TARGET} {last} {pdamp} ptemp 0.05"
    return pressed(words, dt, run=run, box=CRYSTAL, pair=PAIR, thermo=thermo).replace("exclude molecule/intra all", "")


def volume_frequency(lmp):
    """Frequency of small oscillations, from the zero crossings in a run with short steps."""
    dt = 0.001
    table = lmp.succeed(crystal("values 7", dt, "run 2000", thermo=1)).thermo[0]
    strain = np.log(table["Volume"])
    strain -= (strain.min() + strain.max()) / 2
    k = np.flatnonzero(strain[:-1] * strain[1:] < 0)
    times = dt * (k + strain[k] / (strain[k] - strain[k + 1]))
    return np.pi * (len(times) - 1) / (times[-1] - times[0])


def printed(text, value, tolerance):
    """True if a printed number of two digits is this value, up to rounding."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 1)
    return abs(float(text) - value) < 0.51 * unit + tolerance * value


def test_a_box_that_oscillates_too_fast(lmp_wheel):
    """The printed radians agree with the volume in a run, for any method; Pdamp is as long as needed."""
    omega = volume_frequency(lmp_wheel)
    for words, fastest in SCHEMES.items():
        dt = {part: part * fastest / omega for part in (0.58, 0.63, 0.75, 0.9)}
        assert not TOLD.search(lmp_wheel.succeed(crystal(words, dt[0.58], "run 500")).words)
        for part in (0.63, 0.75, 0.9):
            result = lmp_wheel.succeed(crystal(words, dt[part], "run 500\nrun 500"))
            ((radians, limit),) = TOLD.findall(result.words)
            # differences over a step at the end of the step
            exact = part * fastest
            assert printed(radians, np.sqrt(exact * np.sin(exact)), 0.01), (words, part)
            assert printed(limit, 0.6 * fastest, 0.01)
            # the method is stable with it
            assert largest_change(result.thermo[1]) < 0.02
        *_, pdamp = LONGER.findall(result.words)
        assert float(pdamp) == pytest.approx(1.05 * float(radians) / float(limit), rel=0.05)
        assert not TOLD.search(lmp_wheel.succeed(crystal(words, dt[0.9], "run 1500", pdamp)).words)


def test_steps_that_change_follow_the_box(lmp_wheel):
    """With keyword tolerance a step is short enough instead, for any first step."""
    result = lmp_wheel.succeed(crystal("tolerance 1e-8", 3.0 / volume_frequency(lmp_wheel), "run 500"))
    assert "radians" not in result.output and largest_change(result.thermo[0]) < 1e-4


@pytest.mark.parametrize("words", SCHEMES)
def test_a_box_that_becomes_too_stiff(lmp_wheel, words):
    """In a ramp of the pressure: the end of the run warns as a new start would."""
    omega, fastest, steps = volume_frequency(lmp_wheel), SCHEMES[words], 6000
    dt, last = 0.54 * fastest / omega, 12.0
    result = lmp_wheel.succeed(crystal(words, dt, f"run {steps}", last=last))
    ((radians, _),) = TOLD.findall(result.words)
    again = f"run {steps}\nunfix move\nfix move all gear/quat molecule {words} iso {last} {last} 1.0 ptemp 0.05\nrun 1"
    *_, (measured, _) = TOLD.findall(lmp_wheel.succeed(crystal(words, dt, again, last=last)).words)
    assert float(radians) == pytest.approx(float(measured), rel=0.1)
    assert float(radians) > 0.6 * fastest
