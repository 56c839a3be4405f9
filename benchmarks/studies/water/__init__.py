"""Water at constant pressure: density, temperatures and compressibility, and their dependence on the time step.

plan.py (sizes of the runs), runs.py (LAMMPS' runs and the stored samples), and here the results from samples.
"""

import math

import numpy as np

from benchmarks.engine import Finding, Measurement, Study, Table
from benchmarks.engine.statistics import allowed, mean_of_blocks, with_error

from .plan import COMPRESSED, LONG, METHODS, MODELS, OURS, PUBLISHED, SHORT, TARGETS, TEMPERATURE
from .runs import BOLTZMANN, measure

#: 1/atm in 1/GPa, and kcal/mol/A^3 in atm
PER_GPA, ATMOSPHERES = 1.0 / 1.01325e-4, 68568.415
#: constant energy within rigid molecules, which the scene of SPC/E includes, kcal/mol: two O-H of 1 A and one H-H
WITHIN_MOLECULE = {
    "spce": 332.06371 * 0.4238**2 * (1 / (2 * math.sin(math.radians(109.47) / 2)) - 4),
    "tip4p": 0.0,
}
#: standard errors that a comparison of time steps needs: K, g/mL (3e-4 of the density), kcal/mol (0.02 kJ/mol)
NEEDED = {"T translation − T rotation": 0.3, "density": 3e-4, "potential energy": 0.02 / 4.184}
#: number of values that are compared with expected ones; it determines the largest deviation allowed
COMPARED = 6


def of_series(samples):
    """Series -> list of its samples, in the order of the plan."""
    return {series: [sample for sample in samples if sample.series == series] for series in ROUND}


def mean(samples, read):
    """(mean, standard error) of ``read(sample)``; no error with fewer than three samples."""
    values = np.array([read(sample) for sample in samples])
    if len(values) < 3:
        return float(values.mean()), math.nan
    found = mean_of_blocks(values)
    return float(found.value), float(found.error)


def text(found, sign=""):
    """A (value, error) as a cell."""
    value, error = found
    return with_error(value, error, sign) if error > 0 else f"{value:{sign}.4f}"


def jackknife(samples, read):
    """(value, error) of ``read(list of samples)`` from all samples and from all but each."""
    n, value = len(samples), read(samples)
    if n < 3:
        return value, math.nan
    others = np.array([read(samples[:k] + samples[k + 1 :]) for k in range(n)])
    return value, float(np.sqrt((n - 1) / n * np.sum((others - others.mean()) ** 2)))


def fluctuating(samples):
    """Isothermal compressibility from the variance of the volume, 1/GPa."""
    volume, square = (np.mean([getattr(s, name) for s in samples]) for name in ("volume", "volume2"))
    return PER_GPA * (square - volume**2) / (volume * BOLTZMANN * TEMPERATURE * ATMOSPHERES)


def by_two_pressures(low, high):
    """(value, error) of the same from the densities at two pressures."""
    (small, e_small), (large, e_large) = (mean(samples, density) for samples in (low, high))
    apart = high[0].pressure - low[0].pressure
    return PER_GPA * math.log(large / small) / apart, PER_GPA * math.hypot(e_small / small, e_large / large) / apart


def difference(one, other):
    """(value, error) of the difference of two (value, error)."""
    return one[0] - other[0], math.hypot(one[1], other[1])


def widest(error, *groups):
    """Largest allowed deviation of a value with this standard error, from this number of groups of samples."""
    freedoms = sum(len(samples) - 1 for samples in groups)
    return error * allowed(COMPARED, freedoms) if freedoms > 1 else math.nan


def density(sample):
    """In g/mL."""
    return sample.density


def energy(sample):
    """Potential energy per molecule without the energy within it, kcal/mol."""
    return sample.energy - WITHIN_MOLECULE[sample.model]


def warmer(sample):
    """Temperature of translation minus temperature of rotation."""
    return sample.translation - sample.rotation


