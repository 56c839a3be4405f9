"""Stays of bodies near given places, such as the sites of a cage."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from . import mapped
from .averages import weights_of
from .correlations import lags


@dataclass(frozen=True)
class Stays:
    """K uninterrupted stays of B bodies at S places, in F frames.

    ``body``, ``place`` (K,): counted from 0; ``begin``, ``end`` (K,): the first frame, and the frame after the last;
    ``time`` (F,).

    >>> from gearquat_analysis import Poses, open_dump, residence
    >>> results = Poses(open_dump("nitrogen.dump").atoms).run(step=10).results
    >>> found = residence.stays(results.center, results.center[0, :5], 1.0, results.time)
    >>> found.places, found.survival().shape, bool(found.complete.any())
    (5, (81,), True)
    """

    body: np.ndarray
    place: np.ndarray
    begin: np.ndarray
    end: np.ndarray
    time: np.ndarray
    bodies: int
    places: int

    def of(self, bodies):
        """Stays of some ``bodies`` (b,), given by their numbers, which do not change."""
        own = np.isin(self.body, bodies)
        each = (values[own] for values in (self.body, self.place, self.begin, self.end))
        return Stays(*each, self.time, len(bodies), self.places)

    @property
    def frames(self):
        return self.end - self.begin

    @property
    def complete(self):
        """True (K,) if both the beginning and the end of a stay are within the trajectory."""
        return (self.begin > 0) & (self.end < len(self.time))

    def fraction(self):
        """Fraction (S,) of the time of all bodies that is spent at each place; frames are weighted as in averages."""
        weights = weights_of(self.time)
        passed = np.concatenate([[0.0], np.cumsum(np.ones(len(self.time)) if weights is None else weights)])
        spent = np.bincount(self.place, passed[self.end] - passed[self.begin], self.places)
        return spent / (self.bodies * passed[-1])

    def survival(self):
        """Probability (F,) that a body at a place stays there without interruption for a lag.

        It is a mean over all origins for which the trajectory is long enough, and NaN if there are none.  Raises
        ValueError unless frames are evenly spaced in time.
        """
        lags(self.time)
        frames = len(self.time)
        # a stay of n frames covers a lag from n - lag origins, so the counts are double cumulative sums over longer
        # stays
        longer = np.cumsum(np.bincount(self.frames, minlength=frames + 1)[::-1])[::-1]
        lasting = np.cumsum(longer[1:][::-1])[::-1].astype(float)
        change = np.bincount(self.begin, minlength=frames + 1) - np.bincount(self.end, minlength=frames + 1)
        asked = np.cumsum(np.cumsum(change)[:frames])[::-1]
        return np.divide(lasting, asked, out=np.full(frames, np.nan), where=asked > 0)


def stays(center, places, radius, time, progress=iter):
    """Stays of centers (F, B, 3) within ``radius`` of the nearest of ``places`` (S, 3).

    ``time`` (F,); ``progress`` wraps the iteration over frames.  Raises ValueError if the radius is not
    positive, or if places are not finite points.
    """
    places = np.atleast_2d(np.asarray(places, dtype=float))
    if places.shape[1] != 3 or not np.isfinite(places).all():
        raise ValueError("places: three coordinates each are required")
    if not radius > 0.0:
        raise ValueError(f"radius {radius:g}: it must be above zero")
    tree, nowhere = cKDTree(places), len(places)
    frames, bodies = center.shape[:2]
    at, since, rows = np.full(bodies, nowhere), np.zeros(bodies, dtype=int), []

    def change(k, now):
        left = np.flatnonzero((now != at) & (at < nowhere))
        rows.append(np.column_stack([left, at[left], since[left], np.full(len(left), k)]))
        since[now != at] = k
        at[:] = now

    for k in progress(mapped.rows(center)):
        change(k, tree.query(center[k], distance_upper_bound=radius)[1])
    change(frames, np.full(bodies, nowhere))
    columns = np.concatenate(rows).T
    return Stays(*columns, np.asarray(time, dtype=float), bodies, len(places))
