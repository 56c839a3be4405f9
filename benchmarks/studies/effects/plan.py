"""The measured effects, one row each, and the rungs of the ladder.

A new effect of the fix needs another Effect here, and another Rung if it belongs on the ladder.
"""

from dataclasses import dataclass, replace
from functools import partial

from .scenes import Scene

FULL = Scene()  # no force on the bodies
MOVED = replace(FULL, forces="neutral")
POINTS = replace(MOVED, shape="point")
LINEAR = replace(MOVED, shape="linear")
CHARGED = replace(MOVED, forces="charged")
EACH, CHARGED_EACH = replace(MOVED, each=True), replace(CHARGED, each=True)
#: MOVED, and everything on the ladder from the virial on, with further settings
moved, charged_each = partial(replace, MOVED), partial(replace, CHARGED_EACH)
#: step control that does all its work but never changes the step, so that equal steps are compared
TOLERANCE = "tolerance 1.0 dtmin 0.0005 dtmax 0.0005"
#: Gauss's principle needs the first formulation and its own step
FIRST = "formulation first"
ISOKINETIC = f"{FIRST} isokinetic total"
TEMP = "temp 300.0 300.0 0.1"
#: functions that solve a chain once per step: their instructions depend on the motion, not on the number of bodies
ONCE_A_STEP = r"GearQuat::Chain(Drive)?::"
#: functions that correct all bodies together
TOGETHER = r"|GearQuat::Bath::(correct|add|find_friction)\("
SET = "set group all"
PERIODIC = replace(FULL, boundary="p p p")
UNSIZED, SIZED = (
    replace(FULL, style="hybrid sphere full", before=f"{SET} mass 12.0\n{SET} diameter {diameter}")
    for diameter in (0.0, 0.5)
)


@dataclass(frozen=True)
class Effect:
    """An effect: ``on`` differs from ``base`` only by the effect; without ``on`` it is impossible on one rank.

    ``own``: pattern of the names of functions only for this effect, "" for none.  ``off``: a scene in which the effect
    is possible but not needed; ``never``: the same scene with the effect impossible.
    """

    name: str
    on: Scene
    base: Scene
    own: str = ""
    off: Scene = None
    never: Scene = None

    @property
    def idle(self):
        """The scene in which the effect's own functions must not run."""
        return self.off or self.base


@dataclass(frozen=True)
class Rung:
    """A rung: ``on`` has one effect more than ``base``; both have all effects of the rungs below.

    ``row``: name of the Effect that measures the same without the rungs below, "" if there is none.
    ``against``: description of ``base``.
    """

    name: str
    on: Scene
    base: Scene = None
    row: str = ""
    against: str = "the row above"


EFFECTS = (
    Effect(
        "rotation",
        MOVED,
        POINTS,
        own=r"GearQuat::(Integrator|Kinematics)::(correct|body_state|correct_all<.*>)\("
        r"|GearQuat::Bodies::update_frame\(",
    ),
    Effect("torques of forces", MOVED, FULL, own=r"GearQuat::Sites::gather"),
    Effect("finite size", SIZED, UNSIZED, own=r"GearQuat::Extended::", off=UNSIZED, never=FULL),
    Effect(
        "images",
        replace(PERIODIC, crossing=True),
        PERIODIC,
        own=r"GearQuat::Sites::place_points<\w+, \w+, true>",
        off=PERIODIC,
        never=FULL,
    ),
    Effect(
        "virial",
        replace(EACH, columns="press"),
        EACH,
        own=r"::(tally_virial|v_tally|visit_constraint_forces)\(",
        off=MOVED,
        never=moved(after="fix_modify move virial no"),
    ),
    Effect(
        "ghost bodies", None, MOVED, own=r"GearQuat::Ownership::(un)?pack_|FixGearQuat::(un)?pack_"
    ),
    Effect("predicted velocities", moved(after="fix reads all viscous 0.0"), MOVED),
    Effect(
        "changing step",
        moved(words=TOLERANCE),
        MOVED,
        own=r"GearQuat::Tolerance::|GearQuat::RememberedLoads::",
    ),
    Effect(
        "masks",
        moved(words="force * on on off"),
        MOVED,
    ),
    Effect(
        "isokinetic",
        moved(words=ISOKINETIC),
        moved(words=FIRST),
        own=r"GearQuat::IsokineticConstraint::" + TOGETHER,
    ),
    Effect("temp", moved(words=TEMP), MOVED, own=r"GearQuat::Temperature::" + TOGETHER),
    Effect("compensated sums", moved(words="compensate yes"), MOVED),
)

LADDER = (
    Rung("point particles", POINTS),
    Rung("linear bodies", LINEAR, POINTS),
    Rung("full bodies", MOVED, LINEAR),
    Rung("charges", CHARGED, MOVED),
    # without forces bodies remember fewer loads, so the cost is not that of the effect alone
    Rung("changing step", replace(CHARGED, words=TOLERANCE), CHARGED),
    Rung(
        "virial",
        charged_each(words=TOLERANCE, columns="press"),
        charged_each(words=TOLERANCE),
        "virial",
        "the row above with output in every step",
    ),
    Rung(
        "isokinetic",
        charged_each(words=ISOKINETIC, columns="press"),
        charged_each(words=FIRST, columns="press"),
        "isokinetic",
        f"charges and virial with `{FIRST}`",
    ),
)


def scenes():
    """All scenes, each once, in order."""
    every = [(effect.on, effect.base, effect.off, effect.never) for effect in EFFECTS]
    every += [(rung.on, rung.base) for rung in LADDER]
    return list(dict.fromkeys(scene for row in every for scene in row if scene))
