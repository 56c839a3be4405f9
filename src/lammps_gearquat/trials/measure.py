"""Trials of one deck: positions of its bodies at chosen times, and the cost of reaching them.

Positions are unwrapped, lengths and times in the units of the deck.
"""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gearquat_analysis.bodies import Bodies, places
from gearquat_analysis.units import UNITS

from ..launch import LammpsError
from . import process, script
from .worker import Worker

DECK_ITSELF = "the deck's own"
#: keywords of fix gear/quat for a reference trajectory; the second text is for isokinetic decks
ACCURATE = ("values 9 compensate yes", "formulation first values 7 compensate yes")
#: a checkpoint is good if steps from it differ from the steps of the deck by at most this part of the motion
CHECKPOINT_ERROR = 1e-6


@dataclass
class Trial:
    """One way to move the bodies of a deck, from its start to ``time[-1]``.

    ``keywords`` of fix gear/quat, or None for the deck's own line; ``time`` (S,), samples after the
    start; ``positions`` (S, n, 3) of sites; ``center`` (S, B, 3), centers of mass of bodies.  ``start_evaluations``,
    evaluations of the forces before the first step. ``seconds`` and ``start_seconds``, wall times of the steps and of
    the start before them, one for each repetition.  ``energies`` (S, 4), the conserved and the kinetic energy of the
    system, and the kinetic energies of translation (relative to the common center of mass) and of rotation of the
    bodies.  ``energies`` is None unless requested; with energies, ``positions`` and ``center`` are given at the end
    only.
    """

    keywords: str
    dt: float
    steps: int
    time: np.ndarray
    positions: np.ndarray
    center: np.ndarray
    start_evaluations: int = 1
    seconds: list = field(default_factory=list)
    start_seconds: list = field(default_factory=list)
    warnings: tuple = ()
    energies: np.ndarray = None

    @property
    def label(self):
        return DECK_ITSELF if self.keywords is None else self.keywords

    @property
    def fastest(self):
        """The smallest of ``seconds``: other load on the machine can only add to it."""
        return min(self.seconds)

    @property
    def fastest_start(self):
        return min(self.start_seconds)


class Scene:
    """The rigid bodies of a deck when they begin to move: B bodies of n sites.

    ``ids`` (n,), rising within a body; ``bodies`` (Bodies), which has them in this order;
    ``positions`` (n, 3), unwrapped.  ``size``: the largest distance of a site from its center of mass, as the median
    over bodies of more than one site.
    """

    def __init__(self, situations):
        ids = np.concatenate([part.sites.ids for part in situations])
        labels = np.concatenate([part.labels for part in situations])
        masses = np.concatenate([part.masses for part in situations])
        positions = np.concatenate([part.sites.positions for part in situations])
        order = np.argsort(ids)
        order = order[labels[order, 0] >= 0]
        if not len(order):
            raise script.DeckError("the rigid fix of the deck has no atoms")
        _, numbers = np.unique(labels[order], axis=0, return_inverse=True)
        self.bodies = Bodies(numbers.reshape(-1) + 1, masses[order])
        order = order[self.bodies.index]
        self.ids, self.positions = ids[order], positions[order]
        arms = positions[order] - self.bodies.center(positions[order])[self.bodies.of]
        reach = self.bodies.largest(np.linalg.norm(arms, axis=1))[self.bodies.counts > 1]
        self.size = float(np.median(reach)) if len(reach) else 0.0
        self.bodies.set_shape(self.positions)

    @property
    def freedoms(self):
        """Degrees of freedom of translation, without the common translation, and of rotation of sites as points."""
        count, bodies = len(self.bodies), self.bodies
        return 3 * (count - 1), int(3 * count - bodies.linear.sum() - 3 * bodies.point.sum())

    @property
    def ranges(self):
        """``ids`` as words of the command group, such as 1:3000."""
        ids = np.sort(self.ids)
        return [f"{part[0]}:{part[-1]}" for part in np.split(ids, np.flatnonzero(np.diff(ids) > 1) + 1)]

    def of_sites(self, parts):
        """Positions (n, 3) of the sites of the bodies, from the Positions of all ranks."""
        ids = np.concatenate([part.ids for part in parts])
        positions = np.concatenate([part.positions for part in parts])
        place = places(ids, self.ids)
        if (place < 0).any():
            raise LammpsError("atoms of bodies were lost")
        return positions[place]

    def centers(self, positions):
        """Centers of mass (S, B, 3) of sites at ``positions`` (S, n, 3)."""
        return np.array([self.bodies.center(frame) for frame in positions])


