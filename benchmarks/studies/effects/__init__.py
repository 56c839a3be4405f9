"""The cost of each effect: instructions counted by valgrind, and time.

scenes.py (bodies on a lattice, one deck for many scenes), plan.py (effects and rungs of the ladder, one row each),
count.py (valgrind's tool callgrind), runs.py (all measurements).
"""

import re

import numpy as np

from benchmarks.engine import Bars, Finding, Measurement, Panel, Study, Table

from . import plan
from .runs import measure

#: functions for output, which are not part of the work of a step
_ASIDE = re.compile(r"Outputs::|::(forces_changed|rounding)\(")
#: largest relative difference between the cost of an effect on the ladder and its cost alone.  It is not zero, because
#: the control of the step takes branches that depend on the data: repeated runs gave 0.0098 to 0.0101.
MOST_APART = 1.5e-2


def number(value):
    """A count as text, with decimals if it is not an integer."""
    return f"{value:.0f}" if abs(value - round(value)) < 5e-4 else f"{value:.3f}"


def row_of(rung):
    """The effect of a rung, None if no row measures it alone."""
    return next((effect for effect in plan.EFFECTS if effect.name == rung.row), None)


# --- measurements -------------------------------------------------------------------------------
def idle_measurements(results):
    """Remaining cost of effects that are off."""
    measurements, free = [], {"spec": ".6g", "least": 0.0, "most": 0.0}
    for effect in plan.EFFECTS:
        if effect.own:
            what = f"{effect.name}, off: instructions of its own functions per body and step"
            measurements.append(Measurement(what, results.idle(effect), **free))
        if effect.never:
            what = f"{effect.name}, off: additional instructions compared with a scene where it is impossible"
            measurements.append(Measurement(what, results.fix(effect.off, effect.never), **free))
    return measurements


def apart(results):
    """Largest relative difference between the cost of an effect on the ladder and alone."""
    gaps = [0.0]
    for rung in plan.LADDER:
        effect = row_of(rung)
        alone = results.fix(effect.on, effect.base) if effect else 0.0
        if alone:  # some versions of LAMMPS compute the virial at every output
            gaps.append(abs(results.fix(rung.on, rung.base) - alone) / alone)
    return max(gaps)


# --- tables -------------------------------------------------------------------------------------
def effects_table(results):
    """Effects: cost if they are on, and remaining cost if they are off."""
    rows = []
    for effect in plan.EFFECTS:
        on = ("needs several ranks", "")
        if effect.on:
            on = (number(results.fix(effect.on, effect.base)),)
            on += (f"{results.nanoseconds(effect.on, effect.base):.0f}",)
        own = number(results.idle(effect)) if effect.own else "none of its own"
        twin = number(results.fix(effect.off, effect.never)) if effect.never else ""
        rows.append([effect.name, *on, own, twin])
    off = ("off: instructions of its own functions", "off: additional instructions compared with an impossible effect")
    return Table(("effect", "on: instructions", "on: ns", *off), rows)


def ladder_table(results):
    """Rungs: cost of a body, difference from the scene without the effect, and cost of the effect alone."""
    rows = []
    for rung in plan.LADDER:
        effect = row_of(rung)
        there = (rung.against, number(results.fix(rung.base))) if rung.base else ("", "")
        more = number(results.fix(rung.on, rung.base)) if rung.base else ""
        alone = number(results.fix(effect.on, effect.base)) if effect else ""
        times = [f"{results.nanoseconds(rung.on, part=part):.0f}" for part in (0, 1)]
        rows.append([rung.name, number(results.fix(rung.on)), *there, more, alone, *times])
    header = ("rung", "instructions in the fix", "compared with", "instructions there")
    header += ("more", "the effect alone")
    return Table((*header, "ns in the fix", "ns in the pair style"), rows)


def short(name):
    """A function's name without namespaces, arguments and redundant spaces."""
    return re.sub(r"LAMMPS_NS::|\bGearQuat::|\bvoid |\(.*", "", name)


def function_table(results, scene=plan.MOVED):
    """Own instructions of the functions in a step of a body with translation and rotation, the largest first."""
    names = results.profiles[scene, results.sizes.counted[1]].own
    counts = {
        name: results.per_body(scene, lambda profile, name=name: profile.own[name])
        for name in names
        if "GearQuat" in name and not _ASIDE.search(name)
    }
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    rows = [[f"`{short(name)}`", f"{count:.0f}"] for name, count in ordered if count >= 1.0]
    return Table(("function", "instructions per body and step"), rows)


# --- picture ------------------------------------------------------------------------------------
def panels(results):
    """The ladder: instructions and time per body and step in the fix, rung by rung."""

    def bars(value):
        whole = np.array([value(rung.on) for rung in plan.LADDER])
        more = np.array([value(rung.on, rung.base) for rung in plan.LADDER])
        return Bars(tuple(rung.name for rung in plan.LADDER), whole - more, more)

    return (
        Panel("Instructions in the fix", "per body and step", "", bars(results.fix)),
        Panel("Time in the fix", "ns per body and step", "", bars(results.nanoseconds)),
    )


def find(results):
    """Finding of runs.Results."""
    idle = idle_measurements(results)
    what = "largest relative deviation from additivity"
    more = Measurement(what, apart(results), most=MOST_APART)
    tables = {
        "effects": effects_table(results),
        "ladder": ladder_table(results),
        "functions": function_table(results),
    }
    context = {
        "not_free": list(dict.fromkeys(m.what.partition(",")[0] for m in idle if m.value != 0)),
        "apart": more,
        "cage": results.cage,
        "sizes": results.sizes,
        "tolerance": plan.TOLERANCE,
        "temp": plan.TEMP,
    }
    return Finding([*idle, more], tables, {"effects": panels(results)}, context)


STUDY = Study("effects", "What each effect costs", 120.0, measure, find)
