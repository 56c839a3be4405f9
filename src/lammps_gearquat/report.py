"""Write and print the tables: claims with their verdicts, and Table 7 by threshold."""

import csv
import textwrap

from . import divergence as dv
from .cases import ACCURATE, ROWS, STEP
from .claims import THRESHOLDS, all_claims, parting_times, show_time

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


def _markdown_row(cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def _markdown_table(header, rows):
    lines = [_markdown_row(header), "|" + "---|" * len(header)]
    return lines + [_markdown_row(row) for row in rows]


def table7_markdown(lines):
    """Table 7 by threshold as Markdown lines, cases side by side."""
    labels = list(dict.fromkeys(label for label, *_ in lines))
    by = {(label, case): " / ".join(map(show_time, times)) for label, case, _, times in lines}
    header = ["apart by " + " / ".join(f"{t:g}" for t in THRESHOLDS)]
    header += [f"case {case}, step {dt:g}" for case, dt in STEP.items()]
    rows = [["paper (no threshold given)", *(PAPER_TIMES[case] for case in STEP)]]
    rows += [[label, *(by[label, case] for case in STEP)] for label in labels]
    return _markdown_table(header, rows)


def write_tables(folder, results):
    """Leave ``table.md``, ``table.csv`` and ``table7.csv`` in ``folder``; return the claims."""
    claims, times = all_claims(results), table7(results)
    header = ("where", "the paper", "measured", "rule", "verdict", "why")
    rows = [(c.source, c.paper, c.measured, c.rule, c.verdict, c.why) for c in claims]
    with open(folder / "table.csv", "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])
    with open(folder / "table7.csv", "w", newline="", encoding="utf-8") as file:
        names = [f"apart by {threshold:g}" for threshold in THRESHOLDS]
        table = [(label, case, dt, *found) for label, case, dt, found in times]
        csv.writer(file).writerows([("row", "case", "step", *names), *table])
    text = ["# The paper's claims and what was measured", "", NOTE, ""]
    text += _markdown_table(header, rows)
    text += ["", "## Table 7: time at which the two formulations part", ""]
    text += table7_markdown(times)
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
