"""The paper's three test cases: what is run, and where each result is found again.

Source: R. M. Pratt and K. M. Bin Mohamad Zaini, "General Algorithms for 3-D Motion of a Non-Planar
Body in a Steady-State Force Field".  The decks are those under ``examples``; every run is sampled
once per unit of time.
"""

from dataclasses import dataclass
from pathlib import Path

from benchmarks.engine import decks, series
from benchmarks.engine.lammps_runner import Job, run_many

FORMULATIONS = ("first", "second")


@dataclass(frozen=True)
class Row:
    """One way to read the paper: a body, a start and what is projected."""

    key: str
    label: str
    variables: dict
    as_printed: bool  # the paper's own choices throughout


ROWS = {
    row.key: row
    for row in (
        Row(
            "consistent-zero-free",
            "consistent body, zero start, not projected (as the paper ran)",
            {"body": "consistent", "choices": "paper"},
            True,
        ),
        Row(
            "unrotated-zero-free",
            "unrotated body, zero start, not projected (as the paper ran)",
            {"body": "unrotated", "choices": "paper"},
            True,
        ),
        Row(
            "unrotated-zero-projected",
            "unrotated body, zero start, projected",
            {"body": "unrotated", "choices": "paper", "project": "yes"},
            False,
        ),
        Row(
            "consistent-accurate",
            "consistent body, accurate start, projected (defaults of the fix)",
            {"body": "consistent"},
            False,
        ),
    )
}
AS_PRINTED = tuple(row.key for row in ROWS.values() if row.as_printed)
ACCURATE = "consistent-accurate"

STEP = {1: 0.001, 2: 0.125, 3: 0.005}  # the step of Table 7
END = {1: 5000.0, 2: 5000.0, 3: 5000.0}
FINE_STEP, FULL_END = 0.0001, 5000.0  # --full: the 50 million steps of Figs. 2 to 4

#: case: (other step, end) of the runs that ask whether the step matters
OTHER_STEP = {1: (0.0005, 1500.0), 3: (0.001, 1500.0)}

#: which omega feeds Eq. 5: short runs with an accurate start at this step
OMEGA_STEP, OMEGA_END = 0.05, 200.0

#: error against step (accuracy.py): short runs of case 1, to where its trajectory is known
ACCURACY_STEPS, ACCURACY_END = (0.1, 0.05, 0.02, 0.01), 200.0
#: energy against step: long runs of case 1 at steps that are too large for it
COARSE_STEPS = (0.25, 1.0)


@dataclass(frozen=True)
class Run:
    """One run: a case, a way to read it, a formulation (or the yardstick "rigid"), a step."""

    case: int
    row: str
    formulation: str
    dt: float
    end: float
    omega: str = ""

    @property
    def name(self):
        """Name of its files."""
        parts = [f"case{self.case}", self.row, self.formulation, f"dt{self.dt:g}"]
        return "_".join(parts + ([f"omega-{self.omega}"] if self.omega else []))

    @property
    def steps(self):
        """Number of time steps."""
        return round(self.end / self.dt)

    def job(self, folder):
        """The job that runs it and leaves its log in ``folder``."""
        variables = dict(ROWS[self.row].variables)
        variables |= {"formulation": self.formulation, "dt": f"{self.dt:.17g}"}
        variables |= {"steps": self.steps, "every": round(1.0 / self.dt)}
        if self.omega:
            # as the paper corrects: a second pass would use the corrected one in any case
            variables |= {"omega": self.omega, "values": 5, "passes": 1}
        log = Path(folder) / f"log.{self.name}"
        return Job(decks.deck_of_case(self.case), log, variables, self.steps)


def planned_runs(full=False):
    """All runs behind the table and the figures, as a list of Run."""
    runs = []
    for case, dt in STEP.items():
        for row in ROWS:
            runs += [Run(case, row, formulation, dt, END[case]) for formulation in FORMULATIONS]
        runs.append(Run(case, ACCURATE, "rigid", dt, END[case]))
    for case, (dt, end) in OTHER_STEP.items():
        for row in AS_PRINTED:
            runs += [Run(case, row, formulation, dt, end) for formulation in FORMULATIONS]
    runs += [
        Run(1, ACCURATE, "first", OMEGA_STEP, OMEGA_END, omega)
        for omega in ("corrected", "predicted")
    ]
    measured = [(dt, ACCURACY_END) for dt in ACCURACY_STEPS] + [(dt, END[1]) for dt in COARSE_STEPS]
    for dt, end in measured:
        for formulation in FORMULATIONS:
            runs += [Run(1, row, formulation, dt, end) for row in (AS_PRINTED[0], ACCURATE)]
        runs.append(Run(1, ACCURATE, "rigid", dt, end))
    if full:
        for row in AS_PRINTED:
            runs += [Run(1, row, formulation, FINE_STEP, FULL_END) for formulation in FORMULATIONS]
    return runs


class Results:
    """Series of finished runs, found by what was run."""

    def __init__(self):
        self.runs = {}
        self.seconds = {}

    def add(self, run, values, seconds=float("nan")):
        """Keep the series of a run and how long LAMMPS' loop took."""
        self.runs[run] = values
        self.seconds[run] = seconds

    def _find(self, case, row, formulation, dt, omega):
        dt = STEP[case] if dt is None else dt
        for run in self.runs:
            found = (run.case, run.row, run.formulation, run.dt, run.omega)
            if found == (case, row, formulation, dt, omega):
                return run
        raise KeyError(f"no run of case {case}, {row}, {formulation}, step {dt:g} {omega}")

    def get(self, case, row, formulation, dt=None, omega=""):
        """Series of a run; ``dt`` is the step of Table 7 unless given."""
        return self.runs[self._find(case, row, formulation, dt, omega)]

    def seconds_per_step(self, case, row, formulation):
        """Time of LAMMPS' loop over the steps of a run at the step of Table 7."""
        run = self._find(case, row, formulation, None, "")
        return self.seconds[run] / run.steps

    def has_full(self):
        """Whether the 50 million steps of 0.0001 were run."""
        return any(run.dt == FINE_STEP for run in self.runs)


def run_cases(folder, full=False, lmp=None, workers=2, progress=None):
    """Run everything; leave logs and series (CSV) in ``folder`` and return the Results.

    ``progress`` is an object with ``total`` and ``update(steps)``, such as a tqdm bar, or None.
    """
    folder = Path(folder)
    runs = planned_runs(full)
    jobs = [run.job(folder / "logs") for run in runs]
    if progress is not None:
        progress.reset(total=sum(job.steps for job in jobs))
    run_many(jobs, lmp, workers, progress.update if progress is not None else None)
    return read_results(folder, runs)


def read_results(folder, runs):
    """Results of runs whose logs are in ``folder``; leaves their series as CSV."""
    folder = Path(folder)
    results = Results()
    (folder / "series").mkdir(parents=True, exist_ok=True)
    for run in runs:
        log = run.job(folder / "logs").log
        values = series.read_log(log)
        series.write_csv(folder / "series" / f"{run.name}.csv", values)
        results.add(run, values, series.loop_seconds(log))
    return results
