"""Demands of the hard cases as CSV, and the page doc/hard_cases.md: every number from Findings."""

import shutil
from pathlib import Path

from benchmarks.engine import tables
from benchmarks.engine.checkout import find, provenance
from benchmarks.engine.tables import markdown_table, verdict, write_csv

COMMAND = "benchmarks/run hard --publish"
PAGE = "hard_cases.md"
HEADER = ("case", *tables.HEADER)


def table(findings):
    """Rows below HEADER; ``findings``: Case -> Finding."""
    return [(case.title, *row.cells) for case, finding in findings.items() for row in finding.rows]


def sentence(findings):
    """How many demands are met."""
    return verdict([row for finding in findings.values() for row in finding.rows])


def picture_of(case):
    """Where the picture of a case is in a checkout, from the page."""
    return f"../examples/hard/{case.key}/{case.key}.png"


def page_text(out, findings, picture=picture_of):
    """The page; ``out``: folder of the run, ``picture``: Case -> its picture, from the page."""
    shown = [(f"[{row[0]}](#{case.key})", *row[1:]) for row, case in _with_cases(findings)]
    lines = [
        "# Hard cases",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out)}",
        "",
        f"{sentence(findings)} Each scene is under `examples/hard`; `benchmarks/run hard` runs all of them, "
        "`benchmarks/run hard --only KEY` one.",
        "",
        *markdown_table(HEADER, shown),
    ]
    for case, finding in findings.items():
        lines += ["", f'<a id="{case.key}"></a>', "", f"## {case.title}", ""]
        lines += [f"`examples/hard/{case.key}`. {case.why} {finding.text}", ""]
        lines += [f"![{case.title}]({picture(case)})"]
    return "\n".join(lines) + "\n"


def _with_cases(findings):
    cases = [case for case, finding in findings.items() for _ in finding.rows]
    return zip(table(findings), cases)


def write(out, findings):
    """hard.csv and the page, in the folder of the run; pictures are in its ``figures``."""
    write_csv(Path(out) / "hard.csv", HEADER, table(findings))
    text = page_text(out, findings, lambda case: f"figures/{case.key}.png")
    (Path(out) / PAGE).write_text(text, encoding="utf-8")


def publish(folder, out, findings):
    """Put page and pictures into the checkout ``folder``."""
    folder = find(folder)
    for case in findings:
        name = f"{case.key}.png"
        target = folder / "examples" / "hard" / case.key / name
        shutil.copyfile(Path(out) / "figures" / name, target)
    (folder / "doc" / PAGE).write_text(page_text(out, findings), encoding="utf-8")


def console_text(findings):
    """The table for a terminal: one line a demand."""
    lines = []
    for case, finding in findings.items():
        lines.append(f"{case.title} ({case.key})")
        for row in finding.rows:
            word = "met   " if row.met else "MISSED"
            lines.append(f"  {word} {row.what}: {row.measured}; asked: {row.asked}")
    return "\n".join([*lines, "", sentence(findings)])
