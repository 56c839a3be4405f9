"""Scenes in which the fix is compared with other methods, and their runs.

The first is test case 1.  Two are in the middle of its cage, where forces are weak and the body turns slowly or fast.
A charge passes a fixed one at a small distance, where only methods that control their steps are of use.  Ten random starts near test case 1 were not used to choose any
coefficient.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.engine.decks import EXAMPLES, deck
from benchmarks.reference import Cage, Problem, State, bodies_from_sites, paper_problem
from benchmarks.reference import quaternion as qt
from benchmarks.reference.paper import SITE_MASSES, SITES
from benchmarks.studies import accuracy
from benchmarks.studies.accuracy import Reference, geometric

from . import peers

CASE1 = "Test case 1"
#: seed and number of the random starts, and their largest distance from test case 1 along each axis
SEED, STARTS, AWAY = 2026, 10, 4.0
#: angular velocity in the weak field, along the principal axes, and the factor of the fast rotation
OMEGA, FASTER = (0.2, 0.3, 0.12), 8
#: distance at which the charge would pass the fixed one without forces
PASSES = 0.02
#: tolerance of the reference there; below it, rounding ends the extrapolation
TIGHT = 1e-14
#: keys of the fix, beside the names of the other methods
FIXED, TOLERANCE = "default settings", "`tolerance`"
#: keys of the scenes, and methods, of quick runs
QUICK = ("case1", "case1-weak", "encounter", "case1-start7")
QUICK_NAMES = ("DDEABM", "Quinlan–Tremaine 8", "SABA4, 4 stages")
#: columns of the errors in the rows of peers.py
COLUMNS = {"position": 2, "orientation": 3, "sites": 4}

ENCOUNTER = """\
# a charge passes a fixed one
units lj
atom_style full
atom_modify map array sort 0 0.0
boundary f f f
region box block -50 50 -50 50 -50 50
create_box 4 box
{atoms}
create_atoms 4 single 0 0 0
set type 4 charge 1.0
mass 4 1.0
pair_style coul/cut 90.0
pair_coeff * *
neighbor 5.0 nsq
neigh_modify once yes exclude molecule/intra all
group body molecule > 0
variable dt index 1
variable steps index 1
variable every index 1
variable out index out
include {motion}
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
class Scene(accuracy.Scene):
    """A scene of the study of accuracy, whose error may also be that of "sites".

    ``steps``: numbers of steps of the fix, ascending; ``tolerances`` of methods that control their steps;
    ``evaluations``: approximate numbers for splittings; ``path`` of the deck, if it is not one of the examples.
    """

    steps: tuple = ()
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


def random_starts():
    """Problems of the body of test case 1, displaced along each axis, in random orientations."""
    base, random = paper_problem(1), np.random.default_rng(SEED)
    length = np.linalg.norm(base.start.omega_body.astype(float))
    for number in range(1, STARTS + 1):
        center = base.start.center + random.uniform(-AWAY, AWAY, (1, 3))
        directions = random.normal(size=(2, 1, 3))
        velocity, omega = directions / np.linalg.norm(directions, axis=2, keepdims=True)
        q = qt.normalised(random.normal(size=(1, 4)).astype(base.dtype))
        start = State(center, 0.2 * velocity, q, length * omega).astype(base.dtype)
        yield Problem(f"start {number}", base.bodies, base.field, start)


def write_data(path, problem):
    """Write the data file of test case 1 with atoms 1 to 4 (the body) at their positions in a Problem.

    Returns variables of the deck that name the file.
    """
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
    path.with_suffix(".consistent").write_text("\n".join(lines) + "\n")
    return (("data", str(path)),)


def _in_the_middle(omega):
    """The body of test case 1 in the middle of the cage."""
    base = paper_problem(1)
    numbers = (0, 0, 0), (0.02, -0.01, 0.015)
    center, velocity = (np.array([row], dtype=base.dtype) for row in numbers)
    start = State(center, velocity, base.start.q, np.array([omega], dtype=base.dtype))
    return Problem("middle of the cage", base.bodies, base.field, start)


