"""Runs of decks in a process that holds LAMMPS as a library; only their ``run`` command is timed.

The time of this command includes the set-up, the start of the method and all steps.  Starting LAMMPS, reading the data
file and defining the scene are not timed.  Every run has a separate LAMMPS, which takes the variables of the deck as
from the command line.
"""

import gc
import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lammps_gearquat.launch import LammpsError, open_library
from lammps_gearquat.logs import Log
from lammps_gearquat.trials.worker import Worker

#: time limit of a run: these seconds plus this multiple of the expected time, because LAMMPS can hang when atoms are
#: lost
PATIENCE = 20.0
#: the median is steady when its relative standard error is below this number; runs longer than SHORT seconds always
#: count as steady, and there are at most MOST_ROUNDS
STEADY, SHORT, MOST_ROUNDS = 0.02, 0.05, 20


class RunError(LammpsError):
    """Raised if LAMMPS ended a run with an error, for example because the step is too large."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of a run, in the units of the run.

    ``seconds``: wall time of the ``run`` command; ``start``: force evaluations of the method's own start.
    ``ids``, ``masses`` and ``molecules`` (n,), ``before`` and ``after`` (n, 3): unwrapped positions of all atoms,
    sorted by ID, before and after the run; ``thermo``: column -> samples.
    """

    seconds: float
    start: int
    ids: np.ndarray
    masses: np.ndarray
    molecules: np.ndarray
    before: np.ndarray
    after: np.ndarray
    thermo: dict


# --- in the process -------------------------------------------------------------------------------
def _state(lmp):
    """IDs, masses, molecules and unwrapped positions in an orthogonal box, sorted by ID."""
    atoms = lmp.numpy
    ids = atoms.extract_atom("id")[: lmp.extract_setting("nlocal")]
    order = np.argsort(ids)
    masses = atoms.extract_atom("mass").ravel()[atoms.extract_atom("type")]
    low, high, *_ = lmp.extract_box()
    images = [lmp.decode_image_flags(int(flag)) for flag in atoms.extract_atom("image")[order]]
    positions = atoms.extract_atom("x")[order] + np.array(images) * np.subtract(high, low)
    return ids[order], masses[order], atoms.extract_atom("molecule")[order], positions


def perform(deck, variables, log, tell):
    """Outcome of a deck whose last line is ``run ${steps}`` after ``${last}``, as in in.motion; a request to a Worker.

    Raises LammpsError if the scene cannot be defined, RunError if its run fails.
    """
    os.chdir(deck.parent)
    log.parent.mkdir(parents=True, exist_ok=True)
    ending = {"last": "jump /dev/null"}  # the deck ends before its run
    with open_library((variables | ending).items(), log) as lmp:
        try:
            lmp.file(deck.name)
        except Exception as error:  # LAMMPS' module raises Exception itself
            raise LammpsError(f"{log.name}: {error}") from error
        *atoms, before = _state(lmp)
        gc.collect()
        gc.disable()  # permanently: garbage is collected before the timing of every run
        begin = time.perf_counter()
        try:
            lmp.command(f"run {variables['steps']}")
        except Exception as error:
            raise RunError(f"{log.name}: {error}") from error
        seconds = time.perf_counter() - begin
        *_, after = _state(lmp)
    left = Log(log)
    return Outcome(seconds, left.start_evaluations, *atoms, before, after, left.thermo)


# --- the side of the caller -----------------------------------------------------------------------
class Session:
    """LAMMPS in a separate process, as a context; one run after the other.  ``logs``: a folder."""

    def __init__(self, logs):
        self.logs = Path(logs).resolve()

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="gearquat-")
        self._worker = Worker(self._folder.name)
        return self

    def __exit__(self, *_):
        self._worker.end()
        self._folder.cleanup()

    def run(self, deck, variables, name, expected=0.0):
        """Outcome of a deck, see ``perform``; ``expected``: approximate duration in seconds.

        Raises LammpsError, or RunError for a run that failed or did not end in time.
        """
        log, patience = self.logs / f"log.{name}", PATIENCE * (1.0 + expected)
        asked = {"deck": deck, "variables": variables, "log": log}
        try:
            return self._worker.ask(perform, patience, **asked)[0]
        except LammpsError as error:
            if str(error).startswith(log.name):
                raise
            raise RunError(f"{log.name}: {error}") from error


# --- timings --------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Timing:
    """Wall times of one run: number of timings, quartiles in seconds."""

    count: int
    low: float
    median: float
    high: float

    @classmethod
    def of(cls, seconds):
        """Timing of a list of wall times."""
        return cls(len(seconds), *map(float, np.percentile(seconds, (25, 50, 75))))

    @property
    def error(self):
        """Relative standard error of the median, as for a normal distribution."""
        return 0.93 * (self.high - self.low) / np.sqrt(self.count) / self.median

    @property
    def steady(self):
        """True if the median is known well enough, or the run is not short."""
        return self.median > SHORT or self.error < STEADY


def time_in_turn(competitors, rounds, once, most):
    """Timings of ``competitors``, each timed by ``once(competitor)`` in every round.

    If the machine is slow for a while, all competitors are affected alike.  After ``rounds`` rounds, competitors whose
    median is not steady continue, up to ``most`` rounds.
    """
    seconds = {competitor: [] for competitor in competitors}
    for number in range(max(rounds, most)):
        for competitor, times in seconds.items():
            if number < rounds or not Timing.of(times).steady:
                times.append(once(competitor))
    return {competitor: Timing.of(times) for competitor, times in seconds.items()}
