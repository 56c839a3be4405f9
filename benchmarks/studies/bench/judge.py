"""What the runs of ``benchmarks/run bench`` say: statistics, and what was asked beside what was measured.

What is asked stands here, nowhere else; every other number is measured.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import stats

from .runs import GEAR, NVE_SMALL, SECOND, bodies_of
from .decks import MOLECULES
from benchmarks.engine.tables import Row

#: time in the fix and memory, over fix rigid/nve/small's
TIME_ASKED, MEMORY_ASKED = 1.0, 1.5
#: ways to count memory: fields of Timing, and in words
MEMORY_KINDS = {"reported": "LAMMPS' sum", "allocated": "heap"}
#: deviation from a time proportional to the number of bodies
GROWTH_ASKED = 0.10
#: how sure a deviation must be to count as one, over all values that are compared at once
CONFIDENCE = 0.95
BLOCKS = 10
#: relative differences below it are rounding
ROUNDING = 1e-9

# constants of LAMMPS' units real: kcal/mol/K, and g/mol (Angstrom/fs)^2 in kcal/mol
BOLTZMANN, ENERGY = 0.0019872067, 48.88821291**2
#: SPC/E: masses of O, H, H; r(OH) = 1 Angstrom, a tetrahedral angle
MASSES = np.array([15.9994, 1.008, 1.008])
SITES = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-1 / 3, math.sqrt(8) / 3, 0.0]])
AXES = ("across the plane", "of the dipole", "from H to H")


# --- statistics ---------------------------------------------------------------------------------
@dataclass(frozen=True)
class Mean:
    """A mean over time with its standard error."""

    value: float
    error: float

    def __str__(self):
        return f"{self.value:.1f} ± {self.error:.1f}"


def block_mean(values, blocks=BLOCKS):
    """Mean of a series (n,), standard error from the scatter of ``blocks`` means of equal parts.

    The first sample, the start that all runs share, and what does not fill a block are left out.
    """
    length = (len(values) - 1) // blocks
    if length < 1:
        raise ValueError(f"{len(values)} samples are too few for {blocks} blocks")
    parts = np.asarray(values)[-length * blocks :].reshape(blocks, length).mean(axis=1)
    return Mean(float(parts.mean()), float(parts.std(ddof=1) / math.sqrt(blocks)))


def bound(count, blocks=BLOCKS):
    """How many standard errors the largest of ``count`` deviations may be away from zero.

    Student's t for the error of ``blocks`` blocks, Bonferroni's correction for ``count`` looks.
    """
    return float(stats.t.ppf(1 - (1 - CONFIDENCE) / (2 * count), blocks - 1))


def largest_deviation(means, expected=None):
    """Largest deviation from ``expected`` (default: the weighted mean), in standard errors."""
    values, errors = np.array([(m.value, m.error) for m in means]).T
    if expected is None:
        expected = np.average(values, weights=errors**-2.0)
    return float(np.max(np.abs(values - expected) / errors))


def spread(values):
    """Median, least and largest."""
    return float(np.median(values)), float(np.min(values)), float(np.max(values))


# --- quantities ---------------------------------------------------------------------------------
def time_ratio(results, method, ranks):
    """Time in the fix over fix rigid/nve/small's: of the medians, least and largest of a round.

    NaN where noise in the communication has made one of the times negative.
    """
    cells = results.plan.headline
    own, other = (np.array(results.fix_seconds(m, cells, ranks)) for m in (method, NVE_SMALL))
    if min(own.min(), other.min()) <= 0.0:
        return (math.nan,) * 3
    _, least, largest = spread(own / other)
    return float(np.median(own) / np.median(other)), least, largest


def memory(results, method):
    """Bytes a body: (cells, kind) -> number, for each size and both kinds of count."""
    return {
        (cells, kind): results.bytes_per_body(method, cells, kind)
        for cells in results.plan.growth
        for kind in MEMORY_KINDS
    }


def memory_ratios(results, method):
    """Memory of a body over fix rigid/nve/small's, for each size and both kinds of count."""
    own, other = (memory(results, m) for m in (method, NVE_SMALL))
    return [own[key] / other[key] for key in own]


