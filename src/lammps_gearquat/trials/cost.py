"""The cost of an error in the simulation of a deck: short trials over steps and orders.

1. A reference: fix gear/quat of high order at finer and finer steps, until two of them agree far
   better than required, and a trial with another formulation or order that confirms the reference.  Smaller errors
   than the difference of these two cannot be judged; the time of the trials is shortened until the smallest error can
   be judged, but not below a tenth.
2. Trials of every method from coarse to fine steps, to the same time.
3. The trials that matter several times, interleaved, for their wall time: the smallest counts.
4. Where few bodies move, keyword tolerance, whose evaluations of the forces are compared with those of that trial.

Where trajectories diverge before the end of the deck's run, ``sampling`` takes the place of all but the first.
"""

import math
import time as clock
from dataclasses import dataclass, field

import numpy as np

from gearquat_analysis.superposition import angles
from gearquat_analysis.tables import rounded

from ..launch import LammpsError
from . import BOUND, evaluate, sampling
from .budget import Budget
from .doubt import MANY, MARGIN, chaotic, cut_to
from .methods import methods, named, stated
from .script import DeckError
from .worker import NOT_FINISHED

#: keywords of fix gear/quat that confirm a reference; the second text is for isokinetic decks, the third for thermostats
CONFIRMATION = (
    "formulation second values 8 compensate yes",
    "formulation first values 6 compensate yes",
    "values 7 compensate yes",
)
#: default errors, in powers of ten of the size of the bodies
DECADES = (1e-2, 1e-4, 1e-6, 1e-8)

SAMPLES = 20  # of a reference in time
#: number of runs at the step of the deck that fit into the budget; this determines the time of the trials
RUNS_IN_BUDGET = 100
SHARE_REFERENCE, SHARE_TIMING = 0.3, 0.3
FEWEST_STEPS, PROBE_STEPS = 8, 20
PATIENCE = 30.0  # seconds by which any trial may exceed the expected time
#: the part of the budget that may be spent before the trials
SHARE_BEFORE = 0.8
#: values of keyword tolerance for each error: each is smaller by this factor, the first relative to the error itself
TOLERANCES, TIGHTER = 5, 0.3
#: another fix pays off if the fix of the deck takes longer by this factor
WORTHWHILE = 1.05


@dataclass(frozen=True)
class Row:
    """The cost of one error: ``own``, evaluate.Point with the deck's fix, and ``best``, with fix gear/quat.

    Either is None if the error cannot be reached or cannot be judged.
    """

    error: float
    own: evaluate.Point = None
    best: evaluate.Point = None

    @property
    def keep(self):
        """True if no fix is faster than the fix of the deck."""
        return bool(self.own and (self.best is None or self.own.seconds < WORTHWHILE * self.best.seconds))

    @property
    def choice(self):
        """The recommended evaluate.Point, or None."""
        return self.own if self.keep else self.best

    @property
    def recommended(self):
        """(keywords, step) for a script if there is a choice; keywords None: the fix of the deck."""
        return None if self.keep else self.choice.method, evaluate.usable_step(self.choice.dt)


@dataclass
class Costs:
    """The answer; times, lengths in units of the deck.

    ``end``, the time of the trials; ``doubt``, the difference of the two best trials there.  ``trials``, list of
    (Trial, errors) with one error for each of NORMS; ``norm``, the index of the chosen norm; ``rows``, list of Row;
    ``before``, seconds spent following the deck.
    """

    end: float
    doubt: float
    reference: object
    confirmation: object
    norm: int
    trials: list = field(default_factory=list)
    rows: list = field(default_factory=list)
    notes: list = field(default_factory=list)
    before: float = 0.0

    @property
    def doubt_limit(self):
        """The smallest error that can be judged."""
        return MARGIN * self.doubt

    def points(self):
        """Dictionary keywords -> list of evaluate.Point, with the largest errors that ``doubt`` allows."""
        points = {}
        for trial, errors in self.trials:
            cost = trial.steps, trial.fastest, errors[self.norm] + self.doubt
            start = trial.start_evaluations, trial.fastest_start, len(trial.seconds)
            point = evaluate.Point(trial.label, trial.dt, *cost, *start)
            points.setdefault(trial.keywords, []).append(point)
        return points


