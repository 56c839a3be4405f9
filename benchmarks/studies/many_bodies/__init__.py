"""Many bodies: time, memory, pressure and temperature in water, compared with LAMMPS' own fixes.

runs.py (runs and their logs), quantities.py (results from runs), and here the measurements, tables and panels.
"""

from functools import partial

import numpy as np

from benchmarks.engine.panels import Curve, Panel, draw
from benchmarks.engine.statistics import allowed
from benchmarks.engine.study import Finding, Measurement, Study, Table

from . import quantities as of
from .runs import COMPARED, FROZEN, MOLECULES, NVE_SMALL, OURS, RACE, SMALL, TIMED
from .runs import bodies_of, measure

#: bounds: time in the fix and memory, relative to fix rigid/nve/small; deviation from linear growth
MOST_TIME, MOST_MEMORY, MOST_GROWTH = 1.0, 1.5, 0.10
#: relative differences below this are round-off
ROUNDING = 1e-9
OVER = f"relative to {NVE_SMALL.label}"
#: method -> color, marker
LOOKS = {
    OURS: ("momentum", "o"),
    NVE_SMALL: ("rigid", "D"),
    SMALL: ("translation", "^"),
}


def ranks_text(ranks):
    """Number of ranks in words."""
    return f"{ranks} rank{'s' * (ranks > 1)}"


# --- measurements ---------------------------------------------------------------------------------
def timing_measurements(results):
    """Time in the fix, growth and memory."""
    plan, ratios = results.plan, of.memory_ratios(results, OURS)
    for ranks in plan.ranks:
        ratio, least, largest = of.time_ratio(results, OURS, ranks)
        what = f"{bodies_of(plan.headline)} molecules, {ranks_text(ranks)}: time in the fix {OVER}"
        remark = f"{least:.2f} to {largest:.2f} in {plan.rounds} rounds"
        yield Measurement(what, ratio, spec=".2f", remark=remark, most=MOST_TIME)
    what, remark = f"largest memory of a body {OVER}, all sizes", f"least: {min(ratios):.2f}"
    yield Measurement(what, max(ratios), spec=".2f", remark=remark, most=MOST_MEMORY)
    what = f"{', '.join(map(str, plan.sizes))} bodies: deviation from linear scaling"
    value = of.nonlinearity(results, OURS)
    yield Measurement(what, value, spec=".0%", most=MOST_GROWTH)


def pressure_measurements(results):
    """The mean pressure does not depend on the step; the pressure of one configuration tests this more precisely."""
    dts, interval = results.plan.pressure_dts, results.plan.interval
    steps = f"steps of {', '.join(f'{dt:g}' for dt in dts)} fs"
    value = of.largest_deviation(of.mean_pressures(results, OURS).values())
    what = f"{steps}: largest deviation of a mean pressure, in standard errors"
    yield Measurement(what, value, spec=".1f", most=allowed(len(dts), of.BLOCKS - 1))
    instants = of.instants(results, OURS)
    start, after = np.ptp(instants, axis=0)
    most = ROUNDING * np.abs(instants[:, 0]).max()
    what = f"{steps}: largest difference of the pressures at the start"
    yield Measurement(what, start, spec=".1g", unit="atm", most=most)
    _, theirs = np.ptp(of.instants(results, NVE_SMALL), axis=0)
    remark = f"{NVE_SMALL.label}: {theirs:.2g} atm"
    what = f"{steps}: largest difference of the pressures after {interval:g} fs"
    yield Measurement(what, after, spec=".2g", unit="atm", remark=remark, most=theirs)


def temperature_measurements(results):
    """Degrees of freedom, equipartition, and the mean temperature at the same energy."""
    thermo = results.temperatures[OURS.key]
    parts = of.partition(thermo).values()
    value, most = of.largest_deviation(parts, 0.0), allowed(len(parts), of.BLOCKS - 1)
    what = "largest deviation from equipartition, in standard errors"
    yield Measurement(what, value, spec=".1f", most=most)
    what = "relative difference of compute temp and 6N - 3 degrees of freedom"
    yield Measurement(what, of.kinetic_mismatch(thermo), spec=".0e", most=ROUNDING)
    off = of.warmer(results, OURS)
    most = allowed(1, off.freedoms) * off.error
    what = f"difference of the mean temperature from {NVE_SMALL.label}"
    yield Measurement(what, off.value, off.error, ".1f", "K", least=-most, most=most)


