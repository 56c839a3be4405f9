"""The record of a flight: a row of numbers and words; many flights form columns."""

from dataclasses import astuple, dataclass, fields

import numpy as np

from .pair import cross
from .sampling import starts_of

WORDS = ("fate", "message")
WHOLE = ("flight", "turnings", "steps", "repeats")


@dataclass(frozen=True)
class Flight:
    """One flight, in units of the deck.

    ``flight``, its number; ``b``, impact parameter; ``energy``, of the relative translation, and
    ``rotation_1``, ``rotation_2``, of the rotation of both bodies, before and ``_after``; ``angle``, by which the
    relative velocity has turned, in radians.  ``time``, ``closest``, ``turnings``, ``steps``, ``repeats``, ``fate``
    and ``message`` as in ``pair.End``.  Errors are changes from the start to the end: ``error_energy`` by the
    energy at the start, ``error_momentum`` by the momentum of one body, ``error_angular`` by this momentum times
    ``closest``.  For flights that have not parted, the angle and the columns ``..._after`` are NaN.
    """

    flight: int
    b: float
    energy: float
    rotation_1: float
    rotation_2: float
    angle: float
    energy_after: float
    rotation_1_after: float
    rotation_2_after: float
    time: float
    closest: float
    turnings: int
    steps: int
    repeats: int
    error_energy: float
    error_momentum: float
    error_angular: float
    fate: str
    message: str


HEADER = tuple(field.name for field in fields(Flight))


def row(flight):
    """Words of a Flight, with all digits."""
    return [str(value) for value in astuple(flight)]


def columns(rows):
    """Columns of rows of words, by name: arrays (n,) of numbers, and of words."""
    table = dict(zip(HEADER, zip(*rows))) if rows else dict.fromkeys(HEADER, ())
    kinds = {**dict.fromkeys(WORDS, str), **dict.fromkeys(WHOLE, int)}
    return {name: np.array(values, dtype=kinds.get(name, float)) for name, values in table.items()}


def fly(pair, plan, numbers, most_steps):
    """List of the Flights with these numbers."""
    planned = plan.starts(pair, numbers)
    return [judge(pair, number, one, pair.fly(one[2], most_steps)) for number, one in zip(numbers, planned)]


def fly_pilots(pair, b, energy, thermal, random, most_steps):
    """List of Flights with impact parameters, energies and kT of rotation (n,); ``random`` (n, m), the other random
    numbers."""
    planned = starts_of(pair, b, energy, thermal, random)
    return [judge(pair, 0, one, pair.fly(one[2], most_steps)) for one in planned]


def judge(pair, number, planned, end):
    """Make a Flight from its plan (impact parameter, energy, Start) and its outcome, an End."""
    b, energy, start = planned
    before = pair.rotational_energy(start.quaternion, start.momentum)
    known = (int(number), b, energy, *before.tolist())
    course = (end.time, end.closest, end.turnings, end.steps, end.repeats)
    if end.fate != "parted":
        return Flight(*known, *[np.nan] * 4, *course, *[np.nan] * 3, end.fate, end.message)
    mass, length = pair.bodies.mass[:, None], end.closest
    g, g_after = (state.velocity[1] - state.velocity[0] for state in (start, end))
    angle = np.arctan2(np.linalg.norm(cross(g, g_after)), g @ g_after)
    energy_after = 0.5 * pair.units.energy * pair.reduced_mass * (g_after @ g_after)
    after = pair.rotational_energy(end.quaternion, end.momentum)
    change = energy_after + after.sum() - energy - before.sum()
    momentum = pair.reduced_mass * np.linalg.norm(g)
    drift = np.linalg.norm((mass * (end.velocity - start.velocity)).sum(axis=0))
    turn = np.linalg.norm(_angular_momentum(mass, end) - _angular_momentum(mass, start))
    errors = (abs(change) / (energy + before.sum()), drift / momentum, turn / (momentum * length))
    values = (float(angle), float(energy_after), *after.tolist(), *course, *map(float, errors))
    return Flight(*known, *values, end.fate, end.message)


def _angular_momentum(mass, state):
    """Angular momentum of both bodies together about the origin, (3,)."""
    return (mass * cross(state.center, state.velocity) + state.momentum).sum(axis=0)