def table(found):
    """A row for each series at 1 atm."""
    rows = []
    for series, samples in found.items():
        if series.pressure != 1.0 or not samples:
            continue
        cells = [f"{sum(s.ps for s in samples) / 1000:.2f}", text(mean(samples, density))]
        cells += [text(mean(samples, energy)), text(mean(samples, warmer), "+")]
        cells.append(text(jackknife(samples, fluctuating)))
        rows.append([MODELS[series.model].title, series.text, *cells])
    header = ["model", "method and step", "ns", "density, g/mL", "potential energy, kcal/mol", "T translation − T rotation, K"]
    return Table((*header, "compressibility, 1/GPa"), rows)


def duration(samples, read, error):
    """Nanoseconds after which the standard error of ``read(sample)`` is ``error``: it falls with their square root."""
    return sum(sample.ps for sample in samples) / 1000 * (mean(samples, read)[1] / error) ** 2


def durations(found):
    """Length of each series at 1 atm that is required for the errors NEEDED, in ns."""
    rows = []
    for series, samples in found.items():
        if series.pressure == 1.0 and samples:
            cells = [f"{duration(samples, read, error):.2g}" for read, error in zip((warmer, density, energy), NEEDED.values())]
            rows.append([MODELS[series.model].title, series.text, *cells])
    units = ("K", "g/mL", "kcal/mol")
    header = [f"{name}, ± {error:.2g} {unit}" for (name, error), unit in zip(NEEDED.items(), units)]
    return Table(("model", "method and step", *header), rows)


def measurements(found):
    """Measurements with their bounds."""
    rows = []
    for model, series in LONG.items():
        value, error = mean(found[series], density)
        most, right = 0.002 + 2 * error, PUBLISHED[model]
        bounds = {"remark": f"published: {right}", "least": right - most, "most": right + most}
        what = f"density of {MODELS[model].title}, {series.text}"
        rows.append(Measurement(what, value, error, ".5f", "g/mL", **bounds))
    for what, read, unit in (("density", density, "g/mL"), ("energy", energy, "kcal/mol")):
        both = [found[series] for series in (LONG["tip4p"], SHORT)]
        apart = difference(*(mean(samples, read) for samples in both))
        most = widest(apart[1], *both)
        words = f"{what} of {MODELS['tip4p'].title}, {LONG['tip4p'].text}, minus {SHORT.text}"
        rows.append(Measurement(words, *apart, ".5f", unit, least=-most, most=most))
    squeezed = [found[series] for series in COMPRESSED]
    apart = difference(jackknife(found[LONG["spce"]], fluctuating), by_two_pressures(*squeezed))
    most, remark = widest(apart[1], *squeezed), f"the latter: {text(by_two_pressures(*squeezed))}"
    words = "compressibility of SPC/E water from fluctuations minus compressibility from two pressures"
    rows.append(Measurement(words, *apart, ".3f", "1/GPa", remark, least=-most, most=most))
    for series, samples in found.items():
        value, error = mean(samples, warmer)
        most = widest(error, samples)
        bounds = {"least": -most, "most": most} if series.method == OURS and series.pressure == 1 else {}
        words = f"T translation − T rotation, {MODELS[series.model].title}, {series.text}, {series.pressure:g} atm"
        rows.append(Measurement(words, value, error, ".2f", "K", **bounds))
    return rows


def find(samples):
    """Finding of the samples."""
    found = of_series(samples)
    context = {"samples": len(samples), "ps": samples[0].ps, "runs": len({(s.series, s.start) for s in samples}), "methods": METHODS, "temperature": TEMPERATURE}
    context |= {"molecules": MODELS["tip4p"].molecules, "ns": sum(s.ps for s in samples) / 1000}
    context["compressibility"] = [
        text(jackknife(found[LONG["spce"]], fluctuating)),
        text(by_two_pressures(*(found[series] for series in COMPRESSED))),
    ]
    context["pressures"] = [series.pressure for series in COMPRESSED]
    context["commits"] = sorted({s.commit for s in samples})
    return Finding(measurements(found), {"water": table(found), "durations": durations(found)}, context=context)


STUDY = Study("water", "Water at constant pressure", 3600.0, measure, find)