def per_body(results, method):
    """Microseconds in the fix a body and step: bodies -> (median, least, largest)."""
    return {
        bodies_of(cells): tuple(
            1e6 * value / bodies_of(cells) for value in spread(results.fix_seconds(method, cells))
        )
        for cells in results.plan.growth
    }


def nonlinearity(results, method):
    """Largest relative deviation of the time in the fix from the best proportional law."""
    times = [median for median, _, _ in per_body(results, method).values()]
    return (max(times) - min(times)) / (max(times) + min(times))


def mean_pressures(results, method):
    """dt -> Mean of the pressure, atm."""
    return {
        dt: block_mean(results.pressures[method.key, dt]["Press"])
        for dt in results.plan.pressure_dts
    }


def pressure_shifts(results, method):
    """dt -> Mean of the pressure minus that at the smallest step at the same times, atm."""
    first, *others = results.plan.pressure_dts
    reference = results.pressures[method.key, first]["Press"]
    return {dt: block_mean(results.pressures[method.key, dt]["Press"] - reference) for dt in others}


def instants(results, method):
    """dt -> pressure at the start and at the first sample after it, atm: no statistics in it."""
    return {
        dt: tuple(results.pressures[method.key, dt]["Press"][:2])
        for dt in results.plan.pressure_dts
    }


def instant_changes(results, method):
    """How much the pressures of ``instants`` differ between steps: (at the start, after it), atm."""
    return tuple(np.ptp(list(instants(results, method).values()), axis=0))


def moments():
    """Principal moments of inertia of SPC/E, the largest first, g/mol Angstrom^2."""
    x = SITES - MASSES @ SITES / MASSES.sum()
    inertia = np.einsum("i,ij,ij->", MASSES, x, x) * np.eye(3) - np.einsum("i,ij,ik", MASSES, x, x)
    return np.linalg.eigvalsh(inertia)[::-1]


def temperatures(thermo):
    """Temperatures of a sampled run, kelvin: name -> series (n,).

    "all" is that of compute temp; the others follow from k_B T / 2 for each degree of freedom, of
    which the translation of N molecules with no momentum has 3N - 3 and each axis N.
    """
    found = {"all": thermo["Temp"]}
    if "f_move[1]" in thermo:
        squares = [thermo[f"c_squares[{k}]"] for k in range(1, 7)]
        kinetic = 0.5 * ENERGY * MASSES.sum() * sum(squares[:3])
        axes = [0.5 * ENERGY * i * square for i, square in zip(moments(), squares[3:])]
        found["translation"] = 2 * kinetic / ((3 * MOLECULES - 3) * BOLTZMANN)
        for name, energy in zip(AXES, axes):
            found[f"axis {name}"] = 2 * energy / (MOLECULES * BOLTZMANN)
    else:
        found["translation"] = 2 * thermo["c_trans"] / ((3 * MOLECULES - 3) * BOLTZMANN)
        found["rotation"] = 2 * thermo["c_rot"] / (3 * MOLECULES * BOLTZMANN)
    return found


def kinetic_mismatch(thermo):
    """Largest relative difference between compute temp and the squares of all velocities.

    Zero if degrees of freedom, moments and the rows of the fix belong together.
    """
    found = temperatures(thermo)
    energy = (3 * MOLECULES - 3) * found["translation"]
    energy = energy + MOLECULES * sum(found[f"axis {name}"] for name in AXES)
    return float(np.max(np.abs(energy / (6 * MOLECULES - 3) / found["all"] - 1)))


def partition(thermo):
    """Name -> Mean of its temperature minus that of all, kelvin."""
    found = temperatures(thermo)
    whole = found.pop("all")
    return {name: block_mean(series - whole) for name, series in found.items()}


# --- verdicts -----------------------------------------------------------------------------------
def _name(method):
    return "second formulation" if method == SECOND else "first formulation"


