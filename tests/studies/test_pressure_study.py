"""Study of constant pressure: the errors of its drifts."""

import numpy as np

from benchmarks.studies import pressure

RATE = 0.02  # kT/ns/dof


def slow_walks(rng):
    """Columns of runs whose energy has a drift and a random walk, which is as slow as the run is long."""
    plan, unit = pressure.Plan(dts=(2.0,)), 1e6 / (pressure.BOLTZMANN * pressure.TEMPERATURE * pressure.FREEDOMS)
    time, water = np.arange(0.0, plan.time, plan.sample), {}
    for seed in plan.seeds:
        walk = np.cumsum(1e-3 * rng.normal(size=len(time)))
        water[pressure.OURS, 2.0, seed] = {"Time": time, "v_conserved": RATE / unit * time + walk}
    return pressure.Results(plan, water, {})


def test_errors_of_drifts_are_their_scatter():
    """The rms of deviations over errors agrees with Student's t with 7 degrees of freedom."""
    rng = np.random.default_rng(8)
    found = np.array([slow_walks(rng).drift(pressure.OURS, 2.0) for _ in range(300)])
    ratios = (found[:, 0] - RATE) / found[:, 1]
    assert abs(np.sqrt(np.mean(ratios**2)) / np.sqrt(7 / 5) - 1.0) < 0.15
    assert abs(np.mean(ratios)) < 0.25
