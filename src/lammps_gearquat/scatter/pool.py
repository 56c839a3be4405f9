"""Simulates flights in several processes; each has its own LAMMPS, which reads the deck once.

A flight depends on its number only, so the number of processes changes only the time.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from queue import LifoQueue
from tempfile import TemporaryDirectory, mkdtemp

from gearquat_analysis.units import UNITS

from ..launch import LammpsError
from ..trials.worker import Worker
from . import cutoff, flights
from .pair import open_pair
from .pilots import cells, nearest_thermal
from .sampling import rotational

#: flights that a process simulates before it returns them
BLOCK = 32
_pair = None


@dataclass(frozen=True)
class Facts:
    """The data of a Pair that averages need, under the same names; lists instead of arrays.

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


def _answer(scene, asked, arguments, tell):
    """A request to a Worker: a function of arguments and of the pair, which the first request opens."""
    global _pair
    if _pair is None:
        _pair = open_pair(**scene)
    return asked(_pair, *arguments)


class Pool:
    """Processes that simulate flights of the pair of a deck; use it in a with statement.

    ``scene`` holds the arguments of ``open_pair``; ``most_steps``, the largest number of steps of a flight.
    ``facts`` are the Facts.  Raises DeckError for decks that cannot be used, and LammpsError.
    """

    def __init__(self, scene, processes, most_steps):
        self.scene, self.most_steps, self._interrupted = scene, most_steps, False
        self._folder, self._idle = TemporaryDirectory(prefix="gearquat-"), LifoQueue()
        self._threads = ThreadPoolExecutor(processes)
        self._workers = [Worker(mkdtemp(prefix="", dir=self._folder.name)) for _ in range(processes)]
        for worker in self._workers:
            worker.on_wait = self._heed
            self._idle.put(worker)

    def __enter__(self):
        try:
            self.facts = self._submit(facts_of).result()
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def __exit__(self, kind=None, *_):
        self._interrupted = kind is KeyboardInterrupt
        self._threads.shutdown(cancel_futures=True)
        for worker in self._workers:
            worker.end()
        self._folder.cleanup()

    def _heed(self):
        """End the work of a process after Ctrl-C: a block of flights can take long."""
        if self._interrupted:
            raise LammpsError("interrupted")

    def _ask(self, function, *arguments):
        worker = self._idle.get()
        try:
            return worker.ask(_answer, scene=self.scene, asked=function, arguments=arguments)[0]
        finally:
            self._idle.put(worker)

    def _submit(self, function, *arguments):
        return self._threads.submit(self._ask, function, *arguments)

    def check(self, scale):
        """Raise DeckError if forces do not vanish smoothly, for flights with energies of about ``scale``."""
        self._submit(cutoff.check, scale).result()

    def fly(self, plan, numbers):
        """Flights with these ``numbers``, a range, in lists of up to BLOCK, in their order."""
        blocks = [numbers[k : k + BLOCK] for k in range(0, len(numbers), BLOCK)]
        futures = [self._submit(flights.fly, plan, block, self.most_steps) for block in blocks]
        try:
            for future in futures:
                yield future.result()
        finally:
            for future in futures:
                future.cancel()

    def pilots(self, plan, advance):
        """(Cells, columns) of the pilots of a Plan; ``advance(n)`` is called when n more flights have ended."""
        boltzmann = UNITS[self.facts.style].boltzmann
        places = cells(plan, self.facts.cutoff, boltzmann, self._submit(rotational).result())
        b, energy = places.b.ravel(), places.energy.ravel()
        thermal = nearest_thermal(plan, boltzmann, energy)
        blocks = [slice(k, k + BLOCK) for k in range(0, places.number, BLOCK)]
        futures = [
            self._submit(flights.fly_pilots, b[own], energy[own], thermal[own], places.random[own], self.most_steps)
            for own in blocks
        ]
        rows = []
        for future in futures:
            some = future.result()
            rows += [flights.row(flight) for flight in some]
            advance(len(some))
        return places, flights.columns(rows)
