"""doc/effects.md: every number on it comes from Results."""

import re
from pathlib import Path

from benchmarks.engine.checkout import provenance, write_page
from benchmarks.engine.tables import markdown_table, write_csv
from . import plan

COMMAND = "benchmarks/run effects --publish"
PAGE, PICTURE, FOLDER = "effects.md", "effects.png", "effects"
CAPTION = (
    "The ladder: what a body costs in a step of the fix, by rung; instructions (left) and time."
)


def number(value):
    """A count as text: whole, or with what is broken."""
    return f"{value:.0f}" if abs(value - round(value)) < 5e-4 else f"{value:.3f}"


def _time(results, on, base=None):
    """Nanoseconds, or what ``on`` takes more than ``base``."""
    more = results.nanoseconds(on) - (results.nanoseconds(base) if base else 0.0)
    return f"{more:.0f}"


# --- tables ---------------------------------------------------------------------------------------
def effects_table(results):
    """Effects: what they add where they are on, what is left of them where they are not."""
    header = ["effect", "on: instructions", "on: ns", "off: own functions", "off: beside never"]
    rows = []
    for effect in plan.EFFECTS:
        on = (
            ("needs ranks", "")
            if effect.on is None
            else (
                number(results.fix(effect.on) - results.fix(effect.base)),
                _time(results, effect.on, effect.base),
            )
        )
        own = number(results.idle(effect)) if effect.own else "has none"
        twin = number(results.fix(effect.off) - results.fix(effect.never)) if effect.never else ""
        rows.append([effect.name, *on, own, twin])
    return header, rows


def row_of(rung):
    """The effect that a rung adds, None if no row measures it alone."""
    return next((effect for effect in plan.EFFECTS if effect.name == rung.row), None)


def ladder_table(results):
    """Rungs: what a body costs, what that is more than below, and what its row says."""
    header = ["rung", "instructions in the fix", "more than below", "its row alone"]
    header += ["ns in the fix", "ns in the pair style"]
    rows = []
    for rung in plan.LADDER:
        more = number(results.fix(rung.on) - results.fix(rung.base)) if rung.base else ""
        effect = row_of(rung)
        alone = number(results.fix(effect.on) - results.fix(effect.base)) if effect else ""
        pair = f"{results.nanoseconds(rung.on, 1):.0f}"
        line = [rung.name, number(results.fix(rung.on)), more, alone, _time(results, rung.on), pair]
        rows.append(line)
    return header, rows


def function_table(results, scene=plan.MOVED):
    """Own instructions of the functions that a full body's step is made of, the largest first."""
    high = results.sizes.counted[1]
    names = results.profiles[scene, high].own
    found = {
        name: results.per_body(scene, lambda profile, name=name: profile.own[name])
        for name in names
        if "GearQuat" in name and "BodyTable" not in name
    }
    rows = [
        [f"`{short(name)}`", number(count)]
        for name, count in sorted(found.items(), key=lambda item: -item[1])
        if count >= 1.0
    ]
    return ["function", "instructions a body and step"], rows


def short(name):
    """A function's name without namespaces, arguments and spaces that mean nothing."""
    return re.sub(r"LAMMPS_NS::|\bGearQuat::|\bvoid |\(.*", "", name)


# --- sentences ------------------------------------------------------------------------------------
def off_sentence(results):
    """Whether anything is left of an effect that is off."""
    left = [e.name for e in plan.EFFECTS if e.own and abs(results.idle(e)) > 0]
    twins = [e for e in plan.EFFECTS if e.never]
    differ = [e.name for e in twins if abs(results.fix(e.off) - results.fix(e.never)) > 0]
    if left or differ:
        return "Not free when off: " + ", ".join(dict.fromkeys(left + differ)) + "."
    return (
        "Of every effect that is off, 0 instructions a body and step are executed: none in the "
        "functions that are its own, and where a scene without the possibility of it exists, the "
        "two counts are equal to the instruction."
    )


