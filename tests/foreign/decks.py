"""Every deck of LAMMPS' examples and bench that has a rigid fix: agrees, is refused, or neither."""

import gzip
import itertools
import re
import resource
import shutil
from collections import Counter
from dataclasses import dataclass, field, replace

import numpy as np
from support.running import Result

from . import convert

#: steps with the original fix, followed by steps with each of the compared fixes
FIRST, STEPS, WHOLE = 100, 10, 60
#: steps of an earlier run, if the deck needs one: many decks begin by pushing atoms apart
LONG = 2000
#: in units of the error of the reference, which is found by halving its step
WITHIN = 4.0
#: seconds of processor time that a deck may take with its own fix, and with fix gear/quat in its place
PATIENCE, PATIENCE_OURS = 15, 60
#: seconds of wall time per second of processor time, on a machine with other load
BUSY = 10
#: largest error of a usable reference, in units of the displacement of atoms
TELLS = 0.05

#: reasons why a deck is refused: message of the fix, name, and pattern of the manual
REASONS = (
    (
        r"constant pressure requires all moving atoms to be in bodies",
        "pressure beside other moving atoms",
        r"require all moving atoms to be in bodies of this fix",
    ),
    (
        r"constant pressure cannot be used with run_style|with a pressure, fix \S+ \(\S+\) has to be defined",
        "pressure with r-RESPA, or another order of fixes",
        r"run_style \*respa\* are refused with a pressure",
    ),
    (r"Unknown fix gear/quat keyword: gravity", "keyword gravity", r"\*gravity\* and"),
    (r"fix_modify bodyforces", "bodyforces early", r"\*Fix_modify bodyforces\* is always \*late\*"),
    (
        r"does not support fix_modify temp",
        "fix_modify temp",
        r"`fix_modify temp`, `press` \| not there",
    ),
    (
        r"changes the box without informing other fixes",
        "box that changes untold",
        r"do not inform other fixes of the change",
    ),
    (
        r"is in (?:both )?groups?|in two groups|more than one",
        "bodies that share atoms (poems)",
        r"An atom may be in one of them at most",
    ),
    (
        r"also moved by fix",
        "another fix moves the same atoms",
        r"No other fix that integrates time",
    ),
    (r"bodystyle: file ", "bodies listed in a file (poems)", r"`fix poems` with `file` \| not there"),
    (r"fix hmc does not point to fix rigid", "fix hmc", r"fix hmc"),
    (
        r"\(lb/viscous\) changes atoms of bodies",
        "impulses of a lattice Boltzmann fluid",
        r"\*lb/viscous\*\s+- refused",
    ),
    (
        r"fix \S+ \((\S+)\) changes atoms of bodies",
        "a fix that moves single atoms of bodies",
        r"\*STYLE\*",
    ),
    (
        r"compiled without the headers for that",
        "shapes, in a plug-in",
        r"Ellipsoids, lines and triangles need headers",
    ),
    (r"cannot be used with min_style", "another minimizer", r"\*sd\* \(other styles are refused\)"),
)

#: reasons why an unchanged deck does not run here: message of LAMMPS, and text of the page
CANNOT = (
    (r"still running", f"takes longer than {PATIENCE} s here with its own fix"),
    (r"[Cc]annot open|No such file|not found", "a file of it is not in Debian's source"),
    (r"Unrecognized|Unknown", "a style of it is in no package that is built here"),
    (r"", "LAMMPS ends it with an error"),
)

#: reasons why a deck that runs cannot be compared: part of the message, and text of the page
INCOMPARABLE = (
    ("Resetting timestep size is not allowed", "another fix forbids a smaller step"),
)
#: the same for a deck with atom style line or tri whose results differ (doc/lammps_defects.md)
TAKES_FOR_SPHERES = "fix rigid takes lines and triangles for spheres"


