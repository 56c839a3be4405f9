"""Scenes that were not used to choose coefficients: errors compared with the formulations of the paper.

They are ten seeded starts near test case 1 in random orientations, the other body that the paper may have used, test
cases 2 and 3, and the free top.  Costs are force evaluations, start included.
"""

from pathlib import Path

import numpy as np

from benchmarks.engine import Measurement, Table, deck
from benchmarks.engine.methods import DEFAULTS
from benchmarks.reference import FreeField, Problem, State, paper_problem, reference_state
from benchmarks.reference import quaternion as qt
from benchmarks.reference.lammps_forces import deck_problem

from . import plan
from .runs import Reference, judged

PAPER = ("second", "first")
SEED, STARTS = 2026, 10
#: largest distance of a start from test case 1 along each axis
AWAY = 4.0
#: errors are compared from ABOVE_FLOOR times the smallest error up to COARSE; round-off errors have the last two numbers
#: as bounds
COARSE, ABOVE_FLOOR, LEAST_ROUNDING, ROUNDING = 1e-3, 1e3, 1e-14, 1e-11
#: bounds for the ratio of errors: geometric mean of second over momentum, and any formulation in its worst scene
LEAST_MEAN, LEAST = 25.0, 1.0
#: smallest and largest number of steps, and the ratio from one run to the next
STEPS = 50, 2400, 2**0.5


# --- scenes ---------------------------------------------------------------------------------------
def turned_start(base, random, away, name):
    """The Problem ``base`` displaced by up to ``away`` along each axis, in a random orientation."""
    length = np.linalg.norm(base.start.omega_body.astype(float))
    center = base.start.center + random.uniform(-away, away, (1, 3))
    directions = random.normal(size=(2, 1, 3))
    velocity, omega = directions / np.linalg.norm(directions, axis=2, keepdims=True)
    q = qt.normalised(random.normal(size=(1, 4)).astype(base.dtype))
    start = State(center, 0.2 * velocity, q, length * omega).astype(base.dtype)
    return Problem(name, base.bodies, base.field, start)


def random_starts():
    """Problems of the consistent body in the cage, near test case 1 in random orientations."""
    base, random = paper_problem(1), np.random.default_rng(SEED)
    return [turned_start(base, random, AWAY, f"start {n}") for n in range(1, STARTS + 1)]


def data_text(problem):
    """The data file of test case 1, with atoms 1 to 4 (the body) at their positions in a Problem."""
    state = problem.start
    rotation = qt.rotation_space_body(state.q)
    spin = (rotation @ state.omega_body[..., None])[..., 0]
    positions = problem.site_positions(state)
    velocities = state.velocity + qt.cross(spin, positions - state.center)
    lines = (deck("case1").parent / "data.consistent").read_text().splitlines()
    for section, rows in (("Atoms # full", positions), ("Velocities", velocities)):
        first = lines.index(section) + 2
        for k, row in enumerate(rows.astype(np.float64)):
            kept = lines[first + k].split()[:-3]
            lines[first + k] = " ".join([*kept, *(f"{x:.17g}" for x in row)])
    return "\n".join(lines) + "\n"


def scenes(folder, quick=False):
    """(Scene, Problem) of all scenes; data files of the starts are written to ``folder``."""
    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    facts = {"samples": 1, "methods": (), "end": 100.0, "rigid_blocks": ()}
    facts["gear_blocks"] = plan.geometric(200, 800, 2.0) if quick else plan.geometric(*STEPS)
    for number, problem in enumerate(random_starts(), 1):
        path = folder / f"start{number}"
        path.with_suffix(".consistent").write_text(data_text(problem))
        variables = (("data", str(path)),)
        yield plan.Scene(f"case1-start{number}", problem.name, variables=variables, **facts), problem
    unrotated = (("body", "unrotated"),)
    title = "test case 1, unrotated body"
    scene = plan.Scene("case1-unrotated", title, variables=unrotated, **facts)
    yield scene, paper_problem(1, "unrotated")
    # test case 2 is test case 1 with a larger step, so it starts here from the end of test case 1
    longer = facts | {"end": 300.0, "gear_blocks": tuple(3 * n for n in facts["gear_blocks"])}
    yield plan.Scene("case2", "test case 2", **longer), paper_problem(2)
    yield plan.Scene("case3", "test case 3", **facts), paper_problem(3)
    scene = plan.Scene("top", "free top", measure="orientation", **facts)
    top = deck_problem(scene.deck)
    top.field.close()
    yield scene, top.with_field(FreeField())


