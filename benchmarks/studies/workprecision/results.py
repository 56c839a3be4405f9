"""Everything that was measured, as rows that are one line of a CSV file each."""

import csv
from dataclasses import dataclass, field, fields
from pathlib import Path

import numpy as np

from .plan import SCENES


@dataclass(frozen=True)
class Row:
    """One run of LAMMPS: what it cost and how far off it was.

    ``evaluations``: of the forces, those of the set-up and of the start (``start``) included;
    errors as in judge.Errors; ``low``, ``seconds``, ``high``: quartiles of ``timings`` wall times of the
    `run` command, NaN if it was not timed.
    """

    scene: str
    method: str
    label: str
    family: str
    values: int
    passes: int
    steps: int
    dt: float
    start: int
    evaluations: int
    position: float
    orientation: float
    energy: float
    drift: float
    norm: float
    tangency: float
    timings: int = 0
    low: float = np.nan
    seconds: float = np.nan
    high: float = np.nan


@dataclass(frozen=True)
class SolverRow:
    """One run of a SciPy solver."""

    scene: str
    solver: str
    tolerance: float
    evaluations: int
    position: float
    orientation: float


@dataclass(frozen=True)
class LimitRow:
    """The largest usable step of a method in a scene; ``steps`` 0 if none was found."""

    scene: str
    method: str
    steps: int
    dt: float


@dataclass(frozen=True)
class OrderRow:
    """Error of the centre of mass with compensated sums, for the order of each N; test case 1."""

    formulation: str
    values: int
    dt: float
    position: float


@dataclass(frozen=True)
class RoundingRow:
    """Error of the centre of mass at a small step, with or without compensated sums."""

    formulation: str
    compensate: str
    dt: float
    position: float


@dataclass(frozen=True)
class ModifyRow:
    """Time inside fixes, LAMMPS' "Modify", seconds a step: quartiles over ``timings`` runs."""

    method: str
    label: str
    timings: int
    low: float
    median: float
    high: float


KINDS = {
    "runs": Row,
    "solvers": SolverRow,
    "limits": LimitRow,
    "orders": OrderRow,
    "rounding": RoundingRow,
    "modify": ModifyRow,
}


@dataclass
class Results:
    """Rows of each kind; ``scenes`` in the order they were run."""

    runs: list = field(default_factory=list)
    solvers: list = field(default_factory=list)
    limits: list = field(default_factory=list)
    orders: list = field(default_factory=list)
    rounding: list = field(default_factory=list)
    modify: list = field(default_factory=list)

    @property
    def scenes(self):
        """Keys of the scenes."""
        return list(dict.fromkeys(row.scene for row in self.runs))

    def methods(self, scene):
        """Key -> label of the methods of a scene, in the order they were run."""
        return {row.method: row.label for row in self.runs if row.scene == scene}

    def curve(self, scene, method):
        """Rows of one method, from large steps to small ones."""
        found = [row for row in self.runs if (row.scene, row.method) == (scene, method)]
        return sorted(found, key=lambda row: row.steps)

    def end(self, scene):
        """Time at which the runs of a scene end."""
        row = next(row for row in self.runs if row.scene == scene)
        return round(row.steps * row.dt, 9)

    def title(self, scene):
        """What a scene is and how long its runs are."""
        known = facts(scene)
        time = f"{self.end(scene):g} {known.time}" if known.time else f"t = {self.end(scene):g}"
        return f"{known.title}, {time}"

    def column(self, scene, method, name):
        """One column of ``curve`` as an array."""
        return np.array([getattr(row, name) for row in self.curve(scene, method)], dtype=float)

    def solver(self, scene, name):
        """Evaluations and errors (the scene's measure) of a SciPy solver, two arrays."""
        found = [row for row in self.solvers if (row.scene, row.solver) == (scene, name)]
        found.sort(key=lambda row: row.evaluations)
        measure = facts(scene).measure
        return np.array([[r.evaluations, getattr(r, measure)] for r in found]).reshape(-1, 2).T

    def largest_step(self, scene, method):
        """The largest usable step; 0 if there is none, inf if it was not looked for."""
        found = [row.dt for row in self.limits if (row.scene, row.method) == (scene, method)]
        return found[0] if found else np.inf

    def errors(self, scene, method):
        """Steps and errors (the scene's measure) of one method, two arrays."""
        return self.column(scene, method, "dt"), self.column(scene, method, facts(scene).measure)

    def write(self, folder):
        """A CSV file for each kind of row, with 17 digits."""
        for name, kind in KINDS.items():
            header = [f.name for f in fields(kind)]
            with open(Path(folder) / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(header)
                for row in getattr(self, name):
                    writer.writerow([_cell(getattr(row, column)) for column in header])


def _cell(value):
    return f"{value:.17g}" if isinstance(value, float) else value


def read_results(folder):
    """Results written by ``Results.write``."""
    results = Results()
    for name, kind in KINDS.items():
        types = {f.name: f.type for f in fields(kind)}
        with open(Path(folder) / f"{name}.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                getattr(results, name).append(kind(**{k: types[k](v) for k, v in row.items()}))
    return results


def facts(scene):
    """The Scene of a key."""
    return SCENES[scene](False)
