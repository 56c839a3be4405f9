"""Flights on several processes, each with a LAMMPS of its own that reads the deck once.

A flight depends on its number only, so the number of processes changes nothing but the time.
"""

import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process

from gearquat_analysis.units import UNITS

from ..launch import LammpsError
from . import cutoff, flights
from .pair import open_pair
from .pilots import cells, nearest_thermal
from .sampling import rotational

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


def facts_of(pair):
    """Facts of a Pair."""
    bodies, charge = pair.bodies, pair.charge
    return Facts(
        pair.path.name,
        bodies.mass.tolist(),
        bodies.moments.tolist(),
        pair.freedoms.tolist(),
        None if charge is None else charge.tolist(),
        pair.reduced_mass,
        pair.identical,
        pair.cutoff,
        pair.reach,
        pair.extent.tolist(),
        pair.style,
        pair.text,
    )


def _facts():
    return facts_of(_pair)


def _end_with_parent():
    parent_process().join()
    os._exit(1)


def _begin():
    os.environ["OMP_NUM_THREADS"] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the command to tell
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


def _fly_pilots(*arguments):
    return flights.fly_pilots(_pair, *arguments)


def _random_numbers():
    return rotational(_pair)


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

    def __exit__(self, kind=None, *_):
        if kind is KeyboardInterrupt:
            for process in active_children():  # a block of flights can take long
                process.kill()
        self._executor.shutdown(cancel_futures=True)

    def _submit(self, function, *arguments):
        return self._executor.submit(_ask, self.scene, function, *arguments)

    @staticmethod
    def _results(futures):
        try:
            return [future.result() for future in futures]
        except BrokenProcessPool as error:
            raise LammpsError("LAMMPS ended its process; lmp -in DECK may say why") from error

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

    def pilots(self, plan, advance):
        """(Cells, columns) of the pilots of a Plan; ``advance(n)`` is told when n more of them have ended."""
        boltzmann = UNITS[self.facts.style].boltzmann
        places = cells(plan, self.facts.cutoff, boltzmann, self._results([self._submit(_random_numbers)])[0])
        b, energy = places.b.ravel(), places.energy.ravel()
        thermal = nearest_thermal(plan, boltzmann, energy)
        blocks = [slice(k, k + BLOCK) for k in range(0, places.number, BLOCK)]
        futures = [
            self._submit(_fly_pilots, b[own], energy[own], thermal[own], places.random[own], self.most_steps)
            for own in blocks
        ]
        rows = []
        for future in futures:
            some = self._results([future])[0]
            rows += [flights.row(flight) for flight in some]
            advance(len(some))
        return places, flights.columns(rows)
