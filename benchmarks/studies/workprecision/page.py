"""doc/accuracy_cost.md and README's block: every number on them comes from Results."""

from pathlib import Path

import numpy as np

from benchmarks.engine.checkout import find, provenance, write_block, write_page
from benchmarks.engine.page import render
from benchmarks.engine.study import Finding, Study, Table
from benchmarks.engine.statistics import order as error_order
from benchmarks.engine.tables import markdown_table
from . import plan, tables
from .evaluate import RULE

COMMAND = "benchmarks/run workprecision --publish"
PAGE, FOLDER = "accuracy_cost.md", "accuracy_cost"
PACKAGES = ("lammps-gearquat", "numpy", "scipy")
#: pictures on the page and what they show
PICTURES = {
    "main.png": "Error of the centre of mass against force evaluations and against wall time, test "
    "case 1. The charges of the cage are reconstructed: the paper does not print them.",
    "top.png": "The free top: errors of orientation and energy, drift, constraints.",
    "orders.png": "The order of every N, and the largest usable steps.",
    "cutoff.png": "500 water molecules with forces that are smooth at the cut-off, and with a plain "
    "cut-off.",
}
#: errors the sentences speak of
SAMPLE, FINE = 1e-6, 1e-8
README_ERRORS = (1e-4, 1e-6, 1e-8)


def _milliseconds(cost):
    return f"{tables.significant(1e3 * cost.value)} ms"


# --- sentences ------------------------------------------------------------------------------------
def price_sentence(results, scene="case1"):
    """What one error costs with the cheapest setting, the default and fix rigid/nve/small."""
    theirs = tables.rigid_price(results, scene, SAMPLE)
    best = tables.cheapest_setting(results, scene, SAMPLE, "seconds")
    default = tables.price(results, scene, plan.DEFAULT.key, SAMPLE, "seconds")
    if not (theirs and best and default):
        return ""
    return (
        f"An error of {tables.power(SAMPLE)} at t = {results.end(scene):g} costs "
        f"{_milliseconds(best[1])} with the cheapest setting ({best[0].label}), "
        f"{_milliseconds(default)} with the defaults and {_milliseconds(theirs)} with "
        "`fix rigid/nve/small`, set-up and start included."
    )


def reach_sentence(results, scene="case1"):
    """How close each comes at any price."""

    def closest(rows):
        row = min(rows, key=lambda row: row.position)
        return f"{row.position:.1e} off, after {tables.grouped(row.steps)} steps"

    rigid = closest(results.curve(scene, plan.RIGID_NVE.key))
    ours = closest(r for r in results.runs if r.scene == scene and r.family != plan.RIGID)
    text = f"The closest run of `fix rigid/nve/small` ends {rigid}; that of `fix gear/quat` {ours}"
    compensated = [row.position for row in results.rounding if row.compensate == "yes"]
    return text + (f", and {min(compensated):.1e} with `compensate yes`." if compensated else ".")


def passes_sentence(results, scene="top"):
    """What a second pass is worth where rotation is fast."""
    prices = []
    for count in plan.PASSES:
        found = tables.cheapest_setting(results, scene, FINE, "evaluations", count)
        if found is None:
            return ""
        prices.append(found[1].value)
    words = "saves" if prices[1] < prices[0] else "costs"
    change = abs(1 - prices[1] / prices[0])
    return (
        f"A second pass (forces frozen) {words} {change:.0%} of the evaluations that an error of "
        f"{tables.power(FINE)} of the free top's orientation takes."
    )


def cutoff_sentence(results):
    """What is left of the order behind a plain cut-off, and who is closer there."""
    methods = plan.DEFAULT.key, plan.RIGID_NVE.key
    slope = {
        (scene, method): error_order(*_ended(results, scene, method))
        for scene in ("water", "water-plain")
        for method in methods
    }
    rows = [{row.steps: row for row in results.curve("water-plain", m)} for m in methods]
    steps = max(set(rows[0]) & set(rows[1]))
    ours, theirs = (found[steps].position for found in rows)
    return (
        "Where a pair style is cut off without being smooth there, forces jump and no method keeps "
        "its order: with a plain cut-off the error in water falls with the power "
        f"{slope['water-plain', methods[0]]:.1f} of the step for the defaults and "
        f"{slope['water-plain', methods[1]]:.1f} for `fix rigid/nve/small` ({ours:.1e} and "
        f"{theirs:.1e} Å after {steps} steps), where with forces smooth at the cut-off the powers "
        f"are {slope['water', methods[0]]:.1f} and {slope['water', methods[1]]:.1f}."
    )


def _ended(results, scene, method):
    """Steps and errors of the runs that did not go astray."""
    steps, errors = results.errors(scene, method)
    return steps[np.isfinite(errors)], errors[np.isfinite(errors)]


def sentences(results):
    """The few sentences of the page, as far as the results allow."""
    scenes = set(results.scenes)
    parts = []
    if "case1" in scenes:
        parts += [price_sentence(results), reach_sentence(results)]
    if "top" in scenes:
        parts.append(passes_sentence(results))
    if {"water", "water-plain"} <= scenes:
        parts.append(cutoff_sentence(results))
    # the fix reports as zero what is rounding
    norm, tangency = (max(largest, 1e-15) for largest in tables.constraints(results))
    parts.append(
        f"Over all usable runs the constraints of the quaternion hold to {norm:.0e} (|q|² = 1) and "
        f"{tangency:.0e} (q·q̇ = 0)."
    )
    return " ".join(part for part in parts if part)


