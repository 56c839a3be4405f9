"""Scenes in which the fix is compared with other methods, and their runs.

The first is test case 1.  Two are in the middle of its cage, where forces are weak and the body turns slowly or fast.
Two molecules of water vibrate about a hydrogen bond, and a charge passes a fixed one at a small distance, where only
methods that control their steps are of use.  The ten starts are those of heldout.py.
"""

from dataclasses import dataclass, fields
from itertools import islice
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.engine.decks import EXAMPLES
from benchmarks.reference import Cage, Problem, State, paper_problem, reference_state
from benchmarks.reference.lammps_forces import deck_problem
from benchmarks.reference.paper import SITE_MASSES, SITES
from benchmarks.studies.accuracy import choice, heldout, plan
from benchmarks.studies.accuracy.runs import Reference

from . import peers

CASE1 = "Test case 1"
#: angular velocity in the weak field, along the principal axes, and the factor of the fast rotation
OMEGA, FASTER = (0.2, 0.3, 0.12), 8
#: half of the angle of a molecule, distance of the oxygen atoms in angstrom, unit of the rates below in fs
HALF, APART, FS = 109.47 / 2, 2.9, 48.88821291
#: distance at which the charge would pass the fixed one without forces
PASSES = 0.02
#: tolerance of the reference there; below it, rounding ends the extrapolation
TIGHT = 1e-14
#: keys of the fix, beside the names of the other methods
FIXED, TOLERANCE = "no keyword", "`tolerance`"
#: keys of the scenes, and methods, of quick runs
QUICK = ("case1", "case1-weak", "encounter", "case1-start7")
QUICK_NAMES = ("DDEABM", "Quinlan–Tremaine 8", "SABA4, 4 stages")
#: columns of the errors in the rows of peers.py
COLUMNS = {"position": 2, "orientation": 3, "sites": 4}

ENDING = """\
group body molecule > 0
variable dt index 1
variable steps index 1
variable every index 1
variable out index out
include {}
"""


class Center(Cage):
    """A fixed charge of 1 at the origin, and the charges of test case 1 without Lennard-Jones potentials."""

    EPSILON = 0

    def __init__(self, dtype=np.longdouble):
        super().__init__(dtype)
        self.positions, self.charges = np.zeros((1, 3), dtype=dtype), np.ones(1, dtype=dtype)

    def astype(self, dtype):
        """The charge in another float type."""
        return Center(dtype)


# --- scenes ---------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Scene(plan.Scene):
    """A scene of accuracy, of which the error may also be that of "sites".

    ``tolerances`` of methods that control their steps; ``evaluations``: approximate numbers for splittings;
    ``path`` of the deck, if it is not one of the examples.
    """

    tolerances: tuple = ()
    evaluations: tuple = ()
    path: str = ""

    @property
    def deck(self):
        """Path of the input script."""
        return Path(self.path) if self.path else super().deck


def half_decades(first, last):
    """1e-first ... 1e-last, two per decade."""
    return tuple(10.0 ** (-k / 2) for k in range(2 * first, 2 * last + 1))


def _in_the_middle(omega):
    """The body of test case 1 in the middle of the cage."""
    base = paper_problem(1)
    numbers = (0, 0, 0), (0.02, -0.01, 0.015)
    center, velocity = (np.array([row], dtype=base.dtype) for row in numbers)
    start = State(center, velocity, base.start.q, np.array([omega], dtype=base.dtype))
    return Problem("middle of the cage", base.bodies, base.field, start)


def _deck(folder, name, units, types, forces, *bodies_kinds_motions):
    """Path of a deck that it writes, with the methods and outputs of examples."""
    path, atoms = folder / f"in.{name}", choice.atoms(*bodies_kinds_motions)
    head = choice.HEAD.format(title=name, units=units, types=types, atoms=atoms, forces=forces)
    path.write_text(head + ENDING.format(EXAMPLES / "common" / "in.motion"))
    return str(path)


def _pair(folder):
    """Deck of two molecules of water, the first a donor."""
    s, c = np.sin(np.radians(HALF)), np.cos(np.radians(HALF))
    sites = np.array([(0, 0, 0), (s, c, 0), (-s, c, 0)])
    turns = Rotation.from_euler("z", HALF - 90, degrees=True), Rotation.from_euler("zx", (-90, 60), degrees=True)
    bodies = [turn.apply(sites) + (x * APART / 2, 0, 0) for turn, x in zip(turns, (-1, 1))]
    rates = np.array([((0, 0.12, 0.1), (0.3, 0.2, -0.4)), ((0, -0.12, -0.1), (-0.3, 0.4, 0.2))]) / FS
    return _deck(folder, "pair", "real", 2, choice.OF_WATER, bodies, (1, 2, 2), rates)


