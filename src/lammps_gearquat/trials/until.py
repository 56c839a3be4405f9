"""The time until which a trajectory can be trusted: the deck as it is beside a run with small errors at half its step."""

from dataclasses import dataclass

import numpy as np

from gearquat_analysis.superposition import angles
from gearquat_analysis.tables import rounded

from . import evaluate
from .cost import Inquiry, warnings_of
from .script import DeckError

SAMPLES = 500
#: the part of the rest of the budget that both runs may take
SHARE = 0.7


@dataclass
class Parting:
    """Two trials of one scene at S times; units of the deck.

    ``largest`` and ``rms``: distances of the centers of mass of bodies, and ``angle``: the largest angle between
    orientations (radians), all (S,).  ``times``: list of (distance, time), infinite if it is not reached.
    """

    trials: tuple
    largest: np.ndarray
    rms: np.ndarray
    angle: np.ndarray
    times: list
    notes: list

    @property
    def time(self):
        """Times of the samples, (S,)."""
        return self.trials[0].time


def measure(deck, budget, distances, time=None):
    """Parting of a Deck within a Budget; ``time``: of the runs, by default the time of the deck's run, if affordable.

    Raises DeckError if a run ends with an error, or if the deck adapts its steps to the error.
    """
    if deck.own != deck.lines:
        raise DeckError(
            f"fix {deck.lines[0].id} gear/quat, keyword tolerance: its steps follow the error, and runs of equal steps"
            " are compared: leave it out for --until"
        )
    inquiry, notes = Inquiry(deck, budget), list(deck.notes)
    inquiry.probe()
    if time is None:
        steps = min(max(int(0.2 / inquiry.pace[None]), 1), deck.start.steps)
        if inquiry.attempt(deck.accurate, steps * deck.dt / 2, steps) is None:
            raise inquiry.refusal("fix gear/quat cannot run this deck", deck.accurate)
        # the second run has twice as many steps
        seconds = inquiry.pace[None] + 2 * inquiry.pace[deck.accurate]
        time = min(deck.end, SHARE * budget.left() * deck.dt / seconds)
        if time < deck.end:
            notes.append(f"the runs end at t = {rounded(time)}, not at {deck.end:g}, to stay within the budget; --time sets another end")
    stride = max(round(time / SAMPLES / deck.dt), 1)
    samples = int(time / (stride * deck.dt) * (1 + 1e-9))
    if samples < 1:
        raise DeckError(f"the time {time:g} is shorter than a step, {deck.dt:g}")
    trials = []
    for keywords, finer in ((None, 1), (deck.accurate, 2)):
        trial = inquiry.attempt(keywords, samples * stride * deck.dt, samples * stride * finer, samples)
        if trial is None:
            raise inquiry.refusal("a run to be compared did not reach its end", keywords)
        trials.append(trial)
    first, second = trials
    distance = np.linalg.norm(first.center - second.center, axis=-1)
    largest = distance.max(axis=1)
    times = [(level, evaluate.parting_time(first.time, largest, level)) for level in sorted(distances)]
    angle = angles(deck.scene.bodies, second.positions, first.positions).max(axis=1)
    return Parting(tuple(trials), largest, evaluate.rms(distance), angle, times, notes + warnings_of(trials))
