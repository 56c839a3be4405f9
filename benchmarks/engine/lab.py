"""The laboratory of a study: it runs decks side by side or in turn, and keeps their output."""

import itertools
import threading
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from tqdm import tqdm

from lammps_gearquat.logs import Log

from .runner import Interrupted, LammpsError, find_lmp, run
from .sites import read_sites


@dataclass(frozen=True)
class Job:
    """One run of the ``deck`` at a path, with ``variables`` (name -> value) on this number of ``ranks``.

    Jobs of more ``steps`` are run first.
    """

    deck: Path
    variables: dict
    steps: int = 1
    ranks: int = 1


@dataclass(frozen=True)
class Finished:
    """A run that has ended: its log, its dump if it wrote one, and LAMMPS' ``error``, "" for none."""

    log: Log
    dump: Path
    error: str = ""

    @property
    def thermo(self):
        """Thermo output of the last run of the deck: column -> array (n,)."""
        return self.log.thermo

    @cached_property
    def sites(self):
        """The Sites of the dump."""
        return read_sites(self.dump)


class Lab:
    """Runs jobs; ``out`` is the folder that gets ``logs`` and ``dumps``.

    ``jobs``: number of simultaneous runs.  ``quick``: whether the study should do less.  ``hours``: duration of a study
    that never ends by itself.
    """

    def __init__(self, out, lmp=None, jobs=2, quick=False, hours=1.0):
        self.out, self.jobs = Path(out), jobs
        self.quick, self.hours = quick, hours
        self._lmp = lmp

    @property
    def lmp(self):
        """The LAMMPS program.  Raises LammpsError if there is none."""
        return find_lmp(self._lmp)

    def dump(self, name):
        """Path of the dump of a run."""
        return self.out / "dumps" / f"{name}.dump"

    def many(self, jobs, may_fail=lambda error: False):
        """Run ``jobs``, name -> Job, side by side, the longest first; returns name -> Finished.

        ``may_fail(error)``: whether an error of LAMMPS is a result.  Any other error ends all runs and is raised as
        LammpsError.
        """
        stop = threading.Event()
        order = sorted(jobs, key=lambda name: -jobs[name].steps)
        with ThreadPoolExecutor(max_workers=self.jobs) as pool, tqdm(total=len(jobs), unit="run", disable=None) as bar:
            futures = {name: pool.submit(self._run, name, jobs[name], may_fail, stop) for name in order}
            for future in futures.values():
                future.add_done_callback(lambda _: bar.update())
            try:
                errors = [future.exception() for future in futures.values()]
            except BaseException:  # Ctrl-C
                stop.set()
                raise
        for error in errors:
            if error is not None and not isinstance(error, Interrupted):
                raise error
        return {name: futures[name].result() for name in jobs}

    def in_turn(self, jobs, rounds):
        """Run ``jobs``, name -> Job, one after the other, in this number of rounds, for timing.

        Every round begins with a different job.  Returns name -> list of Finished, one per round.
        """
        finished_runs, names = {name: [] for name in jobs}, deque(jobs)
        for number in tqdm(range(1, rounds + 1), unit="round", disable=None):
            for name in names:
                finished = self._run(f"{name}.{number}", jobs[name], lambda error: False, threading.Event())
                finished_runs[name].append(finished)
            names.rotate(-1)
        return finished_runs

    def sweep(self, name, deck, axes, read, settings=None):
        """Run a deck for every combination of ``axes``, a dictionary variable -> values.

        ``settings``: further variables, or a function of the combination (a dictionary) that returns
        them; "steps" must be among all of them.  Returns tuple of values -> ``read(finished)``; a tuple of one value is
        that value.
        """
        jobs, keys = {}, {}
        for values in itertools.product(*axes.values()):
            variables = dict(zip(axes, values))
            variables |= settings(variables) if callable(settings) else settings or {}
            of_run = "_".join([name, *map(str, values)])
            jobs[of_run] = Job(deck, variables, int(variables["steps"]))
            keys[of_run] = values if len(values) > 1 else values[0]
        finished_runs = self.many(jobs)
        return {keys[of_run]: read(finished) for of_run, finished in finished_runs.items()}

    def _run(self, name, job, may_fail, stop):
        if stop.is_set():
            raise Interrupted(name)
        log, dump = self.out / "logs" / f"log.{name}", self.dump(name)
        dump.parent.mkdir(parents=True, exist_ok=True)
        variables = job.variables | {"out": dump.with_suffix("").resolve()}
        error = ""
        try:
            run(job.deck, log, variables, self.lmp, job.ranks, stop)
        except Interrupted:
            raise
        except LammpsError as failure:
            error = str(failure)
            if not may_fail(error):
                stop.set()
                raise
        return Finished(Log(log), dump, error)