def measurements_of(results):
    """All measurements, in the order of the page."""
    return [*timing_measurements(results), *pressure_measurements(results), *temperature_measurements(results)]


# --- tables ---------------------------------------------------------------------------------------
def ranged(values, digits=2):
    """Median (smallest to largest) as text."""
    return "{0:.{n}f} ({1:.{n}f} to {2:.{n}f})".format(*of.spread(values), n=digits)


def shown(mean, spec=".1f"):
    """A Mean as text."""
    return f"{mean.value:{spec}} ± {mean.error:{spec}}"


def time_table(results):
    """Milliseconds per step in the fix and in total, by ranks."""
    cells, header, rows = results.plan.headline, ["ms per step"], []
    for ranks in results.plan.ranks:
        header += [f"in the fix, {ranks_text(ranks)}", f"whole step, {ranks_text(ranks)}"]
    for method in TIMED:
        row = [method.label]
        for ranks in results.plan.ranks:
            inside = 1e3 * results.fix_seconds(method, cells, ranks)
            row.append("–" if method == FROZEN else ranged(inside))
            row.append(ranged(1e3 * results.step_seconds(method, cells, ranks)))
        rows.append(row)
    return Table(header, rows)


def start_table(results):
    """Cost of the start of fix gear/quat."""
    rows, cells = [], results.plan.headline
    for ranks in results.plan.ranks:
        timings = results.timings[OURS.key, cells, ranks]
        seconds = [t.seconds for t in timings]
        steps = np.median(seconds) / np.median(results.step_seconds(OURS, cells, ranks))
        counts = " or ".join(map(str, sorted({t.evaluations for t in timings})))
        rows.append([ranks, counts, ranged(seconds), f"{steps:.0f}"])
    return Table(("ranks", "force evaluations of the start", "seconds", "equivalent steps"), rows)


def size_tables(results):
    """Bytes per body, and microseconds in the fix per body and step, by number of bodies."""
    memory = {method: of.memory(results, method) for method in RACE}
    header = [f"{bodies_of(c)} bodies, {of.MEMORY_KINDS[k]}" for c, k in memory[NVE_SMALL]]
    rows = [[m.label, *(f"{value:.0f}" for value in memory[m].values())] for m in RACE]
    tables = {"memory": Table(["bytes per body", *header], rows)}
    header = ["µs in the fix per body and step", *(f"{n} bodies" for n in results.plan.sizes)]
    rows = []
    for method in RACE:
        cells = [ranged(times, 3) for times in of.per_body(results, method).values()]
        rows.append([method.label, *cells, f"{of.nonlinearity(results, method):.0%}"])
    return tables | {"growth": Table([*header, "deviation from linear scaling"], rows)}


def pressure_tables(results):
    """Means with errors, shifts against the smallest step, and pressures of one configuration."""
    dts = results.plan.pressure_dts

    def table(words, steps, values, text):
        rows = [[m.label, *map(text, values(m))] for m in COMPARED]
        return Table([words, *(f"step {dt:g} fs" for dt in steps)], rows)

    def means(of_method):
        return lambda method: of_method(results, method).values()

    def instant(k):
        return lambda method: of.instants(results, method)[:, k]

    shift = f"difference of the mean pressure from step {dts[0]:g} fs, same times, atm"
    after, digits = f"pressure after {results.plan.interval:g} fs, atm", "{:.4f}".format
    return {
        "pressure": table("mean pressure, atm", dts, means(of.mean_pressures), shown),
        "shift": table(shift, dts[1:], means(of.pressure_shifts), partial(shown, spec=".2g")),
        "start_pressure": table("pressure at the start, atm", dts, instant(0), digits),
        "sample": table(after, dts, instant(1), digits),
    }


def temperature_table(results):
    """Mean temperatures with errors, of all and of each part."""
    names = ["all", "translation", "rotation", *(f"axis {name}" for name in of.AXES)]
    rows = []
    for method in RACE:
        series = of.temperatures(results.temperatures[method.key])
        cells = [shown(of.block_mean(series[n])) if n in series else "–" for n in names]
        rows.append([method.label, *cells])
    return Table(["temperature, K", *names], rows)