# --- the page -------------------------------------------------------------------------------------
def _section(title, table, note=""):
    return [f"## {title}", "", *([note, ""] if note else []), *markdown_table(*table), ""]


def _picture(name, folder):
    return [f"![{PICTURES[name]}]({folder}/{name})", "", f"*{PICTURES[name]}*", ""]


def _tables(results, picture):
    """Sections below the main picture."""
    lines = []
    if "case1" in results.scenes:
        note = (
            "Wall time of whole runs, `fix rigid/nve/small` over ours, error of the centre of mass "
            "at t = 200."
        )
        lines += _section("Test case 1: speed-up", tables.speedup(results), note)
        note = "The start of the method counted in."
        lines += _section("Force evaluations", tables.evaluations(results), note)
    if len(results.scenes) > ("case1" in results.scenes):
        note = (
            "Speed-up over `fix rigid/nve/small`; errors are root mean squares over the bodies. The "
            "runs of water are short, so the start of the method is a large part of their cost."
        )
        lines += _section("Other scenes", tables.other_speedups(results), note)
        lines += picture("top.png") + picture("cutoff.png")
    if results.orders:
        note = (
            "Slopes with compensated sums. ω Δt: limit of the linear test equation. Largest usable "
            "step: in test case 1, by bisection; there the energy stays within a tenth of the kinetic."
        )
        lines += _section("Order and stability", tables.orders(results), note)
        lines += picture("orders.png")
    if results.rounding:
        lines += _section("Rounding, t = 200", tables.rounding(results))
    if results.modify:
        note = 'LAMMPS\' "Modify" (`timer normal`), test case 1.'
        lines += _section("Time inside the fix", tables.modify(results), note)
    return lines


def _drift(drift, folder):
    """The fragment that `benchmarks/run drift` left, its picture found beside ours."""
    text = (Path(drift) / "drift.md").read_text(encoding="utf-8")
    return [text.replace("(drift.png)", f"({folder}/drift.png)").strip(), ""]


def page_text(out, results, drift=None, folder="figures"):
    """The page; ``out``: folder of the run, ``folder``: where its pictures are, from the page."""
    here = {path.name for path in (Path(out) / "figures").glob("*.png")}

    def picture(name):
        return _picture(name, folder) if name in here else []

    lines = [
        "# What accuracy costs",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out, PACKAGES)}",
        "",
        *picture("main.png"),
        sentences(results),
        "",
        *_tables(results, picture),
        *(_drift(drift, folder) if drift else []),
        "## How it was measured",
        "",
        *_method(results),
    ]
    return "\n".join(lines) + "\n"


def _method(results):
    """Rules behind the numbers."""
    counts = [row.timings for row in results.runs if row.timings]
    return [
        "- One process, one core; for every timing LAMMPS is made anew, the scene is read, and the `run`",
        "  command alone is timed: set-up, start and steps. Output at start and end only.",
        f"- Medians of at least {min(counts)} timings, competitors in turn; short runs in more rounds until",
        "  the median is steady. Every timed run repeats the run that was judged to the bit.",
        "- Errors against extended precision (cage), elliptic functions (top), extrapolation with",
        "  LAMMPS' forces (water), a run with a far smaller step (plain cut-off).",
        "- Costs are interpolated log-log between the dearest run that misses an error and the next;",
        "  extrapolated costs are labelled.",
        f"- {RULE[0].upper() + RULE[1:]}.",
        "- Decks: `examples/case1`, `top`, `water`. Every run is `lmp -in DECK -var ...`.",
    ]


def write(out, results, drift=None):
    """The page in the folder of the run, and the tables as CSV beside it."""
    (Path(out) / PAGE).write_text(page_text(out, results, drift), encoding="utf-8")


def readme_table(results):
    """Time of fix rigid/nve/small relative to ours, by error: the default settings and the cheapest ones."""
    rows = {row[0]: row for row in tables.speedup(results)[1]}
    errors = [tables.power(target) for target in README_ERRORS]
    header = ["time of `fix rigid/nve/small` relative to", *(f"error {error}" for error in errors)]
    return Table(
        header,
        [
            ["`fix gear/quat`, default settings", *(rows[error][5] for error in errors)],
            ["`fix gear/quat`, cheapest settings", *(rows[error][2] for error in errors)],
        ],
    )


def readme_block(out, results):
    """What README shows between its markers."""
    context = {"end": f"{results.end('case1'):g}"}
    finding = Finding(tables={"readme": readme_table(results)}, context=context)
    study = Study("workprecision", "", FOLDER, 0.0, None, None)
    return render("accuracy_cost.readme.md.j2", study, finding, provenance(out, PACKAGES)).rstrip()


def publish(folder, out, results, drift=None):
    """Write page, pictures and README's block into a checkout."""
    folder, out = find(folder, COMMAND), Path(out)
    pictures = [out / "figures" / name for name in PICTURES]
    if drift:
        pictures.append(Path(drift) / "drift.png")
    write_page(folder, FOLDER, page_text(out, results, drift, FOLDER), pictures)
    write_block(folder / "README.md", COMMAND, readme_block(out, results))
