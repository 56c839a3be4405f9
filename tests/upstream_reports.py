"""The decks of doc/upstream/reports, which show defects of LAMMPS: of its barostat for rigid bodies, and of lines and
triangles.

``doc/upstream/check`` runs all of them and writes decks and numbers into the reports beside them;
tests/lammps/test_upstream_reports.py asserts that each defect is visible.  A deck is a scene (``water``, ``dumbbells``,
``atoms``) and commands, or commands alone, so that each report contains one script that needs no other file.
"""

from __future__ import annotations

import argparse
import re
import statistics
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.engine.page import markdown_table
from benchmarks.engine.publish import write_block

from running import ROOT, Lammps, make_lmp_wheel
from versions import executable_of, version_of

FOLDER = ROOT / "doc" / "upstream" / "reports"
COMMAND = "doc/upstream/check"
SEEDS = (1, 2, 3)
RESULT = re.compile(r"^result (.*)$", re.MULTILINE)
NUMBER = re.compile(r"[-+]?\d")


def deck(scene: str, task: str) -> str:
    """A script that needs no other file."""
    return "".join((FOLDER / f"{part}.lmp").read_text() for part in (scene, task) if part)


def results(log: str) -> dict[str, list[float]]:
    """Results of a deck, from lines ``result NAME NUMBERS NAME NUMBERS``."""
    found: dict[str, list[float]] = {}
    for line in RESULT.findall(log):
        for word in line.split():
            if NUMBER.match(word):
                found[name].append(float(word))
            else:
                name = word
                found[name] = []
    return found


def run(lmp: Lammps, scene: str, task: str, **variables: object) -> dict[str, list[float]]:
    """Results of a deck, which must run to its end."""
    # `print "result ..."` is echoed as well, but with a command before it
    return results(lmp.succeed(deck(scene, task), variables=variables, timeout=3000).log)


@dataclass
class Report:
    """One report: its deck, the rows that are run, and the columns computed from their output."""

    name: str
    scene: str
    task: str
    columns: tuple[str, ...]
    #: label -> variables of the deck, and under "scene" another scene
    rows: dict[str, dict[str, object]]
    #: printed name -> digits of each of its numbers
    digits: dict[str, str] = field(default_factory=dict)
    seeds: tuple[int, ...] = (1,)

    def cells(self, lmp: Lammps, variables: dict[str, object]) -> list[str]:
        """Mean of the seeds, and its standard error where there are several."""
        words = dict(variables)
        scene = str(words.pop("scene", self.scene))
        found = [run(lmp, scene, self.task, **words, seed=seed) for seed in self.seeds]
        cells = []
        for name, form in self.digits.items():
            for values in zip(*(one[name] for one in found)):
                text = format(statistics.mean(values) + 0.0, form)  # 0, not -0
                if len(values) > 1:
                    error = statistics.stdev(values) / len(values) ** 0.5
                    text += f" ± {format(error, form)}"
                cells.append(text)
        return cells

    def table(self, machines: dict[str, Lammps]) -> str:
        rows = [
            [version, label, *self.cells(lmp, variables)]
            for label, variables in self.rows.items()
            for version, lmp in machines.items()
        ]
        return markdown_table(("LAMMPS", "run", *self.columns), rows)


class Refused(Report):
    """LAMMPS' output."""

    def table(self, machines: dict[str, Lammps]) -> str:
        rows = []
        for task in self.rows:
            for version, lmp in machines.items():
                result = lmp.run(deck(self.scene, task))
                said = result.errors or ["no error"]
                rows.append([version, task, said[0].partition(" (")[0]])
        return markdown_table(("LAMMPS", "script", "what it prints"), rows)


class Virial(Report):
    """One row for each component."""

    def table(self, machines: dict[str, Lammps]) -> str:
        rows = [
            [version, component, *(format(value, ".5f") for value in values)]
            for version, lmp in machines.items()
            for component, values in run(lmp, self.scene, self.task).items()
        ]
        return markdown_table(("LAMMPS", "component", *self.columns), rows)


