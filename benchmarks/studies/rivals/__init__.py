"""Force evaluations of the fix and of other methods at their best settings; nothing is timed.

peers.py     the methods, and their runs
scenes.py    the scenes
strongest.py the strongest method of each scene: curves in, numbers and tables out
"""

import numpy as np

from benchmarks.engine import Curve, Finding, Panel, Study
from benchmarks.engine.session import Session
from benchmarks.engine.costs import cost_of
from benchmarks.reference import multistep, solvers
from benchmarks.studies.accuracy import SAMPLE

from . import peers, scenes, strongest

#: methods of the picture with their colors
SHOWN = {scenes.FIXED: "#0072b2", scenes.TOLERANCE: "#d55e00", multistep.LABEL: "#9467bd", solvers.DDEABM: "#009e73"}


def measure(lab):
    """Results of all scenes."""
    with Session(lab.out / "logs") as session:
        return scenes.measure(lab, session)


def _panel(results):
    """Errors in test case 1 against evaluations, each method with the weights that are best for one error."""
    column, own = results[scenes.CASE1]

    def cost(curve):
        found = cost_of(*curve, SAMPLE)
        return found.value if found else np.inf

    shown = []
    for name, color in SHOWN.items():
        for curve in sorted(strongest.curves(own.get(name, []), column), key=cost)[:1]:
            line = {"width": 2.0} if name in strongest.OURS else {"line": "-."}
            label = "keyword tolerance" if name == scenes.TOLERANCE else name
            shown.append(Curve(label, *curve[:, np.isfinite(curve).all(axis=0)], color, **line))
    axes = "force evaluations, start included", "error of the center of mass"
    return Panel("With keyword tolerance, the fix needs the fewest evaluations", *axes, tuple(shown), "xy", ylim=(1e-11, 1.0))


def find(results):
    """Finding of the results of ``measure``."""
    tables, measurements = strongest.case1(results)
    tables |= strongest.of_scenes(results)
    texts, (number, lost) = strongest.losses(results)
    own, (name, peer) = strongest.compared(results)[scenes.CASE1][strongest.TARGETS.index(SAMPLE)]
    counts = [strongest.count_text(cost) for cost in (*own.values(), peer)]
    context = {"losses": texts, "comparisons": number, "lost": list(lost.values()), "peer": name, "counts": counts}
    context |= {"weights": (peers.FEW, len(peers.WEIGHTS)), "passes": f"{scenes.PASSES:g}", "starts": scenes.STARTS}
    context |= {"sample": strongest.power(SAMPLE)}
    return Finding(measurements, tables, {"main": (_panel(results),)}, context)


STUDY = Study(
    "rivals",
    "Other methods",
    700.0,
    measure,
    find,
    blocks={"doc/accuracy.md": "rivals.md.j2", "README.md": "rivals.readme.md.j2", "paper/paper.md": "rivals.paper.md.j2"},
)
