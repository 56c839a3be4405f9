"""The references, the errors of runs, and the sequence of all runs."""

import math
from dataclasses import astuple, dataclass, field

import numpy as np

from benchmarks.engine import LammpsError
from benchmarks.engine.session import MOST_ROUNDS, RunError, time_in_turn
from benchmarks.engine.sites import pose_errors
from benchmarks.reference import FreeField, paper_problem, reference_state
from benchmarks.reference.lammps_forces import deck_problem

from . import plan

#: smallest number of timings of every run
ROUNDS, QUICK_ROUNDS = 5, 2
#: limit for a usable step: of the energy error relative to the initial kinetic energy, of every | |q|^2 - 1 |, and of the
#: change of |q|^2 / 2 in a step
USABLE = 0.1
#: factor by which the reference run has a smaller step, if there is no better reference
FINER = 16


# --- what is kept ---------------------------------------------------------------------------------
@dataclass(frozen=True)
class Errors:
    """Errors of a run, in the units of its deck; infinite if the run was lost.

    * ``position``: distance of the centers of mass at the end, root mean square over the bodies
    * ``orientation``: angle of the rotation from the reference to the run, radians, root mean square over the bodies
    * ``energy``: largest change of the total energy since the start, over the samples
    * ``drift``: magnitude of the least-squares slope of the total energy, per unit of time
    * ``norm``: largest | |q|^2 - 1 |, ``tangency``: largest | q.qdot |, over the samples; NaN if the method has no
      quaternion of its own
    """

    position: float
    orientation: float
    energy: float
    drift: float
    norm: float
    tangency: float


LOST = Errors(*[np.inf] * 4, np.nan, np.nan)


@dataclass(frozen=True)
class Point(Errors):
    """One run: its errors and its cost.

    * ``scene``, ``method``: keys
    * ``start``: force evaluations of the method's own start; ``evaluations``: all, including the set-up
    * ``low``, ``seconds``, ``high``: quartiles of the ``timings`` of the ``run`` command, NaN if it was not timed
    """

    scene: str
    method: str
    steps: int
    dt: float
    start: int
    evaluations: int
    timings: int = 0
    low: float = np.nan
    seconds: float = np.nan
    high: float = np.nan


@dataclass
class Results:
    """All measurements.

    * ``runs``: list of Point
    * ``limits``: (scene, method) -> largest usable step, 0 if none was found
    * ``orders``: (formulation, N) and ``rounding``: (formulation, True if compensated) -> list of (step, error of
      position) in test case 1
    * ``modify``: method -> Timing of a step inside the fix
    * ``heldout``: (scene, method) -> list of (evaluations, error) for the scenes of heldout.py
    * ``choice``: scene -> costs for the scenes of choice.py
    """

    quick: bool
    runs: list = field(default_factory=list)
    limits: dict = field(default_factory=dict)
    orders: dict = field(default_factory=dict)
    rounding: dict = field(default_factory=dict)
    modify: dict = field(default_factory=dict)
    heldout: dict = field(default_factory=dict)
    choice: dict = field(default_factory=dict)

    @property
    def scenes(self):
        """Key -> Scene for all scenes of the runs."""
        keys = dict.fromkeys(point.scene for point in self.runs)
        return {key: plan.scenes(self.quick)[key] for key in keys}

    def curve(self, scene, method):
        """Points of one method, from large steps to small ones."""
        found = [p for p in self.runs if (p.scene, p.method) == (scene, method.key)]
        return sorted(found, key=lambda point: point.steps)

    def column(self, scene, method, name):
        """One column of ``curve``, shape (n,)."""
        return np.array([getattr(point, name) for point in self.curve(scene, method)], dtype=float)

    def errors(self, scene, method):
        """Steps and errors (the scene's measure) of one method, two arrays (n,)."""
        measure = plan.scenes(self.quick)[scene].measure
        return self.column(scene, method, "dt"), self.column(scene, method, measure)


