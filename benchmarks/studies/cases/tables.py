"""Write and print the tables: claims with their verdicts, Table 7 by threshold, accuracy."""

import textwrap

from benchmarks.engine import divergence as dv
from benchmarks.engine.tables import markdown_table, write_csv
from . import accuracy
from .claims import THRESHOLDS, all_claims, parting_times, show_time
from .runs import ACCURACY_END, ACCURACY_STEPS, ACCURATE, ROWS, STEP

PAPER_TIMES = {1: "1300", 2: "250-300", 3: "800"}
NOTE = (
    "The charges of the cage are reconstructed: they fit both printed energies. The paper does not "
    "say which body it ran (consistent: a real rigid body; unrotated: principal moments along the "
    "unrotated axes): both are shown. Every verdict follows from the numbers by the rule beside it."
)


def table7(results):
    """Times at which the formulations part: list of (row label, case, step, three times).

    The last row is the yardstick: when fix rigid/nve/small parts from the second formulation with
    the defaults of the fix.
    """
    lines = []
    for key, row in ROWS.items():
        for case, dt in STEP.items():
            lines.append((row.label, case, dt, parting_times(results, case, key)))
    for case, dt in STEP.items():
        pair = [results.get(case, ACCURATE, name) for name in ("rigid", "second")]
        times = tuple(dv.parting_time(*pair, threshold) for threshold in THRESHOLDS)
        lines.append(("fix rigid/nve/small against the second formulation", case, dt, times))
    return lines


def table7_markdown(lines):
    """Table 7 by threshold as Markdown lines, cases side by side."""
    labels = list(dict.fromkeys(label for label, *_ in lines))
    by = {(label, case): " / ".join(map(show_time, times)) for label, case, _, times in lines}
    header = ["apart by " + " / ".join(f"{t:g}" for t in THRESHOLDS)]
    header += [f"case {case}, step {dt:g}" for case, dt in STEP.items()]
    rows = [["paper (no threshold given)", *(PAPER_TIMES[case] for case in STEP)]]
    rows += [[label, *(by[label, case] for case in STEP)] for label in labels]
    return markdown_table(header, rows)


def accuracy_rows(results):
    """Header and rows of errors and costs, one row a method."""
    header = ["method"]
    header += [f"position, t = {ACCURACY_END:g}, step {step:g}" for step in ACCURACY_STEPS]
    header += [f"energy, t = 5000, step {step:g}" for step in accuracy.ENERGY_STEPS]
    header += ["microseconds a step"]
    position, energy = accuracy.position_errors(results), accuracy.energy_errors(results)
    cost = accuracy.step_costs(results)
    return header, [
        (label, *position[label], *energy[label], cost[label]) for label in accuracy.METHODS
    ]


def accuracy_markdown(results):
    """The same as Markdown lines: one table for positions, one for energies and cost."""
    _, rows = accuracy_rows(results)
    n = len(ACCURACY_STEPS)
    shown = [(row[0], *(f"{value:.1e}" for value in row[1:-1]), f"{row[-1]:.2f}") for row in rows]
    header = [f"error of the centre of mass at t = {ACCURACY_END:g}"]
    header += [f"step {step:g}" for step in ACCURACY_STEPS]
    lines = markdown_table(header, [row[: n + 1] for row in shown])
    header = ["largest error of the total energy to t = 5000"]
    header += [f"step {step:g}" for step in accuracy.ENERGY_STEPS] + ["µs a step"]
    return lines + [""] + markdown_table(header, [(row[0], *row[n + 1 :]) for row in shown])


CLAIM_HEADER = ("where", "the paper", "measured", "rule", "verdict", "why")


def claim_rows(claims):
    """The claims as rows below CLAIM_HEADER."""
    return [(c.source, c.paper, c.measured, c.rule, c.verdict, c.why) for c in claims]


def tables_markdown(claims, results):
    """Claims, Table 7 and accuracy as Markdown lines, headings of the second level."""
    text = [NOTE, "", *markdown_table(CLAIM_HEADER, claim_rows(claims))]
    text += ["", "## Table 7: time at which the two formulations part", ""]
    text += table7_markdown(table7(results))
    text += ["", "## What accuracy costs", "", accuracy.__doc__.partition("\n\n")[2].strip(), ""]
    return text + accuracy_markdown(results)


def write_tables(folder, results):
    """Leave ``table.md`` and the same as CSV in ``folder``; return the claims.

    The CSV files are ``table.csv`` (claims), ``table7.csv`` and ``accuracy.csv``.
    """
    claims = all_claims(results)
    write_csv(folder / "table.csv", CLAIM_HEADER, claim_rows(claims))
    names = [f"apart by {threshold:g}" for threshold in THRESHOLDS]
    times = [(label, case, dt, *found) for label, case, dt, found in table7(results)]
    write_csv(folder / "table7.csv", ("row", "case", "step", *names), times)
    write_csv(folder / "accuracy.csv", *accuracy_rows(results))
    text = ["# The paper's claims and what was measured", "", *tables_markdown(claims, results)]
    (folder / "table.md").write_text("\n".join(text) + "\n", encoding="utf-8")
    return claims


def console_text(claims, results, width=100):
    """The same for a terminal: one short block for each claim, then Table 7."""
    lines = [*textwrap.wrap(NOTE, width), ""]
    for claim in claims:
        lines += textwrap.wrap(f"{claim.verdict.upper()}: {claim.paper} ({claim.source})", width)
        indent = {"initial_indent": "    ", "subsequent_indent": "    "}
        lines += textwrap.wrap(claim.measured, width, **indent)
        if claim.why:
            lines += textwrap.wrap(claim.why, width, **indent)
    lines += ["", "Time at which the two formulations part (apart by 0.1 / 1 / 3):"]
    for label, case, dt, times in table7(results):
        shown = " / ".join(map(show_time, times))
        lines.append(f"  case {case} (paper: {PAPER_TIMES[case]:>7})  {shown:>20}  {label}")
    return "\n".join(lines)
