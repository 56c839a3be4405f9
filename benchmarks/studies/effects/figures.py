"""Draw the ladder from the results of ``benchmarks/run effects``.  Nothing is computed here."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from . import plan  # noqa: E402
from lammps_gearquat.style import COLOUR, STYLE  # noqa: E402


def _bars(axis, below, more, title, unit):
    """One bar a rung: what was there before, and on top of it what the rung adds."""
    names = [rung.name for rung in plan.LADDER]
    axis.barh(names, below, color="#cccccc")
    axis.barh(names, more, left=below, color=COLOUR["second"])
    for k, (start, length) in enumerate(zip(below, more)):
        axis.annotate(
            f" {length:+.0f}" if k else f" {length:.0f}", (start + max(length, 0), k), va="center"
        )
    axis.invert_yaxis()
    axis.set(title=title, xlabel=unit)
    axis.set_xlim(right=1.2 * max(a + b for a, b in zip(below, more)))


def draw(path, results):
    """Two panels: instructions and time of a body and step in the fix, rung by rung."""
    counts = [results.fix(rung.on) for rung in plan.LADDER]
    count_steps = [results.fix(r.on) - (results.fix(r.base) if r.base else 0) for r in plan.LADDER]
    times = [results.nanoseconds(rung.on) for rung in plan.LADDER]
    time_steps = [
        results.nanoseconds(r.on) - (results.nanoseconds(r.base) if r.base else 0)
        for r in plan.LADDER
    ]
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, 2, figsize=(10, 0.6 * len(counts) + 1), layout="constrained")
        for axis, whole, steps, title, unit in (
            (axes[0], counts, count_steps, "Instructions in the fix", "a body and step"),
            (axes[1], times, time_steps, "Time in the fix", "ns a body and step"),
        ):
            _bars(axis, [a - b for a, b in zip(whole, steps)], steps, title, unit)
        axes[1].set_yticklabels([])
        figure.savefig(path)
        plt.close(figure)
