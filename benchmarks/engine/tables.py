"""Tables of results: as Markdown, as CSV, and tables of demands with their verdicts."""

import csv
from dataclasses import dataclass


def _markdown_row(cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def markdown_table(header, rows):
    """Lines of a table in Markdown."""
    lines = [_markdown_row(header), "|" + "---|" * len(header)]
    return lines + [_markdown_row(row) for row in rows]


def write_csv(path, header, rows):
    """The same as a file."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([header, *rows])


# --- demands --------------------------------------------------------------------------------------
HEADER = ("what", "asked", "measured", "verdict")


@dataclass(frozen=True)
class Row:
    """One demand: what it is about, what is asked, what was measured, and whether that is met."""

    what: str
    asked: str
    measured: str
    met: bool

    @property
    def verdict(self):
        """In words."""
        return "met" if self.met else "not met"

    @property
    def cells(self):
        """Below HEADER."""
        return (self.what, self.asked, self.measured, self.verdict)


def verdict(rows):
    """One sentence: how many demands are met."""
    missed = sum(not row.met for row in rows)
    if not missed:
        return f"All {len(rows)} demands are met."
    return f"Of {len(rows)} demands {len(rows) - missed} are met, {missed} not."
