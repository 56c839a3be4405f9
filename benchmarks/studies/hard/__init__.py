"""Scenes that are hard to integrate, each with an exact or independent answer.

Every module is a case: ``TITLE``, ``SECONDS`` on two quiet cores, ``measure(lab)`` and ``find(results)``.
"""

from dataclasses import replace
from importlib import import_module

from benchmarks.engine import Finding, Study

#: the cases, which name their folders under examples/hard, in the order of the page
KEYS = "encounter long fine poles tumbling inertia fast newstep lifecycle boundaries cutoff".split()
CASES = {key: import_module(f"{__name__}.{key}") for key in KEYS}


def measure(lab):
    """Key -> what ``measure`` of the case returns."""
    chosen = {key: case for key, case in CASES.items() if key in lab.parts or not lab.parts}
    total, results = sum(case.SECONDS for case in chosen.values()), {}
    for key, case in chosen.items():
        with lab.share(case.SECONDS / total):
            results[key] = case.measure(lab)
    return results


def find(results):
    """All measurements and pictures; ``cases`` of the template: key -> names of its section."""
    whole = Finding(measurements=[], context={"cases": {}})
    for key, data in results.items():
        case = CASES[key].find(data)
        section = {"title": CASES[key].TITLE, "measurements": case.measurements}
        whole.context["cases"][key] = section | case.context
        whole.measurements.extend(replace(m, what=f"{key}: {m.what}") for m in case.measurements)
        whole.pictures.update(case.pictures)
    return whole


SECONDS = sum(case.SECONDS for case in CASES.values())
STUDY = Study("hard", "Hard cases", SECONDS, measure, find, page="hard_cases", parts=tuple(CASES))