class Inquiry:
    """The trials of one question about ``deck``.

    ``pace``, seconds per step by keywords; ``overhead``, seconds that a trial takes beside its steps;
    ``before``, seconds of the budget that are spent already; ``truth``, positions and centers at the
    end of trials.
    """

    def __init__(self, deck, budget, norm=0):
        self.deck, self.budget, self.norm = deck, budget, norm
        self.pace, self.overhead, self.failures = {}, 0.0, {}
        self.before, self.truth = budget.spent(), None

    def attempt(self, keywords, end, steps, samples=1):
        """Trial, or None if LAMMPS failed (a step that is too large) or the budget ended."""
        self.budget.say(f"{named(keywords)}, step {rounded(end / steps)}")
        timeout = min(PATIENCE + 3 * self.expected(keywords, steps), self.budget.left())
        begin = clock.monotonic()
        try:
            trial = self.deck.run_to(keywords, end, steps, samples, max(timeout, 0.0))
        except LammpsError as error:
            self.failures[keywords] = str(error)
            return None
        finally:
            self.budget.spent()
        self.pace[keywords] = trial.seconds[0] / steps
        self.overhead = clock.monotonic() - begin - trial.seconds[0]
        return trial

    def expected(self, keywords, steps):
        pace = self.pace.get(keywords, max(self.pace.values(), default=0.0))
        return self.overhead + steps * pace

    def affords(self, keywords, steps, reserve=0.0, runs=1.0):
        """True if this number of ``runs`` of this length leaves ``reserve`` seconds of the budget."""
        return runs * self.expected(keywords, steps) < self.budget.left() - reserve

    def enough(self):
        """The recommended budget in seconds, estimated from the trials, as text."""
        trial = self.expected(None, SAMPLES) if self.pace else self.budget.spent() - self.before
        return rounded(2 * self.before + RUNS_IN_BUDGET * trial, 2)

    def refusal(self, what, keywords):
        """The DeckError for a necessary trial that did not finish."""
        reason = self.failures[keywords]
        if self.budget.left() > 0 or not reason.startswith(NOT_FINISHED):
            return DeckError(f"{what}: {reason}")
        return DeckError(
            f"the budget of {self.budget.seconds:g} s was used up before {'this' if self.pace else 'a first'}"
            f" trial ended ({named(keywords)}); {rounded(self.before, 2)} s had passed before the trials:"
            f" try a budget of {self.enough()} s or more"
        )

    # --- 0. how long ----------------------------------------------------------------------------------
    def probe(self):
        """Measure the cost of a step with the fix of the deck, from a run of a few tenths of a second."""
        steps = PROBE_STEPS
        while True:
            trial = self.attempt(None, steps * self.deck.dt, steps)
            if trial is None and None in self.pace:  # the bodies leave the box later on
                return
            if trial is None:
                raise self.refusal("LAMMPS cannot run the deck as it is", None)
            if trial.seconds[0] > 0.2 or steps >= self.deck.start.steps:
                return
            steps = min(4 * steps, self.deck.start.steps)

    def check(self, tries):
        """Raise DeckError for keywords that the fix refuses; such a short step fails for no other reason."""
        for keywords in tries:
            if self.attempt(keywords, 1e-3 * self.deck.dt, 1) is None:
                raise self.refusal(f"--try '{keywords}'", keywords)
            del self.pace[keywords]

    def affordable_end(self):
        """(time, reason or ""): the deck's run, or as much of it as the budget allows."""
        whole = self.deck.start.steps
        seconds = self.budget.left() / RUNS_IN_BUDGET
        # a trial should take longer than its overhead
        steps = int(max(seconds - self.overhead, 0.5 * seconds) / self.pace[None])
        if steps >= whole:
            return self.deck.end, ""
        steps = max(steps - steps % SAMPLES, SAMPLES)
        return min(steps, whole) * self.deck.dt, f"the budget of {self.budget.seconds:g} s"

    # --- 1. the reference -------------------------------------------------------------------------------
    def find_reference(self, end, target, largest=math.inf):
        """(accurate trial, trial with CONFIRMATION), as fine as the budget allows.

        The accurate trial belongs to the halving of the step that changes the result least.  The second trial is None
        if trajectories of many bodies diverge, so that not even an error of ``largest`` can be judged at the end of the
        deck's run.
        """
        many = largest < math.inf
        accurate = self.deck.accurate
        steps = SAMPLES * max(math.ceil(end / self.deck.dt / SAMPLES), 1)
        reserve = (1.0 - SHARE_REFERENCE) * self.budget.left()
        finer, gaps, failed = [], [], 0
        while True:
            trial = self.attempt(accurate, end, steps, SAMPLES)
            if trial:
                finer.append(trial)
            failed += trial is None
            if len(finer) > 1:
                between = self.gap(finer[-2], finer[-1])
                if many and self.deck.end > 1.01 * end and chaotic(trial.time, between, self.deck.end, largest):
                    return trial, None
                gaps.append(between[-1])
                # far better than required, or no gain from two further halvings
                stalled = len(gaps) > 2 and gaps[-1] > 0.5 * gaps[-3]
                if gaps[-1] < 0.03 * target or stalled:
                    break
            # the confirmation takes somewhat longer than the last trial
            affordable = self.affords(accurate, steps, reserve, runs=4)
            if failed > 6 or not (finer or self.affords(accurate, steps, runs=4)):
                raise self.refusal("fix gear/quat cannot run this deck", accurate)
            if finer and not affordable:
                break
            steps *= 2
        reference = finer[int(np.argmin(gaps)) + 1 if gaps else 0]
        steps = SAMPLES * math.ceil(1.25 * reference.steps / SAMPLES)
        second = next(filter(self.deck.takes, CONFIRMATION))
        confirmation = self.attempt(second, end, steps, SAMPLES)
        if confirmation is None:
            raise self.refusal("the reference cannot be confirmed", second)
        return reference, confirmation

    def gap(self, first, second):
        """Difference of two sampled trials in the chosen norm, shape (S,)."""
        frames = first.positions, first.center, second.positions, second.center
        return self.errors(*frames)[self.norm]

    def rounding(self, trial):
        """The error that rounding of the positions alone can cause."""
        scale = np.abs(trial.center).max() if self.norm < 2 else 1.0
        return float(np.finfo(float).eps * scale)

    def errors(self, positions, center, reference, reference_center):
        """One error (...) for each of NORMS, of sites (..., n, 3) and centers (..., B, 3)."""
        shift = np.linalg.norm(center - reference_center, axis=-1)
        turn = angles(self.deck.scene.bodies, reference, positions)
        return shift.max(axis=-1), evaluate.rms(shift), turn.max(axis=-1), evaluate.rms(turn)

    # --- 2. the methods -------------------------------------------------------------------------------
    def add(self, costs, keywords, steps):
        """Add a trial to ``costs``; returns its largest possible error, or None if it did not finish."""
        trial = self.attempt(keywords, costs.end, steps)
        if trial is None:
            return None
        costs.trials.append((trial, self.errors(trial.positions[-1], trial.center[-1], *self.truth)))
        return costs.trials[-1][1][self.norm] + costs.doubt

    def ladder(self, costs, keywords, errors, first, reserve):
        """Trials of one method over steps, from a step that is too long to a step that is short enough.

        ``first``, the number of steps to begin with; ``reserve``, seconds of the budget to leave.
        Returns a dictionary number of steps -> error.
        """
        ratio, rungs = math.sqrt(2.0), {}

        def climb(exponent):
            steps = round(first * ratio**exponent)
            rungs[steps] = self.add(costs, keywords, steps)
            return rungs[steps]

        exponent, error = 0, climb(0)
        while error is not None and error < 3 * max(errors):
            # far below the requested errors, with larger changes of the step
            exponent -= 2 if error < min(errors) / 30 else 1
            steps = round(first * ratio**exponent)
            if steps < FEWEST_STEPS or not self.affords(keywords, steps, reserve):
                break
            error = climb(exponent)
        exponent, last = 0, [] if rungs[first] is None else [rungs[first]]
        while not last or last[-1] > min(errors) / 1.2:
            exponent += 1
            if not self.affords(keywords, round(first * ratio**exponent), reserve) or exponent > 40:
                break
            error = climb(exponent)
            last += [] if error is None else [error]
            if len(last) > 3 and last[-1] > 0.8 * last[-4]:  # the error is due to rounding, or the method has no order
                break
        return {steps: error for steps, error in rungs.items() if error is not None}

    def climb_all(self, costs, errors, tries):
        """Add trials of all methods to ``costs``."""
        tried = [None, *dict.fromkeys([*methods(self.deck), *tries])]
        middle = math.log(errors[0] * errors[-1]) / 2
        own_steps = gear_steps = max(round(costs.end / self.deck.dt), FEWEST_STEPS)
        timing = SHARE_TIMING * self.budget.seconds
        for count, keywords in enumerate(tried):
            left = max(self.budget.left() - timing, 0.0)
            reserve = timing + left * (1.0 - 1.0 / (len(tried) - count))
            if left == 0.0 or not self.affords(keywords, gear_steps, timing):
                costs.notes.append(f"the budget leaves no time for {named(keywords)}")
                continue
            first = own_steps if keywords is None else gear_steps
            rungs = self.ladder(costs, keywords, errors, first, reserve)
            if rungs and keywords is not None:  # the next method begins in the middle
                gear_steps = min(rungs, key=lambda steps: abs(math.log(rungs[steps] + 1e-300) - middle))
            if not rungs and keywords in self.failures:
                costs.notes.append(f"no trial of {named(keywords)} ended without an error: {self.failures[keywords]}")

    # --- 3. the wall time -----------------------------------------------------------------------------
    def repeat(self, trials, timings):
        """Run trials again, interleaved, until each has ``timings`` wall times or the budget ends."""
        trials = [trial for trial in trials if len(trial.seconds) < timings]
        for _ in range(timings - 1):
            # all of them or none: what was timed once, among other trials, is not compared with what was repeated
            if 1.5 * sum(self.expected(trial.keywords, trial.steps) for trial in trials) > self.budget.left():
                return
            for trial in trials:
                again = self.attempt(trial.keywords, float(trial.time[-1]), trial.steps)
                if again:
                    trial.seconds += again.seconds
                    trial.start_seconds += again.start_seconds

    # --- 4. keyword tolerance ---------------------------------------------------------------------------
    def with_tolerance(self, costs):
        """Notes about keyword tolerance, where few bodies move: evaluations of the forces for each error of ``costs``."""
        notes = []
        for row in costs.rows:
            if len(self.deck.scene.bodies) >= MANY or row.choice is None:
                continue
            eps, steps = row.error, row.choice.evaluations + row.choice.start_evaluations
            for _ in range(TOLERANCES):
                eps *= TIGHTER
                self.budget.say(f"gear/quat tolerance {eps:.1g} length")
                try:
                    count, *frame = self.deck.run_adaptive(eps, costs.end, max(self.budget.left(), 0.0))
                except (DeckError, LammpsError):
                    return notes
                finally:
                    self.budget.spent()
                if self.errors(*frame, *self.truth)[self.norm] + costs.doubt <= row.error:
                    notes.append(
                        f"with keyword tolerance {eps:.2g} length, an error of {row.error:.1e} takes {count} evaluations"
                        f" of the forces; with the time step below it takes {round(steps)}"
                    )
                    break
        return notes


