"""What an error costs in the scene of a deck: short trials over steps and orders.

1. A reference: fix gear/quat of high order at finer and finer steps, until two of them agree far
   better than asked, and a second one of the other formulation that confirms it.  Where these two
   part, nothing can be said about smaller errors; the time measured is cut so that the smallest
   error can be judged, if that leaves a tenth of it.
2. Every method from coarse to fine steps, to the same time.
3. Those that matter again and again, interleaved, for their wall time.
"""

import math
import time as clock
from dataclasses import dataclass, field

import numpy as np

from . import evaluate
from .script import DeckError
from .worker import TrialError

CONFIRMATION = "formulation first values 6 compensate yes"
METHODS = (
    *(f"formulation second values {n}" for n in (8, 5, 6, 10, 12)),
    *(f"formulation first values {n}" for n in (5, 6, 8)),
)
#: what an error is of: name -> (which bodies, of what)
NORMS = ("largest position", "rms position", "largest orientation", "rms orientation")
#: default errors, in powers of ten of the size of the bodies
DECADES = (1e-2, 1e-4, 1e-6, 1e-8)

SAMPLES = 20  # of a reference in time
MARGIN = 3.0  # an error is judged if it is this much larger than the doubt about the reference
SHORTEST = 0.1  # of the time asked for
#: full-length runs at the deck's own step that fit into the budget: the time is chosen so
RUNS_IN_BUDGET = 100
SHARE_REFERENCE, SHARE_TIMING = 0.3, 0.25
FEWEST_STEPS = 20
PATIENCE = 30.0  # seconds that any trial may take beyond what was expected


@dataclass
class Costs:
    """What was found; times, lengths in units of the deck.

    ``end``, the time of the trials; ``doubt``, how far the two best trials are apart there;
    ``trials``, list of (Trial, errors) with one error for each of NORMS; ``norm``, the index of the
    one asked for; ``rows``, list of (error, own Price or None, best Price or None).
    """

    end: float
    doubt: float
    reference: object
    confirmation: object
    norm: int
    trials: list = field(default_factory=list)
    rows: list = field(default_factory=list)
    notes: list = field(default_factory=list)

    @property
    def doubt_limit(self):
        """The smallest error that can be judged."""
        return MARGIN * self.doubt

    def points(self):
        """Dictionary method -> list of evaluate.Point; no error is known better than ``doubt``."""
        found = {}
        for trial, errors in self.trials:
            error = max(errors[self.norm], self.doubt)
            point = evaluate.Point(trial.label, trial.dt, trial.evaluations, trial.median, error)
            found.setdefault(trial.keywords, []).append(point)
        return found


class Budget:
    """Seconds of wall time, shown by ``progress`` (an object like a tqdm bar, or None)."""

    def __init__(self, seconds, progress=None):
        self.seconds, self.progress, self.shown = seconds, progress, 0.0
        self.begin = clock.monotonic()

    def spent(self):
        """Seconds since the beginning; moves the bar."""
        now = clock.monotonic() - self.begin
        if self.progress is not None:
            self.progress.update(max(0.0, min(now, self.seconds) - self.shown))
            self.shown = min(now, self.seconds)
        return now

    def say(self, text):
        """What is being done now."""
        if self.progress is not None:
            self.progress.set_description(text)