# --- references -----------------------------------------------------------------------------------
@dataclass(frozen=True)
class Reference:
    """``problem`` and its ``state`` at the end; ``ids`` (S,) of the sites and their positions ``sites`` (S, 3).

    ``problem`` is None if the reference is a LAMMPS run.
    """

    problem: object
    state: object
    ids: np.ndarray
    sites: np.ndarray

    def positions(self, outcome):
        """Positions (n, 3) of all atoms of an Outcome; atoms outside of bodies do not move."""
        positions = outcome.before.copy()
        positions[np.searchsorted(outcome.ids, self.ids)] = self.sites
        return positions


def reference_of(scene, folder, session):
    """Positions of the sites of a scene at its end, independent of the fix.

    Test case 1 has an independent implementation in extended precision, the free top an exact solution, and water an
    extrapolation with LAMMPS' forces.  If forces are discontinuous, the reference is fix rigid/nve/small with a step
    FINER times smaller than its finest one, because nothing better is available.  States are stored in ``folder``.
    """
    if not scene.smooth:
        run = plan.Run(scene, plan.RIGID_NVE, FINER * scene.steps(plan.RIGID_NVE)[-1])
        outcome = run.perform(session)
        return Reference(None, None, outcome.ids, outcome.after)
    if scene.key == "case1":
        problem, ids = paper_problem(1, "consistent"), np.arange(1, 5)
    else:
        problem = deck_problem(scene.deck, dict(scene.variables))
        ids = problem.field.ids
    if scene.key == "top":
        problem.field.close()
        problem = problem.with_field(FreeField())
    state = reference_state(problem, scene.end, folder=folder)
    return Reference(problem, state, ids, problem.site_positions(state).astype(np.float64))


# --- errors of one run ----------------------------------------------------------------------------
def energy_errors(time, total):
    """(energy, drift), see Errors."""
    deviation = np.abs(total - total[0])
    if not np.isfinite(deviation).all():
        return np.inf, np.inf
    return float(deviation.max()), abs(float(np.polyfit(time - time[0], total - total[0], 1)[0]))


def errors_of(outcome, reference):
    """Errors of the Outcome of a sampled run; ``reference``: positions (n, 3)."""
    atoms = outcome.masses, outcome.molecules
    pose = pose_errors(*atoms, outcome.before, outcome.after, reference)
    thermo = outcome.thermo
    constraints = [
        float(np.abs(thermo[column]).max()) if plan.TANGENCY in thermo else np.nan
        for column in (plan.NORM, plan.TANGENCY)
    ]
    return Errors(*pose, *energy_errors(thermo["Time"], thermo[plan.TOTAL]), *constraints)


def judged(session, run, reference):
    """(Outcome, Errors) of a sampled run; if LAMMPS ended the run, the RunError replaces the Outcome."""
    try:
        outcome = run.perform(session, sampled=True)
    except RunError as error:
        return error, LOST
    return outcome, errors_of(outcome, reference.positions(outcome))


def is_usable(session, run):
    """True if a run reaches its end with errors of energy and quaternions within USABLE."""
    try:
        thermo = run.perform(session, sampled=True).thermo
    except RunError:
        return False
    kinetic = thermo["v_ketrans"][0] + thermo["v_kerot"][0]
    energy, _ = energy_errors(thermo["Time"], thermo[plan.TOTAL])
    norm = np.abs(thermo[plan.NORM]).max()
    radial = np.abs(thermo.get(plan.TANGENCY, 0.0)).max() * run.dt
    return energy <= USABLE * kinetic and max(norm, radial) <= USABLE


def fewest_steps(usable, start, most, ratio=1.02):
    """Smallest number n of steps for which ``usable(n)`` is true; None if ``most`` steps are not enough.

    The search doubles or halves ``start``, then bisects log n down to ``ratio``.  It assumes that more steps are usable
    if fewer are.
    """
    high = start
    while not usable(high):
        high *= 2
        if high > most:
            return None
    low = high // 2
    while low and usable(low):
        low, high = low // 2, low
    while high > max(low + 1, ratio * low):
        middle = min(max(round(math.sqrt(low * high)), low + 1), high - 1)
        low, high = (low, middle) if usable(middle) else (middle, high)
    return high


