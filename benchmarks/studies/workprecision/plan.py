"""What is run: methods, scenes, and the numbers of steps of each.

A method is a set of variables of the decks under ``examples``, so that every run can be repeated by
``lmp -in DECK -var ...``.  A scene is a deck, how long it runs and with how many steps.
"""

from dataclasses import dataclass, replace

FIRST, SECOND, RIGID = "first", "second", "rigid"
#: what the fix takes unless told: formulation, values of each formulation, passes
DEFAULT_FORMULATION, DEFAULT_VALUES, DEFAULT_PASSES = SECOND, {FIRST: 6, SECOND: 8}, 2
PASSES = (1, 2)
#: columns of the log of every scene (examples/common/in.motion), and the further one asked for
TOTAL, NORM, TANGENCY = "v_total", "v_qerror", "f_move[4]"


@dataclass(frozen=True)
class Method:
    """One competitor.  ``family`` is first, second or rigid; ``values`` N and ``passes``, 0 for rigid."""

    key: str
    label: str
    family: str
    values: int
    passes: int
    variables: tuple  # pairs (name, value)


def gear(formulation, values, passes=DEFAULT_PASSES, c0="position", compensate="no"):
    """A setting of fix gear/quat."""
    given = [("formulation", formulation), ("values", values), ("passes", passes)]
    label = f"{formulation}, N = {values}, {passes} pass{'es' if passes > 1 else ''}"
    for name, value, usual in (("c0", c0, "position"), ("compensate", compensate, "no")):
        if value != usual:
            given.append((name, value))
            label += f", {name} {value}"
    key = "-".join(str(value) for _, value in given)
    return Method(key, label, formulation, values, passes, tuple(given))


def rigid(style, variable):
    """One of LAMMPS' own fixes; ``variable``: what the decks call it."""
    label = f"fix {style}"
    return Method(style.replace("/", "-"), label, RIGID, 0, 0, (("method", variable),))


DEFAULTS = {name: gear(name, values) for name, values in DEFAULT_VALUES.items()}
DEFAULT = DEFAULTS[DEFAULT_FORMULATION]
RIGID_NVE, RIGID_SMALL = rigid("rigid/nve/small", "rigid"), rigid("rigid/small", "rigid_verlet")

VALUES = {SECOND: range(4, 13), FIRST: range(3, 9)}
EVERY_N = tuple(gear(name, n, passes) for passes in PASSES for name in VALUES for n in VALUES[name])
ALL_METHODS = (
    *EVERY_N,
    gear(SECOND, 6, c0="velocity"),
    gear(SECOND, DEFAULT_VALUES[SECOND], c0="velocity"),
    RIGID_NVE,
    RIGID_SMALL,
)
#: N of the scenes where a step costs milliseconds, and of a first look
FEW_VALUES = {SECOND: (6, 8, 10), FIRST: (6, 8)}


def _few(*settings):
    """Settings, the defaults and fix rigid's, each once."""
    return tuple(dict.fromkeys((*settings, *DEFAULTS.values(), RIGID_NVE, RIGID_SMALL)))


FEW_METHODS = _few(
    *(gear(name, n) for name in FEW_VALUES for n in FEW_VALUES[name]), gear(SECOND, 8, 1)
)
#: where forces jump
ROUGH_METHODS = _few(gear(SECOND, 6), gear(SECOND, 8), gear(FIRST, 5))


def geometric(first, last, ratio):
    """Whole numbers from ``first`` to ``last``, each about ``ratio`` times the one before."""
    numbers, x = [], float(first)
    while x < last * ratio**0.5:
        numbers.append(min(round(x), last))
        x *= ratio
    return tuple(sorted(set(numbers)))


def half_decades(first, last):
    """1e-first ... 1e-last, two a decade."""
    return tuple(10.0 ** (-k / 2) for k in range(2 * first, 2 * last + 1))


@dataclass(frozen=True, eq=False)
class Scene:
    """A deck and how it is run.

    Every run ends at ``end``; it is sampled ``samples`` times, and its number of steps is a multiple
    of that.  ``blocks``: family or key of a method -> steps between two samples, coarse to fine.
    ``length``, ``time``, ``energy`` are names of units, "" for reduced ones.  ``measure`` is the
    error that prices are for: position or orientation.  ``reference`` names one of references.py.
    ``cost``: seconds a step, and ``solving``: seconds a run of a SciPy solver, roughly, for the
    progress bar; ``tolerances`` are those of the solvers; ``smooth``: whether forces have no jump.
    ``variables``, pairs, go to every run.
    """

    key: str
    title: str
    deck: str
    end: float
    samples: int
    blocks: dict
    methods: tuple
    reference: str
    measure: str = "position"
    length: str = ""
    time: str = ""
    energy: str = ""
    cost: float = 1.3e-6
    solving: float = 0.1
    tolerances: tuple = ()
    smooth: bool = True
    quick: bool = False
    variables: tuple = ()

    def steps(self, method):
        """Numbers of steps that a method is run with, ascending."""
        blocks = self.blocks.get(method.key, self.blocks[method.family])
        return [self.samples * block for block in blocks]


