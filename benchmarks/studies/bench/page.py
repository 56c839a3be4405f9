"""Tables of ``benchmarks/run bench`` as CSV, and the page doc/many_bodies.md: every number from Results."""

from pathlib import Path

import numpy as np

from . import judge
from .runs import COMPARED, GEAR, NVE_SMALL, SAMPLED, TIMED, FROZEN, bodies_of
from benchmarks.engine.checkout import provenance, write_page
from benchmarks.engine.tables import HEADER, markdown_table, verdict, write_csv

COMMAND = "benchmarks/run bench --publish"
PAGE, PICTURE, FOLDER = "many_bodies.md", "many_bodies.png", "many_bodies"
TIMINGS_HEADER = ("method", "bodies", "ranks", "round", "steps", "loop", "comm", "modify") + (
    "start evaluations",
    "start seconds",
    "MiB reported",
    "MiB allocated",
)


# --- CSV ----------------------------------------------------------------------------------------
def write_tables(folder, results):
    """bench.csv (demands), timings.csv, pressure.csv and temperature.csv."""
    folder = Path(folder)
    write_csv(folder / "bench.csv", HEADER, [row.cells for row in judge.all_rows(results)])
    rows = []
    for t in results.timings:
        head = (t.run.method.key, t.run.bodies, t.run.ranks, t.run.round, t.run.steps)
        rows.append(
            (*head, t.loop, t.comm, t.modify, t.start_evaluations, t.start_seconds)
            + (t.reported, t.allocated)
        )
    write_csv(folder / "timings.csv", TIMINGS_HEADER, rows)
    rows = []
    for method in COMPARED:
        means, instants = judge.mean_pressures(results, method), judge.instants(results, method)
        rows += [(method.key, dt, m.value, m.error, *instants[dt]) for dt, m in means.items()]
    header = ("method", "step", "mean pressure", "standard error", "at the start", "first sample")
    write_csv(folder / "pressure.csv", header, rows)
    rows = [
        (method.key, name, mean.value, mean.error)
        for method in SAMPLED
        for name, mean in _means(results, method).items()
    ]
    write_csv(folder / "temperature.csv", ("method", "part", "temperature", "standard error"), rows)


def _means(results, method):
    found = judge.temperatures(results.temperatures[method.key])
    return {name: judge.block_mean(series) for name, series in found.items()}


# --- tables -------------------------------------------------------------------------------------
def ranged(values, digits=2):
    """Median (least to largest) as text."""
    return "{0:.{n}f} ({1:.{n}f} to {2:.{n}f})".format(*judge.spread(values), n=digits)


def time_table(results):
    """Milliseconds a step in the fix and altogether, by ranks."""
    cells = results.plan.headline
    header = ["ms a step"]
    for ranks in results.plan.ranks:
        many = "1 rank" if ranks == 1 else f"{ranks} ranks"
        header += [f"in the fix, {many}", f"whole step, {many}"]
    rows = []
    for method in TIMED:
        row = [method.label]
        for ranks in results.plan.ranks:
            for seconds in (results.fix_seconds, results.step_seconds):
                bare = method == FROZEN and seconds == results.fix_seconds
                row.append("–" if bare else ranged(1e3 * np.array(seconds(method, cells, ranks))))
        rows.append(row)
    return markdown_table(header, rows)


def start_table(results):
    """What the start of the series takes."""
    rows, cells = [], results.plan.headline
    for method in GEAR:
        for ranks in results.plan.ranks:
            found = results.of(method, cells, ranks)
            step = judge.spread(results.step_seconds(method, cells, ranks))[0]
            seconds = [t.start_seconds for t in found]
            counts = sorted({t.start_evaluations for t in found})
            steps = judge.spread(seconds)[0] / step
            evaluations = " or ".join(map(str, counts))
            rows.append([method.label, ranks, evaluations, ranged(seconds), f"{steps:.0f}"])
    header = ["start, once", "ranks", "force evaluations", "seconds", "as many steps as"]
    return markdown_table(header, rows)


def memory_table(results):
    """Bytes a body, by number of bodies and way of counting."""
    found = {method: judge.memory(results, method) for method in (*GEAR, NVE_SMALL)}
    header = [
        f"{bodies_of(cells)} bodies, {judge.MEMORY_KINDS[kind]}" for cells, kind in found[NVE_SMALL]
    ]
    rows = [[m.label, *(f"{value:.0f}" for value in found[m].values())] for m in found]
    return markdown_table(["bytes a body", *header], rows)


def growth_table(results):
    """Microseconds a body and step, by number of bodies."""
    sizes = [bodies_of(cells) for cells in results.plan.growth]
    header = ["µs in the fix, a body and step", *(f"{n} bodies" for n in sizes), "off"]
    rows = []
    for method in (*GEAR, NVE_SMALL):
        found = judge.per_body(results, method)
        cells = ["{:.3f} ({:.3f} to {:.3f})".format(*found[n]) for n in sizes]
        rows.append([method.label, *cells, f"{judge.nonlinearity(results, method):.0%}"])
    return markdown_table(header, rows)