def _encounter(folder):
    """(Path of a deck that it writes, Problem): a body without rotation whose third charge passes a fixed one."""
    sites = np.array(SITES, dtype=float)
    places = Rotation.from_euler("zxz", (20, 90, 10), degrees=True).apply(sites - sites[2]) + (PASSES, -1, 0)
    places = np.array([[float(f"{x:.15g}") for x in place] for place in places])
    lines = []
    for k, (place, kind) in enumerate(zip(places, (1, 1, 2, 3)), 1):
        lines.append(f"create_atoms {kind} single {' '.join(f'{x:.15g}' for x in place)}")
        lines.append(f"set atom {k} mol 1 vx 0 vy 0.4 vz 0")
    for kind in (1, 2, 3):
        lines += [f"mass {kind} {SITE_MASSES[kind]}", f"set type {kind} charge {Center.SITE_CHARGES[kind]}"]
    path = folder / "in.encounter"
    path.write_text(ENCOUNTER.format(atoms="\n".join(lines), motion=EXAMPLES / "common" / "in.motion"))
    body = np.zeros(4, dtype=int)
    shapes, start = bodies_from_sites(np.array(SITE_MASSES, float), places, np.tile([0.0, 0.4, 0.0], (4, 1)), body)
    return str(path), Problem("encounter", shapes, Center(), start)


def scenes(folder, quick=False):
    """(Scene, Problem) of all scenes; files that they read are written to ``folder``."""
    folder = Path(folder).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    ratio = 2.0 if quick else 2**0.25
    tolerances = half_decades(2, 8) if quick else half_decades(1, 13)

    def scene(key, title, end, first=0, last=0, measure="sites", tolerances=tolerances, **more):
        if last:
            more |= {"steps": geometric(first, last, ratio), "evaluations": geometric(first, 2 * last, ratio**2)}
        return Scene(key, title, end, measure, tolerances=tolerances, **more)

    yield scene("case1", CASE1, 200.0, 300, 6000, "position"), paper_problem(1)
    for key, title, end, factor, last in (
        ("weak", "Weak field, 200 time units", 200.0, 1, 3000),
        ("spin", "Fast rotation, 49 turns in a weak field", 100.0, FASTER, 9000),
    ):
        problem = _in_the_middle(factor * np.array(OMEGA))
        yield scene(f"case1-{key}", title, end, 40, last, variables=write_data(folder / key, problem)), problem
    path, problem = _encounter(folder)
    title = "A charge that passes a fixed one at a small distance"
    # with larger tolerances, solvers pass through the singularity
    yield scene("encounter", title, 4.0, path=path, tolerances=tolerances[4:]), problem
    for number, problem in enumerate(random_starts(), 1):
        variables = write_data(folder / f"start{number}", problem)
        yield scene(f"case1-start{number}", problem.name, 100.0, 30, 2400, "position", variables=variables), problem


# --- running --------------------------------------------------------------------------------------
def measure(lab, session):
    """Title of the scene -> (column of the error in a row, name -> curves)."""
    found, planned = {}, list(scenes(lab.out / "decks", lab.quick))
    if lab.quick:
        planned = [both for both in planned if both[0].key in QUICK]
    for scene, problem in planned:
        reference = Reference.of(problem, scene.end, TIGHT if isinstance(problem.field, Center) else None)
        own = {FIXED: [peers.fixed(session, scene, reference)]} if scene.steps else {}
        own[TOLERANCE] = peers.controlled(session, scene, reference)
        names = peers.OF_STARTS if scene.title.startswith("start") else peers.NAMES
        names = [name for name in names if name in QUICK_NAMES] if lab.quick else names
        own |= peers.measure(lab, scene, reference, names)
        found[scene.title] = COLUMNS[scene.measure], own
    return found
