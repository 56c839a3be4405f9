"""The results of `tests/run foreign --all` as doc/foreign.md; its text is in foreign.md.j2."""

import datetime
import os
import platform
from collections import Counter
from pathlib import Path

import jinja2

from benchmarks.engine.page import markdown_table
from benchmarks.engine.provenance import processor, system

from . import beside, decks, scene, thermostat

COMMAND = "tests/run foreign --all --publish"
VERDICTS = ("agrees", "refused", "runs", "not run", "NEITHER")
RELEASES = {"oldest": "4 Feb 2025", "newest": "4 Jul 2026"}
RESULTS = ("same", "acts", "warned", "refused", "LAMMPS refuses", "DIFFERS")


def styles_table(tried):
    """``tried``: LAMMPS' name -> (ranks, what try_styles returned)."""
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
    """Styles whose effect even fix rigid does not reproduce."""
    excused = (o for o in outcomes if o.excused and o.result != "DIFFERS")
    return "\n".join(sorted({f"* `{o.name}` ({'; '.join(o.excused)})" for o in excused}))


def with_temp(tried, temp):
    """The outcomes of all LAMMPS with keyword temp, or of all without it."""
    return [
        outcome
        for name, (_, (outcomes, *_)) in tried.items()
        for outcome in outcomes
        if ("temp" in name.split(", ")) == temp
    ]


def refused_by_temp(every, beside_temp):
    """Styles that are refused only with keyword temp."""
    refused = [{o.style for o in found if o.result == "refused"} for found in (every, beside_temp)]
    return sorted(refused[1] - refused[0])


def suffixes_table(found):
    """``found``: (LAMMPS' name, number of ranks) -> outcomes of suffixes.py."""
    rows = {}
    for (name, ranks), outcomes in found.items():
        for outcome in outcomes:
            scene = outcome.name.removesuffix(f", {ranks} rank{'s' * (ranks > 1)}")
            rows.setdefault((name, scene, outcome.start), []).append(str(ranks))
    header = ("LAMMPS, suffix", "scene", "ranks", "start")
    table = [(name, scene, ", ".join(n), start) for (name, scene, start), n in rows.items()]
    return markdown_table(header, table)


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
    """The commit of all parts, or the commits of the parts if they differ."""
    if len(set(commits)) == 1:
        return f"Commit {commits[0]}"
    parts = zip(("Other styles", "variants", "decks"), commits)
    return ", ".join(f"{part} at commit {name}" for part, name in parts if name)


def page(commits, tried, variants, verdicts):
    """Text of doc/foreign.md; arguments as in __main__, ``commits`` in the order of the other arguments."""
    parts = (
        ("decks", verdicts),
        ("other styles", tried),
        ("variants of styles", variants),
    )
    left_out = ", ".join(name for name, found in parts if not found)
    tried, variants = tried or {}, variants or {}
    verdicts = verdicts or {}
    every, beside_temp = (with_temp(tried, temp) for temp in (False, True))
    reasons = {}
    for _, (_, found, *_) in tried.values():
        reasons |= found
    template = Path(__file__).with_name("foreign.md.j2").read_text(encoding="utf-8")
    return jinja2.Template(template, undefined=jinja2.StrictUndefined).render(
        command=COMMAND,
        where=f"{measured_at(commits)}, {system()}, {processor()} ({len(os.sched_getaffinity(0))} cores),"
        f" Python {platform.python_version()}, {datetime.date.today():%d %b %Y}.",
        left_out=f"Not run for this page: {left_out}." if left_out else "",
        rules=decks,
        decks="\n\n".join((counts_table(verdicts), decks_table(verdicts))),
        scene=scene,
        same=beside.SAME,
        styles="\n\n".join((styles_table(tried), by_result(every))),
        thermostat=thermostat,
        refused_by_temp=", ".join(refused_by_temp(every, beside_temp)) or "none",
        excused=not_kept(every + beside_temp) or "nothing.",
        variants=suffixes_table(variants),
        reasons=reasons_table(reasons),
    ) + "\n"