def measure(deck, budget, errors=(), time=None, timings=5, norm=0, tries=(), bound=BOUND):
    """Costs of a Deck, or its sampling.Sampling where many trajectories diverge and neither errors nor a time are given.

    ``budget``, a Budget that began before the deck was opened; ``errors`` in units of the deck
    (radians for orientations; if empty, DECADES of the size of the bodies); ``time``, of the trials;
    ``tries``, keywords of fix gear/quat to try beside ``methods``; ``bound``, the largest energy drift of a
    recommended step, in kT per degree of freedom and ns.  Raises DeckError where nothing can
    be measured.
    """
    unit = evaluate.decade(deck.size) if norm < 2 else 1.0
    many = len(deck.scene.bodies) >= MANY and not (errors or time)
    errors = sorted(errors or [unit * decade for decade in DECADES], reverse=True)
    inquiry = Inquiry(deck, budget, norm)
    inquiry.probe()
    inquiry.check(tries)
    whole, reason = (time, "") if time else inquiry.affordable_end()
    reference, confirmation = inquiry.find_reference(whole, min(errors), max(errors) if many else math.inf)
    if confirmation is None:
        return sampling.measure(inquiry, tries, bound)
    doubt = np.maximum(inquiry.gap(reference, confirmation), inquiry.rounding(reference))
    if many and chaotic(reference.time, doubt, deck.end, max(errors)):
        return sampling.measure(inquiry, tries, bound)
    last, cut = (SAMPLES - 1, "") if time else cut_to(reference.time, doubt, errors)
    end = whole * (last + 1) / SAMPLES
    costs = Costs(end, float(doubt[last]), reference, confirmation, norm, before=inquiry.before)
    costs.notes += deck.notes
    if reason:
        costs.notes.append(f"{reason} allows trials until t = {whole:g}, and the run ends at {deck.end:g}")
    costs.notes += [cut] if cut else []
    inquiry.truth = reference.positions[last], reference.center[last]
    judged = [error for error in errors if error > costs.doubt_limit]
    wanted = judged or errors[:1]
    inquiry.climb_all(costs, wanted, tries)
    if not costs.trials:
        raise DeckError(
            f"a step takes {rounded(inquiry.pace[None], 2)} s, so {budget.seconds:g} s are too few to compare methods:"
            f" try --budget {inquiry.enough()}"
        )
    costs.trials.sort(key=lambda pair: pair[0].steps)
    inquiry.repeat(worth_timing(costs, wanted), timings)
    costs.rows = rows_of(costs, errors)
    costs.notes += inquiry.with_tolerance(costs)
    costs.notes += warnings_of([reference, confirmation, *(trial for trial, _ in costs.trials)])
    return costs


