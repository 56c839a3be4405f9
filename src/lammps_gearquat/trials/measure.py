"""Trials of one deck: where its bodies are at chosen times, and what it cost to bring them there.

Positions are unwrapped, lengths and times in the units of the deck.
"""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import evaluate, script
from .worker import TrialError, Worker

DECK_ITSELF = "the deck's own"
#: keywords of fix gear/quat for a trajectory to compare with; the second ones where it has to be isokinetic
ACCURATE = tuple(f"formulation {name} values 8 compensate yes" for name in ("second", "first"))


@dataclass
class Trial:
    """One way to move the bodies of a deck, from its start to ``time[-1]``.

    ``keywords`` of fix gear/quat, or None for the deck's own line; ``time`` (S,), samples after the
    start; ``positions`` (S, n, 3) of sites; ``centre`` (S, B, 3), centres of mass of bodies;
    ``evaluations`` of the forces: one a step, one of LAMMPS' set-up, and those of the fix's start;
    ``seconds``, wall times of the run commands, set-up counted, one for each repetition.
    """

    keywords: str
    dt: float
    steps: int
    time: np.ndarray
    positions: np.ndarray
    centre: np.ndarray
    evaluations: int
    seconds: list = field(default_factory=list)
    warnings: tuple = ()

    @property
    def label(self):
        """The method in a few words."""
        return DECK_ITSELF if self.keywords is None else self.keywords

    @property
    def median(self):
        """Median of the wall times."""
        return float(np.median(self.seconds))


class Deck:
    """An input script, followed up to the run that moves its bodies; use it in a with statement.

    ``variables`` are tuples (name, value, ...), as after -var; ``without`` are IDs of fixes to
    leave out; ``which`` counts the runs that move bodies; ``say`` is called with a line of text
    when the deck takes time to come there.  Raises DeckError for decks that cannot be used.
    """

    def __init__(self, path, variables=(), without=(), which=1, say=None):
        self.path = Path(path).resolve()
        self.variables = [tuple(map(str, variable)) for variable in variables]
        self.without, self.which, self.say = tuple(without), which, say

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="gearquat-")
        self.log = Path(self._folder.name) / "log"
        self.worker = Worker(self._folder.name)
        try:
            self._follow()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.worker.end()
        self._folder.cleanup()

    def _ask(self, name, timeout=None, **arguments):
        return self.worker.ask(
            name, timeout, deck=self.path, variables=self.variables, log=self.log, **arguments
        )

    def _follow(self):
        self.worker.on_news = self.say
        try:
            self.scene = self._ask("follow", without=self.without, which=self.which)
        except TrialError as error:
            raise script.DeckError(f"LAMMPS cannot run the deck: {error}") from error
        self.worker.on_news = None
        start = self.scene.start
        self.lines = [command.mover for command in start.commands if command.mover]
        script.check_scene(start.fixes, start.pair_style)
        own = [script.for_trials(line) for line in self.lines]
        translated = [script.translate(line) for line in self.lines]
        self.own = [line for line, _ in own]
        self.base = [line for line, _ in translated]
        self.notes = [*start.notes, *(note for _, notes in own + translated for note in notes)]
        if len(self.scene.ids) == 0:
            raise script.DeckError("the rigid fix of the deck has no atoms")
        self.time_unit, self.length_unit = script.UNITS[self.scene.units]
        self.size = evaluate.body_size(self.scene.bodies, self.scene.masses, self.scene.positions)

    @property
    def dt(self):
        """The time step of the deck."""
        return self.scene.dt

    @property
    def end(self):
        """The time its run takes."""
        return self.scene.start.steps * self.dt

    def takes(self, keywords):
        """Whether these keywords of fix gear/quat can go with what the deck says of its bodies."""
        return all(line.takes(keywords) for line in self.base)

    @property
    def accurate(self):
        """Those of ACCURATE that the deck allows."""
        return next(filter(self.takes, ACCURATE))

    def _with(self, keywords):
        """The fix lines with these keywords of fix gear/quat; None: the deck's own."""
        if keywords is None:
            return self.own
        return [line.with_numerics(keywords) for line in self.base]

    def fix_lines(self, keywords):
        """The fix lines that move the bodies with these keywords of fix gear/quat, as text."""
        return [line.text() for line in self._with(keywords)]

    def run(self, keywords, segments, dt, timeout=None):
        """Trial over segments of these numbers of steps.  Raises TrialError if LAMMPS does."""
        new = {b.id: b for b in self._with(keywords) if keywords is not None or b not in self.lines}
        outcome = self._ask(
            "trial", timeout, scene=self.scene, lines=new, dt=dt, segments=list(segments)
        )
        if not np.isfinite(outcome.positions).all():
            raise TrialError("positions are no numbers")
        centre = evaluate.centres(self.scene.bodies, self.scene.masses, outcome.positions)
        steps = int(sum(segments))
        return Trial(
            keywords,
            dt,
            steps,
            np.cumsum(segments) * dt,
            outcome.positions,
            centre,
            1 + steps + outcome.start_evaluations,
            [outcome.seconds],
            outcome.warnings,
        )

    def run_to(self, keywords, end, steps, samples=1, timeout=None):
        """Trial of ``steps`` steps, a multiple of ``samples``, to the time ``end``."""
        return self.run(keywords, [steps // samples] * samples, end / steps, timeout)
