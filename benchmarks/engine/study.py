"""A study and its findings."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Measurement:
    """One number: ``what`` it is, its ``value`` and, where it is known, one standard ``error``.

    ``spec`` formats value and error, ``unit`` follows them, and ``remark`` is appended in parentheses.
    ``least`` and ``most`` bound the value for ``--check``; None means no bound.
    """

    what: str
    value: float
    error: float = None
    spec: str = ".1e"
    unit: str = ""
    remark: str = ""
    least: float = None
    most: float = None

    @property
    def text(self):
        """The value with its uncertainty, as shown on a page."""
        text = format(self.value, self.spec).replace(",", " ")
        if self.error is not None:
            text += f" ± {format(self.error, self.spec)}"
        text += f" {self.unit}" if self.unit else ""
        return text + (f" ({self.remark})" if self.remark else "")

    @property
    def bounds(self):
        """The bounds in words, "" if there are none."""
        parts = [("at least", self.least), ("at most", self.most)]
        return " and ".join(f"{word} {bound:g}" for word, bound in parts if bound is not None)

    @property
    def holds(self):
        """True if the value is within its bounds.  NaN is outside of any bounds."""
        least = -math.inf if self.least is None else self.least
        most = math.inf if self.most is None else self.most
        return not self.bounds or bool(least <= self.value <= most)


@dataclass(frozen=True)
class Table:
    """``rows`` with as many cells as the ``header``; a table is written as CSV and shown as Markdown."""

    header: tuple
    rows: list


@dataclass(frozen=True)
class Finding:
    """The results of a study, derived from its data.

    ``measurements``: a sequence of Measurement.  ``tables``: name -> Table; each is also written as a CSV file.
    ``pictures``: name -> tuple of Panel (see panels.py), or a function that draws into the path it gets;
    names without a suffix become PNG files, and those that the page shows are published.
    ``context``: further names of the templates.
    """

    measurements: tuple = ()
    tables: dict = field(default_factory=dict)
    pictures: dict = field(default_factory=dict)
    context: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Study:
    """A study: its measurement, its judgment, and the pages that show its results.

    ``key``: its name on the command line; its pictures go to doc/KEY.  ``title``: what it measures.  ``seconds``:
    duration on two quiet cores.  ``measure(lab)`` returns plain data, ``find(data)`` a Finding.  ``blocks``: page of the
    checkout -> template of the block that the study writes there.
    """

    key: str
    title: str
    seconds: float
    measure: Callable = field(repr=False)
    find: Callable = field(repr=False)
    blocks: dict = field(default_factory=dict)
