"""The paper's three test cases: the runs and their results.

Source: R. M. Pratt and K. M. Bin Mohamad Zaini, "General Algorithms for 3-D Motion of a Non-Planar
Body in a Steady-State Force Field".  Every run is sampled once per unit of time.
"""

import itertools
from dataclasses import dataclass

from benchmarks.engine import Job, deck, series

#: those of the paper
FORMULATIONS = ("first", "second")


@dataclass(frozen=True)
class Row:
    """One interpretation of the paper, a row of Table 7: a body, a start and a projection."""

    key: str
    body: str
    label: str
    variables: dict


PAPER, PROJECTED = {"keywords": "preset paper"}, {"keywords": "preset paper project yes"}
ROWS = {
    key: Row(key, body, f"{body} body, {label}", {"body": body} | choices)
    for key, body, label, choices in (
        ("consistent-zero-free", "consistent", "zero start, not projected", PAPER),
        ("unrotated-zero-free", "unrotated", "zero start, not projected", PAPER),
        ("unrotated-zero-projected", "unrotated", "zero start, projected", PROJECTED),
        ("consistent-accurate", "consistent", "accurate start, projected", {}),
    )
}
#: rows with the paper's choices, and the row with the default choices of the fix
AS_PRINTED, ACCURATE = ("consistent-zero-free", "unrotated-zero-free"), "consistent-accurate"

STEP = {1: 0.001, 2: 0.125, 3: 0.005}  # of Table 7
QUICK_STEP = {1: 0.005, 2: 0.125, 3: 0.025}
END = 5000.0

#: case: (fraction of the step of Table 7, end) of the runs that test the effect of the step
OTHER_STEP = {1: (1 / 2, 1500.0), 3: (1 / 5, 1500.0)}

#: short runs with an accurate start at this step, for the choice of omega in Eq. 5
OMEGA_STEP, OMEGA_END = 0.05, 200.0

#: error against step (accuracy.py): short runs of case 1, while its trajectory is known
ACCURACY_STEPS, ACCURACY_END = (0.1, 0.05, 0.02, 0.01), 200.0
#: energy against step: long runs of case 1 at steps that are too large for it
COARSE_STEPS = (0.25, 1.0)


def name_of(case, row, formulation, dt, omega=""):
    """Name of a run and its files."""
    name = f"case{case}_{row}_{formulation}_dt{dt:g}"
    return f"{name}_omega-{omega}" if omega else name


@dataclass(frozen=True)
class Run:
    """One run: a case, a row, a formulation ("rigid": fix rigid/nve/small), a step, its end."""

    case: int
    row: str
    formulation: str
    dt: float
    end: float = END
    omega: str = ""

    @property
    def name(self):
        """Name of its files."""
        return name_of(self.case, self.row, self.formulation, self.dt, self.omega)

    @property
    def job(self):
        """The Job for the Lab."""
        steps = round(self.end / self.dt)
        variables = {"formulation": self.formulation, "dt": f"{self.dt:.17g}"}
        variables |= {"steps": steps, "every": round(1.0 / self.dt)} | ROWS[self.row].variables
        if self.omega:
            # one pass as in the paper: a second pass would use the corrected omega in any case
            variables["keywords"] = f"omega {self.omega} values 5 passes 1"
        return Job(deck(f"case{self.case}"), variables, steps)


def planned_runs(step):
    """All runs for the tables and the figures; ``step``: case -> its step."""
    others, runs = [(ACCURATE, "momentum"), (ACCURATE, "rigid")], []
    every = [*itertools.product(ROWS, FORMULATIONS), *others]
    both = list(itertools.product(AS_PRINTED, FORMULATIONS))
    for case, dt in step.items():
        runs += [Run(case, *method, dt) for method in every]
    for case, (part, end) in OTHER_STEP.items():
        runs += [Run(case, *method, step[case] * part, end) for method in both]
    for omega in ("corrected", "predicted"):
        runs.append(Run(1, ACCURATE, "first", OMEGA_STEP, OMEGA_END, omega))
    compared = [*itertools.product((AS_PRINTED[0], ACCURATE), FORMULATIONS), *others]
    for dt in (*ACCURACY_STEPS, *COARSE_STEPS):
        end = END if dt in COARSE_STEPS else ACCURACY_END
        runs += [Run(1, *method, dt, end) for method in compared]
    return runs


@dataclass(frozen=True)
class Results:
    """Finished runs: ``step`` of each case, and the Series of every run by name_of."""

    step: dict
    series: dict

    def get(self, case, row, formulation, dt=None, omega=""):
        """Series of a run; ``dt`` is the step of the case unless given."""
        return self.series[name_of(case, row, formulation, dt or self.step[case], omega)]

    def other_step(self, case):
        """The step of the case's runs that test the effect of the step."""
        return self.step[case] * OTHER_STEP[case][0]


def measure(lab):
    """Run everything and return Results."""
    step = QUICK_STEP if lab.quick else STEP
    found = lab.many({run.name: run.job for run in planned_runs(step)})
    return Results(step, {name: series.of_log(run.log) for name, run in found.items()})
