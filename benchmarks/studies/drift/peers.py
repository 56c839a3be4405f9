"""The largest energy error in test case 1 at equal numbers of force evaluations.

Splittings with exact free rotation and SciPy's solvers are compared with the fix and LAMMPS' own fixes.  A step of
the fix has one evaluation, a step of a splitting one per stage.  The error of a solver is interpolated between two
tolerances.  Close encounters with bare charges determine the errors.
"""

import multiprocessing
from functools import partial

import numpy as np

from benchmarks.engine import Job, Measurement, Table, deck
from benchmarks.engine.methods import DEFAULTS, rigid
from benchmarks.reference import paper_problem, solvers, splittings

#: end of the runs, and time per evaluation
END, QUICK_END, SPACINGS = 5000.0, 50.0, (0.25, 0.125, 0.0625, 0.03125)
TOLERANCES = tuple(10.0**-k for k in range(4, 13))
METHODS = (
    *DEFAULTS.values(),
    rigid("rigid/nve/small", "rigid"),
    rigid("rigid/small", "rigid_verlet"),
)


# --- measuring ------------------------------------------------------------------------------------
def _of_splitting(number, spacing, end):
    """(time per evaluation, largest error of the energy)."""
    own = splittings.SPLITTINGS[number]
    steps = round(end / spacing / own.stages)
    evaluations, error = splittings.largest_energy_error(paper_problem(1), end, own, steps)
    return end / evaluations, error


def _of_solver(name, tolerance, end):
    """(time per evaluation, largest error of the energy)."""
    evaluations, error = solvers.largest_energy_error(paper_problem(1), end, name, tolerance)
    return end / evaluations, error


def _others(lab, end):
    """Label -> list of (time per evaluation, error) of splittings and solvers; ``lab.jobs`` at once."""
    tasks = [
        (own.label, partial(_of_splitting, number, spacing, end))
        for number, own in enumerate(splittings.SPLITTINGS)
        for spacing in SPACINGS
    ]
    tasks += [(m, partial(_of_solver, m, t, end)) for m in solvers.METHODS for t in TOLERANCES]
    found = {}
    with multiprocessing.get_context("spawn").Pool(lab.jobs) as pool:
        waiting = [(label, pool.apply_async(task)) for label, task in tasks]
        for label, result in waiting:
            found.setdefault(label, []).append(result.get())
            lab.advance(1 / len(tasks))
    return found


def measure(lab, read, may_fail):
    """Label -> list of (time per evaluation, largest error of the energy).

    ``read(finished, steps, interval)`` returns the Run of a log, ``may_fail`` is true for a lost run.
    """
    end, jobs, keys = QUICK_END if lab.quick else END, {}, {}
    for method in METHODS:
        for spacing in SPACINGS:
            steps, every = round(end / spacing), round(1 / spacing)
            variables = method.variables | {"dt": f"{spacing:.17g}", "steps": steps, "every": every}
            name = f"case1_{method.key}_dt{spacing:g}"
            jobs[name], keys[name] = Job(deck("case1"), variables, steps), (method.label, spacing)
    found = {}
    with lab.share(0.2):
        for name, run in lab.many(jobs, may_fail=may_fail).items():
            label, spacing = keys[name]
            largest = read(run, jobs[name].steps, 1.0).largest
            found.setdefault(label, []).append((spacing, largest))
    with lab.share(0.8):
        return found | _others(lab, end)


# --- judging --------------------------------------------------------------------------------------
def error_at(rows, spacing):
    """Error at a time per evaluation, interpolated log-log between runs; NaN outside of them, infinite if lost."""
    x, y = np.transpose(sorted(rows))
    if not 0.99 * x[0] <= spacing <= 1.01 * x[-1]:
        return np.nan
    with np.errstate(invalid="ignore"):
        found = np.exp(np.interp(np.log(spacing), np.log(x), np.log(np.maximum(y, 1e-300))))
    return float(found) if np.isfinite(found) else np.inf


def find(rows):
    """Table of errors against time per evaluation, and its measurements."""
    table, found = [], []
    for label, own in rows.items():
        errors = [error_at(own, spacing) for spacing in SPACINGS]
        cells = ["–" if np.isnan(e) else "lost" if np.isinf(e) else f"{e:.1e}" for e in errors]
        table.append([label, *cells])
        for spacing, error in zip(SPACINGS, errors):
            what = f"test case 1, {label}, {spacing:g} per evaluation: largest error of the energy"
            if not np.isnan(error):
                found.append(Measurement(what, error))
    header = ("largest error of the energy", *(f"{s:g} per evaluation" for s in SPACINGS))
    return Table(header, table), found
