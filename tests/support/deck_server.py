"""A deck in a process of a ``Worker``, as the program LAMMPS would run it; see ``Lammps.run`` in running.py."""

import ctypes
import os
from contextlib import contextmanager

from lammps_gearquat.launch import LammpsError, open_library


@contextmanager
def written_to(files):
    """What this process writes to file descriptors goes to files: descriptor -> path."""
    kept = {descriptor: os.dup(descriptor) for descriptor in files}
    try:
        for descriptor, path in files.items():
            file = os.open(path, os.O_WRONLY | os.O_APPEND)
            os.dup2(file, descriptor)
            os.close(file)
        yield
    finally:
        ctypes.CDLL(None).fflush(None)
        for descriptor, copy in kept.items():
            os.dup2(copy, descriptor)
            os.close(copy)


def run_deck(deck, words, folder, log, stdout, stderr, tell):
    """Whether a deck runs to its end in ``folder``, with these words on the command line.

    Raises LammpsError after an error of one rank, for which the others wait.
    """
    os.chdir(folder)
    with written_to({1: stdout, 2: stderr}):
        lmp = None
        try:
            lmp = open_library(log=log, words=words, silent=False)
            lmp.file(deck)
            return True
        except Exception as error:
            if type(error) is Exception:  # the class that LAMMPS' module raises
                return False
            raise LammpsError(str(error)) from error
        finally:
            if lmp:
                lmp.close()