class Study:
    """The trials of one question about ``deck``."""

    def __init__(self, deck, budget, timings=5, norm=0):
        self.deck, self.budget, self.timings, self.norm = deck, budget, timings, norm
        self.per_step = {}
        self.failures = {}

    def attempt(self, keywords, end, steps, samples=1):
        """Trial, or None where LAMMPS gave up (a step that is too large)."""
        expected = self.expected(keywords, steps)
        name = keywords or "the deck's own fix"
        self.budget.say(f"{name}, step {end / steps:.3g}")
        try:
            trial = self.deck.run_to(keywords, end, steps, samples, PATIENCE + 3 * expected)
        except TrialError as error:
            self.failures[keywords] = str(error)
            return None
        finally:
            self.budget.spent()
        self.per_step[keywords] = trial.seconds[0] / trial.evaluations
        return trial

    def expected(self, keywords, steps):
        """Seconds that a trial will take."""
        return steps * self.per_step.get(keywords, max(self.per_step.values(), default=0.0))

    # --- 0. how long ----------------------------------------------------------------------------------
    def probe(self):
        """Seconds a step with the deck's own fix, from a run of a few tenths of a second."""
        steps = 10
        while True:
            trial = self.attempt(None, steps * self.deck.dt, steps)
            if trial is None:
                raise DeckError(f"LAMMPS cannot run the deck as it is: {self.failures[None]}")
            if trial.seconds[0] > 0.2 or steps >= self.deck.scene.start.steps:
                return trial.seconds[0] / steps
            steps = min(4 * steps, self.deck.scene.start.steps)

    def affordable_end(self, seconds_a_step):
        """(time, reason or ""): the deck's run, or as much of it as the budget allows."""
        dt, whole = self.deck.dt, self.deck.scene.start.steps
        steps = int(self.budget.seconds / (RUNS_IN_BUDGET * seconds_a_step))
        if steps >= whole:
            return self.deck.end, ""
        steps = max(steps - steps % SAMPLES, SAMPLES)
        return min(steps, whole) * dt, f"the budget of {self.budget.seconds:g} s"

    # --- 1. the reference -------------------------------------------------------------------------------
    def find_reference(self, end, target):
        """(accurate trial, trial with CONFIRMATION), as fine as the budget allows.

        Of the former's halvings of the step it is the one that changes least.
        """
        accurate = self.deck.accurate
        steps = SAMPLES * max(math.ceil(end / self.deck.dt / SAMPLES), 1)
        limit = self.budget.spent() + SHARE_REFERENCE * self.budget.seconds
        found, gaps, failed = [], [], 0
        while True:
            trial = self.attempt(accurate, end, steps, SAMPLES)
            if trial:
                found.append(trial)
            failed += trial is None
            if len(found) > 1:
                gaps.append(self.gap(found[-2], found[-1])[-1])
                # far better than asked, or nothing gained by two further halvings
                stalled = len(gaps) > 2 and gaps[-1] > 0.5 * gaps[-3]
                if gaps[-1] < 0.03 * target or stalled:
                    break
            if failed > 6:
                raise DeckError(f"fix gear/quat cannot run this deck: {self.failures[accurate]}")
            # the confirmation takes somewhat more than the last trial
            if found and self.budget.spent() + 4 * self.expected(accurate, steps) > limit:
                break
            steps *= 2
        reference = found[int(np.argmin(gaps)) + 1 if gaps else 0]
        steps = SAMPLES * math.ceil(1.25 * reference.steps / SAMPLES)
        confirmation = self.attempt(CONFIRMATION, end, steps, SAMPLES)
        if confirmation is None:
            raise DeckError(f"the reference cannot be confirmed: {self.failures[CONFIRMATION]}")
        return reference, confirmation

    def gap(self, one, other):
        """Difference of two sampled trials in the norm asked for, shape (S,)."""
        pairs = zip(one.positions, one.centre, other.positions, other.centre)
        return np.array([self.error(*pair) for pair in pairs])

    def rounding(self, trial):
        """What rounding of the positions alone can make of the error asked for."""
        scale = np.abs(trial.centre).max() if self.norm < 2 else 1.0
        return float(np.finfo(float).eps * scale)

    def error(self, positions, centre, reference, reference_centre):
        """The error asked for, of sites (n, 3) and centres (B, 3)."""
        if self.norm < 2:
            shift = np.linalg.norm(centre - reference_centre, axis=1)
            return (float(shift.max()), evaluate.rms(shift))[self.norm]
        return self.errors(positions, centre, reference, reference_centre)[self.norm]

    def errors(self, positions, centre, reference, reference_centre):
        """One error for each of NORMS."""
        scene = self.deck.scene
        shift = np.linalg.norm(centre - reference_centre, axis=1)
        turn = evaluate.angles(scene.bodies, scene.masses, reference, positions)
        return float(shift.max()), evaluate.rms(shift), float(turn.max()), evaluate.rms(turn)

    # --- 2. the methods -------------------------------------------------------------------------------
    def ladder(self, keywords, end, judge, errors, first, allowance):
        """Trials of one method over steps: from where it is too coarse to where it is good enough.

        ``judge(trial)`` is its error; ``first``, the number of steps to begin with; ``allowance`` in
        seconds.  Returns a list of (Trial, error), the finest last.
        """
        limit = self.budget.spent() + allowance
        ratio = 2.0 if keywords is None else math.sqrt(2.0)
        found = {}

        def one(steps):
            trial = self.attempt(keywords, end, steps)
            if trial:
                found[steps] = (trial, judge(trial))
            return found[steps][1] if trial else None

        exponent, error = 0, one(first)
        while error is not None and error < 3 * max(errors):
            # far below what is asked, in larger strides
            exponent -= 2 if error < min(errors) / 30 else 1
            steps = round(first * ratio**exponent)
            if steps < FEWEST_STEPS or self.budget.spent() > limit:
                break
            error = one(steps)
        exponent, last = 0, [found[first][1]] if first in found else []
        while not last or last[-1] > min(errors) / 1.2:
            exponent += 1
            steps = round(first * ratio**exponent)
            if self.budget.spent() + self.expected(keywords, steps) > limit or exponent > 40:
                break
            error = one(steps)
            last += [] if error is None else [error]
            if len(last) > 3 and last[-1] > 0.8 * last[-4]:  # rounding, or no order at all
                break
        return [found[steps] for steps in sorted(found)]

    # --- 3. the wall time -----------------------------------------------------------------------------
    def repeat(self, trials, limit):
        """Run trials again, interleaved, until each has ``timings`` wall times."""
        for _ in range(self.timings - 1):
            for trial in trials:
                if self.budget.spent() + 2 * trial.seconds[0] > limit:
                    return
                self.budget.say("timing")
                end = float(trial.time[-1])
                again = self.attempt(trial.keywords, end, trial.steps)
                if again:
                    trial.seconds += again.seconds


