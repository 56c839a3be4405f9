"""Time series of one body, as the decks of ``benchmarks/scenes`` print them."""

from dataclasses import dataclass, fields

import numpy as np

#: columns of the thermo output
COLUMNS = (
    *("Step", "Time", "c_centre[1]", "c_centre[2]", "c_centre[3]", "c_potential"),
    *("v_ketrans", "v_kerot", "v_total", "v_qerror"),
)


@dataclass(frozen=True)
class Series:
    """One run: n samples of one body, in the units of the run.

    ``time`` (n,); ``center`` (n, 3), center of mass; ``potential``, ``translation``, ``rotation``
    and ``total`` (n,), energies of the corrected pose (Eq. 20); ``q_error`` (n,), largest deviation
    of the quaternion's square from 1.
    """

    step: np.ndarray
    time: np.ndarray
    center: np.ndarray
    potential: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    total: np.ndarray
    q_error: np.ndarray

    @property
    def kinetic(self):
        """Translational plus rotational kinetic energy, shape (n,)."""
        return self.translation + self.rotation

    def until(self, time):
        """The samples up to and including ``time``."""
        kept = self.time <= time * (1 + 1e-12)
        return Series(*(getattr(self, field.name)[kept] for field in fields(self)))

    def at(self, time):
        """Index of the sample nearest to ``time``."""
        return int(np.argmin(np.abs(self.time - time)))


def from_thermo(thermo):
    """Series of one run's thermo output: dictionary column name -> n values."""
    columns = (np.asarray(thermo[name], dtype=float) for name in COLUMNS)
    step, time, x, y, z, *others = columns
    return Series(step, time, np.column_stack([x, y, z]), *others)


def of_log(log):
    """Series of the last run of a Log."""
    return from_thermo(log.thermo)