def time_rows(results):
    """Time in the fix, by ranks and formulation."""
    rows, bodies = [], bodies_of(results.plan.headline)
    for ranks in results.plan.ranks:
        for method in GEAR:
            ratio, least, largest = time_ratio(results, method, ranks)
            many = "1 rank" if ranks == 1 else f"{ranks} ranks"
            rows.append(
                Row(
                    f"time in the fix over rigid/nve/small's, {bodies} molecules, {many}, "
                    f"{_name(method)}",
                    f"≤ {TIME_ASKED:g}",
                    (
                        "timings too noisy"
                        if math.isnan(ratio)
                        else f"{ratio:.2f} ({least:.2f} to {largest:.2f})"
                    ),
                    ratio <= TIME_ASKED,
                )
            )
    return rows


def memory_rows(results):
    """Memory of a body: the largest ratio of all sizes counts, by LAMMPS' sum and on the heap."""
    rows = []
    for method in GEAR:
        ratios = memory_ratios(results, method)
        rows.append(
            Row(
                f"memory of a body over rigid/nve/small's, all sizes, {_name(method)}",
                f"≤ {MEMORY_ASKED:g}",
                f"{min(ratios):.2f} to {max(ratios):.2f}",
                max(ratios) <= MEMORY_ASKED,
            )
        )
    return rows


def growth_rows(results):
    """Growth with the number of bodies."""
    sizes = ", ".join(str(bodies_of(cells)) for cells in results.plan.growth)
    rows = []
    for method in GEAR:
        found = nonlinearity(results, method)
        rows.append(
            Row(
                f"time in the fix for {sizes} bodies, off a proportional law, {_name(method)}",
                f"≤ {GROWTH_ASKED:.0%}",
                f"{found:.0%}",
                found <= GROWTH_ASKED,
            )
        )
    return rows


def pressure_rows(results):
    """The mean pressure at every step is one value, and that of one configuration even more so."""
    steps = ", ".join(f"{dt:g}" for dt in results.plan.pressure_dts)
    limit = bound(len(results.plan.pressure_dts))
    rows = []
    for method in GEAR:
        means = mean_pressures(results, method)
        off = largest_deviation(means.values())
        rows.append(
            Row(
                f"mean pressure at steps of {steps} fs, {_name(method)}: farthest from their mean",
                f"one value: ≤ {limit:.1f} standard errors",
                f"{off:.1f}",
                off <= limit,
            )
        )
        start, after = instant_changes(results, method)
        _, theirs = instant_changes(results, NVE_SMALL)
        size = max(abs(pressure) for pressure, _ in instants(results, method).values())
        rows.append(
            Row(
                f"pressure of one configuration at these steps, {_name(method)}: largest difference",
                f"rounding at the start; after {results.plan.interval:g} fs less than "
                f"rigid/nve/small's {theirs:.2g} atm",
                f"{start:.1g} and {after:.2g} atm",
                start <= ROUNDING * size and after < theirs,
            )
        )
    return rows


def temperature_rows(results):
    """Degrees of freedom, equipartition, and the mean temperature at the same energy."""
    rows = []
    theirs = block_mean(temperatures(results.temperatures[NVE_SMALL.key])["all"])
    for method in GEAR:
        thermo = results.temperatures[method.key]
        parts = partition(thermo)
        off, limit = largest_deviation(parts.values(), 0.0), bound(len(parts))
        rows.append(
            Row(
                f"equipartition, {_name(method)}: translation and each axis against the whole",
                f"≤ {limit:.1f} standard errors",
                f"{off:.1f}",
                off <= limit,
            )
        )
        mismatch = kinetic_mismatch(thermo)
        rows.append(
            Row(
                f"compute temp against 6N - 3 degrees of freedom, {_name(method)}",
                f"≤ {ROUNDING:.0e}",
                f"{mismatch:.0e}",
                mismatch <= ROUNDING,
            )
        )
        ours = block_mean(temperatures(thermo)["all"])
        error = math.hypot(ours.error, theirs.error)
        off, limit = abs(ours.value - theirs.value) / error, bound(1)
        rows.append(
            Row(
                f"mean temperature, {_name(method)}, against rigid/nve/small's at the same energy",
                f"≤ {limit:.1f} standard errors",
                f"{off:.1f} ({ours} and {theirs} K)",
                off <= limit,
            )
        )
    return rows


def all_rows(results):
    """Every demand with its verdict."""
    parts = (time_rows, memory_rows, growth_rows, pressure_rows, temperature_rows)
    return [row for part in parts for row in part(results)]
