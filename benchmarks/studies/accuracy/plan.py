"""Methods, scenes and their numbers of steps.

A method is a set of variables of the decks in ``examples``, so that every run can be repeated by
``lmp -in DECK -var ...``.  A scene is a deck with a duration and numbers of steps.
"""

import itertools
from dataclasses import dataclass, replace
from functools import cache

from benchmarks.engine import decks
from benchmarks.engine.methods import AUTOMATIC, DEFAULT_VALUES, DEFAULTS, gear, rigid

#: columns in the log of every scene (examples/common/in.motion), and an additional one
TOTAL, NORM, TANGENCY = "v_total", "v_qerror", "f_move[4]"
VALUES = {"momentum": range(4, 13), "second": range(4, 13), "first": range(3, 9)}
#: the fix without keywords
DEFAULT = AUTOMATIC
RIGID_NVE, RIGID_SMALL = rigid("rigid/nve/small", "rigid"), rigid("rigid/small", "rigid_verlet")
ALL_METHODS = (
    *(gear(name, n) for name in VALUES for n in VALUES[name]),
    DEFAULT,
    RIGID_NVE,
    RIGID_SMALL,
)
METHODS = {method.key: method for method in ALL_METHODS}


def _few(*settings):
    """Settings, the defaults and LAMMPS' own fixes, each once."""
    return tuple(dict.fromkeys((*settings, *DEFAULTS.values(), DEFAULT, RIGID_NVE, RIGID_SMALL)))


#: methods of scenes with steps of milliseconds and of quick runs, and of scenes with discontinuous forces
FEW_METHODS = _few(*(gear("momentum", n) for n in (5, 7, 11)))
ROUGH_METHODS = _few(gear("momentum", 5))


def geometric(first, last, ratio):
    """Integers from ``first`` to ``last``, each about ``ratio`` times the one before."""
    numbers, x = [], float(first)
    while x < last * ratio**0.5:
        numbers.append(min(round(x), last))
        x *= ratio
    return tuple(sorted(set(numbers)))


@dataclass(frozen=True, eq=False)
class Scene:
    """A deck and the parameters of its runs.

    * ``end``: end of every run; ``samples``: number of samples, which divides the number of steps
    * ``gear_blocks``, ``rigid_blocks``: steps between two samples, ascending; ``far``: the same for
      fix rigid/nve/small, if different
    * ``measure``: the error for which costs are given, position or orientation
    * ``time``: unit of time, "" for reduced units
    * ``cost``: approximate seconds per step; ``minutes``: approximate duration of all runs
    * ``smooth``: True if forces have no jump
    """

    key: str
    title: str
    end: float
    samples: int
    gear_blocks: tuple
    rigid_blocks: tuple
    methods: tuple
    measure: str = "position"
    time: str = ""
    cost: float = 1.3e-6
    minutes: float = 15.0
    smooth: bool = True
    far: tuple = ()
    variables: tuple = ()

    @property
    def deck(self):
        """Path of the input script."""
        return decks.deck(self.key.partition("-")[0])

    @property
    def heading(self):
        """Description of the scene and the duration of its runs."""
        time = f"{self.end:g} {self.time}" if self.time else f"t = {self.end:g}"
        return f"{self.title}, {time}"

    def steps(self, method):
        """Numbers of steps of the runs of a method, ascending."""
        blocks = self.gear_blocks if method.gear else self.rigid_blocks
        if method == RIGID_NVE and self.far:
            blocks = self.far
        return [self.samples * block for block in blocks]


