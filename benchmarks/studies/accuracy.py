"""Wall times of the fix and of fix rigid/nve/small for a given error of the trajectory.

Every run can be repeated by ``lmp -in DECK -var ...``.
"""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.engine import Curve, Finding, LammpsError, Measurement, Panel, Study, Table
from benchmarks.engine import decks
from benchmarks.engine.costs import cost_of, count_text, power, ratio_text, significant
from benchmarks.engine.methods import AUTOMATIC, rigid
from benchmarks.engine.session import MOST_ROUNDS, RunError, Session, Timing, time_in_turn
from benchmarks.engine.sites import pose_errors
from benchmarks.reference import FreeField, paper_problem, reference_state
from benchmarks.reference.lammps_forces import deck_problem

RIGID = rigid("rigid/nve/small", "rigid")
METHODS = (AUTOMATIC, RIGID)
#: errors of the tables, and the error of the sentences
TARGETS, SAMPLE = (1e-4, 1e-6, 1e-8, 1e-10), 1e-6
#: least speed-up in test case 1 for each error
LEAST_SPEEDUP = {1e-4: 4.0, 1e-6: 30.0, 1e-8: 150.0}
#: smallest number of timings of every run
ROUNDS, QUICK_ROUNDS = 5, 2


def geometric(first, last, ratio):
    """Integers from ``first`` to ``last``, each about ``ratio`` times the one before."""
    numbers, x = [], float(first)
    while x < last * ratio**0.5:
        numbers.append(min(round(x), last))
        x *= ratio
    return tuple(sorted(set(numbers)))


# --- scenes and runs ------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Scene:
    """A deck that ends at the time ``end``; ``measure``: the error of interest, position or orientation."""

    key: str
    title: str
    end: float
    measure: str = "position"
    variables: tuple = ()

    @property
    def deck(self):
        """Path of the input script."""
        return decks.deck(self.key.partition("-")[0])

    def perform(self, session, method, steps):
        """Outcome of a run in a Session, with output at start and end only."""
        own = dict(self.variables) | method.variables
        own |= {"dt": f"{self.end / steps:.17g}", "steps": steps, "every": steps}
        return session.run(self.deck, own, f"{self.key}_{method.key}_{steps}", seconds(steps))


SCENES = (
    Scene("case1", "Test case 1", 200.0),
    Scene("top", "Free asymmetric top", 200.0, "orientation"),
)


def seconds(steps):
    """Approximate duration of a run of one body, with the start of LAMMPS and reading the scene."""
    return 0.006 + 1.3e-6 * steps


def numbers_of_steps(method, quick):
    """Numbers of steps of the runs of a method, ascending."""
    if method.gear:
        return geometric(320, 10_240, 2.0) if quick else geometric(320, 40_000, 2 ** (1 / 3))
    return geometric(640, 40_960 if quick else 5_242_880, 2.0)


@dataclass(frozen=True)
class Reference:
    """``problem`` and its ``state`` at the end; ``ids`` (S,) of the sites and their positions ``sites`` (S, 3)."""

    problem: object
    state: object
    ids: np.ndarray
    sites: np.ndarray

    @classmethod
    def of(cls, problem, end, tolerance=None):
        """The Reference of a Problem, with a ``tolerance`` of the integrator."""
        state = reference_state(problem, end, tolerance)
        sites = problem.site_positions(state).astype(np.float64)
        return cls(problem, state, getattr(problem.field, "ids", np.arange(1, len(sites) + 1)), sites)

    def positions(self, outcome):
        """Positions (n, 3) of all atoms of an Outcome; atoms outside of bodies do not move."""
        positions = outcome.before.copy()
        positions[np.searchsorted(outcome.ids, self.ids)] = self.sites
        return positions

    def errors(self, outcome):
        """Errors of the centers of mass and of the orientations of an Outcome."""
        return pose_errors(outcome.masses, outcome.molecules, outcome.before, outcome.after, self.positions(outcome))


def problem_of(scene):
    """The Problem of a scene, without LAMMPS' forces: the cage in extended precision, or a top without forces."""
    if scene.key == "case1":
        return paper_problem(1, "consistent")
    problem = deck_problem(scene.deck)
    problem.field.close()
    return problem.with_field(FreeField())


# --- measuring ------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Point:
    """A run: ``evaluations`` of the forces, start included, its ``error``, and its Timing, None if it was lost."""

    evaluations: int
    error: float
    timing: Timing = None


def _errors(session, scene, reference, method, steps):
    """(Outcome or None, Point) of a run."""
    try:
        outcome = scene.perform(session, method, steps)
    except RunError:
        return None, Point(1 + steps, np.inf)
    error = reference.errors(outcome)[scene.measure == "orientation"]
    return outcome, Point(1 + outcome.start + steps, error)


