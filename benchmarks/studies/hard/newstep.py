"""The time step changes in mid-run: the run goes on as if started anew.

Two errors are told, both against the reference in long double: that of the whole run from its start,
and that made after the last change alone, from the state at that change.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck
from benchmarks.engine.sites import read_sites
from benchmarks.reference import Cage, Problem, paper_problem, reference_state

TITLE, SECONDS = "A change of the step in mid-run", 10.0
MOST = 2.0
#: time between changes
SPAN = 40.0
#: change: (words, step at first, step after the change, whether the first one comes back)
CHANGES = {
    "double": ("×2", 0.05, 0.1, False),
    "half": ("÷2", 0.2, 0.1, False),
    "ten": ("×10", 0.02, 0.2, False),
    "back": ("×10 and back", 0.02, 0.2, True),
}
HISTORIES = {"kept": "history kept", "anew": "started anew"}
PARTS = {"whole": "error of the whole run", "after": "error made after the last change"}


@dataclass(frozen=True)
class Errors:
    """Largest error of a site at the end: of the ``whole`` run, and made ``after`` the last change."""

    whole: float
    after: float


def _distance(problem, time, sites):
    """Largest distance of a site in the last frame from where the problem has it at ``time``."""
    exact = problem.site_positions(reference_state(problem, time))
    return float(np.linalg.norm(exact.astype(float) - sites.positions[-1], axis=1).max())


def errors(change, end, time):
    """Errors of a run; ``change`` and ``end``: its Sites there; ``time``: of the end."""
    bodies, state = change.start()
    after = Problem("after the change", bodies, Cage(), state)
    return Errors(_distance(paper_problem(1), time, end), _distance(after, SPAN, end))


def measure(lab, changes=tuple(CHANGES), **options):
    """(change, formulation, "kept" or "anew") -> Errors."""

    def settings(run):
        _, first, then, back = CHANGES[run["change"]]
        steps = round(SPAN / first)
        own = {"dt": first, "steps": steps, "every": steps, "to": then, "then": round(SPAN / then)}
        own |= {"back": steps if back else 0, "anew": "yes" if run["history"] == "anew" else "no"}
        return own | options

    def read(run):
        return read_sites(run.dump.with_suffix(".change")), run.sites

    axes = {"change": changes, "formulation": FORMULATIONS, "history": tuple(HISTORIES)}
    runs = lab.sweep("newstep", deck("hard/newstep"), axes, read, settings)
    spans = {change: 3 if back else 2 for change, (*_, back) in CHANGES.items()}
    return {key: errors(*sites, SPAN * spans[key[0]]) for key, sites in runs.items()}


def find(results):
    """Finding of what ``measure`` returns."""
    measurements, panels = [], []
    changes = list(dict.fromkeys(change for change, *_ in results))
    ticks = tuple(CHANGES[change][0] for change in changes)
    for part, words in PARTS.items():
        errors = {key: getattr(run, part) for key, run in results.items()}
        for change, step in zip(changes, ticks):
            pairs = [[errors[change, f, history] for history in HISTORIES] for f in FORMULATIONS]
            worst = max(kept / anew for kept, anew in pairs)
            remark = "; ".join("{:.1e} and {:.1e}".format(*pair) for pair in pairs)
            what = f"step {step}: {words}, over that of a run started anew"
            measurements.append(Measurement(what, worst, spec=".3g", remark=remark, most=MOST))
        curves = []
        for f in FORMULATIONS:
            for (history, label), marker in zip(HISTORIES.items(), "ox"):
                y = np.array([errors[change, f, history] for change in changes])
                curves.append(Curve(f"{f}, {label}", np.arange(len(y)), y, f, "", marker))
        panels.append(Panel(words, "change", "distance of a site", tuple(curves), ticks=ticks))
    context = {"span": SPAN, "changes": {words: steps for words, *steps in CHANGES.values()}}
    return Finding(measurements, pictures={"newstep": tuple(panels)}, context=context)
