"""What `tests/run foreign --all` found, as doc/foreign.md."""

import datetime
import os
import platform
from collections import Counter

from benchmarks.engine.provenance import processor, system

from . import decks, neighbors, scene

COMMAND = "tests/run foreign --all --publish"
VERDICTS = ("agrees", "refused", "runs", "not run", "NEITHER")
RELEASES = {"oldest": "4 Feb 2025", "newest": "4 Jul 2026"}
RESULTS = ("same", "acts", "warned", "refused", "LAMMPS refuses", "DIFFERS")

TEXT = """# LAMMPS as judge

<!-- written by `{command}` -->

LAMMPS' own input scripts, styles and unit tests, none of them written for this fix, run with it.
{where}
{left_out}

## Decks

Each deck in LAMMPS' `examples` and `bench` that has a rigid fix is converted by a program: the
rigid style gives way to `gear/quat`, an atom map is added if the message asks for one, and runs are
shortened. The whole deck has to run. Then it is followed with its own fix for up to {first} steps, and
from there for {steps} steps with either fix; fixes that draw random numbers, insert or remove atoms,
or act once in so many steps are left out of these. A deck *agrees* if positions and velocities of
all atoms are within {within:g} times the error of fix rigid at a quarter of the deck's step, which is
known from an eighth of it. It is *refused* if the message gives a reason that the manual has. It
*runs* if the whole deck runs with `gear/quat`, and cannot be compared for the reason that is given.
It is *not run* if nothing is known: this machine did not run the deck with its own fix, or there was
no time for it.
*NEITHER* is what remains: the fix is wrong, or the comparison does not suit the deck. The
last column is the error of `gear/quat` at the deck's own step, in units of the error of the deck's
own fix at the same step.

{decks}

## Neighbors

Every fix and compute style that `lmp -h` lists for a LAMMPS of the table is put beside the fix, as far as it runs in a scene
of {molecules} molecules and {free} free atoms: before and after it in the script, on the ranks of the
table, with a restart in the middle. Positions, velocities and all outputs of the neighbor have to be the same to
{same:g} in all of these; with a neighbor that does nothing to atoms they are those without it; and
all have to agree with `fix rigid/nve/small` at small steps (*same*, *acts*). A neighbor that bodies
cannot follow has to be *refused* or *warned* of, by name. *LAMMPS refuses* where the neighbor asks
for a rigid fix. A style that is in no list makes the test fail.

{neighbors}

What LAMMPS does not keep with a rigid fix either, and is not judged:

{excused}

{reasons}

## Unit tests

LAMMPS' tests of fix styles (`fix-timestep-*.yaml`, {oldest}) that can be pointed at bodies, in
their own scene: {units}. {others} are not tried:

{unit_reasons}

The C++ tests of compute styles make their own systems in code and cannot be pointed at another; the
styles themselves are among the neighbors above.
"""


def neighbors_table(tried):
    """``tried``: LAMMPS' name -> (ranks, what try_neighbors returned)."""
    lines = [
        "| LAMMPS | ranks | styles | scenes | runs | of them with a restart | "
        + " | ".join(RESULTS)
        + " |",
        "|---" * (6 + len(RESULTS)) + "|",
    ]
    for name, (ranks, (outcomes, _, runs, restarts)) in tried.items():
        counts = Counter(outcome.result for outcome in outcomes)
        styles = len({(outcome.kind, outcome.style) for outcome in outcomes})
        cells = [name, ", ".join(map(str, ranks)), styles, len(outcomes), runs, restarts]
        cells += [counts[result] for result in RESULTS]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return lines


def by_result(outcomes):
    """Lines with all styles of each result."""
    lines = []
    for result in RESULTS:
        for kind in ("fix", "compute"):
            found = sorted({o.style for o in outcomes if o.result == result and o.kind == kind})
            if found:
                lines += ["", f"**{result}**, {kind} styles: {', '.join(found)}."]
    return lines


