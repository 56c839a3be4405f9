"""The longest acceptable steps for long runs with diverging trajectories, as in a liquid.

In such runs the error of a trajectory is not meaningful.  Two criteria count: the energy does not drift, and
translation and rotation have the same temperature.

1. Short runs of the fix without keywords (it chooses the number of values itself), of the keywords of the user, and
   of the fix of the deck: from the longest known step upwards, until the energy drifts.
2. A longer run of the cheapest step that may meet the bound.  If it does not, the next shorter step is tried, unless
   another method is cheaper then.
"""

import math
from dataclasses import dataclass, field

from . import drift
from .methods import DEFAULT, named

#: time steps that are tried, in powers of ten
STEPS = (1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
#: the part of the budget for short runs, the number of runs for which it is meant, and the number of places in STEPS
#: between them at first
SHARE_SHORT, SHORT_RUNS, STRIDE = 0.4, 10, 2
#: steps of a short run at least
FEWEST = 200
#: the part of the longest time from which on temperatures are compared: they fluctuate slowly
BALANCED = 0.1
#: the shortest step that is tried, as a part of the step of the deck
SHORTEST = 1.0 / 16.0
#: the part of the remaining time for the run of a step that may be recommended
SHARE_LONG = 0.5
#: a run may take longer than expected by this factor
SLACK = 1.2
#: another method has to be faster by this factor than the fix of the deck and the default, because times are noisy
WORTHWHILE = 1.1


def neighbor(dt, shift):
    """The step (STEPS times a power of ten) that is ``shift`` places from the longest step not above ``dt``."""
    power = math.floor(math.log10(dt) + 1e-9)
    place = max(k for k, step in enumerate(STEPS) if step <= dt / 10.0**power * (1 + 1e-6)) + shift
    decade, place = divmod(place, len(STEPS))
    return float(f"{STEPS[place] * 10.0 ** (power + decade):.2g}")


def shorter(dt):
    """The longest step of STEPS times a power of ten that is shorter than ``dt``."""
    return neighbor(dt, 0) if neighbor(dt, 0) < dt * (1 - 1e-6) else neighbor(dt, -1)


@dataclass(frozen=True)
class LongRun:
    """The result of a run with ``keywords`` (None: the deck's own fix) at a step: ``seconds`` per unit of time, and a
    Drift."""

    keywords: str
    dt: float
    seconds: float
    drift: drift.Drift


@dataclass
class Sampling:
    """The answer for a scene whose trajectory diverges; times in units of the deck.

    ``runs``, list of LongRun; ``recommended``, (keywords, step) or None if no step is known to meet ``bound``.
    """

    bound: float
    own_dt: float
    before: float
    runs: list = field(default_factory=list)
    recommended: tuple = None
    notes: list = field(default_factory=list)

    @property
    def rows(self):
        """The longest LongRun of each method and step, by method and step."""
        best = {}
        for run in self.runs:
            key, old = (run.keywords, run.dt), best.get((run.keywords, run.dt))
            if old is None or run.drift.fails or (not old.drift.fails and run.drift.time >= old.drift.time):
                best[key] = run
        order = list(dict.fromkeys(run.keywords for run in self.runs))
        return sorted(best.values(), key=lambda run: (order.index(run.keywords), run.dt))

    def row(self, keywords, dt):
        """The row of a method and step, or None."""
        return next((run for run in self.rows if (run.keywords, run.dt) == (keywords, dt)), None)

    @property
    def own(self):
        """The row of the unchanged deck."""
        return self.row(None, self.own_dt)

    @property
    def choice(self):
        """The row that is recommended, or None."""
        return self.row(*self.recommended) if self.recommended else None

    @property
    def least(self):
        """The row with the smallest drift, or None if no drift is known."""
        known = [run for run in self.rows if run.drift.known and not run.drift.fails]
        return min(known, key=lambda run: abs(run.drift.rate), default=None)


class Search:
    """Runs of a cost.Inquiry for an answer, a Sampling."""

    def __init__(self, inquiry, answer):
        self.inquiry, self.answer = inquiry, answer
        self.end, self.shortest = drift.longest(inquiry.deck), SHORTEST * inquiry.deck.dt

    def seconds_per_step(self, keywords):
        """The smallest known time: other load on the machine can only add to it."""
        known = [run.seconds * run.dt for run in self.answer.runs if run.keywords == keywords and run.drift.known]
        return min(known, default=max(self.inquiry.pace.values()))

    def run(self, keywords, dt, seconds):
        """The Drift of a run of at most this number of seconds, up to the longest time."""
        # uses the latest speed, because the load of the machine may have changed; a run that does not end within the
        # budget decides nothing
        pace = SLACK * self.inquiry.pace.get(keywords, self.seconds_per_step(keywords))
        steps = min(self.end / dt, max((seconds - self.inquiry.overhead) / pace, FEWEST))
        timeout = max(min(3.0 * seconds + 30.0, self.inquiry.budget.left()), 0.0)
        found = drift.Drift(reason="the budget left no time for a run", bound=self.answer.bound)
        if steps * pace < timeout:
            balance = steps * dt > BALANCED * self.end
            found = drift.run(self.inquiry, keywords, dt, steps, timeout, self.answer.bound, balance)
        self.answer.runs.append(LongRun(keywords, dt, self.inquiry.pace.get(keywords, self.seconds_per_step(keywords)) / dt, found))
        return found

    # --- 1. short runs --------------------------------------------------------------------------------
    def may_hold(self, keywords, dt):
        """(True if a short run does not rule out a step, True if the run gave any result)."""
        found = self.run(keywords, dt, self.short)
        return not found.refused, found.known or found.fails

    def climb(self, keywords, good, dt, least):
        """The longest step that may meet the bound: searched from ``dt`` upwards, or else downwards to ``least``, or
        the known ``good``."""
        budget, said = self.inquiry.budget, True
        while said and budget.left() > self.until:
            holds, said = self.may_hold(keywords, dt)
            if not holds:
                break
            good, dt = dt, neighbor(dt, STRIDE)
        else:
            return good
        while budget.left() > self.until:
            dt = shorter(dt)
            if dt < least or good and dt <= good:
                break
            if self.may_hold(keywords, dt)[0]:
                return dt
        return good

    def short_runs(self, tries):
        """Dictionary keywords -> the longest step that may meet the bound, for every method for which there is time."""
        deck, budget, best = self.inquiry.deck, self.inquiry.budget, 0.0
        self.until = (1.0 - SHARE_SHORT) * budget.left()
        self.short = (budget.left() - self.until) / SHORT_RUNS
        own = self.run(None, deck.dt, self.short)
        found = {} if own.refused else {None: deck.dt}
        first = shorter(deck.dt) if own.refused else neighbor(deck.dt, 1)
        for keywords in self.tried(tries):
            if budget.left() < self.until + self.short:
                self.answer.notes.append(f"the budget leaves no time for {named(keywords)}")
                continue
            least = max(self.shortest, 0.8 * best)
            found[keywords] = self.climb(keywords, found.get(keywords), best or first, least)
            best = max(best, found[keywords] or 0.0)
        return {keywords: step for keywords, step in found.items() if step}

    def tried(self, tries):
        """The fix with its defaults, ``tries``, and the deck's own fix, which may be the same."""
        deck = self.inquiry.deck
        defaults = next(filter(deck.takes, (DEFAULT, "formulation first")))
        known, own = dict.fromkeys([defaults, *tries]), deck.fix_lines(None)
        return [*(keywords for keywords in known if deck.fix_lines(keywords) != own), None]

    # --- 2. long runs ---------------------------------------------------------------------------------
    def cheapest(self, steps):
        """The method to try next: the fix of the deck, otherwise the default, unless another method is clearly
        cheaper."""
        prices = {keywords: self.seconds_per_step(keywords) / dt for keywords, dt in steps.items()}
        least = min(prices.values())
        first = [keywords for keywords in (None, DEFAULT) if prices.get(keywords, math.inf) <= WORTHWHILE * least]
        return (first or [min(prices, key=prices.get)])[0]

    def long_runs(self, steps):
        """Lengthen runs of the cheapest steps until one is known to meet the bound: (keywords, step), or None."""
        budget = self.inquiry.budget
        while steps:
            keywords = self.cheapest(steps)
            dt = steps[keywords]
            if budget.left() < self.inquiry.overhead + FEWEST * self.seconds_per_step(keywords):
                return None
            found = self.run(keywords, dt, SHARE_LONG * budget.left())
            if found.holds:
                return keywords, dt
            steps[keywords] = shorter(dt)
            # a run without a result would have no result with a shorter step either
            if not (found.refused or found.known) or steps[keywords] < self.shortest:
                del steps[keywords]
        return None


#: the reason why the answer contains no error of a trajectory
PARTED = (
    "trajectories diverge before the end of the run, so steps are judged by the energy and the temperatures of a long run;"
    " --error and --time ask for the error of a trajectory"
)


def measure(inquiry, tries, bound):
    """Sampling of a cost.Inquiry whose trajectory diverges; arguments as of cost.measure."""
    answer = Sampling(bound, inquiry.deck.dt, inquiry.before, notes=[*inquiry.deck.notes, PARTED])
    search = Search(inquiry, answer)
    answer.recommended = search.long_runs(search.short_runs(tries))
    if answer.recommended is None:  # shorter runs may have shown the divergence
        best = min((run for run in answer.rows if run.drift.holds), key=lambda run: run.seconds, default=None)
        answer.recommended = (best.keywords, best.dt) if best else None
    return answer
