"""Flights on several processes, each with a LAMMPS of its own that reads the deck once.

A flight depends on its number only, so the number of processes changes nothing but the time.
"""

import os
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context, parent_process

from ..trials.worker import TrialError
from . import cutoff, flights
from .pair import open_pair

#: flights that a process makes before it hands them over
BLOCK = 32
_pair = None


@dataclass(frozen=True)
class Facts:
    """What averages need to know of a Pair, whose members have the same names; lists instead of arrays.

    ``mass`` and ``freedoms`` (2,); ``moments`` (2, 3); ``name`` of the deck; ``text``, the commands of the deck.
    """

    name: str
    mass: list
    moments: list
    freedoms: list
    charge: list
    reduced_mass: float
    identical: bool
    cutoff: float
    reach: float
    extent: list
    style: str
    text: list


def _facts():
    bodies, charge = _pair.bodies, _pair.charge
    return Facts(
        _pair.path.name,
        bodies.mass.tolist(),
        bodies.moments.tolist(),
        _pair.freedoms.tolist(),
        None if charge is None else charge.tolist(),
        _pair.reduced_mass,
        _pair.identical,
        _pair.cutoff,
        _pair.reach,
        _pair.extent.tolist(),
        _pair.style,
        _pair.text,
    )


def _end_with_parent():
    parent_process().join()
    os._exit(1)


def _begin():
    os.environ["OMP_NUM_THREADS"] = "1"
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _ask(scene, function, *arguments):
    """A request, answered by a process that has opened the pair."""
    global _pair
    if _pair is None:
        _pair = open_pair(**scene)
    return function(*arguments)


def _check(scale):
    cutoff.check(_pair, scale)


def _fly(*arguments):
    return flights.fly(_pair, *arguments)


class Pool:
    """Processes that fly the pair of a deck; use it in a with statement.

    ``scene`` holds the arguments of ``open_pair``; ``most_steps``, after which a flight is given up.
    ``facts`` are the Facts.  Raises DeckError for decks that cannot be used.
    """

    def __init__(self, scene, processes, most_steps):
        self.scene, self.most_steps = scene, most_steps
        self._executor = ProcessPoolExecutor(processes, get_context("spawn"), _begin)

    def __enter__(self):
        try:
            self.facts = self._results([self._submit(_facts)])[0]
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self._executor.shutdown(cancel_futures=True)

    def _submit(self, function, *arguments):
        return self._executor.submit(_ask, self.scene, function, *arguments)

    @staticmethod
    def _results(futures):
        try:
            return [future.result() for future in futures]
        except BrokenProcessPool as error:
            raise TrialError("LAMMPS ended its process; lmp -in DECK may say why") from error

    def check(self, scale):
        """Raise DeckError if forces do not vanish smoothly, for flights with energies of about ``scale``."""
        self._results([self._submit(_check, scale)])

    def fly(self, plan, numbers):
        """Flights with these ``numbers``, a range, in lists of up to BLOCK, in their order."""
        blocks = [numbers[k : k + BLOCK] for k in range(0, len(numbers), BLOCK)]
        futures = [self._submit(_fly, plan, block, self.most_steps) for block in blocks]
        try:
            for future in futures:
                yield self._results([future])[0]
        finally:
            for future in futures:
                future.cancel()

    def fly_at(self, plan, numbers, distances):
        """For each impact parameter the list of Flights with these numbers."""
        futures = [self._submit(_fly, plan, numbers, self.most_steps, b) for b in distances]
        return self._results(futures)