def warnings_of(trials):
    """LAMMPS' warnings in trials: list of notes, each once, with the methods that caused it."""
    methods_of = {}
    for trial in trials:
        for line in trial.warnings:
            methods_of.setdefault(line, {})[stated(trial.keywords)] = True
    labels = {stated(trial.keywords) for trial in trials if trial.keywords is not None}
    return [
        f"{line} ({'every fix gear/quat' if labels <= set(names) else ', '.join(names)})"
        for line, names in methods_of.items()
    ]


def worth_timing(costs, errors):
    """Trials whose times are the prices of ``errors``."""
    points = costs.points()
    prices = {(key, price.dt) for error in errors for key, price in evaluate.candidates(points, error).items()}
    return [trial for trial, _ in costs.trials if (trial.keywords, trial.dt) in prices]


def rows_of(costs, errors):
    """One Row for each error: its cost with the deck's own method, and at best.

    If a smaller error was measured as cheaper, its cost is also used for a larger error, because times are noisy.
    """
    points, rows = costs.points(), []
    for error in sorted(errors):
        prices = evaluate.candidates(points, error) if error > costs.doubt_limit else {}
        finer = rows[-1] if rows else Row(error)
        own = prices.pop(None, None)
        if own and finer.own:
            own = min(own, finer.own, key=lambda price: price.seconds)
        bests = [*prices.values(), finer.best] if finer.best else prices.values()
        rows.append(Row(error, own, min(bests, key=lambda price: price.seconds, default=None)))
    return sorted(rows, key=lambda row: errors.index(row.error))
