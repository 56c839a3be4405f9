"""Scenes in which the fix is compared with other methods, and their runs.

The first is test case 1.  Two are in the middle of its cage, where forces are weak and the body turns slowly or fast.
Two molecules of water vibrate about a hydrogen bond, and a charge passes a fixed one at a small distance, where only
methods that control their steps are of use.  Ten random starts near test case 1 were not used to choose any
coefficient.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.engine.decks import EXAMPLES, SCENES
from benchmarks.reference import Cage, Problem, State, paper_problem
from benchmarks.reference import quaternion as qt
from benchmarks.reference.lammps_forces import deck_problem
from benchmarks.reference.paper import SITE_MASSES, SITES
from benchmarks.studies import accuracy
from benchmarks.studies.accuracy import Reference, geometric

from . import peers

CASE1 = "Test case 1"
#: seed and number of the random starts, and their largest distance from test case 1 along each axis
SEED, STARTS, AWAY = 2026, 10, 4.0
#: angular velocity in the weak field, along the principal axes, and the factor of the fast rotation
OMEGA, FASTER = (0.2, 0.3, 0.12), 8
#: half of the angle of a molecule, distance of the oxygen atoms in angstrom, unit of the rates below in fs
HALF, APART, FS = 109.47 / 2, 2.9, 48.88821291
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

HEAD = """\
# {title}
units {units}
atom_style full
atom_modify map array sort 0 0.0
boundary f f f
region box block -50 50 -50 50 -50 50
create_box {types} box
{atoms}
{forces}
neighbor 5.0 nsq
neigh_modify once yes exclude molecule/intra all
group body molecule > 0
variable dt index 1
variable steps index 1
variable every index 1
variable out index out
include {motion}
"""
WATER = """\
pair_style lj/cut/coul/cut 90.0
pair_coeff * * 0.0 1.0
pair_coeff 1 1 0.1553 3.166
mass 1 15.9994
mass 2 1.008
set type 1 charge -0.8476
set type 2 charge 0.4238"""


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
    ``evaluations``: approximate numbers for splittings; ``path`` of the deck, if it is not one of benchmarks/scenes.
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
    lines = (EXAMPLES / "case1" / "data.consistent").read_text().splitlines()
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


def _atoms(bodies, kinds, motions):
    """Commands that create ``bodies``, arrays (n, 3) of sites, with pairs of velocity and angular velocity."""
    lines, number = [], 0
    for molecule, (sites, (velocity, omega)) in enumerate(zip(bodies, motions), 1):
        middle = sites.mean(axis=0)
        for kind, place in zip(kinds, sites):
            number += 1
            v = velocity + np.cross(omega, place - middle)
            x, y, z = (f"{c:.15g}" for c in place)
            lines.append(f"create_atoms {kind} single {x} {y} {z}")
            lines.append(f"set atom {number} mol {molecule} vx {v[0]:.15g} vy {v[1]:.15g} vz {v[2]:.15g}")
    return "\n".join(lines)


def _deck(folder, name, units, types, forces, *bodies_kinds_motions):
    """Path of a deck that it writes, with the methods and outputs of benchmarks/scenes."""
    path, motion = folder / f"in.{name}", SCENES / "in.motion"
    atoms = _atoms(*bodies_kinds_motions)
    path.write_text(HEAD.format(title=name, units=units, types=types, atoms=atoms, forces=forces, motion=motion))
    return str(path)


def _pair(folder):
    """Deck of two molecules of water, the first a donor."""
    s, c = np.sin(np.radians(HALF)), np.cos(np.radians(HALF))
    sites = np.array([(0, 0, 0), (s, c, 0), (-s, c, 0)])
    turns = Rotation.from_euler("z", HALF - 90, degrees=True), Rotation.from_euler("zx", (-90, 60), degrees=True)
    bodies = [turn.apply(sites) + (x * APART / 2, 0, 0) for turn, x in zip(turns, (-1, 1))]
    rates = np.array([((0, 0.12, 0.1), (0.3, 0.2, -0.4)), ((0, -0.12, -0.1), (-0.3, 0.4, 0.2))]) / FS
    return _deck(folder, "pair", "real", 2, WATER, bodies, (1, 2, 2), rates)


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
    path = _pair(folder)
    yield scene("pair", "Two molecules of water, 1 ps", 20 * FS, 150, 3000, path=path), deck_problem(path)
    path, title = _encounter(folder), "A charge that passes a fixed one at a small distance"
    problem = deck_problem(path)
    problem.field.close()
    # with larger tolerances, solvers pass through the singularity
    yield scene("encounter", title, 4.0, path=path, tolerances=tolerances[4:]), problem.with_field(Center())
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
        if "ids" in vars(problem.field):
            problem.field.close()
    return found
