"""Water: averages, fluctuations and motion, and their dependence on the time step.

plan.py (sizes of the runs), runs.py (LAMMPS' runs and the stored samples), frames.py (motion of the molecules),
quantities.py (quantities from samples), and here the results.
"""

import math

import numpy as np

from benchmarks.engine import Finding, Measurement, Study, Table
from benchmarks.engine.panels import Curve, Panel
from benchmarks.engine.statistics import allowed

from . import quantities
from .plan import EXTRAPOLATED, FIXED, LONG, METHODS, MODELS, OURS, PUBLISHED, RIVAL, SHAKE, SHORT, TARGETS, TEMPERATURE
from .quantities import AVERAGES, DENSITY, DRIFT, ENERGY, FLUCTUATIONS, PRESSURE, WARMER, cell, difference
from .runs import measure

#: standard errors that a comparison of time steps needs: K, g/mL (3e-4 of the density), kcal/mol (0.02 kJ/mol)
NEEDED = {WARMER: 0.3, DENSITY: 3e-4, ENERGY: 0.02 / 4.184}
#: number of values that are compared with expected ones; it determines the largest deviation allowed
COMPARED = 8
RICHARDSON = f"{METHODS[SHAKE]}, extrapolated from 1 and 2 fs"


def of_series(samples):
    """Series -> list of its samples, in the order of the plan."""
    return {series: [sample for sample in samples if sample.series == series] for series in TARGETS}


def at_atmosphere(found, model=None):
    """The series at 1 atm that have samples, of one model or all; by model and method, the longest step first."""
    chosen = [one for one in found if one.at_constant_pressure and found[one] and model in (None, one.model)]
    return sorted(chosen, key=lambda one: (list(MODELS).index(one.model), list(METHODS).index(one.method), -one.dt))


def length(samples):
    """Duration of the samples together in ns."""
    return sum(sample.ps for sample in samples) / 1000


def table(found, chosen, lengths=True):
    """A row with the ``chosen`` quantities for each series at 1 atm, and for Richardson's extrapolation."""
    rows = []
    for series in at_atmosphere(found):
        samples = found[series]
        cells = [f"{length(samples):.2f}"] if lengths else []
        rows.append([MODELS[series.model].title, series.text, *cells, *(quantity.text(samples) for quantity in chosen)])
    both = [found[series] for series in EXTRAPOLATED]
    cells = [cell(quantities.extrapolated(*both, quantity), quantity.sign) for quantity in chosen]
    rows.append([MODELS[SHORT.model].title, RICHARDSON, *(["–"] if lengths else []), *cells])
    return Table(("model", "method and step", *(["ns"] if lengths else []), *(quantity.title for quantity in chosen)), rows)


def volume_table(found):
    """A row for each series at constant volume."""
    chosen = (WARMER, PRESSURE, ENERGY, DRIFT)
    rows = [[s.text, f"{length(found[s]):.2f}", *(quantity.text(found[s]) for quantity in chosen)] for s in (FIXED, RIVAL)]
    return Table(("method and step", "ns", *(quantity.title for quantity in chosen)), rows)


def square_per_ns(found, quantity):
    """Square of the standard error of a quantity after 1 ns, the mean over the series of TIP4P/2005 at 1 atm by their lengths."""
    lengths, squares = [], []
    for series in at_atmosphere(found, SHORT.model):
        lengths.append(length(found[series]))
        squares.append(quantity.of(found[series])[1] ** 2 * lengths[-1])
    return float(np.average(squares, weights=lengths))


def per_square(seconds, method, dt):
    """Seconds for 1 ns with a method and step: the cost for an error whose square after 1 ns is one."""
    return seconds[method] * 1e6 / dt


def extrapolated_per_square(seconds):
    """The same with Richardson's extrapolation, if both runs have the lengths with the smallest error."""
    fine, coarse = (math.sqrt(per_square(seconds, series.method, series.dt)) for series in EXTRAPOLATED)
    return (4 * fine + coarse) ** 2 / 9


def costs(seconds):
    """Method and step -> seconds for 1 ns, for those whose averages have no visible error of the step."""
    found = {one.text: per_square(seconds, one.method, one.dt) for one in (LONG["tip4p"], SHORT)}
    return found | {RICHARDSON: extrapolated_per_square(seconds)}