def _children_seconds():
    """Processor time of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(lammps, text, folder, patience):
    """Result of a deck, which has this number of seconds of processor time."""
    used, still_running = _children_seconds(), f"ERROR: still running after {patience} s\n"

    def limit(process):
        resource.prlimit(process, resource.RLIMIT_CPU, (patience, patience))

    try:
        lammps = replace(lammps, folder=folder)
        result = lammps.run(text, timeout=BUSY * patience, meanwhile=limit)
    except TimeoutError:
        return Result(-1, "", still_running, "", folder)
    if result.returncode and _children_seconds() - used > patience - 1:
        return replace(result, stderr=still_running)
    return result


@dataclass
class DeckVerdict:
    """Per rigid fix of a deck; ``result``: agrees, refused, NEITHER; "runs", if the deck runs with our
    fix and nothing can be compared; "not run", if the deck as it is does not run here."""

    deck: str
    line: str
    result: str = "NEITHER"
    reason: str = ""
    #: error of our fix at the step of the deck, in units of the error of the original fix
    ratio: float = float("nan")
    notes: list = field(default_factory=list)


def pages_of_reasons(root):
    """The text of the pages that have the reasons, with single spaces."""
    pages = ("src/fix_gear_quat.rst", "howto/from_rigid.md")
    return " ".join(" ".join((root / "doc" / name).read_text(encoding="utf-8").split()) for name in pages)


def decks_of(source):
    """Paths of all input scripts with a rigid fix, relative to the LAMMPS source tree."""
    return [
        path.relative_to(source)
        for top in ("examples", "bench")
        for path in sorted((source / top).rglob("in.*"))
        if path.is_file()
        and path.suffix not in (".gz", ".bz2")
        and convert.rigid_lines(path.read_text(errors="replace"))
    ]


def _copy(deck, folder):
    """Text of a deck, whose folder is copied without logs and with packed data unpacked."""
    shutil.rmtree(folder, ignore_errors=True)
    without = shutil.ignore_patterns("log.*", "*.jpg", "*.png", "*.mp4", "*.gif")
    shutil.copytree(deck.parent, folder, ignore=without)
    for path in folder.rglob("*.gz"):
        path.with_suffix("").write_bytes(gzip.decompress(path.read_bytes()))
    return deck.read_text(errors="replace").replace(".dat.gz", ".dat")


def _error(result):
    """First line of LAMMPS' error, or of another cause of the end; "" for a normal end."""
    if result.returncode == 0:
        return ""
    if result.errors:
        return result.errors[0]
    return f"exit code {result.returncode}: {result.output.strip()[-200:]}"


def _state(path):
    """Array sorted by ID: ID, unwrapped position, velocity."""
    return np.loadtxt(path, skiprows=9, ndmin=2)


def _apart(a, b):
    """Root mean square difference of positions and of velocities."""
    if a.shape != b.shape or (a[:, 0] != b[:, 0]).any():
        return np.array([np.inf, np.inf])
    difference = (a - b)[:, 1:]
    return np.sqrt([np.mean(difference[:, :3] ** 2), np.mean(difference[:, 3:] ** 2)])