def ladder_sentence(results):
    """How far a rung is from its own row, the largest of all."""
    gaps = []
    for rung in plan.LADDER:
        effect = row_of(rung)
        if effect:
            more = results.fix(rung.on) - results.fix(rung.base)
            alone = results.fix(effect.on) - results.fix(effect.base)
            if alone != 0.0:  # some versions of LAMMPS ask for the virial whenever they print
                gaps.append(abs(more - alone) / alone)
    return (
        "A rung costs more only by its own row: what it adds on top of all below and what its effect "
        f"adds to a plain body differ by {max(gaps):.2%} at most. Charges add nothing in the fix; "
        "their cost is the pair style's."
    )


def cage_sentence(results):
    """What the exclusions proposed by the report are worth in the paper's cage."""
    cage = results.cage
    return (
        f"In the paper's cage the list has {cage.pairs} pairs. With the lines that the scene report "
        f"proposes it has {cage.left}, and a step takes {1e6 * min(cage.mended):.2f} µs instead of "
        f"{1e6 * min(cage.plain):.2f} µs, {cage.speedup:.1f} times less (the least of "
        f"{len(cage.plain)})."
    )


# --- the page -------------------------------------------------------------------------------------
def page_text(out, results, picture=PICTURE):
    """The page; ``out``: folder of the run, ``picture``: where the picture is, from the page."""
    low, high = results.sizes.counted
    lines = [
        "# What each effect costs",
        "",
        f"Written by `{COMMAND}`; do not edit. {provenance(out, ('lammps-gearquat',))}",
        "",
        f"![{CAPTION}]({picture})",
        "",
        f"*{CAPTION}*",
        "",
        "The fix looks at the scene before a run and leaves out what it does not call for; its report "
        "in the log says what, and why. " + off_sentence(results),
        "",
        "## The ladder",
        "",
        ladder_sentence(results),
        "",
        *markdown_table(*ladder_table(results)),
        "",
        "## Effects",
        "",
        *markdown_table(*effects_table(results)),
        "",
        "## Where the instructions of a full body are",
        "",
        *markdown_table(*function_table(results)),
        "",
        "## Surroundings",
        "",
        cage_sentence(results),
        "",
        "## How it was measured",
        "",
        "- `valgrind --tool=callgrind` on one LAMMPS program and one run, all scenes in it; counted are the",
        f"  steps alone, {results.sizes.counted_steps} of each scene, without start and output.",
        f"- Instructions a body and step: the difference of {high**3} and {low**3} bodies, so what is done once a",
        "  step (the tests whether an effect is on) is not in it.",
        '- Bodies of three sites, points of one, formulation *second* with its defaults. "On" is what the',
        "  effect adds to the same scene without it; rotation adds to points two sites as well.",
        f"- With a changing step, and below it, the fix has `{plan.FIXED}`, and the tolerance leaves the step",
        "  where it is: the same steps are compared. The thermostat is `isokinetic total`, its scenes are of",
        "  formulation *first*; it cannot be had with a changing step.",
        '- "Off: own functions": instructions in functions that serve this effect only, in a scene that does',
        '  not call for it. "Off: beside never": such a scene less one where it cannot be (virial:',
        "  `fix_modify virial no`; finite size: no radius; images: no periodic direction).",
        f"- Times: LAMMPS' timers, {results.sizes.timed**3} bodies, {results.sizes.timed_steps} steps, the least of "
        f"{results.sizes.rounds}; differences of a few ns are noise.",
    ]
    return "\n".join(lines) + "\n"


def write(out, results):
    """The page and its tables in the folder of the run."""
    out = Path(out)
    for name, table in (("effects", effects_table), ("ladder", ladder_table)):
        write_csv(out / f"{name}.csv", *table(results))
    (out / PAGE).write_text(page_text(out, results), encoding="utf-8")


def publish(folder, out, results):
    """Write page and picture into a checkout."""
    text = page_text(out, results, f"{FOLDER}/{PICTURE}")
    write_page(folder, FOLDER, text, [Path(out) / PICTURE])