def largest_step(session, scene, method):
    """Largest usable step of a method in a scene, 0 if none was found."""
    first, *_, most = scene.steps(method)
    steps = fewest_steps(lambda n: is_usable(session, plan.Run(scene, method, n)), first, most)
    return scene.end / steps if steps else 0.0


def timed(session, run, outcome):
    """Wall time of a run; raises an error unless the Outcome agrees with the sampled run to the last bit."""
    again = run.perform(session)
    if not np.array_equal(again.after, outcome.after, equal_nan=True):
        raise LammpsError(f"log.{run.name}: the timed run does not repeat the sampled one")
    return again.seconds


def point_of(run, outcome, errors, timing=None):
    """The Point of a run."""
    start = 0 if isinstance(outcome, RunError) else outcome.start
    times = (timing.count, timing.low, timing.median, timing.high) if timing else ()
    facts = run.scene.key, run.method.key, run.steps, run.dt, start, 1 + start + run.steps
    return Point(*astuple(errors), *facts, *times)


# --- everything -----------------------------------------------------------------------------------
def judge_all(lab, session, scene, reference):
    """Run -> (Outcome, Errors) of all runs; raises an error if no run of the fix reaches the end of a scene."""
    runs, outcomes = plan.scene_runs(scene), {}
    for run in runs:
        outcomes[run] = judged(session, run, reference)
        lab.advance(run.cost / sum(run.cost for run in runs))
    mine = [outcome for run, (outcome, _) in outcomes.items() if run.method.gear]
    if all(isinstance(outcome, RunError) for outcome in mine):  # the deck or the fix is at fault
        raise LammpsError(str(mine[-1]))
    return outcomes


def time_all(lab, session, outcomes):
    """Run -> Timing of all runs that reached their end."""
    ended = [run for run, (outcome, _) in outcomes.items() if not isinstance(outcome, RunError)]
    rounds, total = QUICK_ROUNDS if lab.quick else ROUNDS, sum(run.cost for run in ended)

    def once(run):
        lab.advance(run.cost / total / rounds)
        return timed(session, run, outcomes[run][0])

    return time_in_turn(ended, rounds, once, rounds if lab.quick else MOST_ROUNDS)


def run_scene(lab, session, results, scene, reference):
    """Errors, largest usable steps and timings of all methods."""
    with lab.share(0.15):
        outcomes = judge_all(lab, session, scene, reference)
    with lab.share(0.15):
        for method in scene.methods if scene.smooth else ():
            results.limits[scene.key, method.key] = largest_step(session, scene, method)
            lab.advance(1 / len(scene.methods))
    with lab.share(0.6):
        times = time_all(lab, session, outcomes)
    results.runs += [point_of(run, *own, times.get(run)) for run, own in outcomes.items()]


def run_further(lab, session, results, scene, reference):
    """Orders, round-off and time in the fix, all in test case 1."""

    orders, rounding = (f(scene, lab.quick) for f in (plan.order_runs, plan.rounding_runs))
    for kept, planned in ((results.orders, orders), (results.rounding, rounding)):
        for key, runs in planned.items():
            kept[key] = [(run.dt, judged(session, run, reference)[1].position) for run in runs]
            lab.advance(0.03 / len(planned))

    def once(run):
        return run.perform(session, timers=True).modify / run.steps

    rounds = QUICK_ROUNDS if lab.quick else ROUNDS
    times = time_in_turn(plan.modify_runs(scene, lab.quick), rounds, once, rounds)
    results.modify = {run.method.key: timing for run, timing in times.items()}


def measure(lab, session):
    """Results of all scenes of the plan.  Runs are timed, so there is one run at a time."""
    scenes = [s for key, s in plan.scenes(lab.quick).items() if key in lab.parts or not lab.parts]
    results = Results(lab.quick)
    for scene in scenes:
        with lab.share(scene.minutes / sum(scene.minutes for scene in scenes)):
            reference = reference_of(scene, lab.out / "reference", session)
            run_scene(lab, session, results, scene, reference)
            if scene.key == "case1":
                run_further(lab, session, results, scene, reference)
    return results