def _timed(session, scene, method, steps, outcome):
    """Wall time of a run; raises an error unless it agrees with its Outcome to the last bit."""
    again = scene.perform(session, method, steps)
    if not np.array_equal(again.after, outcome.after, equal_nan=True):
        raise LammpsError(f"{scene.key}, {method.label}, {steps} steps: the timed run does not repeat the first one")
    return again.seconds


def measure(lab):
    """(scene, method) -> list of Point, large steps first.  Runs are timed, so there is one run at a time."""
    found, rounds = {}, QUICK_ROUNDS if lab.quick else ROUNDS
    with Session(lab.out / "logs") as session:
        for scene in SCENES:
            reference = Reference.of(problem_of(scene), scene.end)
            runs = [(method, steps) for method in METHODS for steps in numbers_of_steps(method, lab.quick)]
            points = {run: _errors(session, scene, reference, *run) for run in runs}
            ended = [run for run, (outcome, _) in points.items() if outcome is not None]

            def once(run, scene=scene, points=points):
                return _timed(session, scene, *run, points[run][0])

            times = time_in_turn(ended, rounds, once, rounds if lab.quick else MOST_ROUNDS)
            for (method, steps), (_, point) in points.items():
                timed = replace(point, timing=times.get((method, steps)))
                found.setdefault((scene.key, method.key), []).append(timed)
    return found


# --- results --------------------------------------------------------------------------------------
def price(points, target):
    """Cost in seconds of an error, with the uncertainty of the timings; None if no run reaches the error."""
    times = [np.nan if point.timing is None else point.timing.median for point in points]
    cost = cost_of(times, [point.error for point in points], target)
    error = np.median([point.timing.error for point in points if point.timing])
    return cost and replace(cost, error=float(error))


def speedup(results, scene, target):
    """Wall time of RIGID over that of the fix for an error, a Cost or None."""
    ours, theirs = (price(results[scene.key, method.key], target) for method in METHODS)
    return ours and theirs and theirs.over(ours)


def panels(results):
    """Error in test case 1 against force evaluations, and against wall time."""
    shown, names = ([], []), ("fix gear/quat", RIGID.label)
    for method, name, color, marker in zip(METHODS, names, ("momentum", "rigid"), "oD"):
        points = [point for point in results[SCENES[0].key, method.key] if point.timing]
        errors = np.array([point.error for point in points])
        for curves, x in zip(shown, ([p.evaluations for p in points], [1e3 * p.timing.median for p in points])):
            curves.append(Curve(name, np.array(x, float), errors, color, marker=marker))
    axes = ("force evaluations, start included", "wall time of the run, ms")
    titles = ("The fix needs fewer evaluations for the same error", "The fix needs less time for the same error")
    error = "error of the center of mass"
    return [Panel(t, x, error, own, "xy", ylim=(1e-13, 1), legend=False) for t, x, own in zip(titles, axes, shown)]


def find(results):
    """Finding of the results of ``measure``."""
    rows, measurements, case1 = [], [], SCENES[0]
    for scene in SCENES:
        cells = [ratio_text(speedup(results, scene, target)) for target in TARGETS]
        rows.append([f"{scene.title}: {scene.measure}", *cells])
    for target in TARGETS:
        cost = speedup(results, case1, target)
        value, error = (cost.value, cost.error * cost.value) if cost else (np.nan, None)
        what = f"test case 1, error {power(target)}: time of `{RIGID.label}` relative to `fix gear/quat`"
        measurements.append(Measurement(what, value, error, ".3g", "times", least=LEAST_SPEEDUP.get(target)))
    ours = results[case1.key, AUTOMATIC.key]
    count = cost_of(*zip(*((point.evaluations, point.error) for point in ours)), SAMPLE)
    prices = [price(results[case1.key, method.key], SAMPLE) for method in METHODS]
    context = {
        "end": f"{case1.end:g}",
        "sample": power(SAMPLE),
        "count": count_text(count),
        "speedup": significant(prices[1].over(prices[0]).value) if all(prices) else "–",
        "times": [f"{significant(1e3 * cost.value)} ms" if cost else "more than was tried" for cost in prices],
        "timings": min(point.timing.count for points in results.values() for point in points if point.timing),
    }
    tables = {"speedup": Table(["scene", *(f"error {power(target)}" for target in TARGETS)], rows)}
    return Finding(measurements, tables, {"main": panels(results)}, context)


STUDY = Study(
    "accuracy",
    "Wall time for an error",
    400.0,
    measure,
    find,
    blocks={
        "doc/accuracy.md": "accuracy.md.j2",
        "README.md": "accuracy.readme.md.j2",
        "paper/paper.md": "accuracy.paper.md.j2",
    },
)
