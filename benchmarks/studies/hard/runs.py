"""LAMMPS for the hard cases: decks of examples/hard side by side, and what they leave.

A run that LAMMPS ends with an error is a result where a case says so (``may_fail``): steps that
are too large are among the cases.
"""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from benchmarks.engine.decks import examples_folder
from benchmarks.engine.lammps_runner import Interrupted, Job, LammpsError, run
from .sites import read_sites


def tables(log):
    """Thermo tables of a log, one a run, as column -> array (n,); also of a run that failed."""
    found, columns = [], []
    for line in Path(log).read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            columns = words
            found.append([])
        elif line.startswith("Loop time"):
            columns = []
        elif columns and len(words) == len(columns):
            try:
                found[-1].append((columns, [float(word) for word in words]))
            except ValueError:  # a warning between two rows
                continue
    return [
        dict(zip(rows[0][0], np.array([values for _, values in rows]).T)) for rows in found if rows
    ]


@dataclass(frozen=True)
class Finished:
    """A run that has ended: its log, the dump it may have left, and LAMMPS' words if it failed."""

    log: Path
    dump: Path
    error: str = ""

    @cached_property
    def tables(self):
        """Thermo tables, see ``tables``."""
        return tables(self.log)

    @property
    def thermo(self):
        """The last of them."""
        return self.tables[-1]

    @cached_property
    def sites(self):
        """Sites of the dump."""
        return read_sites(self.dump)


class Runs:
    """Runs decks; ``out``: folder for logs and dumps; ``tell(part)``: part of the case done so far.

    ``workers`` runs at once, ``lmp`` as in lammps_runner.find_lmp.
    """

    def __init__(self, out, lmp=None, workers=2, tell=None):
        self.out, self.lmp, self.workers = Path(out), lmp, workers
        self.tell = tell or (lambda part: None)
        self._lock = threading.Lock()

    def files(self, key, name):
        """Log and dump of a run of the case ``key``."""
        whole = f"{key}_{name}"
        return self.out / "logs" / f"log.{whole}", self.out / "dumps" / f"{whole}.dump"

    def many(self, key, variables, deck=None, may_fail=False):
        """Run ``in.KEY`` (or another ``deck`` of its folder) for each of ``variables``, a dictionary
        name -> variables of the deck; returns name -> Finished, in the same order.

        The longest run starts first.  Raises LammpsError, unless runs ``may_fail``.
        """
        folder = examples_folder() / "hard" / key
        deck = folder / (deck or f"in.{key}")
        total, stop = sum(int(v["steps"]) for v in variables.values()), threading.Event()
        done = 0

        def advance(steps):
            nonlocal done
            with self._lock:
                done += steps
                self.tell(done / max(total, 1))

        def one(name):
            if stop.is_set():
                raise Interrupted(name)
            return self._one(key, name, deck, variables[name], may_fail, advance, stop)

        order = sorted(variables, key=lambda name: -int(variables[name]["steps"]))
        with ThreadPoolExecutor(max_workers=self.workers) as pool:
            futures = {name: pool.submit(one, name) for name in order}
            try:
                errors = [future.exception() for future in futures.values()]
            except BaseException:  # Ctrl-C
                stop.set()
                raise
        for error in errors:
            if error is not None and not isinstance(error, Interrupted):
                raise error
        return {name: futures[name].result() for name in variables}

    def _one(self, key, name, deck, variables, may_fail, advance, stop):
        log, dump = self.files(key, name)
        dump.parent.mkdir(parents=True, exist_ok=True)
        steps, before = int(variables["steps"]), 0
        job = Job(deck, log, variables | {"out": dump.with_suffix("").resolve()}, steps)

        def on_step(step):
            nonlocal before
            if step > before:
                advance(step - before)
                before = step

        error = ""
        try:
            run(job, self.lmp, on_step=on_step, stop=stop)
        except Interrupted:
            raise
        except LammpsError as failure:
            if not may_fail:
                stop.set()
                raise
            error = str(failure)
        advance(steps - before)
        return Finished(log, dump, error)