def pressure_tables(results):
    """Means with errors, shifts against the smallest step, and pressures of one configuration."""
    dts = results.plan.pressure_dts
    steps = [f"step {dt:g} fs" for dt in dts]
    means = {m: judge.mean_pressures(results, m) for m in COMPARED}
    shifts = {m: judge.pressure_shifts(results, m) for m in COMPARED}
    instants = {m: judge.instants(results, m) for m in COMPARED}
    tables = [
        (
            ["mean pressure, atm", *steps],
            [[m.label, *map(str, means[m].values())] for m in COMPARED],
        ),
        (
            [f"less that at step {dts[0]:g}, same times, atm", *steps[1:]],
            [[m.label, *(_fine(mean) for mean in shifts[m].values())] for m in COMPARED],
        ),
    ]
    for k, moment in enumerate(("at the start", f"after {results.plan.interval:g} fs")):
        rows = [[m.label, *(f"{instants[m][dt][k]:.4f}" for dt in dts)] for m in COMPARED]
        tables.append(([f"pressure {moment}, atm", *steps], rows))
    return [line for table in tables for line in [*markdown_table(*table), ""]]


def _fine(mean):
    return f"{mean.value:.2g} ± {mean.error:.2g}"


def temperature_table(results):
    """Means with errors of every part."""
    names = ["all", "translation", "rotation", *(f"axis {name}" for name in judge.AXES)]
    rows = []
    for method in SAMPLED:
        found = _means(results, method)
        rows.append([method.label, *(str(found[n]) if n in found else "–" for n in names)])
    return markdown_table(["temperature, K", *names], rows)


# --- the page -----------------------------------------------------------------------------------
def _section(title, *parts):
    lines = [f"## {title}", ""]
    for part in parts:
        lines += [*([part] if isinstance(part, str) else part), ""]
    return lines


def _tables(results):
    plan, bodies = results.plan, bodies_of(results.plan.headline)
    count = f"Median of {plan.rounds} (least to largest)."
    interval = f"every {plan.interval:g} fs for {plan.pressure_time / 1000:g} ps"
    return [
        *_section(f"Time, {bodies} molecules", count, time_table(results), start_table(results)),
        *_section("Memory", memory_table(results)),
        *_section("Growth", count + " One rank.", growth_table(results)),
        *_section(
            "Pressure",
            f"{judge.MOLECULES} molecules, smooth forces, sampled {interval} from the same start; "
            f"mean ± standard error of {judge.BLOCKS} blocks. Pressures of one configuration have "
            "no statistical error: what they differ by comes from the step.",
            pressure_tables(results),
        ),
        *_section(
            "Temperature",
            f"{judge.MOLECULES} molecules, smooth forces, {plan.temperature_time / 1000:g} ps at "
            f"steps of {plan.temperature_dt:g} fs, constant energy.",
            temperature_table(results),
        ),
    ]


def _method(plan):
    """Rules behind the numbers."""
    sizes = ", ".join(f"{bodies_of(cells)}: {steps}" for cells, steps in plan.growth.items())
    return [
        f"- SPC/E water, `examples/water/data.water` replicated; steps of {plan.timing_dt:g} fs, "
        "charges and Lennard-Jones cut off plainly at 8 Å (`forces.plain`), neighbours renewed every "
        "10 steps. One LAMMPS at a time, methods in turn, each round in another order. Steps timed, "
        f"by number of molecules: {sizes}. Fixes at their defaults; for growth the start is left out "
        "(`start zero`), it takes no steps.",
        '- Time in the fix: LAMMPS\' "Modify", which has all that the fix sends by itself, plus '
        '"Comm" less that of the same run without a fix, in which nothing moves: what the fix adds '
        "to LAMMPS' messages. Slowest rank, `timer normal sync`, so that no rank's waiting for the "
        "other counts. The first step, with the start, is not among the timed ones.",
        "- Memory: that of the run less that of the same run without a fix, after the first step, on "
        "one rank: LAMMPS' own sum, and what is in use of the heap (`info memory`). Arrays grow in "
        "leaps, so bytes a body depend on the number of bodies: the largest of all ratios counts.",
        "- Growth: (largest − least) / (largest + least) of the times a body and step, the deviation "
        "from the best proportional law.",
        f"- Standard errors: {judge.BLOCKS} blocks. A deviation counts if Student's t makes it sure "
        f"to {judge.CONFIDENCE:.0%}, over all values that are compared at once (Bonferroni).",
        "- Temperatures: k_B T / 2 for each of 3N − 3 degrees of freedom of translation and N of each "
        "principal axis, from the rows of the fix; `all` is LAMMPS' compute temp.",
    ]


def page_text(out, results, picture=PICTURE):
    """The page; ``out``: folder of the run, ``picture``: where the picture is, from the page."""
    rows = judge.all_rows(results)
    lines = [
        "# Many bodies",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out, ('lammps-gearquat', 'numpy', 'scipy'))}",
        "",
        f"![Time, growth, memory, pressure and temperature.]({picture})",
        "",
        verdict(rows),
        "",
        *markdown_table(HEADER, [row.cells for row in rows]),
        "",
        *_tables(results),
        "## How it was measured",
        "",
        *_method(results.plan),
    ]
    return "\n".join(lines) + "\n"


def write(out, results):
    """Tables as CSV and the page, in the folder of the run."""
    write_tables(out, results)
    (Path(out) / PAGE).write_text(page_text(out, results), encoding="utf-8")


def publish(folder, out, results):
    """Write page and picture into a checkout."""
    text = page_text(out, results, f"{FOLDER}/{PICTURE}")
    write_page(folder, FOLDER, text, [Path(out) / PICTURE])