# --- running --------------------------------------------------------------------------------------
def measure(lab, session):
    """(title of the scene, key of the method) -> list of (evaluations, error), large steps first."""
    methods, found = DEFAULTS.values(), {}
    planned = list(scenes(lab.out / "heldout", lab.quick))
    for scene, problem in planned:
        state = reference_state(problem, scene.end, folder=lab.out / "reference")
        sites = problem.site_positions(state).astype(np.float64)
        reference = Reference(problem, state, np.arange(1, len(sites) + 1), sites)
        for method in methods:
            rows = found[scene.title, method.key] = []
            for block in scene.gear_blocks:
                run = plan.Run(scene, method, block)
                outcome, errors = judged(session, run, reference)
                start = getattr(outcome, "start", 0)
                rows.append((1 + start + run.steps, getattr(errors, scene.measure)))
            lab.advance(1 / len(methods) / len(planned))
    return found


# --- judging --------------------------------------------------------------------------------------
def gains(gears, ours):
    """Ratios (n,) of errors at equal evaluations, ``gears`` over ``ours``.

    ``gears``, ``ours``: lists of (evaluations, error).  They are compared at the runs of ``gears`` with an error of at
    most COARSE and at least ABOVE_FLOOR times the round-off (smallest) error; ``ours`` are interpolated log-log.  The
    ratio is zero if ``ours`` are lost.
    """
    gears, ours = np.array(gears, dtype=float), np.array(ours, dtype=float)
    ended = np.isfinite(ours[:, 1])
    if not ended.any():
        return np.zeros(1)
    smallest = min(ROUNDING, max(min(gears[:, 1].min(), ours[:, 1].min()), LEAST_ROUNDING))
    used = (gears[:, 1] <= COARSE) & (gears[:, 1] >= ABOVE_FLOOR * smallest)
    used &= gears[:, 0] <= ours[ended, 0].max()
    if ended.all():  # fewer evaluations than any run of ours
        used &= gears[:, 0] >= ours[:, 0].min()
    costs, errors = gears[used].T
    found = np.exp(np.interp(np.log(costs), *np.log(ours[ended]).T, left=np.inf))
    return errors / found


def _mean(values):
    """Geometric mean; NaN without values."""
    with np.errstate(divide="ignore"):
        return float(np.exp(np.log(values).mean())) if len(values) else np.nan


def find(results):
    """Table of the gains, and their measurements."""
    rows, found = {title: [title] for title, _ in results}, []
    for formulation in PAPER:
        keys, means = [DEFAULTS[name].key for name in (formulation, "momentum")], {}
        for title, row in rows.items():
            own = gains(*(results[title, key] for key in keys))
            means[title] = _mean(own)
            row += [f"{value:.3g}" for value in (means[title], own.min(initial=np.inf))]
        worst = min(means, key=lambda title: np.nan_to_num(means[title], nan=-1.0))
        what = f"held-out scenes: error of formulation {formulation} over the error of momentum at equal evaluations"
        least = LEAST_MEAN if formulation == "second" else LEAST
        mean = _mean(np.array(list(means.values())))
        found.append(Measurement(f"{what}, geometric mean", mean, spec=".3g", least=least))
        facts = {"spec": ".3g", "remark": worst, "least": LEAST}
        found.append(Measurement(f"{what}, worst scene", means[worst], **facts))
    header = ["scene"]
    for formulation in PAPER:
        header += [f"formulation {formulation}", "its worst run"]
    return Table(header, list(rows.values())), found
