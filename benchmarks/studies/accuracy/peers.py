"""The methods that the fix is compared with, counted in evaluations of the forces.

These are SciPy's solvers, splittings with exact free rotation, fix rigid/nve/small, and compositions of its steps.
LAMMPS runs the compositions itself: a step may be negative, and ``run 1 pre no`` continues the last run.
The composition of order 4 is from M. Suzuki, Phys. Lett. A 146, 319 (1990).
"""

from functools import partial

import numpy as np

from benchmarks.engine.session import RunError
from benchmarks.engine.sites import pose_errors
from benchmarks.reference import solvers, splittings
from benchmarks.reference.splittings import KAHAN_LI, SPLITTINGS, symmetric

from . import plan

SUZUKI = 1 / (4 - 4 ** (1 / 3))
#: name -> parts of a step, each a step of fix rigid/nve/small
COMPOSITIONS = {
    f"{plan.RIGID_NVE.label} composed, order 4": symmetric(SUZUKI, SUZUKI, even=False),
    f"{plan.RIGID_NVE.label} composed, order 8": KAHAN_LI,
}
NAMES = (*solvers.METHODS, *(own.label for own in SPLITTINGS), *COMPOSITIONS)


def _composed(session, scene, reference, parts, numbers):
    """WorkPoints of a composition, one for each of the ``numbers`` of steps with which LAMMPS reaches the end."""
    points = []
    for steps in numbers:
        variables = plan.Run(scene, plan.RIGID_NVE, steps).variables(False)
        evaluations = 1 + steps * len(parts)
        try:
            found = session.run(scene.deck, variables, "composed", 1e-3 * evaluations, parts)
        except RunError:
            continue
        places = found.before, found.after, reference.positions(found)
        errors = pose_errors(found.masses, found.molecules, *places)
        points.append(solvers.WorkPoint(steps, evaluations, solvers.Errors(*np.reshape(errors, (2, 1)), np.nan)))
    return points


def _jobs(session, scene, reference):
    """(name, tolerances or numbers of steps, function from a list of these to WorkPoints)."""
    task = reference.problem, scene.end, reference.state
    for name in solvers.METHODS:
        for tolerance in scene.tolerances:
            yield name, tolerance, partial(solvers.work_precision, *task, name)
    for evaluations in scene.evaluations:
        for own in SPLITTINGS:
            work = partial(splittings.work_precision, *task, own)
            yield own.label, round(evaluations / own.stages), work
        for name, parts in COMPOSITIONS.items():
            work = partial(_composed, session, scene, reference, parts)
            yield name, round(evaluations / len(parts)), work


def measure(lab, session, scene, reference):
    """Name -> list of (tolerance or number of steps, evaluations, error of position, of orientation)."""
    jobs, found = list(_jobs(session, scene, reference)), {}
    for name, setting, work in jobs:
        for point in work([setting]):
            errors = point.errors.rms_center, point.errors.rms_angle
            found.setdefault(name, []).append((setting, point.evaluations, *errors))
        lab.advance(1 / len(jobs))
    return found
