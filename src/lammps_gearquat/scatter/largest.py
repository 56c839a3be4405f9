"""The largest impact parameter: beyond it flights are left out, and what that changes is estimated.

Pilot flights with the same starts are flown at distances in geometric progression up to the cutoff.  What
they lose, h(b), times 2 pi b is integrated from outside inwards.  Of the forces that the cutoff takes away, a power
law through h between NEAR and FAR times the cutoff estimates the effect.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..trials.script import DeckError
from . import flights
from .integrals import Collisions
from .sampling import REPLICAS, weight

#: distances of pilot flights, the nearest by the cutoff, and how many flights at each
DISTANCES, NEAREST, FLIGHTS = 24, 0.04, 2 * REPLICAS
#: part of the cutoff in which the decay is fitted
NEAR, FAR = 0.4, 0.75
#: part of the losses of momentum and of viscosity that is outside of the core
OUTSIDE = 0.1
#: losses below this are rounding
NOTHING = 1e-14
#: marks the random numbers of pilot flights
PILOT = 1
LOSSES = ("momentum", "viscosity", "rotation")


@dataclass(frozen=True)
class Largest:
    """``value``, the largest impact parameter; ``left``: name -> part of the whole beyond it; ``pilots``, flights;
    ``core``, the impact parameter within which most of every loss is, 0 if that is not known."""

    value: float
    left: dict
    pilots: int
    core: float = 0.0


def losses(columns, scale, moments):
    """Array (3,): means of x (1 - cos chi), x^2 sin^2 chi and of the squared gain of rotation over the flux."""
    pairs = Collisions.of(columns, scale)
    parts = [pairs.x * (1.0 - pairs.cosine), pairs.x**2 * pairs.sine2, pairs.gain**2]
    return np.array([(weight(pairs.x, moments) * part).mean() for part in parts])


def beyond(b, h):
    """Integrals (n, 3) of 2 pi b h from each distance (n,) to the last; ``h`` (n, 3)."""
    slices = np.pi * np.diff(b**2)[:, None] * 0.5 * (h[1:] + h[:-1])
    return np.vstack([np.cumsum(slices[::-1], axis=0)[::-1], np.zeros(h.shape[1])])


def taken_away(b, h, cutoff):
    """Integral (3,) from the cutoff to infinity of 2 pi b times the power law of h between NEAR and FAR."""
    inside = (b >= NEAR * cutoff) & (b <= FAR * cutoff)
    result = np.zeros(h.shape[1])
    for k, values in enumerate(h[inside].T):
        if (values > NOTHING).all():
            slope, level = np.polyfit(np.log(b[inside] / cutoff), np.log(values), 1)
            result[k] = 2.0 * np.pi * cutoff**2 * np.exp(level) / (-slope - 2.0) if slope < -2.0 else np.inf
    return result


def find(pool, plan, scale, allowed):
    """Largest, so that what is beyond it is at most the part ``allowed`` of every loss.

    Raises DeckError if that is beyond the cutoff.
    """
    facts = pool.facts
    b = facts.cutoff * np.geomspace(NEAREST, 1.0, DISTANCES)
    pilots = replace(plan, seed=(*plan.seed, PILOT))
    flown = pool.fly_at(pilots, range(FLIGHTS), b)
    rows = [[flights.row(one) for one in some] for some in flown]
    h = np.array([losses(flights.columns(some), scale, facts.moments) for some in rows])
    h[h < NOTHING] = 0.0
    if not any(facts.freedoms):
        h[:, LOSSES.index("rotation")] = 0.0  # what atoms gain is the error of a flight
    outer = beyond(b, h)
    whole = outer[0] + np.pi * b[0] ** 2 * h[0]
    missing = taken_away(b, h, facts.cutoff)
    with np.errstate(invalid="ignore", divide="ignore"):
        left = np.where(whole > 0.0, (outer + missing) / whole, 0.0)
    if (left[-1] > allowed).any():
        worst = int(np.argmax(left[-1]))
        if not np.isfinite(left[-1, worst]):
            raise DeckError(
                f"the loss of {LOSSES[worst]} does not decay towards the cutoff of {facts.cutoff:.6g}, so what the"
                " cutoff takes away is not known; a longer cutoff is required, or the largest impact parameter with"
                " --largest"
            )
        raise DeckError(
            f"the cutoff of {facts.cutoff:.6g} is inside the largest impact parameter: the forces that it takes"
            f" away are {left[-1, worst]:.1e} of the loss of {LOSSES[worst]}, and {allowed:.1e} is allowed, a tenth of"
            " --error; a longer cutoff or a larger --error is required"
        )
    first = int(np.argmax((left <= allowed).all(axis=1)))
    within = int(np.argmax((left[:, :2] <= OUTSIDE).all(axis=1)))
    core = rounded(b[min(within, first - 1)])
    return Largest(rounded(b[first]), dict(zip(LOSSES, left[first].tolist())), DISTANCES * FLIGHTS, core)


def given(facts, value):
    """Largest of an impact parameter that the user has given.  Raises DeckError."""
    if value > facts.cutoff:
        raise DeckError(
            f"--largest {value:g}: the cutoff of {facts.cutoff:.6g} is inside it; a longer cutoff is required"
        )
    return Largest(value, {}, 0)


def rounded(value):
    """Up to three digits: the same where the last digits of flights differ."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 2)
    return float(f"{np.ceil(value / unit) * unit:.3g}")