def cost_table(found, rounds):
    """Core-hours for the errors NEEDED, and the factor relative to our fix with its error from the rounds of timing."""
    least = {method: min(seconds) for method, seconds in rounds.items()}
    ours, rows = LONG["tip4p"].text, []
    for name, cost in costs(least).items():
        each = [costs(dict(zip(rounds, seconds))) for seconds in zip(*rounds.values())]
        factors = [one[name] / one[ours] for one in each]
        error = float(np.std(factors, ddof=1) / math.sqrt(len(factors))) if len(factors) > 1 else math.nan
        hours = [cost * square_per_ns(found, quantity) / error**2 / 3600 for quantity, error in NEEDED.items()]
        factor = (cost / costs(least)[ours], error) if name != ours else (1.0, math.nan)
        rows.append([name, *(f"{h:.2g}" for h in hours), cell(factor) if name != ours else "1"])
    header = [f"{quantity.name}, ± {error:.2g} {quantity.unit}" for quantity, error in NEEDED.items()]
    return Table(("method and step", *header, "relative cost"), rows)


def widest(error, *groups):
    """Largest allowed deviation of a value with this standard error, from this number of groups of samples."""
    freedoms = sum(len(samples) - 1 for samples in groups)
    return error * allowed(COMPARED, freedoms) if freedoms > 1 else math.nan


def measurements(found):
    """Measurements with their bounds."""
    rows = []
    for model, series in LONG.items():
        value, error = DENSITY.of(found[series])
        most, right = 0.002 + 2 * error, PUBLISHED[model]
        bounds = {"remark": f"published: {right}", "least": right - most, "most": right + most}
        what = f"density of {MODELS[model].title}, {series.text}"
        rows.append(Measurement(what, value, error, ".5f", "g/mL", **bounds))
    for quantity in (DENSITY, ENERGY):
        pair = LONG["tip4p"], SHORT
        both = [found[series] for series in pair]
        apart = difference(*(quantity.of(samples) for samples in both))
        most = widest(apart[1], *both)
        words = f"{quantity.name} of {MODELS['tip4p'].title}, {pair[0].text}, minus {pair[1].text}"
        rows.append(Measurement(words, *apart, ".5f", quantity.unit, least=-most, most=most))
    for series in (*at_atmosphere(found), FIXED, RIVAL):
        value, error = WARMER.of(found[series])
        most = widest(error, found[series])
        bounds = {"least": -most, "most": most} if series.method == OURS else {}
        where = "" if series.at_constant_pressure else ", at constant volume"
        words = f"T translation − T rotation, {MODELS[series.model].title}, {series.text}{where}"
        rows.append(Measurement(words, value, error, ".2f", "K", **bounds))
    return rows


def panels(found):
    """Panels of the difference of temperatures and of the density of TIP4P/2005 against the step."""
    shown = []
    longest = {series.method: series for series in reversed(at_atmosphere(found, "tip4p"))}  # of each method
    signed = (WARMER, "rotation is hotter", "rotation is colder"), (DENSITY, "the density is lower", "the density is higher")
    for quantity, *signs in signed:
        apart, error = difference(*(quantity.of(found[longest[method]]) for method in (SHAKE, OURS)))
        seen = f"{signs[apart > 0]} with fix shake" if abs(apart) > 2 * error else "the methods agree within their errors"
        title = f"At {longest[OURS].dt:g} fs {seen}"
        curves = []
        for method, color in ((OURS, "momentum"), (SHAKE, "rigid")):
            of_method = sorted((s for s in at_atmosphere(found, "tip4p") if s.method == method), key=lambda s: s.dt)
            values, errors = np.array([quantity.of(found[series]) for series in of_method]).T
            steps = np.array([series.dt for series in of_method])
            label = METHODS[method].replace("`", "")
            curves.append(Curve(label, steps, values, color, "-", "o", errors))
        shown.append(Panel(title, "step, fs", quantity.title, curves, log="", legend=False))
    return shown


def find(results):
    """Finding of Results."""
    samples, found = results.samples, of_series(results.samples)
    context = {"samples": len(samples), "ps": samples[0].ps, "runs": len({(s.series, s.start) for s in samples})}
    context |= {"temperature": TEMPERATURE, "molecules": MODELS["tip4p"].molecules}
    tables = {"water": table(found, AVERAGES), "fluctuations": table(found, FLUCTUATIONS, lengths=False)}
    tables |= {"volume": volume_table(found), "costs": cost_table(found, results.seconds)}
    pictures = {"water": panels(found)}
    return Finding(measurements(found), tables, pictures, context)


STUDY = Study("water", "Averages of water", 3600.0, measure, find, blocks={"doc/water.md": "water.md.j2"})