@dataclass(frozen=True)
class Run:
    """One scene, one method, one number of steps."""

    scene: Scene
    method: Method
    steps: int

    @property
    def dt(self):
        """The time step."""
        return self.scene.end / self.steps

    @property
    def name(self):
        """Name of its log."""
        return f"{self.scene.key}_{self.method.key}_{self.steps}"

    def variables(self, sampled, timers=False):
        """Variables of the deck, name -> value.

        ``sampled``: with the samples of the scene, else with output at start and end only;
        ``timers``: with LAMMPS' timers inside the step.
        """
        own = dict(self.scene.variables) | dict(self.method.variables)
        own |= {"dt": f"{self.dt:.17g}", "steps": self.steps, "every": self.steps}
        if sampled:
            own["every"] = max(1, self.steps // self.scene.samples)
            if self.method.family != RIGID:
                own["more"] = TANGENCY
        if timers:
            own["timers"] = "normal"
        return own


# --- scenes ---------------------------------------------------------------------------------------
def _blocks(gear_blocks, rigid_blocks, **others):
    """``blocks`` of a scene."""
    return {FIRST: gear_blocks, SECOND: gear_blocks, RIGID: rigid_blocks, **others}


def _one_body(quick, **facts):
    """A scene of one body, whose steps cost microseconds."""
    ratio = 2.0 if quick else 2 ** (1 / 3)
    own = {} if quick else {RIGID_NVE.key: geometric(16, 1 << 17, 2.0)}  # to where it stops
    blocks = _blocks(
        geometric(8, 256 if quick else 1000, ratio),
        geometric(16, 1 << 10 if quick else 1 << 14, 2.0),
        **own,
    )
    tolerances = half_decades(4, 12) if quick else half_decades(2, 13)
    return Scene(end=200.0, samples=40, blocks=blocks, tolerances=tolerances, quick=quick, **facts)


def case1(quick):
    """Test case 1, consistent body."""
    return _one_body(
        quick,
        key="case1",
        title="One body in the cage (test case 1, consistent body)",
        deck="case1/in.case1",
        methods=FEW_METHODS if quick else ALL_METHODS,
        reference="cage",
    )


def top(quick):
    """Free asymmetric top; its centre of mass rests."""
    return _one_body(
        quick,
        key="top",
        title="Free asymmetric top",
        deck="top/in.top",
        methods=FEW_METHODS if quick else ALL_METHODS,
        reference="free",
        measure="orientation",
    )


def _water(quick, **facts):
    """500 water molecules; units real."""
    blocks = _blocks(
        (2, 4) if quick else (1, 2, 3, 4, 6, 8, 12, 16, 24),
        (2, 4) if quick else (1, 2, 4, 8, 16, 32),
    )
    return Scene(
        deck="water/in.water",
        end=8.0 if quick else 48.0,
        samples=2 if quick else 12,
        blocks=blocks,
        length="Å",
        time="fs",
        energy="kcal/mol",
        cost=7e-3,
        solving=8.0,
        quick=quick,
        **facts,
    )


def water(quick):
    """Water with forces that are smooth at the cut-off."""
    return _water(
        quick,
        key="water",
        title="500 SPC/E molecules, smooth at the cut-off",
        reference="deck",
        methods=FEW_METHODS,
        tolerances=() if quick else (1e-4, 1e-6, 1e-8, 1e-10, 1e-12),
        variables=(("forces", "smooth"),),
    )


def water_plain(quick):
    """Water with a plain cut-off, where forces jump."""
    return _water(
        quick,
        key="water-plain",
        title="500 SPC/E molecules, plain cut-off",
        reference="finest",
        methods=ROUGH_METHODS,
        smooth=False,
        variables=(("forces", "plain"),),
    )


SCENES = {"case1": case1, "top": top, "water": water, "water-plain": water_plain}

# --- further runs, test case 1 only ---------------------------------------------------------------
#: steps between samples of the runs that show the order of each N
ORDER_BLOCKS = geometric(20, 400, 2**0.125)
ROUNDING_STEPS = (0.02, 0.01, 0.005, 0.002, 0.001)
#: steps of the runs that time the fix itself
MODIFY_STEPS, MODIFY_DT = 200_000, 0.02
MODIFY = (RIGID_NVE, DEFAULTS[SECOND], DEFAULTS[FIRST], RIGID_SMALL)


def _case1(scenes):
    return [scene for scene in scenes if scene.key == "case1" and not scene.quick]


def order_runs(scenes):
    """Runs of every N with compensated sums, so that rounding hides as little as possible."""
    return [
        Run(scene, gear(name, n, compensate="yes"), block * scene.samples)
        for scene in _case1(scenes)
        for name in VALUES
        for n in VALUES[name]
        for block in ORDER_BLOCKS
    ]


def rounding_runs(scenes):
    """Runs with small steps, with and without compensated sums, in both formulations."""
    return [
        Run(scene, gear(name, values, compensate=word), round(scene.end / dt))
        for scene in _case1(scenes)
        for name, values in DEFAULT_VALUES.items()
        for word in ("no", "yes")
        for dt in ROUNDING_STEPS
    ]


def modify_runs(scenes):
    """Long runs that time the fix itself."""
    return [
        Run(replace(scene, end=MODIFY_STEPS * MODIFY_DT), method, MODIFY_STEPS)
        for scene in _case1(scenes)
        for method in MODIFY
    ]
