"""What `benchmarks/run workprecision` runs, in order: errors, largest steps, timings, SciPy, further runs."""

from dataclasses import asdict, dataclass

import numpy as np

from benchmarks.reference import solvers
from . import plan
from .judge import Errors, energy_errors, errors_of
from .measure import time_in_turn
from .references import reference_of
from .results import LimitRow, ModifyRow, OrderRow, Results, RoundingRow, Row, SolverRow
from .stability import fewest_steps
from .worker import DeckError, Outcome, RunError

#: a step is usable while the total energy stays within this part of the kinetic energy at the start,
#: every |q|^2 within it of 1, and the change of |q|^2 / 2 over a step below it
USABLE = 0.1
ASTRAY = Errors(np.inf, np.inf, np.inf, np.inf, np.nan, np.nan)
#: LAMMPS started anew and a scene read, in seconds, roughly; the search for a largest step, in runs
OVERHEAD, TRIALS = 0.006, 12


@dataclass(frozen=True)
class Judged:
    """A sampled run: its Outcome, None if LAMMPS ended it with ``words``; its Errors."""

    outcome: Outcome
    errors: Errors
    words: str = ""


def judge(session, run, reference):
    """A Run sampled and Judged; a run that LAMMPS ends with an error went astray."""
    try:
        outcome = session.run(run, sampled=True)
    except RunError as error:
        return Judged(None, ASTRAY, str(error))
    return Judged(outcome, errors_of(outcome, reference.positions(outcome)))


def is_usable(session, run):
    """Whether a run ends, and holds energy and quaternions within USABLE."""
    try:
        thermo = session.run(run, sampled=True).thermo
    except RunError:
        return False
    kinetic = thermo["v_ketrans"][0] + thermo["v_kerot"][0]
    energy, _ = energy_errors(thermo["Time"], thermo[plan.TOTAL])
    norm = np.abs(thermo[plan.NORM]).max()
    radial = np.abs(thermo.get(plan.TANGENCY, 0.0)).max() * run.dt
    return energy <= USABLE * kinetic and max(norm, radial) <= USABLE


def largest_step(session, scene, method):
    """LimitRow of a method in a scene."""
    start, *_, most = scene.steps(method)
    steps = fewest_steps(lambda n: is_usable(session, plan.Run(scene, method, n)), start, most)
    return LimitRow(scene.key, method.key, steps or 0, scene.end / steps if steps else 0.0)


def timed(session, run, judged):
    """Wall time of a run; refuses one that does not repeat the sampled run to the bit."""
    outcome = session.run(run)
    if not np.array_equal(outcome.after, judged.outcome.after, equal_nan=True):
        raise DeckError(f"log.{run.name}: the timed run does not repeat the sampled one")
    return outcome.seconds


def row_of(run, judged, timing):
    """The Row of a run; ``timing`` is None if it was not timed."""
    method, outcome = run.method, judged.outcome
    start = outcome.start if outcome else 0
    times = (timing.count, timing.low, timing.median, timing.high) if timing else ()
    names = (run.scene.key, method.key, method.label, method.family, method.values, method.passes)
    cost = (run.steps, run.dt, start, 1 + start + run.steps)
    return Row(*names, *cost, *asdict(judged.errors).values(), *times)


def solver_rows(scene, reference, solver):
    """Rows of a SciPy solver, one at a time."""
    for tolerance in scene.tolerances:
        (point,) = solvers.work_precision(
            reference.problem, scene.end, reference.state, solver, [tolerance]
        )
        errors = (point.errors.rms_centre, point.errors.rms_angle)
        yield SolverRow(scene.key, solver, tolerance, point.evaluations, *errors)


class Conductor:
    """Runs everything; ``progress(seconds, text)`` is told the work done, as expected beforehand."""

    def __init__(self, session, folder, timings, progress):
        self.session, self.folder, self.timings = session, folder, timings
        self.progress, self.results = progress, Results()

    def expected(self, scenes):
        """Seconds that all of it takes, roughly."""
        every = sum(_cost(run) * (1 + self.timings) for scene in scenes for run in _runs(scene))
        search = sum(
            _search_cost(scene, m) for scene in scenes if scene.smooth for m in scene.methods
        )
        solving = sum(scene.solving * 2 * len(scene.tolerances) for scene in scenes)
        further = sum(map(_cost, plan.rounding_runs(scenes)))
        return (
            every
            + search
            + solving
            + further
            + sum(self.timings * _cost(run) for run in plan.modify_runs(scenes))
        )

    def run(self, scenes):
        """Results of all scenes."""
        for scene in scenes:
            self._scene(scene)
        self._orders(plan.order_runs(scenes))
        self._rounding(plan.rounding_runs(scenes))
        self._modify(plan.modify_runs(scenes))
        return self.results

    def _scene(self, scene):
        self.progress(0.0, f"{scene.key}: reference")
        reference = reference_of(scene, self.folder / "reference", self.session)
        runs, judged = _runs(scene), {}
        for run in runs:
            judged[run] = judge(self.session, run, reference)
            self.progress(_cost(run), f"{scene.key}: errors")
        _refuse_hopeless(judged)
        for method in scene.methods if scene.smooth else ():
            self.results.limits.append(largest_step(self.session, scene, method))
            self.progress(_search_cost(scene, method), f"{scene.key}: largest steps")

        def once(run):
            self.progress(_cost(run), f"{scene.key}: timing")
            return timed(self.session, run, judged[run])

        finished = [run for run in runs if judged[run].outcome]
        times = time_in_turn(finished, self.timings, once)
        self.results.runs += [row_of(run, judged[run], times.get(run)) for run in runs]
        for solver in solvers.METHODS if scene.tolerances else ():
            for row in solver_rows(scene, reference, solver):
                self.results.solvers.append(row)
                self.progress(scene.solving, f"{scene.key}: {solver}")

    def _further(self, runs, what):
        """Sampled runs that are not timed: pairs (run, error of position)."""
        for run in runs:
            reference = reference_of(run.scene, self.folder / "reference", self.session)
            error = judge(self.session, run, reference).errors.position
            self.progress(_cost(run), what)
            yield run, error

    def _orders(self, runs):
        for run, error in self._further(runs, "orders"):
            row = OrderRow(run.method.family, run.method.values, run.dt, error)
            self.results.orders.append(row)

    def _rounding(self, runs):
        for run, error in self._further(runs, "rounding"):
            compensate = dict(run.method.variables).get("compensate", "no")
            row = RoundingRow(run.method.family, compensate, run.dt, error)
            self.results.rounding.append(row)

    def _modify(self, runs):
        def once(run):
            self.progress(_cost(run), "time inside the fix")
            return self.session.run(run, timers=True).modify / run.steps

        for run, timing in time_in_turn(runs, self.timings, once, self.timings).items():
            times = (timing.count, timing.low, timing.median, timing.high)
            self.results.modify.append(ModifyRow(run.method.key, run.method.label, *times))


def _runs(scene):
    return [
        plan.Run(scene, method, steps) for method in scene.methods for steps in scene.steps(method)
    ]


def _cost(run):
    return OVERHEAD + run.scene.cost * run.steps


def _search_cost(scene, method):
    return TRIALS * _cost(plan.Run(scene, method, scene.steps(method)[0]))


def _refuse_hopeless(judged):
    """No run of fix gear/quat ends: in LAMMPS' words, it is the deck or the fix that is at fault."""
    mine = [found for run, found in judged.items() if run.method.family != plan.RIGID]
    if mine and all(found.outcome is None for found in mine):
        raise DeckError(mine[-1].words)