def not_kept(outcomes):
    """Lines with what fix rigid does not keep either."""
    found = sorted(
        {
            f"`{o.name}` ({'; '.join(o.excused)})"
            for o in outcomes
            if o.excused and o.result != "DIFFERS"
        }
    )
    return [f"* {text}" for text in found]


def reasons_table(reasons):
    """Lines with the styles that are not tried."""
    grouped = {}
    for style, reason in reasons.items():
        grouped.setdefault(reason, []).append(style)
    lines = ["| not tried because it | styles |", "|---|---|"]
    for reason, styles in sorted(grouped.items()):
        lines.append(f"| {reason} | {', '.join(sorted(styles))} |")
    return lines


def decks_table(verdicts):
    """Lines: counts by release, then each deck with both releases side by side."""
    lines = [
        f"| LAMMPS | decks | rigid fixes | {' | '.join(VERDICTS)} |",
        "|---" * (3 + len(VERDICTS)) + "|",
    ]
    for release, found in verdicts.items():
        counts = Counter(v.result for v in found)
        cells = [RELEASES[release], len({v.deck for v in found}), len(found)]
        cells += [counts[result] for result in VERDICTS]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    rows = {}
    for release, found in verdicts.items():
        for v in found:
            rows.setdefault((v.deck, v.line), {}).setdefault(release, v)
    lines += [
        "",
        "| deck | fix | "
        + " | ".join(RELEASES[release] for release in verdicts)
        + " | error at its own step |",
        "|---" * (3 + len(verdicts)) + "|",
    ]
    for (deck, line), found in rows.items():
        cells = []
        for release in verdicts:
            v = found.get(release)
            cells.append(
                "not there" if not v else f"{v.result}{': ' + v.reason if v.reason else ''}"
            )
        ratios = [f"{v.ratio:.2g}" for v in found.values() if v.ratio == v.ratio]
        words = line if len(line) < 60 else line[:57] + "..."
        lines.append(
            f"| {deck.removeprefix('examples/')} | `{words}` | {' | '.join(cells)} | {', '.join(ratios)} |"
        )
    return lines


def measured_at(commits):
    """The commit of all parts, or that of each."""
    if len(set(commits)) == 1:
        return f"Commit {commits[0]}"
    parts = zip(("Neighbors", "decks", "unit tests"), commits)
    return ", ".join(f"{part} at commit {name}" for part, name in parts if name)


def page(commits, tried, verdicts, units):
    """Text of doc/foreign.md; arguments as in __main__, ``commits`` in the order of the others."""
    left_out = [
        name
        for name, found in (("decks", verdicts), ("neighbors", tried), ("unit tests", units))
        if not found
    ]
    tried, verdicts, units = tried or {}, verdicts or {}, units or ([], {})
    every = [outcome for _, (outcomes, *_) in tried.values() for outcome in outcomes]
    reasons = {}
    for _, (_, found, *_) in tried.values():
        reasons |= found
    counts = Counter(outcome.result for outcome in units[0])
    return TEXT.format(
        command=COMMAND,
        where=f"{measured_at(commits)}, {system()}, {processor()} ({len(os.sched_getaffinity(0))} cores),"
        f" Python {platform.python_version()}, {datetime.date.today():%d %b %Y}.",
        left_out=f"Not run for this page: {', '.join(left_out)}." if left_out else "",
        first=decks.FIRST,
        steps=decks.STEPS,
        within=decks.WITHIN,
        decks="\n".join(decks_table(verdicts)),
        molecules=scene.MOLECULES,
        free=scene.FREE,
        same=neighbors.SAME,
        neighbors="\n".join([*neighbors_table(tried), *by_result(every)]),
        excused="\n".join(not_kept(every)) or "nothing.",
        reasons="\n".join(reasons_table(reasons)),
        oldest=RELEASES["oldest"],
        units=", ".join(f"{number} {what}" for what, number in sorted(counts.items())) or "none was run",
        others=len(units[1]),
        unit_reasons="\n".join(reasons_table(units[1])),
    )