class Deck:
    """One deck of one release with the LAMMPS that may run it, in the order of preference."""

    def __init__(self, source, path, programs, scratch, manual):
        self.name = str(path)
        self.folder = scratch / re.sub(r"\W", "_", self.name)
        self.text = _copy(source / path, self.folder)
        self.programs, self.manual = programs, manual

    def _refused(self, verdict, error):
        """Records an error: a refusal if the manual states its reason, otherwise NEITHER."""
        verdict.result = "NEITHER"
        for pattern, name, manual in REASONS:
            found = re.search(pattern, error)
            if found and found.groups() and found[1]:  # the manual has to name the very style
                manual = manual.replace("STYLE", re.escape(found[1]))
            if found and re.search(manual, self.manual):
                verdict.result, verdict.reason = "refused", name
                return

    def left_out(self, reason=""):
        """A DeckVerdict for each rigid fix of the deck, before anything is run."""
        rigid = convert.rigid_lines(self.text)
        return [
            DeckVerdict(self.name, " ".join(line.words[3:]), "not run", reason) for line in rigid
        ]

    def verdicts(self):
        """A DeckVerdict for each rigid fix of the deck."""
        own = self._choose()
        if own:
            found = self.left_out(next(name for pattern, name in CANNOT if re.search(pattern, own)))
            for verdict in found:
                verdict.notes.append(f"the deck itself: {own}")
            return found
        found = self.left_out()
        ours = set(range(len(found)))
        while ours:
            error = self._whole(ours)
            if "atom map" in error or "atom_modify map" in error:
                self.text = convert.with_map(self.text)
                error = self._whole(ours)
            if not error:
                break
            # find the one that fails by trying each alone
            errors = {n: error if len(ours) == 1 else self._whole({n}) for n in ours}
            bad = {n for n in ours if errors[n]}
            if not bad:
                found[min(ours)].notes.append(f"only together: {error}")
                break
            for n in bad:
                self._refused(found[n], errors[n])
                found[n].notes.append(errors[n])
            ours -= bad
        for n in sorted(ours):
            self._compare(n, found[n])
        return found

    def _whole(self, ours, patience=PATIENCE_OURS):
        """Error of the whole deck with these rigid fixes converted, "" if it runs."""
        text = convert.whole(self.text, WHOLE, self.earlier, ours)
        return _error(run(self.program, text, self.folder, patience))

    def _choose(self):
        """Sets ``program``; returns the error of the unchanged deck, "" if it runs."""
        errors = []
        for self.program, self.earlier in itertools.product(self.programs, (WHOLE, LONG)):
            errors.append(self._whole(set(), PATIENCE))
            if not errors[-1]:
                return ""
        return errors[0]  # the error of the LAMMPS that has more packages

    def _compare(self, number, verdict):
        if convert.segment(self.text, number) is None:
            verdict.result, verdict.reason = "agrees", "no run follows"
            return
        verdict.result, ends = "NEITHER", {}
        for method, divide in (("gear", 4), ("rigid", 4), ("rigid", 8), ("gear", 1), ("rigid", 1)):
            text = convert.trial(self.text, number, method, divide, STEPS, FIRST, self.earlier)
            error = _error(run(self.program, text, self.folder, PATIENCE_OURS))
            if error:
                verdict.notes.append(f"{method}, step/{divide}: {error}")
                why = next((reason for text, reason in INCOMPARABLE if text in error), "")
                if why:
                    verdict.result, verdict.reason = "runs", why
                elif method == "gear":
                    self._refused(verdict, error)
                elif "still running" in error:
                    verdict.result, verdict.reason = "runs", "the reference takes too long here"
                return
            ends[method, divide] = _state(self.folder / "end")
        self._judge(verdict, _state(self.folder / "begin"), ends)

    def _judge(self, verdict, begin, ends):
        """Compares our final state at a quarter of the step with the final state of the rigid fix at an eighth."""
        fine = ends["rigid", 8]
        moved = _apart(begin, fine)
        error = _apart(ends["rigid", 4], fine)
        ours = _apart(ends["gear", 4], fine)
        sizes = np.array([moved[0], np.sqrt(np.mean(fine[:, 4:] ** 2))])
        rounding = 1e-9 * sizes + 1e-15
        coarse = np.maximum(_apart(ends["rigid", 1], fine), rounding)
        verdict.ratio = float(np.max(_apart(ends["gear", 1], fine) / coarse))
        verdict.notes.append(
            f"{len(fine)} atoms moved by {moved[0]:.1e}; apart {ours[0]:.1e} {ours[1]:.1e}, "
            f"error of the reference {error[0]:.1e} {error[1]:.1e}"
        )
        if not error[0] < TELLS * moved[0]:
            chance = convert.has_random_forces(self.text)
            verdict.result = "runs" if chance else "NEITHER"
            verdict.reason = (
                "random forces leave nothing to compare" if chance else "reference too coarse"
            )
        elif (ours <= WITHIN * error + rounding).all():
            verdict.result = "agrees"
        elif convert.has_lines_or_triangles(self.text):
            verdict.result, verdict.reason = "runs", TAKES_FOR_SPHERES


def counted(verdicts):
    """Counter of "agrees", "refused: reason", "NEITHER"."""
    return Counter(
        f"{v.result}: {v.reason}" if v.result == "refused" else v.result for v in verdicts
    )
