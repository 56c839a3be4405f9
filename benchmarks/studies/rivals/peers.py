"""The methods that the fix is compared with, counted in evaluations of the forces.

These are solvers that control their steps, splittings with exact free rotation, and a symmetric multistep method.  A
method that controls its steps runs with several weights of the kinds of variables, and the best ones count.
"""

import warnings
from functools import partial

import numpy as np
from tqdm import tqdm

from benchmarks.engine.methods import AUTOMATIC
from benchmarks.engine.session import RunError
from benchmarks.reference import multistep, solvers, splittings

CVODE = "CVODE Adams"
ADAPTIVE = (solvers.DDEABM, CVODE, "DOP853")
SPLIT = {own.label: own for own in splittings.SPLITTINGS}
#: methods that are also run from the random starts, where forces are strong
OF_STARTS = (*ADAPTIVE, multistep.LABEL)
NAMES = (*OF_STARTS, *SPLIT)
#: weights of the kinds of variables: the error of a length of 1 weighs the same as that of an angle times the radius of
#: gyration, and as that of a rate over a part of the run.  Pairs of angle and part; most scenes have FEW of them.
WEIGHTS = (1.0, 0.1), (0.1, 0.01), (0.1, 0.1), (1.0, 0.01)
FEW = 2
#: a curve ends at this error, or at this number of evaluations
STOP, MOST = 2e-11, 12_000
#: first steps, as parts of the run, and measures of the error of the fix under a tolerance
FIRST_STEPS, MEASURES = (1 / 30, 1 / 1000), ("length", "energy")


# --- one run --------------------------------------------------------------------------------------
def _rms(shifts):
    """Root mean square of vectors (n, 3); infinite if one is not finite."""
    found = float(np.sqrt((shifts**2).sum(axis=1).mean()))
    return found if np.isfinite(found) else np.inf


def errors_of_state(reference, state):
    """Errors of a State: centers, orientations, sites."""
    problem, state = reference.problem, state.astype(reference.problem.dtype)
    errors = solvers.state_errors(problem, reference.state, state)
    sites = problem.site_positions(state) - problem.site_positions(reference.state)
    return errors.rms_center, errors.rms_angle, _rms(sites)


def errors_of_outcome(reference, outcome):
    """The same errors of an Outcome of LAMMPS."""
    off = (outcome.after - reference.positions(outcome))[outcome.molecules > 0]
    return *reference.errors(outcome), _rms(off)


def curve(settings, run):
    """Rows (setting, evaluations, errors of centers, orientations and sites) of ``run(setting)``, which returns
    evaluations and errors.  A lost run has infinite errors; the list ends at STOP and at MOST."""
    rows = []
    for setting in settings:
        try:
            with warnings.catch_warnings(), np.errstate(all="ignore"):
                warnings.simplefilter("ignore")
                evaluations, errors = run(setting)
        except (RunError, RuntimeError, ValueError):
            evaluations, errors = np.nan, [np.inf] * 3
        rows.append((setting, evaluations, *(e if np.isfinite(e) else np.inf for e in errors)))
        if max(errors) < STOP or evaluations > MOST:
            break
    return rows


# --- the fix --------------------------------------------------------------------------------------
def fixed(session, scene, reference):
    """Curve of the fix without keywords over the numbers of steps of a scene."""

    def run(steps):
        outcome = scene.perform(session, AUTOMATIC, steps)
        return 1 + outcome.start + steps, errors_of_outcome(reference, outcome)

    return curve(scene.steps, run)


def controlled(session, scene, reference):
    """Curves of the fix with keyword tolerance, for each first step and each measure of the error."""

    def run(eps, first, measure):
        variables = dict(scene.variables) | {"dt": f"{first * scene.end:.17g}", "steps": 10**6, "every": 1}
        variables |= {"tolerance": f"{eps:.17g}", "measure": f"{measure} every/time {scene.end:.17g}"}
        variables |= {"until": f"{scene.end:.17g}", "more": "f_move[16]"}
        outcome = session.run(scene.deck, variables, f"{scene.key}_tolerance", 1.0)
        steps, repeated = (outcome.thermo[column][-1] for column in ("Step", "f_move[16]"))
        return int(1 + outcome.start + steps + repeated), errors_of_outcome(reference, outcome)

    work = [partial(run, first=first, measure=measure) for first in FIRST_STEPS for measure in MEASURES]
    return [curve(scene.tolerances, one) for one in work]


# --- the others -----------------------------------------------------------------------------------
def _adaptive(scene, reference, name, quick):
    """Curves of a method that controls its steps."""
    problem, bodies = reference.problem, reference.problem.bodies
    size = float(np.sqrt((bodies.moments.max(axis=1) / bodies.masses).max()))

    def run(tolerance, weights):
        state, evaluations = solvers.solve(problem, scene.end, name, tolerance, weights, MOST)
        return evaluations, errors_of_state(reference, state)

    for angle, part in WEIGHTS[: 1 if quick else len(WEIGHTS) if scene.key == "case1" else FEW]:
        weights = solvers.weights(1.0, angle / size, part * scene.end)
        yield curve(scene.tolerances, partial(run, weights=weights))


def _equal_steps(scene, reference, name):
    """Curve of a splitting, or of the multistep method."""

    def run(steps):
        task = reference.problem, scene.end
        if name == multistep.LABEL:
            state, evaluations = multistep.solve(*task, steps)
        else:
            ((state, evaluations),) = splittings.states(*task, SPLIT[name], steps)
        return evaluations, errors_of_state(reference, state)

    numbers = scene.steps  # of the multistep method as of the fix
    if name in SPLIT:
        numbers = [round(evaluations / SPLIT[name].stages) for evaluations in scene.evaluations]
    return curve(numbers, run)


def measure(lab, scene, reference, names):
    """Name -> curves, lists of (tolerance or number of steps, evaluations, errors of centers, orientations, sites)."""
    skipped = {CVODE} - set(solvers.available())
    skipped |= set() if scene.evaluations else set(NAMES) - set(ADAPTIVE)
    names, found = [name for name in names if name not in skipped], {}
    for name in tqdm(names, desc=scene.title, disable=None):
        if name in ADAPTIVE:
            found[name] = list(_adaptive(scene, reference, name, lab.quick))
        else:
            found[name] = [_equal_steps(scene, reference, name)]
    return found
