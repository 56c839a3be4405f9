"""Flights on several processes, each as a row of numbers; each process has its own LAMMPS, which reads the deck once."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from queue import LifoQueue
from tempfile import TemporaryDirectory, mkdtemp
from typing import NamedTuple

import numpy as np

from ..launch import LammpsError
from ..trials.worker import Worker
from .pair import MARGIN, Pair, cross
from .sampling import Plan, dimension

#: flights that a process simulates before it returns them
BLOCK = 32
_pair = None


class Flight(NamedTuple):
    """One flight, in units of the deck.

    ``b``, impact parameter; ``energy``, of the relative translation, and ``rotation_1``, ``rotation_2``, of the rotation of
    both bodies, before and ``_after``; ``angle``, by which the relative velocity has turned, in radians.  ``time``,
    ``steps``, ``fate`` and ``message`` as in ``pair.End``; ``error_energy``: change of the energy by the energy at the
    start.  For flights that have not parted, the angle, the error and the columns ``..._after`` are NaN.
    """

    flight: int
    b: float
    energy: float
    rotation_1: float
    rotation_2: float
    angle: float
    energy_after: float
    rotation_1_after: float
    rotation_2_after: float
    error_energy: float
    time: float
    steps: int
    fate: str
    message: str


def columns(flights):
    """Columns of a list of Flights by name, arrays (n,)."""
    return dict(zip(Flight._fields, map(np.array, zip(*flights))))


@dataclass(frozen=True)
class Facts:
    """The data of a Pair that averages need, under the same names; ``dimension``: random numbers of a flight."""

    freedoms: tuple
    charge: tuple
    reduced_mass: float
    identical: bool
    style: str
    dimension: int = 0


def planned(pair, seed, temperature, energy, rotation):
    """[Facts, Plan] of a Pair; a Worker does not answer with a tuple."""
    charge = None if pair.charge is None else tuple(pair.charge.tolist())
    facts = Facts(tuple(pair.freedoms.tolist()), charge, pair.reduced_mass, pair.identical, pair.style, dimension(pair))
    scale = energy or pair.units.boltzmann * temperature
    return [facts, Plan(seed, temperature, energy, rotation, scale, float(pair.reach / MARGIN), *pair.envelope())]


def fly(pair, plan, first, points, most_steps):
    """List of the Flights with numbers from ``first`` on and random numbers ``points``."""
    starts = plan.starts(pair, points)
    return [judge(pair, first + k, one, pair.fly(one[2], most_steps)) for k, one in enumerate(starts)]


def judge(pair, number, planned, end):
    """Make a Flight from its plan (impact parameter, energy, Start) and its outcome, an End."""
    b, energy, start = planned
    before = pair.rotational_energy(start.quaternion, start.momentum)
    known, course = ((number, b, energy, *before.tolist()), (end.time, end.steps, end.fate, end.message))
    if end.fate != "parted":
        return Flight(*known, *[np.nan] * 5, *course)
    g, g_after = (state.velocity[1] - state.velocity[0] for state in (start, end))
    angle = np.arctan2(np.linalg.norm(cross(g, g_after)), g @ g_after)
    energy_after = 0.5 * pair.units.energy * pair.reduced_mass * (g_after @ g_after)
    after = pair.rotational_energy(end.quaternion, end.momentum)
    change = abs(energy_after + after.sum() - energy - before.sum()) / (energy + before.sum())
    return Flight(*known, float(angle), float(energy_after), *after.tolist(), float(change), *course)


def _answer(scene, asked, arguments, tell):
    """A request to a Worker: a function of arguments and of the pair, which the first request opens."""
    global _pair
    if _pair is None:
        _pair = Pair(**scene)
    return asked(_pair, *arguments)


class Pool:
    """Processes that simulate flights of the pair of a deck; use it in a with statement.

    ``scene`` holds the arguments of ``Pair``.  A flight depends on its random numbers only, so the number of processes
    changes only the time.  ``interrupted``: True ends running flights.  Raises DeckError for decks that cannot be used, and
    LammpsError.
    """

    def __init__(self, scene, processes):
        self.scene, self.interrupted = scene, False
        self._folder, self._idle = TemporaryDirectory(prefix="gearquat-"), LifoQueue()
        self._threads = ThreadPoolExecutor(processes)
        self._workers = [Worker(mkdtemp(prefix="", dir=self._folder.name)) for _ in range(processes)]
        for worker in self._workers:
            worker.on_wait = self._heed
            self._idle.put(worker)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._threads.shutdown(cancel_futures=True)
        for worker in self._workers:
            worker.end()
        self._folder.cleanup()

    def _heed(self):
        """End the work of a process after Ctrl-C: a block of flights can take long."""
        if self.interrupted:
            raise LammpsError("interrupted")

    def ask(self, function, *arguments):
        """The answer of an idle process: a function of the pair and of these arguments."""
        worker = self._idle.get()
        try:
            return worker.ask(_answer, scene=self.scene, asked=function, arguments=arguments)[0]
        finally:
            self._idle.put(worker)

    def fly(self, plan, first, points, most_steps):
        """Flights with numbers from ``first`` on and random numbers ``points``, in lists of up to BLOCK, in their order."""
        blocks = range(0, len(points), BLOCK)
        return self._threads.map(lambda k: self.ask(fly, plan, first + k, points[k : k + BLOCK], most_steps), blocks)