def _encounter(folder):
    """Deck of a body at rest in its frame whose third charge passes a fixed one."""
    sites = np.array(SITES, dtype=float)
    turned = Rotation.from_euler("zxz", (20, 90, 10), degrees=True).apply(sites - sites[2]) + (PASSES, -1, 0)
    forces = ["pair_style coul/cut 90.0", "pair_coeff * *", "create_atoms 4 single 0 0 0", "set type 4 charge 1.0"]
    forces += ["mass 4 1.0", *(f"mass {k} {m}" for k, m in zip((1, 2, 3), SITE_MASSES[1:]))]
    forces += [f"set type {k} charge {q}" for k, q in zip((1, 2, 3), Center.SITE_CHARGES[1:])]
    motion = [((0, 0.4, 0), (0, 0, 0))]
    return _deck(folder, "encounter", "lj", 4, "\n".join(forces), [turned], (1, 1, 2, 3), motion)


def scenes(folder, quick=False):
    """(Scene, Problem) of all scenes; files that they read are written to ``folder``."""
    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    ratio = 2.0 if quick else 2**0.25
    facts = {"samples": 1, "methods": (), "rigid_blocks": (), "measure": "sites"}
    facts["tolerances"] = half_decades(2, 8) if quick else half_decades(1, 13)
    starts = facts | {"measure": "position"}

    def numbers(first, last):
        evaluations = plan.geometric(first, 2 * last, ratio**2)
        return {"gear_blocks": plan.geometric(first, last, ratio), "evaluations": evaluations}

    yield Scene("case1", CASE1, 200.0, **starts, **numbers(300, 6000)), paper_problem(1)
    for key, title, end, factor, last in (
        ("weak", "Weak field, 200 time units", 200.0, 1, 3000),
        ("spin", "Fast rotation, 49 turns in a weak field", 100.0, FASTER, 9000),
    ):
        problem, path = _in_the_middle(factor * np.array(OMEGA)), folder / key
        path.with_suffix(".consistent").write_text(heldout.data_text(problem))
        variables = (("data", str(path)),)
        yield Scene(f"case1-{key}", title, end, variables=variables, **facts, **numbers(40, last)), problem
    path = _pair(folder)
    scene = Scene("pair", "Two molecules of water, 1 ps", 20 * FS, path=path, **facts, **numbers(150, 3000))
    yield scene, deck_problem(path)
    path, title = _encounter(folder), "A charge that passes a fixed one at a small distance"
    problem = deck_problem(path)
    problem.field.close()
    facts["tolerances"] = facts["tolerances"][4:]  # with larger ones, solvers pass through the singularity
    yield Scene("encounter", title, 4.0, path=path, gear_blocks=(), **facts), problem.with_field(Center())
    for scene, problem in islice(heldout.scenes(folder, quick), heldout.STARTS):
        own = {one.name: getattr(scene, one.name) for one in fields(scene)}
        yield Scene(**own | starts | numbers(30, 2400)), problem


# --- running --------------------------------------------------------------------------------------
def measure(lab, session):
    """Title of the scene -> (column of the error in a row, name -> curves)."""
    found, planned = {}, list(scenes(lab.out / "decks", lab.quick))
    if lab.quick:
        planned = [both for both in planned if both[0].key in QUICK]
    for scene, problem in planned:
        accuracy = {"tolerance": TIGHT} if isinstance(problem.field, Center) else {}
        state = reference_state(problem, scene.end, folder=lab.out / "reference", **accuracy)
        sites = problem.site_positions(state).astype(np.float64)
        ids = getattr(problem.field, "ids", np.arange(1, len(sites) + 1))
        reference = Reference(problem, state, ids, sites)
        with lab.share(1 / len(planned)):
            own = {FIXED: [peers.fixed(session, scene, reference)]} if scene.gear_blocks else {}
            own[TOLERANCE] = peers.controlled(session, scene, reference)
            names = peers.OF_STARTS if scene.measure == "position" else peers.STRONGEST
            names = peers.NAMES if scene.title == CASE1 else names
            names = [name for name in names if name in QUICK_NAMES] if lab.quick else names
            own |= peers.measure(lab, session, scene, reference, names)
        found[scene.title] = COLUMNS[scene.measure], own
        if "ids" in vars(problem.field):
            problem.field.close()
    return found