def measure(deck, errors=(), time=None, budget=180.0, timings=5, norm=0, tries=(), progress=None):
    """Costs of a Deck.

    ``errors`` in units of the deck (radians for orientations; none: DECADES of the size of the
    bodies); ``time``, of the trials; ``budget``, seconds of wall time; ``tries``, keywords of fix
    gear/quat to try beside METHODS.  Raises DeckError where nothing can be measured.
    """
    unit = evaluate.decade(deck.size) if norm < 2 else 1.0
    errors = sorted(errors or [unit * decade for decade in DECADES], reverse=True)
    study = Study(deck, Budget(budget, progress), timings, norm)
    notes = list(deck.notes)
    pace = study.probe()
    asked, reason = (time, "") if time else study.affordable_end(pace)
    reference, confirmation = study.find_reference(asked, min(errors))
    doubt = np.maximum(study.gap(reference, confirmation), study.rounding(reference))
    at, cut = (SAMPLES - 1, "") if time else cut_to(reference.time, doubt, errors)
    end = asked * (at + 1) / SAMPLES
    if reason:
        notes.append(
            f"the trials end at t = {end:g}, not at {deck.end:g}, for {reason} allows no more"
        )
    if cut:
        notes.append(cut)
    costs = Costs(end, float(doubt[at]), reference, confirmation, norm, notes=notes)

    def against(judge):
        known = reference.positions[at], reference.centre[at]
        return lambda trial: judge(trial.positions[-1], trial.centre[-1], *known)

    judged = [error for error in errors if error > costs.doubt_limit]
    wanted = judged or errors[:1]
    methods = [None, *dict.fromkeys([*filter(deck.takes, METHODS), *tries])]
    limit = (1 - SHARE_TIMING) * budget
    middle = math.log(wanted[0] * wanted[-1]) / 2
    first = {None: max(round(end / deck.dt), FEWEST_STEPS)}
    for count, keywords in enumerate(methods):
        allowance = max(limit - study.budget.spent(), 0.0) / (len(methods) - count)
        steps = first.get(keywords, first.get("gear", first[None]))
        found = study.ladder(keywords, end, against(study.error), wanted, steps, allowance)
        if found and keywords is not None:  # the next method begins in the middle
            near = min(found, key=lambda pair: abs(math.log(pair[1] + 1e-300) - middle))
            first["gear"] = near[0].steps
        costs.trials += [(trial, against(study.errors)(trial)) for trial, _ in found]
        if not found and keywords in study.failures:
            costs.notes.append(
                f"no trial of {keywords} came to its end: {study.failures[keywords]}"
            )
    study.repeat(worth_timing(costs, wanted), budget)
    fill_rows(costs, errors)
    costs.notes += known_until(reference.time, doubt, [e for e in errors if e not in judged])
    costs.notes += warnings_of([reference, confirmation, *(trial for trial, _ in costs.trials)])
    return costs