@dataclass(frozen=True)
class Run:
    """One scene, one method, one number of steps."""

    scene: Scene
    method: object
    steps: int

    @property
    def dt(self):
        """The time step."""
        return self.scene.end / self.steps

    @property
    def cost(self):
        """Approximate duration in seconds, with the start of LAMMPS and reading the scene."""
        return 0.006 + self.scene.cost * self.steps

    @property
    def name(self):
        """Name of its log."""
        return f"{self.scene.key}_{self.method.key}_{self.steps}"

    def variables(self, sampled, timers=False):
        """Variables of the deck, name -> value.

        ``sampled``: output at the samples of the scene, instead of at start and end only;
        ``timers``: use LAMMPS' timers inside the step.
        """
        own = dict(self.scene.variables) | self.method.variables
        own |= {"dt": f"{self.dt:.17g}", "steps": self.steps, "every": self.steps}
        if sampled:
            own["every"] = max(1, self.steps // self.scene.samples)
            if self.method.gear:
                own["more"] = TANGENCY
        if timers:
            own["timers"] = "normal"
        return own

    def perform(self, session, sampled=False, timers=False):
        """Its Outcome in a Session; options as in ``variables``."""
        return session.run(self.scene.deck, self.variables(sampled, timers), self.name, self.cost)


# --- scenes ---------------------------------------------------------------------------------------
def _one_body(quick, **facts):
    """A scene of one body, with steps of microseconds."""
    facts |= {"end": 200.0, "samples": 40, "methods": FEW_METHODS if quick else ALL_METHODS}
    if quick:
        blocks, rigid_blocks, far = geometric(8, 256, 2.0), geometric(16, 1 << 10, 2.0), ()
    else:
        blocks, rigid_blocks = geometric(8, 1000, 2 ** (1 / 3)), geometric(16, 1 << 14, 2.0)
        far = geometric(16, 1 << 17, 2.0)  # down to the round-off error
    facts |= {"gear_blocks": blocks, "rigid_blocks": rigid_blocks, "far": far}
    return Scene(**facts)


def _water(quick, forces, **facts):
    """500 water molecules; units real."""
    facts |= {"time": "fs", "cost": 7e-3, "minutes": 5.0}
    facts |= {"end": 8.0 if quick else 48.0, "samples": 2 if quick else 12}
    facts["gear_blocks"] = (2, 4) if quick else (1, 2, 3, 4, 6, 8, 12, 16, 24)
    facts["rigid_blocks"] = (2, 4) if quick else (1, 2, 4, 8, 16, 32)
    return Scene(variables=(("forces", forces),), **facts)


@cache
def scenes(quick):
    """Key -> Scene, all of them."""
    cage = "One body in the cage (test case 1, consistent body)"
    smooth, plain = (f"500 SPC/E molecules, {how} cutoff" for how in ("smooth at the", "plain"))
    found = (
        _one_body(quick, key="case1", title=cage),
        _one_body(quick, key="top", title="Free asymmetric top", measure="orientation"),
        _water(quick, "smooth", key="water", title=smooth, methods=FEW_METHODS),
        _water(quick, "plain", key="water-plain", title=plain, methods=ROUGH_METHODS, smooth=False),
    )
    return {scene.key: scene for scene in found}


# --- further runs, test case 1 only ---------------------------------------------------------------
#: steps of the runs for round-off, and of the runs that time the fix
ROUNDING_STEPS = (0.02, 0.01, 0.005, 0.002, 0.001)
MODIFY_STEPS, MODIFY_DT = 200_000, 0.02
MODIFY = (RIGID_NVE, DEFAULT, DEFAULTS["second"], DEFAULTS["first"], RIGID_SMALL)


def scene_runs(scene):
    """Runs of all methods of a scene."""
    return [Run(scene, method, steps) for method in scene.methods for steps in scene.steps(method)]


def order_runs(scene, quick):
    """(formulation, N) -> runs with compensated sums, to reduce round-off."""
    runs, blocks = {}, geometric(20, 400, 2**0.5 if quick else 2**0.125)
    for name, n in ((name, n) for name in VALUES for n in VALUES[name]):
        method = gear(name, n, compensate=True)
        runs[name, n] = [Run(scene, method, block * scene.samples) for block in blocks]
    return runs


def rounding_runs(scene, quick):
    """(formulation, True for compensated sums) -> runs with small steps."""
    runs, steps = {}, ROUNDING_STEPS[:2] if quick else ROUNDING_STEPS
    for name, compensate in itertools.product(DEFAULT_VALUES, (False, True)):
        method = gear(name, DEFAULT_VALUES[name], compensate)
        runs[name, compensate] = [Run(scene, method, round(scene.end / dt)) for dt in steps]
    return runs


def modify_runs(scene, quick):
    """Long runs for the time in the fix."""
    steps = MODIFY_STEPS // 20 if quick else MODIFY_STEPS
    return [Run(replace(scene, end=steps * MODIFY_DT), method, steps) for method in MODIFY]
