"""Tables of ``benchmarks/run isokinetic`` as CSV, and the page doc/isokinetic.md: numbers from Results."""

from pathlib import Path

from benchmarks.engine.checkout import provenance, write_page
from benchmarks.engine.tables import HEADER, markdown_table, verdict, write_csv
from . import judge
from .runs import CONSTRAINTS, MOLECULES, TEMPERATURE, THERMOSTAT, TITLES, DriftRun

COMMAND = "benchmarks/run isokinetic --publish"
PAGE, PICTURE, FOLDER = "isokinetic.md", "isokinetic.png", "isokinetic"
#: kcal/mol in kJ/mol
KILOJOULES = 4.184
METHODS = (*CONSTRAINTS, THERMOSTAT)


# --- CSV ----------------------------------------------------------------------------------------
def write_tables(folder, results):
    """isokinetic.csv (demands), drift.csv, distribution.csv."""
    folder = Path(folder)
    write_csv(folder / "isokinetic.csv", HEADER, [row.cells for row in judge.rows(results)])
    rows = []
    for run, kept in results.kept.items():
        rate, error = judge.drift_rate(kept)
        head = (run.constraint, run.rescale, run.dt)
        rows.append((*head, rate, error, judge.largest(results, run), abs(kept.balance).max()))
    header = ("constraint", "rescaled", "step", "drift", "standard error", "largest", "balance")
    write_csv(folder / "drift.csv", header, rows)
    rows = []
    for method in METHODS:
        distances, g = judge.distribution(results, method)
        rows += [(method, *values) for values in zip(distances, g.value, g.error)]
    write_csv(folder / "distribution.csv", ("method", "r", "g", "standard error"), rows)


# --- tables -------------------------------------------------------------------------------------
def drift_tables(results):
    """Drift of the kinetic energy and of the balance of energies, by step."""
    plan = results.plan
    header = ["", *(f"step {dt:g}" for dt in plan.dts), "order"]
    drifts, ends, balances = [], [], []
    for constraint in CONSTRAINTS:
        kept = [results.kept[DriftRun(constraint, False, dt)] for dt in plan.dts]
        rates = [
            judge.drift_rate(one)[0] * plan.drift_steps * dt for one, dt in zip(kept, plan.dts)
        ]
        order = f"{judge.order(results, constraint):.2f}"
        title = TITLES[constraint]
        drifts.append([title, *(f"{rate:.1e}" for rate in rates), order])
        ends.append([title, *(f"{abs(one.error).max():.1e}" for one in kept), ""])
        balances.append([title, *(f"{abs(one.balance).max():.1e}" for one in kept), ""])
    lines = []
    for first, rows in (
        ("drift of K/K(0) in the run, least squares", drifts),
        ("largest change of K/K(0)", ends),
        ("largest error of potential + kinetic energy + heat, in units of K", balances),
    ):
        lines += [*markdown_table([first, *header[1:]], rows), ""]
    return lines


def rescaled_table(results):
    """The same with momenta rescaled."""
    plan = results.plan
    rows = []
    for constraint in CONSTRAINTS:
        run = DriftRun(constraint, True, plan.rescaled_dt)
        balance = abs(results.kept[run].balance).max()
        rows.append([TITLES[constraint], f"{judge.largest(results, run):.1e}", f"{balance:.1e}"])
    header = [
        f"rescaled, step {plan.rescaled_dt:g}",
        "largest change of K/K(0)",
        "largest error of potential + kinetic energy + heat, in units of K",
    ]
    return markdown_table(header, rows)


def water_table(results):
    """Mean energies of water, with errors, and g(r) against the thermostat's."""
    rows = []
    for method in METHODS:
        mean = judge.energy(results, method)
        unit = KILOJOULES / MOLECULES
        value, error = unit * float(mean.value), unit * float(mean.error)
        kinetic, scatter = (unit * number for number in judge.kinetic(results, method))
        row = [TITLES[method], f"{value:.3f} ± {error:.3f}", f"{kinetic:.4f} ± {scatter:.1g}"]
        if method == THERMOSTAT:
            row += ["", ""]
        else:
            z = float(judge.deviation(mean, judge.energy(results, THERMOSTAT)))
            d = judge.compare_distributions(results, method)
            row += [f"{z:+.1f}", f"{d.largest:.1f} ({d.difference:.2g}), rms {d.rms:.2f}"]
        rows.append(row)
    header = [
        "water",
        "potential energy, kJ/mol, ± standard error",
        "kinetic energy, kJ/mol, ± its fluctuation",
        "energy less the thermostat's, standard errors",
        "g(r) less the thermostat's, largest, standard errors (value)",
    ]
    return markdown_table(header, rows)


# --- the page -----------------------------------------------------------------------------------
def _method(plan):
    """Rules behind the numbers."""
    steps = f"{plan.drift_steps:,}".replace(",", " ")
    ps = plan.water_steps * plan.water_dt / 1000
    return [
        f"- Tied bodies: `examples/isokinetic/in.tethered`, three triangles and a dumbbell, every "
        f"atom on a spring, {plan.values} values, {steps} steps in every run. The drift is the slope "
        "of a least-squares line; for `separate` the change is that of translation or rotation, "
        "whichever is larger.",
        f"- Water: `examples/isokinetic/in.isokinetic`, {MOLECULES} SPC/E molecules with the smooth "
        f"forces of `examples/water`, step {plan.water_dt:g} fs, {len(plan.seeds)} runs of {ps:g} ps "
        f"a method from different velocities, after {plan.block} steps. Total momentum zero; "
        f"K = (g − 1) kT/2 with T = {TEMPERATURE:g} K, and g = 6N − 3, or 3N − 3 and 3N. The thermostat "
        "counts 6N degrees of freedom, so its temperature is set lower by 3/(6N).",
        f"- Standard errors: {plan.blocks} blocks of each run. A deviation counts if Student's t makes "
        f"it sure to {judge.CONFIDENCE:.0%}, over all values that are compared at once (Bonferroni). "
        f"g(r) is compared where it is above {judge.LEAST_DISTRIBUTION:g}.",
    ]


def page_text(out, results, picture=PICTURE):
    """The page; ``out``: folder of the run, ``picture``: where the picture is, from the page."""
    rows = judge.rows(results)
    packages = ("lammps-gearquat", "numpy", "scipy")
    lines = [
        "# Constant kinetic energy",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out, packages)}",
        "",
        f"![Kinetic energy over time, its drift by step, pair distribution of water.]({picture})",
        "",
        verdict(rows),
        "",
        *markdown_table(HEADER, [row.cells for row in rows]),
        "",
        "## The kinetic energy",
        "",
        *drift_tables(results),
        *rescaled_table(results),
        "",
        "## Configurations of water",
        "",
        *water_table(results),
        "",
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
