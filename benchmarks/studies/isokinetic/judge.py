"""What the runs of ``benchmarks/run isokinetic`` say: drifts, orders, agreement within error bars.

What is asked stands here, nowhere else; every other number is measured.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from benchmarks.engine.statistics import slope
from benchmarks.engine.tables import Row
from .runs import CONSTRAINTS, THERMOSTAT, DriftRun

#: largest relative change of a rescaled kinetic energy
RESCALED_ASKED = 1e-13
#: by how much the order of the drift may fall short of the number of values
ORDER_SLACK = 0.5
#: how sure a deviation must be to count as one, over all values that are compared at once
CONFIDENCE = 0.99
#: bins with less are empty: no pair of oxygens comes as close
LEAST_DISTRIBUTION = 0.05


@dataclass(frozen=True)
class Mean:
    """A mean with its standard error and the degrees of freedom of the latter."""

    value: np.ndarray
    error: np.ndarray
    freedoms: int


def mean_of_blocks(blocks):
    """Mean of ``blocks`` (n, ...) over the first axis, and standard error from their scatter."""
    blocks = np.asarray(blocks)
    n = len(blocks)
    if n < 3:
        raise ValueError(f"{n} blocks are too few for a standard error")
    return Mean(blocks.mean(axis=0), blocks.std(axis=0, ddof=1) / math.sqrt(n), n - 1)


def blocks_of(values, count):
    """Means of ``count`` equal parts of a series (n,), the first sample and what is left apart."""
    length = (len(values) - 1) // count
    if length < 1:
        raise ValueError(f"{len(values)} samples are too few for {count} blocks")
    return np.asarray(values)[-length * count :].reshape(count, length).mean(axis=1)


# --- kinetic energy -----------------------------------------------------------------------------
def drift_rate(kept):
    """Relative drift of the kinetic energy per unit of time, and its standard error."""
    return slope(kept.time, kept.error)


def order(results, constraint):
    """Power of the step with which the drift falls."""
    dts = results.plan.dts
    rates = [abs(drift_rate(results.kept[DriftRun(constraint, False, dt)])[0]) for dt in dts]
    return float(np.polyfit(np.log(dts), np.log(rates), 1)[0])


def largest(results, run):
    """Largest relative change of the kinetic energy."""
    return float(np.abs(results.kept[run].error).max())


# --- water --------------------------------------------------------------------------------------
def _of(results, method):
    return [water for run, water in results.water.items() if run.method == method]


def energy(results, method):
    """Mean potential energy of all molecules, from the blocks of all seeds."""
    blocks = [blocks_of(water.potential, results.plan.blocks) for water in _of(results, method)]
    return mean_of_blocks(np.concatenate(blocks))


def kinetic(results, method):
    """Mean kinetic energy of all molecules and standard deviation of one configuration's."""
    values = np.concatenate([water.kinetic for water in _of(results, method)])
    return float(values.mean()), float(values.std())


def distribution(results, method):
    """g(r) with errors, from the blocks of all seeds, and distances (bins,)."""
    found = _of(results, method)
    return found[0].distance, mean_of_blocks(np.concatenate([w.distribution for w in found]))


def deviation(one, other):
    """Difference of two Means in standard errors of it."""
    return (one.value - other.value) / np.hypot(one.error, other.error)


def allowed(one, other, count):
    """How many standard errors the largest of ``count`` differences may have.

    Student's t with the freedoms of both, Bonferroni's correction for ``count`` looks.
    """
    freedoms = one.freedoms + other.freedoms
    return float(stats.t.ppf(1 - (1 - CONFIDENCE) / (2 * count), freedoms))


@dataclass(frozen=True)
class Distance:
    """How far g(r) is from the thermostat's: largest and root mean square deviation, in standard
    errors; ``difference``: the largest itself; ``allowed`` by Student's t."""

    largest: float
    rms: float
    difference: float
    allowed: float


def compare_distributions(results, method):
    """g(r) of a constraint against that of the thermostat, where there are pairs."""
    _, ours = distribution(results, method)
    _, theirs = distribution(results, THERMOSTAT)
    there = np.minimum(ours.value, theirs.value) > LEAST_DISTRIBUTION
    ours, theirs = (
        Mean(mean.value[there], mean.error[there], mean.freedoms) for mean in (ours, theirs)
    )
    z = deviation(ours, theirs)
    difference = np.abs(ours.value - theirs.value).max()
    limit = allowed(ours, theirs, int(there.sum()))
    return Distance(float(np.abs(z).max()), float(np.sqrt(np.mean(z**2))), float(difference), limit)


# --- what was asked -----------------------------------------------------------------------------
def rows(results):
    """All demands."""
    found = []
    plan = results.plan
    steps = f"{plan.drift_steps:,} steps".replace(",", " ")
    for constraint in CONSTRAINTS:
        p = order(results, constraint)
        asked = f"order {plan.values}, ≥ {plan.values - ORDER_SLACK:g}"
        what = f"drift of the kinetic energy, {constraint}, no rescaling"
        found.append(Row(what, asked, f"order {p:.2f}", p >= plan.values - ORDER_SLACK))
    for constraint in CONSTRAINTS:
        change = largest(results, DriftRun(constraint, True, plan.rescaled_dt))
        what = f"kinetic energy over {steps}, {constraint}, rescaled"
        asked = f"constant to {RESCALED_ASKED:g}"
        found.append(Row(what, asked, f"{change:.1e}", change <= RESCALED_ASKED))
    for constraint in CONSTRAINTS:
        ours, theirs = energy(results, constraint), energy(results, THERMOSTAT)
        z, limit = float(abs(deviation(ours, theirs))), allowed(ours, theirs, len(CONSTRAINTS))
        what = f"mean energy of water, {constraint}, against the thermostat"
        found.append(Row(what, f"≤ {limit:.1f} standard errors", f"{z:.1f}", z <= limit))
    for constraint in CONSTRAINTS:
        d = compare_distributions(results, constraint)
        what = f"g(r) of water, {constraint}, against the thermostat, largest of all distances"
        asked = f"≤ {d.allowed:.1f} standard errors"
        found.append(Row(what, asked, f"{d.largest:.1f}", d.largest <= d.allowed))
    return found
