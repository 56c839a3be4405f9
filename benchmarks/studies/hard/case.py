"""What a hard case is, and what it leaves: demands with verdicts, and curves to draw.

A case is a module with a ``CASE``; ``cases.py`` lists them.  Its ``run(runs)`` gets a Runs (see
runs.py), runs what it needs and returns a Finding.  Judging is apart from running in each module, so
that tests can feed it data that must be refused.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.engine.tables import Row

FORMULATIONS = ("second", "first")


@dataclass(frozen=True)
class Curve:
    """One line of a panel: ``x``, ``y`` (n,); ``colour`` is a name of style.COLOUR.

    ``line`` ("" for none) and ``marker`` are matplotlib's.
    """

    label: str
    x: np.ndarray
    y: np.ndarray
    colour: str
    line: str = "-"
    marker: str = ""


@dataclass(frozen=True)
class Panel:
    """One pair of axes; ``limit``: what is asked, drawn as a line across; ``log``: "x", "y", "xy".

    ``ticks``: words for x = 0, 1, 2 ...
    """

    title: str
    xlabel: str
    ylabel: str
    curves: tuple
    limit: float = None
    log: str = "y"
    ticks: tuple = ()


@dataclass(frozen=True)
class Finding:
    """What a case has shown: demands, panels of its picture, and a paragraph on how and why."""

    rows: tuple
    panels: tuple
    text: str


@dataclass(frozen=True)
class Case:
    """A case: ``key`` names its folder under examples/hard; ``title`` and ``why``, for the page;
    ``seconds``, what it takes about on two quiet cores; ``run``: Runs -> Finding."""

    key: str
    title: str
    why: str
    seconds: float
    run: Callable = field(repr=False)


def at_most(what, limit, measured, said=""):
    """Row of a demand ``measured <= limit``; ``said``: where or with what it was measured.

    A number that is not finite is not met.
    """
    text = f"{measured:.1e}" + (f" ({said})" if said else "")
    return Row(what, f"≤ {limit:.0e}".replace("e-0", "e-"), text, bool(measured <= limit))


def floor(values, least=1e-17):
    """Values that can be drawn on a logarithmic axis."""
    return np.maximum(np.abs(values), least)