# --- picture --------------------------------------------------------------------------------------
def _bars(samples):
    """Medians (n,) and error bars (2, n) to the smallest and largest value, for n lists of values."""
    median, least, largest = np.transpose([of.spread(values) for values in samples])
    return median, np.array([median - least, largest - median])


def _curve(method, x, y, error=None, line="-"):
    color, marker = LOOKS[method]
    return Curve(method.label, np.array(x), y, color, line, marker, error)


def _size_panels(results):
    """Time by ranks, time by bodies, memory by bodies."""
    plan, time, growth, memory = results.plan, [], [], []
    for k, method in enumerate(RACE):
        seconds = [results.fix_seconds(method, plan.headline, n) for n in plan.ranks]
        at = np.arange(len(plan.ranks)) + 0.08 * (k - 1)
        time.append(_curve(method, at, *_bars([1e3 * s for s in seconds]), line=""))
        per_body = of.per_body(results, method).values()
        growth.append(_curve(method, plan.sizes, *_bars(per_body)))
        bytes_of = of.memory(results, method)
        for kind, line in (("reported", "--"), ("allocated", "-")):
            values = np.array([bytes_of[cells, kind] for cells in plan.growth])
            memory.append(_curve(method, plan.sizes, values, line=line))
    title = f"Time in the fix, {bodies_of(plan.headline)} molecules"
    ticks = {"ticks": tuple(map(ranks_text, plan.ranks)), "ylim": (0, None)}
    by_size = {"log": "x", "xticks": plan.sizes, "ylim": (0, None), "legend": False}
    heap, one_rank = "Memory: heap, dashed: LAMMPS' sum", "Time in the fix, one rank"
    return (
        Panel(title, "", "ms per step", time, log="", legend=False, **ticks),
        Panel(one_rank, "bodies", "µs per body and step", growth, **by_size),
        Panel(heap, "bodies", "bytes per body", memory, **by_size),
    )


def _sample_panels(results):
    """Pressure against the step, averaged and of one configuration; temperature of the parts."""
    plan, shifts, instants = results.plan, [], []
    dts, known = plan.pressure_dts, of.instants(results, OURS)[0, 1]
    for method in COMPARED:
        means = of.pressure_shifts(results, method)
        values, errors = np.transpose([(abs(mean.value), mean.error) for mean in means.values()])
        bars = np.array([np.minimum(errors, 0.9 * values), errors])
        shifts.append(_curve(method, list(means), values, bars))
        off = np.abs(of.instants(results, method)[:, 1] - known)
        seen = off > ROUNDING * abs(known)
        instants.append(_curve(method, np.array(dts)[seen], off[seen]))
    means = of.partition(results.temperatures[OURS.key])
    values, errors = np.transpose([(mean.value, mean.error) for mean in means.values()])
    part = _curve(OURS, np.arange(len(means)), values, errors, line="")
    zero = Curve("", np.array([-0.4, len(means) - 0.6]), np.zeros(2), "#222222")
    names = tuple(n.removeprefix("axis ").replace(" the ", "\nthe ") for n in means)
    by_step = {"log": "xy", "xticks": dts, "legend": False}
    shift = f"Mean pressure: difference from step {dts[0]:g} fs"
    after = f"Pressure after {plan.interval:g} fs: difference from {OURS.label}, step {dts[0]:g} fs"
    return (
        Panel(shift, "step, fs", "atm", shifts, **(by_step | {"xticks": dts[1:]})),
        Panel(after, "step, fs", "atm", instants, **by_step),
        Panel("Temperature minus overall temperature", "", "K", (zero, part), "", names, legend=False),
    )


def find(results):
    """Finding of Results."""
    plan = results.plan
    tables = {"time": time_table(results), "start": start_table(results)}
    tables |= size_tables(results) | pressure_tables(results)
    tables["temperature"] = temperature_table(results)
    panels = _size_panels(results) + _sample_panels(results)
    note = "bars: least and largest (time), one standard error (pressure, temperature)"
    sizes = dict(zip(plan.sizes, plan.growth.values()))
    context = {"plan": plan, "sizes": sizes, "bodies": bodies_of(plan.headline)}
    context |= {"molecules": MOLECULES, "blocks": of.BLOCKS}
    picture = partial(draw, panels=panels, columns=3, note=note)
    return Finding(measurements_of(results), tables, {"many_bodies": picture}, context)


STUDY = Study("many_bodies", "Many bodies", 720.0, measure, find)