class Deck:
    """An input script, followed up to the run that moves its bodies; use it in a with statement.

    ``variables`` are tuples (name, value, ...), as after -var; ``without`` are IDs of fixes to leave out.  ``which``
    counts the runs that move bodies; None is the first that can be measured.  ``ranks`` is the number of LAMMPS
    processes.  ``say`` is called with a line of text before slow commands of the deck, and ``on_wait`` repeatedly
    while LAMMPS runs; ``timeout`` is the time limit in seconds. Raises DeckError for decks that cannot be used.
    """

    def __init__(self, path, variables=(), without=(), which=None, ranks=1, say=None, on_wait=None, timeout=None):
        self.path = Path(path).resolve()
        self.variables = [tuple(map(str, variable)) for variable in variables]
        self.without, self.which, self.ranks = tuple(without), which, ranks
        self.say, self.on_wait, self.timeout = say, on_wait, timeout

    def __enter__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="gearquat-")
        self.log = Path(self._folder.name) / "log"
        self.worker = Worker(self._folder.name, self.ranks)
        self.worker.on_wait = self.on_wait
        try:
            self._follow()
            self._test_checkpoint()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        self.worker.end()
        self._folder.cleanup()

    def _ask(self, function, timeout=None, **arguments):
        return self.worker.ask(function, timeout, deck=self.path, variables=self.variables, log=self.log, **arguments)

    def _follow(self):
        self.worker.on_news = self.say
        try:
            parts = self._ask(process.follow, self.timeout, without=self.without, which=self.which)
        except LammpsError as error:
            remedy = "; a longer --budget gives it more time" if self.timeout else ""
            raise script.DeckError(f"LAMMPS did not reach the run to be measured: {error}{remedy}") from error
        self.worker.on_news = None
        self._situation, self.start = parts[0], parts[0].start
        self.dt = self._situation.dt
        self.lines = self.start.movers
        own = [script.for_trials(line) for line in self.lines]
        translated = [script.translate(line) for line in self.lines]
        self.own = [line for line, _ in own]
        self.base = [line for line, _ in translated]
        used = {command.mover.id for command in self.start.commands if command.mover and command.in_use}
        #: lines that trials of the method of the deck define again, because the state of chains is not kept
        self._anew = {b.id: b for b in self.own if b not in self.lines or (b.has_chains and b.id in used)}
        notes = [note for _, notes in own + translated for note in notes]
        if self.start.checkpoints:
            notes += [
                f"fix {b.id} {b.style}, keyword temp: the variables of its chains are zero at the beginning of"
                " every trial; the values from earlier runs are not used"
                for b in self._anew.values()
                if b.has_chains
            ]
        self.notes = [*self.start.notes, *notes]
        self.scene = Scene(parts)
        self.size = self.scene.size
        self.units = self._situation.units
        self.time_unit, self.length_unit = UNITS[self.units].time, UNITS[self.units].length or "σ"
        #: True if atoms outside of bodies move
        self.others = sum(len(part.sites.ids) for part in parts) > len(self.scene.ids)
        self._continued = [part.continued for part in parts]

    def _test_checkpoint(self):
        """Drop the checkpoints if steps from the last checkpoint differ from the steps of the deck."""
        if not self.start.checkpoints or self._anew:
            return
        try:
            trial = self.run(None, [self._situation.test_steps], self.dt)
            known = self.scene.of_sites(self._continued)
            motion = np.abs(known - self.scene.positions).max()
            rounding = 1e-12 * np.abs(known).max()
            error = np.abs(trial.positions[-1] - known).max()
            good = error < CHECKPOINT_ERROR * motion + rounding
        except LammpsError:
            good = False
        if not good:
            self.start.checkpoints = False
            self.notes.append(
                "the runs before the measured one leave more behind than positions and velocities,"
                " so every trial repeats them"
            )

    @property
    def partial(self):
        """True if thermodynamic output counts only a part of the kinetic energy of the bodies."""
        return self._situation.rotating or any("infile" in dict(line.keywords) for line in self.lines)

    @property
    def freedoms(self):
        """Scene.freedoms, or None if they are unknown: bodies are held, their sites or dimensions do not determine
        them, or the total angular momentum is conserved, too, as in a box that is not periodic in two directions.
        """
        held = any(key in script.MASKS for line in self.lines for key, _ in line.keywords)
        alone = self._situation.flat or self._situation.periodic < 2
        known = not (held or self.partial or alone) and min(self.scene.freedoms) > 0
        return self.scene.freedoms if known else None

    @property
    def map_missing(self):
        """True if the deck lacks the atom map that fix gear/quat needs."""
        return self._situation.map_missing

    @property
    def end(self):
        return self.start.steps * self.dt

    def takes(self, keywords):
        """True if these keywords of fix gear/quat are compatible with the bodies of the deck."""
        return all(line.takes(keywords) for line in self.base)

    @property
    def accurate(self):
        """The keywords of ACCURATE that are compatible with the deck."""
        return next(filter(self.takes, ACCURATE))

    def fix_lines_of(self, keywords):
        """The FixLines with these keywords of fix gear/quat; None: the deck's own."""
        if keywords is None:
            return self.own
        return [line.with_numerics(keywords) for line in self.base]

    def fix_lines(self, keywords):
        """The fix lines that move the bodies with these keywords of fix gear/quat, as text."""
        return [line.text() for line in self.fix_lines_of(keywords)]

    def run(self, keywords, segments, dt, timeout=None, energies=False):
        """Trial over segments of these numbers of steps, perhaps with energies.  Raises LammpsError if LAMMPS fails."""
        new = self._anew if keywords is None else {b.id: b for b in self.fix_lines_of(keywords)}
        watched = {"partial": self.partial, "ids": self.scene.ranges, "unit": UNITS[self.units].energy}
        outcomes = self._ask(
            process.trial,
            timeout,
            start=self.start,
            lines=new,
            need_map=bool(new) and self.map_missing,
            ramp_steps=round(self.end / dt),
            dt=dt,
            segments=list(segments),
            energies=watched if energies else None,
        )
        samples = zip(*(outcome.samples for outcome in outcomes))
        positions = np.array([self.scene.of_sites(parts) for parts in samples])
        if not np.isfinite(positions).all():
            raise LammpsError("positions are not numbers")
        first = next(outcome for outcome in outcomes if outcome.rank == 0)
        return Trial(
            keywords,
            dt,
            int(sum(segments)),
            np.cumsum(segments) * dt,
            positions,
            self.scene.centers(positions),
            1 + first.start_evaluations,
            [first.seconds],
            [first.start_seconds],
            first.warnings,
            np.array(first.energies) if energies else None,
        )

    def run_to(self, keywords, end, steps, samples=1, timeout=None):
        """Trial of ``steps`` steps, a multiple of ``samples``, to the time ``end``."""
        return self.run(keywords, [steps // samples] * samples, end / steps, timeout)

    def run_adaptive(self, eps, end, timeout=None):
        """(evaluations of the forces, sites, centers) at the time ``end`` with keyword tolerance ``eps``, a length.

        Raises DeckError if fix gear/quat moves the bodies in several fixes or with other equations of motion, and
        LammpsError if LAMMPS fails.
        """
        if len(self.base) > 1:
            raise script.DeckError("keyword tolerance in one of several fixes")
        lines = {line.id: line.with_tolerance(eps) for line in self.base}
        outcomes = self._ask(
            process.adaptive, timeout, start=self.start, lines=lines, need_map=self.map_missing, end=end
        )
        positions = self.scene.of_sites([outcome.samples[0] for outcome in outcomes])
        return outcomes[0].evaluations, positions, self.scene.centers(positions[None])[0]
