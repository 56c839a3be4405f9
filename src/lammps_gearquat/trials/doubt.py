"""The time until which the reference is accurate enough to judge an error, and notes where it is too short."""

import math

import numpy as np

from gearquat_analysis.tables import rounded

MARGIN = 3.0  # an error is judged if it exceeds the uncertainty of the reference by this factor
SHORTEST = 0.1  # of the time to be measured
#: with at least this many bodies, a run whose trajectories diverge is assumed to serve averages
MANY = 8


def judged_at(doubt, error):
    """Indices of the samples up to which an error can be judged."""
    return np.flatnonzero(MARGIN * np.maximum.accumulate(doubt) < error)


def known_until(time, doubt, errors):
    """Times until which errors that cannot be judged at the end can be judged: list of notes."""
    notes = []
    for error in errors:
        known = judged_at(doubt, error)
        until = f"only until t = {time[known[-1]]:g}" if len(known) else f"not even until t = {time[0]:g}"
        notes.append(f"an error of {error:g} can be judged {until}: the two best trials differ by more")
    return notes


def cut_to(time, doubt, errors):
    """(index of the sample at which to end, the reason if it is not the last).

    It is the latest sample at which the smallest error can be judged; if that is too early, the next error is used.
    """
    last = len(time) - 1
    for error in sorted(errors):
        good = judged_at(doubt, error)
        if len(good) and (good[-1] + 1) / len(time) >= SHORTEST:
            if good[-1] == last:
                return last, ""
            return int(good[-1]), (
                f"the trials end at t = {time[good[-1]]:g}, not at {time[-1]:g}, because the two best trials"
                f" differ by more than {rounded(error / MARGIN, 2)} later, so an error of {error:g} cannot be judged"
            )
    index = max(int(SHORTEST * len(time)) - 1, 0)
    return index, (
        f"the two best trials differ by {rounded(doubt[index], 2)} already at a tenth of the time, so none of"
        " the errors can be judged in this scene"
    )


def diverging(time, doubt, end, error):
    """True if the trajectory cannot be followed to ``end``.

    This is the case if two trials of high accuracy, which differ by ``doubt`` (S,) at the times (S,), will differ too
    much at ``end`` even for the largest ``error`` of interest.  Beyond the last time the difference is extrapolated by
    the power law of its second half.
    """
    largest = np.maximum.accumulate(doubt)
    half = len(time) // 2
    power = max(math.log(largest[-1] / largest[half - 1]) / math.log(time[-1] / time[half - 1]), 1.0)
    return bool(MARGIN * largest[-1] * max(end / time[-1], 1.0) ** power > error)


def chaotic(time, difference, end, error):
    """True if a ``difference`` (S,) of two trials at the times (S,) would be larger than ``error`` at ``end`` if it
    grew exponentially, as for many bodies, at the rate of the second half.
    """
    largest = np.maximum.accumulate(difference)
    half = len(time) // 2
    rate = math.log(largest[-1] / largest[half - 1]) / (time[-1] - time[half - 1])
    return math.log(MARGIN * largest[-1] / error) + rate * (end - time[-1]) > 0.0 and end > 1.01 * time[-1]
