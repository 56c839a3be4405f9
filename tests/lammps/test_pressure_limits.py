"""Constant pressure: a box that oscillates fast."""

import numpy as np
from support.constant_pressure import pressed
from support.scenes import largest_change

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


def crystal(words, dt, run, thermo=1000):
    words = f"{words} iso 0.3 0.3 1.0 ptemp 0.05"
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


def test_steps_that_change_follow_the_box(lmp_wheel):
    """With keyword tolerance a step is short enough instead, for any first step."""
    result = lmp_wheel.succeed(crystal("tolerance 1e-8", 3.0 / volume_frequency(lmp_wheel), "run 500"))
    assert largest_change(result.thermo[0]) < 1e-4
