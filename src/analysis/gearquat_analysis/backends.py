"""A backend of MDAnalysis with a progress bar, which the backends in MDAnalysis lack."""

import functools
from multiprocessing import Pool
from types import SimpleNamespace

from MDAnalysis.analysis.backends import BackendBase


def _outcome(function, part):
    """The results of one part of a trajectory, as ``AnalysisBase.run`` uses them; the universe is not sent back."""
    done = function(part)
    return SimpleNamespace(frames=done.frames, times=done.times, results=done.results)


class Processes(BackendBase):
    """Processes that analyze parts of a trajectory; ``progress(iterator, total)`` wraps finished parts.

    A process returns only results.

    >>> from gearquat_analysis import Poses, open_dump
    >>> from gearquat_analysis.backends import Processes
    >>> poses = Poses(open_dump("nitrogen.dump").atoms)
    >>> poses.run(backend=Processes(2), n_parts=4, unsupported_backend=True, step=10).n_frames
    81
    """

    def __init__(self, n_workers, progress=None):
        super().__init__(n_workers)
        self._progress = progress

    def apply(self, func, computations):
        with Pool(self.n_workers) as pool:
            parts = pool.imap(functools.partial(_outcome, func), computations)
            return list(self._progress(parts, len(computations)) if self._progress else parts)
