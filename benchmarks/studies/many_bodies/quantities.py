"""Quantities computed from the results: ratios, means with standard errors, deviations, temperatures."""

import math

import numpy as np

from benchmarks.engine.statistics import Mean, mean_of_series

from .runs import MOLECULES, NVE_SMALL, bodies_of

BLOCKS = 10
#: ways to count memory: fields of Timing, and in words
MEMORY_KINDS = {"reported": "LAMMPS' sum", "allocated": "heap"}

# constants of LAMMPS' units real: kcal/mol/K, and g/mol (Angstrom/fs)^2 in kcal/mol
BOLTZMANN, ENERGY = 0.0019872067, 48.88821291**2
#: SPC/E: masses of O, H, H; r(OH) = 1 Angstrom, a tetrahedral angle
MASSES = np.array([15.9994, 1.008, 1.008])
SITES = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1 / 3, math.sqrt(8) / 3, 0.0]])
AXES = ("normal to the plane", "along the dipole", "from H to H")


def block_mean(series):
    """Mean of a series (n,) without its first sample, which all runs have in common."""
    return mean_of_series([series], BLOCKS)


def spread(values):
    """Median, smallest and largest value."""
    return float(np.median(values)), float(np.min(values)), float(np.max(values))


def largest_deviation(means, expected=None):
    """Largest deviation from ``expected`` (default: the weighted mean), in standard errors."""
    values, errors = np.array([(m.value, m.error) for m in means]).T
    if expected is None:
        expected = np.average(values, weights=errors**-2.0)
    return float(np.max(np.abs(values - expected) / errors))


# --- time and memory ------------------------------------------------------------------------------
def time_ratio(results, method, ranks):
    """Time in the fix relative to fix rigid/nve/small: ratio of the medians, smallest and largest ratio of a round.

    NaN if noise in the communication makes one of the times negative.
    """
    cells = results.plan.headline
    own, other = (results.fix_seconds(m, cells, ranks) for m in (method, NVE_SMALL))
    if min(own.min(), other.min()) <= 0.0:
        return (math.nan,) * 3
    _, least, largest = spread(own / other)
    return float(np.median(own) / np.median(other)), least, largest


def memory(results, method):
    """Bytes per body: (cells, kind) -> number."""
    growth = results.plan.growth
    return {(c, k): results.bytes_per_body(method, c, k) for c in growth for k in MEMORY_KINDS}


def memory_ratios(results, method):
    """Memory per body relative to fix rigid/nve/small, for each size and both ways to count."""
    own, other = (memory(results, m) for m in (method, NVE_SMALL))
    return [own[key] / other[key] for key in own]


def per_body(results, method):
    """Microseconds in the fix per body and step: bodies -> values by round."""
    return {
        bodies_of(cells): 1e6 * results.fix_seconds(method, cells) / bodies_of(cells)
        for cells in results.plan.growth
    }


def nonlinearity(results, method):
    """Largest relative deviation of the time in the fix from the best linear law."""
    times = [np.median(values) for values in per_body(results, method).values()]
    return float((max(times) - min(times)) / (max(times) + min(times)))


# --- pressure -------------------------------------------------------------------------------------
def mean_pressures(results, method):
    """dt -> Mean of the pressure, atm."""
    return {dt: block_mean(results.pressures[method.key, dt]) for dt in results.plan.pressure_dts}


def pressure_shifts(results, method):
    """dt -> Mean of the pressure minus the pressure with the smallest step at the same times, atm."""
    first, *others = results.plan.pressure_dts
    reference = results.pressures[method.key, first]
    return {dt: block_mean(results.pressures[method.key, dt] - reference) for dt in others}


def instants(results, method):
    """Pressures at the start and at the first sample after it, atm, shape (steps, 2)."""
    return np.array([results.pressures[method.key, dt][:2] for dt in results.plan.pressure_dts])


# --- temperature ----------------------------------------------------------------------------------
def moments():
    """Principal moments of inertia of SPC/E, the largest first, g/mol Angstrom^2."""
    x = SITES - MASSES @ SITES / MASSES.sum()
    inertia = np.einsum("i,ij,ij->", MASSES, x, x) * np.eye(3) - np.einsum("i,ij,ik", MASSES, x, x)
    return np.linalg.eigvalsh(inertia)[::-1]


def temperatures(thermo):
    """Temperatures of a sampled run, kelvin: name -> series (n,).

    "all" is from compute temp; the others follow from k_B T / 2 for each degree of freedom.  The translation of N
    molecules without total momentum has 3N - 3 degrees of freedom, and each axis has N.
    """
    series, translation = {"all": thermo["Temp"]}, (3 * MOLECULES - 3) * BOLTZMANN
    if "f_move[1]" not in thermo:
        series["translation"] = 2 * thermo["c_trans"] / translation
        return series | {"rotation": 2 * thermo["c_rot"] / (3 * MOLECULES * BOLTZMANN)}
    squares = [thermo[f"c_squares[{k}]"] for k in range(1, 7)]
    series["translation"] = ENERGY * MASSES.sum() * sum(squares[:3]) / translation
    for name, moment, square in zip(AXES, moments(), squares[3:]):
        series[f"axis {name}"] = ENERGY * moment * square / (MOLECULES * BOLTZMANN)
    return series


def kinetic_mismatch(thermo):
    """Largest relative difference between compute temp and the squares of all velocities.

    It is zero if degrees of freedom, moments and the rows of the fix are consistent.
    """
    series = temperatures(thermo)
    energy = (3 * MOLECULES - 3) * series["translation"]
    energy = energy + MOLECULES * sum(series[f"axis {name}"] for name in AXES)
    return float(np.max(np.abs(energy / (6 * MOLECULES - 3) / series["all"] - 1)))


def partition(thermo):
    """Name -> Mean of its temperature minus the temperature of all, kelvin."""
    series = temperatures(thermo)
    whole = series.pop("all")
    return {name: block_mean(own - whole) for name, own in series.items()}


def warmer(results, method):
    """Difference of the mean temperature from fix rigid/nve/small, a Mean in kelvin."""
    own, other = (block_mean(results.temperatures[m.key]["Temp"]) for m in (method, NVE_SMALL))
    error = math.hypot(own.error, other.error)
    return Mean(own.value - other.value, error, own.freedoms + other.freedoms)
