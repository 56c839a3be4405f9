"""Run LAMMPS as a program.  This module is independent of the contents of decks."""

import os
import shutil
import sys
from collections import deque
from pathlib import Path
from subprocess import PIPE

from lammps_gearquat.launch import LammpsError, find, started, words_of


class Interrupted(LammpsError):
    """Raised if a run was ended because another run failed."""


def find_lmp(lmp=None):
    """The LAMMPS program: the given program, or the program in the folder of this Python or on the PATH."""
    program = lmp or find("lmp")
    if not program or not shutil.which(str(program)):
        place = lmp or Path(sys.executable).parent / "lmp"
        raise LammpsError(f"there is no LAMMPS program at {place}: name one with --lmp")
    return str(program)


def run(deck, log, variables, lmp, ranks=1, stop=None):
    """Run ``deck`` in its folder and leave ``log``; raise LammpsError if the run fails.

    ``variables`` are given as ``-var name value``; ``stop`` is an Event that ends the run, which raises Interrupted.
    Afterwards the log is complete and no process of the run is left.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    command = []
    if ranks > 1:
        mpiexec = find("mpiexec", beside=shutil.which(lmp))
        if not mpiexec:
            raise LammpsError(f"there is no mpiexec program beside {lmp}, nor on the PATH")
        command += [mpiexec, "-n", str(ranks)]
    command += [lmp, "-in", deck.name, "-log", str(log.resolve()), "-nocite", *words_of(variables.items())]
    tail = deque(maxlen=15)
    with started(command, deck.parent, {**os.environ, "OMP_NUM_THREADS": "1"}, PIPE) as process:
        for line in process.stdout:
            tail.append(line)
            if stop is not None and stop.is_set():
                raise Interrupted(log.name)
        process.wait()
    if process.returncode != 0:
        raise LammpsError(f"{log.name}: exit code {process.returncode}\n" + "".join(tail))