def known_until(time, doubt, errors):
    """Until what time errors that cannot be judged at the end could be: list of notes."""
    notes = []
    for error in errors:
        known = np.flatnonzero(MARGIN * np.maximum.accumulate(doubt) < error)
        until = f"only until t = {time[known[-1]]:g}" if len(known) else f"not at t = {time[0]:g}"
        notes.append(f"the trajectory is known well enough to judge an error of {error:g} {until}")
    return notes


def warnings_of(trials):
    """What LAMMPS said in trials: list of notes, each once, with the methods it belongs to."""
    said = {}
    for trial in trials:
        for line in trial.warnings:
            said.setdefault(line, {})[trial.label] = True
    methods = {trial.label for trial in trials if trial.keywords is not None}
    return [
        f"{line} ({'every fix gear/quat' if methods <= set(who) else ', '.join(who)})"
        for line, who in said.items()
    ]


def cut_to(time, doubt, errors):
    """(index of the sample at which to end, why if it is not the last).

    The latest sample at which the smallest error can be judged; if that is too early, the next.
    """
    last = len(time) - 1
    for error in sorted(errors):
        good = np.flatnonzero(MARGIN * np.maximum.accumulate(doubt) < error)
        if len(good) and (good[-1] + 1) / len(time) >= SHORTEST:
            if good[-1] == last:
                return last, ""
            return int(good[-1]), (
                f"the trials end at t = {time[good[-1]]:g}, not at {time[-1]:g}, for later the two best ones"
                f" differ by more than {error / MARGIN:.2g}, so an error of {error:g} cannot be judged"
            )
    return max(int(SHORTEST * len(time)) - 1, 0), (
        f"the two best trials differ by {doubt[int(SHORTEST * len(time)) - 1]:.2g} already at a"
        " tenth of the time, so no error asked for can be judged in this scene"
    )


def candidates(points, error):
    """(own Price or None, Prices of the two methods that take the fewest evaluations)."""
    prices = {key: evaluate.price(found, error, key is None) for key, found in points.items()}
    own = prices.pop(None, None)
    ranked = sorted((item for item in prices.items() if item[1]), key=lambda i: i[1].evaluations)
    return own, dict(ranked[:2])


def worth_timing(costs, errors):
    """Trials beside the prices of ``errors``: of the deck's own method and of the best two."""
    chosen, points = {}, costs.points()
    for error in errors:
        own, best = candidates(points, error)
        for keywords, price in {None: own, **best}.items():
            mine = [trial for trial, _ in costs.trials if trial.keywords == keywords and price]
            for trial in sorted(mine, key=lambda t: abs(math.log(t.dt / price.dt)))[:2]:
                chosen[id(trial)] = trial
    return list(chosen.values())


def fill_rows(costs, errors):
    """One row for each error: what it costs with the deck's own method, and at best."""
    points = costs.points()
    for error in errors:
        own = best = None
        if error > costs.doubt_limit:
            own, prices = candidates(points, error)
            best = min(prices.values(), key=lambda price: price.seconds, default=None)
        costs.rows.append((error, own, best))
