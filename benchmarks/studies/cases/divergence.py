"""The time for which two runs agree, the energy conservation of a run, and the direction in which a body leaves.

Arrays in, numbers out; nothing is drawn or printed here.  Lengths, times and energies are in the units of the run.
"""

import numpy as np

#: beyond this distance from the center of the cage (its corners: 173) the body has left it
OUTSIDE = 200.0


def separation(first, second):
    """Distances (n,) between the centers of mass of two series at their n common times.

    Both must be sampled at the same times from the start on; the longer one is truncated.
    """
    n = min(len(first.time), len(second.time))
    if not np.allclose(first.time[:n], second.time[:n], rtol=1e-9, atol=1e-9):
        raise ValueError("the two series are not sampled at the same times")
    return np.linalg.norm(first.center[:n] - second.center[:n], axis=1)


def first_time(time, condition):
    """First of the times (n,) at which a condition (n,) is true; infinite if it never is."""
    return float(time[condition.argmax()]) if condition.any() else float("inf")


def lasting_from(time, condition):
    """First of the times (n,) from which a condition (n,) is true until the end; infinite if there is none."""
    begin = len(time) - condition[::-1].cumprod().sum()
    return float(time[begin]) if begin < len(time) else float("inf")


def parting_time(first, second, threshold):
    """First sampled time at which the centers of mass are farther apart than ``threshold``."""
    apart = separation(first, second)
    return first_time(first.time[: len(apart)], ~(apart <= threshold))


def energy_error(series):
    """Deviation of the total energy from its first value, shape (n,)."""
    return series.total - series.total[0]


def energy_scale(series):
    """Range (largest minus smallest value) of the potential energy, the height of the figures with energies."""
    return float(np.ptp(series.potential))


def drift_onset(series, fraction=0.02):
    """Time from which the total energy differs from its start by more than ``fraction`` of the potential's range.

    Returns (time, sign): infinite and 0 if the last sample is within this limit.
    """
    error = energy_error(series)
    beyond = np.abs(error) > fraction * energy_scale(series)
    return lasting_from(series.time, beyond), int(np.sign(error[-1])) if beyond[-1] else 0


def leaving_time(series):
    """Time after which the body stays outside the cage; infinite if it is inside at the end."""
    return lasting_from(series.time, np.linalg.norm(series.center, axis=1) > OUTSIDE)


def leaving_axis(series):
    """Axis along which the body leaves, as "+x" … "-z"; "" if it has not left.

    It is the largest component of the last velocity (difference of the last two samples).
    """
    if not np.isfinite(leaving_time(series)):
        return ""
    velocity = series.center[-1] - series.center[-2]
    axis = int(np.argmax(np.abs(velocity)))
    return ("-" if velocity[axis] < 0 else "+") + "xyz"[axis]
