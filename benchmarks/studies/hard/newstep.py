"""The time step changes in mid-run: the run goes on as if started anew.

Two errors are told, both against the reference in long double: that of the whole run from its start,
and that made after the last change alone, from the state at that change.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.reference import Cage, Problem, paper_problem, reference_state
from benchmarks.engine.tables import Row
from .case import FORMULATIONS, Case, Curve, Finding, Panel
from .sites import read_sites

ASKED = 2.0
#: time between changes
SPAN = 40.0
#: change: (words, step at first, step after the change, whether the first one comes back)
CHANGES = {
    "double": ("×2", 0.05, 0.1, False),
    "half": ("÷2", 0.2, 0.1, False),
    "ten": ("×10", 0.02, 0.2, False),
    "back": ("×10 and back", 0.02, 0.2, True),
}


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


def judge(results):
    """Rows; ``results``: (change, formulation, "kept" or "anew") -> Errors."""
    rows = []
    for name, part in (("whole", "of the whole run"), ("after", "made after the last change")):
        for change, (words, *_) in CHANGES.items():
            if (change, FORMULATIONS[0], "kept") not in results:
                continue
            pairs = [
                tuple(getattr(results[change, f, kind], name) for kind in ("kept", "anew"))
                for f in FORMULATIONS
            ]
            worst = max(kept / anew for kept, anew in pairs)
            said = "; ".join("{:.1e} and {:.1e}".format(*pair) for pair in pairs)
            rows.append(
                Row(
                    f"step {words}: error {part} over that of a run started anew at the change, worst "
                    "of both formulations",
                    f"≤ {ASKED:g}",
                    f"{worst:.3g} ({said})",
                    bool(worst <= ASKED),
                )
            )
    return tuple(rows)


def panels(results):
    """Errors of all runs, kept beside anew."""
    panels = []
    for name, title in (
        ("whole", "error of the whole run"),
        ("after", "made after the last change"),
    ):
        curves = []
        for formulation in FORMULATIONS:
            for kind, marker in (("kept", "o"), ("anew", "x")):
                y = [getattr(results[change, formulation, kind], name) for change in CHANGES]
                label = f"{formulation}, {'history kept' if kind == 'kept' else 'started anew'}"
                x = np.arange(len(CHANGES))
                curves.append(Curve(label, x, np.array(y), formulation, "", marker))
        ticks = tuple(words for words, *_ in CHANGES.values())
        panels.append(Panel(title, "change", "distance of a site", tuple(curves), ticks=ticks))
    return tuple(panels)


def measure(runs, changes=tuple(CHANGES), **options):
    """(change, formulation, "kept" or "anew") -> Errors."""
    variables = {}
    for change in changes:
        _, first, then, back = CHANGES[change]
        steps = round(SPAN / first)
        for formulation in FORMULATIONS:
            for kind in ("kept", "anew"):
                variables[f"{change}-{formulation}-{kind}"] = {
                    "formulation": formulation,
                    "dt": first,
                    "steps": steps,
                    "every": steps,
                    "to": then,
                    "then": round(SPAN / then),
                    "back": steps if back else 0,
                    "anew": "yes" if kind == "anew" else "no",
                } | options
    found = runs.many("newstep", variables)
    results = {}
    for name, finished in found.items():
        change, formulation, kind = name.split("-")
        middle = read_sites(finished.dump.with_suffix(".change"))
        time = SPAN * (3 if CHANGES[change][3] else 2)
        results[change, formulation, kind] = errors(middle, finished.sites, time)
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    steps = "; ".join(
        f"{words}: {first:g} → {then:g}" + (f" → {first:g}" if back else "")
        for words, first, then, back in CHANGES.values()
    )
    text = (
        f"Test case 1, consistent body, defaults of the fix, a change every {SPAN:g} units of time "
        f"(steps {steps}). What a coarse step leaves in the higher derivatives is as wrong as that "
        "step was: where the step becomes shorter than half, the fix starts the histories anew by "
        "itself; elsewhere it rescales them. The charges of the cage are reconstructed."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "newstep",
    "A change of the step in mid-run",
    "A history belongs to one step; for another one its rows are rescaled.",
    10.0,
    run,
)
