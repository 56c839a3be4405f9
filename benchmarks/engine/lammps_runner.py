"""Many runs of LAMMPS side by side, for the studies that do not use the engine's Lab yet."""

import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

from .runner import Interrupted, LammpsError, find_lmp  # noqa: F401
from .runner import run as run_deck


@dataclass(frozen=True)
class Job:
    """One run of one deck.

    ``variables`` are given as ``-var name value``; ``log`` is the log file to write; ``steps`` only
    weighs the job in the progress bar.
    """

    deck: Path
    log: Path
    variables: dict = field(default_factory=dict)
    steps: int = 0


def run(job, lmp=None, launcher=(), timeout=None, on_step=None, stop=None):
    """Run one job; see runner.run."""
    run_deck(job.deck, job.log, job.variables, lmp, launcher, timeout, on_step, stop)


def run_many(jobs, lmp=None, workers=2, progress=None):
    """Run jobs side by side, the longest first; the first error ends all of them.

    ``progress(steps)`` is called with the steps done since its last call, from several threads but
    never from two at once.
    """
    stop, lock = threading.Event(), threading.Lock()

    def one(job):
        done = 0

        def on_step(step):
            nonlocal done
            with lock:
                if progress:
                    progress(step - done)
            done = step

        if stop.is_set():
            raise Interrupted(job.log.name)
        try:
            run(job, lmp, on_step=on_step, stop=stop)
        except BaseException:
            stop.set()
            raise

    with ThreadPoolExecutor(max_workers=workers) as pool:
        futures = [pool.submit(one, job) for job in sorted(jobs, key=lambda j: -j.steps)]
        try:
            errors = [future.exception() for future in as_completed(futures)]
        except BaseException:  # Ctrl-C
            stop.set()
            raise
    for error in errors:
        if error is not None and not isinstance(error, Interrupted):
            raise error