CONSTANT = {"style": "rigid/nvt/small", "pressure": "reinit yes"}
#: 32 dumbbells, which have five degrees of freedom
DUMBBELLS = {
    **{"scene": "dumbbells", "cells": 2, "freedoms": 5 * 32, "T": 0.5, "k": 1.0},
    **{"dt": 0.004, "begin": 8, "time": 100, "damp": 0.5},
}
REPORTS = [
    Report(
        "targets",
        "dumbbells",
        "targets",
        ("Pxx", "Pyy", "Pzz", "lx", "ly", "lz"),
        {
            "`rigid/npt/small`, targets 0, 0, 3": {"x": 0, "y": 0, "z": 3},
            "`rigid/npt/small`, targets 0.5, 0.5, 1.5": {},
            "`rigid/npt`, targets 0.5, 0.5, 1.5": {"style": "rigid/npt molecule"},
            "atoms, `fix npt`, targets 0.5, 0.5, 1.5": {"scene": "atoms", "style": "npt nreset 1"},
        },
        {"pressures": ".3f", "edges": ".3f"},
    ),
    Report(
        "barostat",
        "water",
        "barostat",
        ("drift, kT per degree of freedom in 10⁶ units of time", "W ⟨ε̇²⟩/kT"),
        {
            "water, `rigid/nvt/small`, 2 fs": CONSTANT,
            "water, iso, 2 fs": {},
            "water, iso, 1 fs": {"dt": 1.0},
            "water, aniso, 2 fs": {"pressure": "aniso 1 1 200"},
            "dumbbells, `rigid/nvt/small`": {**DUMBBELLS, **CONSTANT},
            "dumbbells, iso": {**DUMBBELLS, "pressure": "iso 1 1 0.5"},
            "dumbbells, aniso": {**DUMBBELLS, "pressure": "aniso 1 1 0.5"},
            "dumbbells, aniso, `rigid/npt`": {**DUMBBELLS, "pressure": "aniso 1 1 0.5", "style": "rigid/npt"},
        },
        {"drift": ".3g", "kinetic": ".3f"},
        SEEDS,
    ),
    Report(
        "lengths",
        "dumbbells",
        "lengths",
        ("error of the length within a run", "error after 400 runs of 10 steps"),
        {"`rigid/npt/small`": {}, "`rigid/npt`": {"style": "rigid/npt"}},
        {"within": ".1e", "after": ".1e"},
    ),
    Refused("refused", "dumbbells", "", (), {"negative": {}, "triclinic": {}}),
    Virial("virial", "dumbbells", "virial", ("atomic", "molecular", "finite difference"), {}),
    Report(
        "inertia",
        "",
        "inertia",
        ("energy", "exact energy"),
        {
            "data file, center 0 0": {},
            "data file, center 5 0": {"x": 5},
            "data file, center 5 7": {"x": 5, "y": 7},
            "data file, center 0 0, density 2": {"density": 2},
            "`set tri`": {"from": "set"},
            "`set tri`, mass of density 3": {"from": "set", "density": 3},
        },
        {"energy": ".4f", "exact": ".4f"},
    ),
    Report(
        "triangles",
        "",
        "triangles",
        ("mass", "exact mass", "energy", "exact energy", "angle of body", "angle of shapes", "exact angle"),
        {
            f"{words}, `{style}`": {"atoms": atoms, "style": style}
            for atoms, words in (("tri", "two triangles"), ("line", "two lines"))
            for style in ("rigid", "rigid/small")
        },
        {"mass": ".4f", "energy": ".4f", "angle": ".4f"},
    ),
]


def block(report: Report, machines: dict[str, Lammps]) -> str:
    """Table, and the script, or the scripts where there are several."""
    tasks = [report.task] if report.task else list(report.rows)
    scripts = "\n\n".join(f"```\n{deck(report.scene, task)}```" for task in tasks)
    return f"{report.table(machines)}\n\n{scripts}"


def machines(more: list[Path], folder: Path) -> dict[str, Lammps]:
    """The wheel, the builds of `tests/run build` and `versions`, and others: version -> LAMMPS."""
    wheel = make_lmp_wheel(folder)
    builds = [executable_of("oldest"), executable_of("newest"), *more]
    found = {version_of(wheel.executable): wheel}
    for number, executable in enumerate(path for path in builds if path.exists()):
        own = folder / str(number)
        own.mkdir()
        found.setdefault(version_of(executable), Lammps(f"build{number}", executable, [], own, wheel.environment))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(prog=COMMAND, description="Writes decks and numbers into the reports.")
    names = [report.name for report in REPORTS]
    parser.add_argument("reports", nargs="*", metavar="REPORT", help=f"some of {', '.join(names)}; default all")
    parser.add_argument("--lammps", action="append", type=Path, default=[], help="one more LAMMPS")
    arguments = parser.parse_args()
    if unknown := set(arguments.reports) - set(names):
        parser.error(f"no report {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    with tempfile.TemporaryDirectory() as folder:
        tried = machines(arguments.lammps, Path(folder))
        for report in REPORTS:
            if report.name in (arguments.reports or names):
                print(report.name, file=sys.stderr)
                write_block(FOLDER / f"{report.name}.md", COMMAND, block(report, tried))
    return 0


if __name__ == "__main__":
    sys.exit(main())
