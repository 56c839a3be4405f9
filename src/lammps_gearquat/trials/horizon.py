"""The time until which a trajectory can be trusted: one scene at two accuracies, side by side."""

from dataclasses import dataclass, field

import numpy as np

from gearquat_analysis.superposition import angles

from ..launch import LammpsError
from . import evaluate
from .cost import Budget, Inquiry, warnings_of
from .explain import explained
from .script import DeckError

#: default thresholds, in powers of ten of the size of the bodies
THRESHOLDS = (0.1, 1.0, 3.0)
SAMPLES = 500
#: a difference above this part of the size of the bodies no longer grows freely
SATURATION = 0.1
BUDGET = 120.0  # seconds of wall time that determine the default time


@dataclass
class Horizon:
    """Two trials of one scene, B bodies, S samples; units of the deck.

    ``largest`` and ``rms``, distances of the centers of mass of bodies, and ``angle``, the largest
    angle between orientations (radians), all (S,).  ``parting``, list of (threshold, time), infinite if not reached;
    ``growth``, an evaluate.Growth, or None with the reason in ``no_growth``.
    """

    trials: tuple
    largest: np.ndarray
    rms: np.ndarray
    angle: np.ndarray
    parting: list
    growth: object
    no_growth: str
    notes: list = field(default_factory=list)

    @property
    def time(self):
        """Times of the samples, (S,)."""
        return self.trials[0].time


def measure(deck, a=None, b=None, steps=(None, None), time=None, every=None, thresholds=(), progress=None):
    """Horizon of a Deck.

    ``a`` and ``b`` are changes to the keywords of the deck's line in terms of fix gear/quat; None: the unchanged deck,
    and accurate keywords.  ``steps`` are their time steps; None: the step of the deck, and half of it if nothing else
    differs.  ``every`` is the time between samples.  Raises DeckError if the unchanged deck adapts its steps to the
    error.
    """
    if a is None and deck.own != deck.lines:
        raise DeckError(
            f"fix {deck.lines[0].id} gear/quat, keyword tolerance: its steps follow the error, and runs of"
            " equal steps are compared: give keywords for such a run with --a, such as --a 'values 9', and"
            " its step with --step-a"
        )
    keywords = [None if a is None else deck.lines[0].numerics(a)]
    keywords += [deck.accurate if b is None else deck.lines[0].numerics(b)]
    dt_a = steps[0] or deck.dt
    dt_b = steps[1] or (dt_a / 2 if b is None else dt_a)
    notes = list(deck.notes)
    if time is None:
        time = affordable(deck, dt_a, dt_b)
        if time < deck.end:
            notes.append(
                f"the runs end at t = {time:g}, not at {deck.end:g}, to stay within {BUDGET:g} s; --time sets"
                " another end"
            )
    segments, interval = sampling(time, every, dt_a)
    inner = max(round(interval / dt_b), 1)
    if abs(inner * dt_b / interval - 1) > 1e-9:
        inner = int(np.ceil(interval / dt_b))
        dt_b = interval / inner
        notes.append(f"the second step is {dt_b:g}, so that a sample ends with a step")
    strides = round(interval / dt_a), inner
    if progress is not None:
        progress.reset(total=segments * sum(strides))
    pair = _Pair(deck, keywords, (dt_a, dt_b), strides, progress)
    return compare(deck, pair.run(segments), thresholds, notes)


class _Pair:
    """The two runs: keywords, steps and numbers of steps between samples are pairs."""

    def __init__(self, deck, keywords, steps, strides, progress):
        self.deck, self.progress, self.done = deck, progress, 0
        self.words = list(zip(("first", "second"), keywords, steps, strides))

    def run(self, segments):
        """Trials over this number of segments.  Raises LammpsError, which states the cause and the time reached by both."""
        trials, reached, errors = [], [segments], []
        for words in self.words:
            try:
                trials.append(self._trial(*words, reached[-1]))
            except LammpsError as error:
                errors.append((words, error))
                reached.append(self.done // words[-1])
                if not self.done:
                    break
        if not errors:
            return tuple(trials)
        (_, keywords, dt, stride), error = errors[0]
        name = f"gear/quat {keywords}" if keywords else "the deck as it is"
        why = explained(str(error), self.deck, dt, reached[-1] * stride * dt)
        raise LammpsError(f"{name}, timestep {dt:g}: {why}") from error

    def _trial(self, name, keywords, dt, stride, segments):
        self.done = 0
        if self.progress is not None:
            self.progress.set_description(f"{name} run")
        self.deck.worker.on_news = self._tell
        return self.deck.run(keywords, [stride] * segments, dt)

    def _tell(self, steps):
        self.done += steps
        if self.progress is not None:
            self.progress.update(steps)


def affordable(deck, dt_a, dt_b):
    """The time of the deck's run, or the time that two runs reach within BUDGET."""
    inquiry = Inquiry(deck, Budget(BUDGET))
    inquiry.probe()
    return min(deck.end, BUDGET / (inquiry.pace[None] / dt_a + inquiry.pace[None] / dt_b))


def sampling(time, every, dt):
    """(number of samples, time between them); this time is a multiple of ``dt``."""
    stride = max(round((every or time / SAMPLES) / dt), 1)
    segments = int(time / (stride * dt) * (1 + 1e-9))
    if segments < 1:
        raise DeckError(f"the time {time:g} is shorter than one sample, {stride * dt:g}")
    if every and abs(stride * dt / every - 1) > 1e-9:
        raise DeckError(f"--every {every:g} is not a multiple of the time step {dt:g}")
    return segments, stride * dt


def compare(deck, trials, thresholds, notes=()):
    """Horizon of two trials sampled at the same times."""
    first, second = trials
    distance = np.linalg.norm(first.center - second.center, axis=-1)
    angle = angles(deck.scene.bodies, second.positions, first.positions)
    unit = evaluate.decade(deck.size)
    thresholds = sorted(thresholds or [float(f"{unit * factor:.0e}") for factor in THRESHOLDS])
    largest = distance.max(axis=1)
    parting = [(level, evaluate.parting_time(first.time, largest, level)) for level in thresholds]
    floor = evaluate.ROUNDING * np.abs(second.center).max()
    growth, no_growth = evaluate.growth(first.time, largest, SATURATION * (deck.size or unit), floor)
    return Horizon(
        trials,
        largest,
        evaluate.rms(distance),
        angle.max(axis=1),
        parting,
        growth,
        no_growth,
        [*notes, *warnings_of(trials)],
    )
