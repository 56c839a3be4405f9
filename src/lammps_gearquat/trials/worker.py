"""The process that runs LAMMPS, as its caller sees it; it may be one process or several ranks.

LAMMPS runs in separate processes because it may end its process, and because its library needs the MPI library loaded
first.  The module ``process`` contains the code that runs in them.
"""

import os
import socket
import sys
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path

from gearquat_analysis.tables import rounded

from ..launch import LammpsError, find, started
from .script import DeckError

#: seconds that the processes may take to start
PATIENCE = 60.0
#: beginning of the message if an answer comes too late
NOT_FINISHED = "not finished"
#: and if the processes have ended
ENDED = "LAMMPS ended its process"


@dataclass
class Positions:
    """Atoms of one rank or of all: ``ids`` (n,), ``positions`` (n, 3), unwrapped."""

    ids: object
    positions: object


@dataclass
class Situation:
    """The setup of a deck when its bodies begin to move, as one rank sees it; units of the deck.

    ``start``, a LeadIn; ``dt``, the deck's time step; ``map_missing``, True if atoms cannot be found by ID.
    ``sites`` of all its n atoms; ``labels`` (n, 2), fix and body of each, -1 for none;
    ``masses`` (n,).  ``rotating``: atoms have their own rotations; ``flat``: the system is
    two-dimensional; ``periodic``, the number of periodic directions; ``continued``, the sites
    ``test_steps`` steps later.
    """

    start: object
    dt: float
    units: str
    map_missing: bool
    sites: Positions
    labels: object
    masses: object
    rotating: bool
    flat: bool = False
    periodic: int = 3
    test_steps: int = 0
    continued: Positions = None


@dataclass
class TrialPart:
    """The data of one trial on one rank: ``samples``, a list of Positions, and ``energies``, as in Trial; on rank 0

    ``seconds``, wall time of the steps; ``start_seconds``, of the set-up and of the start of the
    fix; ``start_evaluations``, evaluations of the forces that the start of fix gear/quat took;
    ``warnings``, lines of the log that matter; ``evaluations``, of the forces in the steps, if steps follow the error.
    """

    rank: int
    samples: list
    seconds: float = 0.0
    start_seconds: float = 0.0
    start_evaluations: int = 0
    warnings: tuple = ()
    energies: list = field(default_factory=list)
    evaluations: int = 0


def _drain(connection):
    """Close a connection once its other end is closed; a process closes it when it ends."""
    with connection, suppress(EOFError, OSError):
        while connection.poll(PATIENCE):
            connection.recv_bytes()


class Worker:
    """Processes that run LAMMPS; those that have ended are restarted, until ``end``.

    ``folder``, whose path has to be short, is for a socket.  ``environment``: None for the environment of
    this process; ``launcher``: the words before the number of ranks, by default for the MPI beside Python or on the
    PATH. ``on_news`` is called with the messages of a running request, ``on_wait`` repeatedly while it runs.
    """

    def __init__(self, folder, ranks=1, environment=None, launcher=()):
        self.folder, self.ranks = Path(folder), ranks
        self.environment, self.launcher = environment, launcher
        self.output = self.folder / "output"
        self.process, self.connections, self._running = None, [], ExitStack()
        self.on_news = self.on_wait = None

    def end(self):
        """End all processes, and return when they have ended."""
        self._running.close()
        for connection in self.connections:
            _drain(connection)
        self.process, self.connections = None, []

    def _begin(self):
        """Start the processes and wait until all of them have connected."""
        address = self.folder / "socket"
        address.unlink(missing_ok=True)
        with socket.socket(socket.AF_UNIX) as listener, self.output.open("ab") as output:
            listener.bind(str(address))
            listener.listen(self.ranks)
            listener.settimeout(0.2)
            command = [sys.executable, "-m", "lammps_gearquat.trials.process", str(address)]
            if self.ranks > 1:
                launcher = self.launcher or (find("mpiexec"), "-n")
                if not launcher[0]:
                    raise DeckError("--ranks needs the program mpiexec, which was not found beside Python or on the PATH")
                command = [*launcher, str(self.ranks), *command]
            self.process = self._running.enter_context(started(command, None, self.environment, output))
            end = time.monotonic() + PATIENCE
            while len(self.connections) < self.ranks:
                try:
                    link, _ = listener.accept()
                except TimeoutError:
                    if self.process.poll() is not None or time.monotonic() > end:
                        raise EOFError from None
                    continue
                link.setblocking(True)
                self.connections.append(Connection(link.detach()))
        for connection in self.connections:
            connection.send([os.path.abspath(folder) for folder in sys.path])

    def ask(self, function, timeout=None, **arguments):
        """The answers of all ranks: a function of these arguments and of ``tell``, which passes its argument to
        ``on_news``.

        Raises DeckError or LammpsError, also after ``timeout`` s.
        """
        try:
            if not self.process:
                self._begin()
            for connection in self.connections:
                connection.send((function, arguments))
            answers = self._receive(timeout)
        except (EOFError, OSError) as error:
            self.end()
            raise LammpsError(f"{ENDED}: " + self._last_words()) from error
        except BaseException:  # after Ctrl-C, or after the time limit
            self.end()
            raise
        for answer in answers:
            if isinstance(answer, Exception):
                if len(answers) < self.ranks:  # the other ranks wait for this rank
                    self.end()
                raise answer
        return answers

    def _receive(self, timeout):
        """One answer of each rank; fewer if one of them is an exception."""
        end = None if timeout is None else time.monotonic() + timeout
        answers, open_ = [], list(self.connections)
        while open_:
            ready = wait(open_, 0.5)
            if self.on_wait:
                self.on_wait()
            for connection in ready:
                answer = connection.recv()
                if not isinstance(answer, tuple):
                    open_.remove(connection)
                    answers.append(answer)
                elif self.on_news and connection is self.connections[0]:
                    self.on_news(answer[0])
            failed = any(isinstance(answer, Exception) for answer in answers)
            if failed and not ready:
                break
            if end is not None and time.monotonic() > end and not failed:
                raise LammpsError(f"{NOT_FINISHED} after {rounded(timeout)} s")
        return answers

    def _last_words(self):
        lines = self.output.read_text(errors="replace").split("\n") if self.output.exists() else []
        return " ".join(line for line in lines[-6:] if line.strip())
