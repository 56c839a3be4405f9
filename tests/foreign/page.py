"""What `tests/run foreign --all` found, as doc/foreign.md; its prose is in foreign.md.j2."""

import datetime
import os
import platform
from collections import Counter
from pathlib import Path

import jinja2

from benchmarks.engine.page import markdown_table
from benchmarks.engine.provenance import processor, system

from . import decks, neighbors, scene

COMMAND = "tests/run foreign --all --publish"
VERDICTS = ("agrees", "refused", "runs", "not run", "NEITHER")
RELEASES = {"oldest": "4 Feb 2025", "newest": "4 Jul 2026"}
RESULTS = ("same", "acts", "warned", "refused", "LAMMPS refuses", "DIFFERS")


def neighbors_table(tried):
    """``tried``: LAMMPS' name -> (ranks, what try_neighbors returned)."""
    header = ("LAMMPS", "ranks", "styles", "scenes", "runs", "of them with a restart", *RESULTS)
    rows = []
    for name, (ranks, (outcomes, _, runs, restarts)) in tried.items():
        counts = Counter(outcome.result for outcome in outcomes)
        styles = len({(outcome.kind, outcome.style) for outcome in outcomes})
        row = [name, ", ".join(map(str, ranks)), styles, len(outcomes), runs, restarts]
        rows.append(row + [counts[result] for result in RESULTS])
    return markdown_table(header, rows)


def by_result(outcomes):
    """Paragraphs with all styles of each result."""
    styles = {}
    for result in RESULTS:
        for kind in ("fix", "compute"):
            found = {o.style for o in outcomes if (o.result, o.kind) == (result, kind)}
            if found:
                styles[f"**{result}**, {kind} styles"] = ", ".join(sorted(found))
    return "\n\n".join(f"{title}: {names}." for title, names in styles.items())


def not_kept(outcomes):
    """List of what fix rigid does not keep either."""
    excused = (o for o in outcomes if o.excused and o.result != "DIFFERS")
    return "\n".join(sorted({f"* `{o.name}` ({'; '.join(o.excused)})" for o in excused}))


def reasons_table(reasons):
    """Table of the styles that are not tried."""
    grouped = {}
    for style, reason in sorted(reasons.items()):
        grouped.setdefault(reason, []).append(style)
    rows = [(reason, ", ".join(styles)) for reason, styles in sorted(grouped.items())]
    return markdown_table(("not tried because it", "styles"), rows)


def counts_table(verdicts):
    """Table of how many rigid fixes of each release have which result."""
    rows = []
    for release, found in verdicts.items():
        counts = Counter(v.result for v in found)
        row = [RELEASES[release], len({v.deck for v in found}), len(found)]
        rows.append(row + [counts[result] for result in VERDICTS])
    return markdown_table(("LAMMPS", "decks", "rigid fixes", *VERDICTS), rows)


def decks_table(verdicts):
    """Table of each deck with both releases side by side."""
    lines, rows = {}, []
    for release, found in verdicts.items():
        for v in found:
            lines.setdefault((v.deck, v.line), {}).setdefault(release, v)
    for (deck, line), found in lines.items():
        words = line if len(line) < 60 else line[:57] + "..."
        told = [": ".join(filter(None, (v.result, v.reason))) for v in found.values()]
        told = dict(zip(found, told))
        ratios = ", ".join(f"{v.ratio:.2g}" for v in found.values() if v.ratio == v.ratio)
        cells = [told.get(release, "not there") for release in verdicts]
        rows.append((deck.removeprefix("examples/"), f"`{words}`", *cells, ratios))
    releases = [RELEASES[release] for release in verdicts]
    return markdown_table(("deck", "fix", *releases, "error at its own step"), rows)


def measured_at(commits):
    """The commit of all parts, or that of each."""
    if len(set(commits)) == 1:
        return f"Commit {commits[0]}"
    parts = zip(("Neighbors", "decks", "unit tests"), commits)
    return ", ".join(f"{part} at commit {name}" for part, name in parts if name)


def page(commits, tried, verdicts, units):
    """Text of doc/foreign.md; arguments as in __main__, ``commits`` in the order of the others."""
    parts = (("decks", verdicts), ("neighbors", tried), ("unit tests", units))
    left_out = ", ".join(name for name, found in parts if not found)
    tried, verdicts, units = tried or {}, verdicts or {}, units or ([], {})
    every = [outcome for _, (outcomes, *_) in tried.values() for outcome in outcomes]
    reasons = {}
    for _, (_, found, *_) in tried.values():
        reasons |= found
    counts = sorted(Counter(outcome.result for outcome in units[0]).items())
    template = Path(__file__).with_name("foreign.md.j2").read_text(encoding="utf-8")
    return jinja2.Template(template, undefined=jinja2.StrictUndefined).render(
        command=COMMAND,
        where=f"{measured_at(commits)}, {system()}, {processor()} ({len(os.sched_getaffinity(0))} cores),"
        f" Python {platform.python_version()}, {datetime.date.today():%d %b %Y}.",
        left_out=f"Not run for this page: {left_out}." if left_out else "",
        rules=decks,
        decks="\n\n".join((counts_table(verdicts), decks_table(verdicts))),
        scene=scene,
        same=neighbors.SAME,
        neighbors="\n\n".join((neighbors_table(tried), by_result(every))),
        excused=not_kept(every) or "nothing.",
        reasons=reasons_table(reasons),
        oldest=RELEASES["oldest"],
        units=", ".join(f"*{what}* ({number})" for what, number in counts) or "none was run",
        others=len(units[1]),
        unit_reasons=reasons_table(units[1]),
    ) + "\n"
