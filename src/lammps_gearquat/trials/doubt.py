"""The time until which the reference is accurate enough to judge an error."""

import math

import numpy as np

from gearquat_analysis.tables import rounded

MARGIN = 3.0  # an error is judged if it exceeds the uncertainty of the reference by this factor
SHORTEST = 0.1  # of the time to be measured
#: with at least this many bodies, a run whose trajectories diverge is assumed to serve averages
MANY = 8


def cut_to(time, doubt, errors):
    """(index of the sample at which to end, the reason if it is not the last).

    It is the latest sample at which the smallest error can be judged; if that is too early, the next error is used.
    """
    for error in sorted(errors):
        good = np.flatnonzero(MARGIN * np.maximum.accumulate(doubt) < error)
        if len(good) == len(time):
            return len(time) - 1, ""
        if len(good) >= SHORTEST * len(time):
            return int(good[-1]), (
                f"the trials end at t = {time[good[-1]]:g}, not at {time[-1]:g}, because the two best trials"
                f" differ by more than {rounded(error / MARGIN, 2)} later, so an error of {error:g} cannot be judged"
            )
    index = max(int(SHORTEST * len(time)) - 1, 0)
    return index, f"the two best trials differ by {rounded(doubt[index], 2)} already at a tenth of the time"


def chaotic(time, difference, end, error):
    """True if a ``difference`` (S,) of two trials at the times (S,) would be larger than ``error`` at ``end`` if it
    grew exponentially, as for many bodies, at the rate of the second half.
    """
    largest = np.maximum.accumulate(difference)
    half = len(time) // 2
    rate = math.log(largest[-1] / largest[half - 1]) / (time[-1] - time[half - 1])
    return math.log(MARGIN * largest[-1] / error) + rate * (end - time[-1]) > 0.0
