"""Pilot flights, which determine the largest impact parameter and the sampling density.

Pilots fill cells: shells of the impact parameter b, in geometric progression up to the cutoff, times levels of the
energy, from the slowest to the fastest that matter.  Each cell contains a few flights at stratified places.  The plan
of a run depends on its pilots only, and s0 and s1 are rounded to three digits, so that the plan is the same even if the
last digits of flights differ.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..trials.script import DeckError
from .density import shares_of
from .integrals import Collisions

#: shells of b, the largest b of the first shell relative to the cutoff; levels of a factor of 3.5 in energy; flights in
#: a cell
SHELLS, NEAREST, LEVEL, ALONG = 24, 0.04, np.log(450.0) / 8, 4
#: energies, by the lowest and by the highest kT
SLOWEST, FASTEST = 0.02, 9.0
#: energies by kT that are common in collisions
COMMON = 2.0
#: part of the cutoff in which the decay is fitted
NEAR, FAR = 0.4, 0.75
#: losses below this are rounding
NOTHING = 1e-14
#: marks the random numbers of pilot flights
PILOT = 1
LOSSES = ("momentum", "viscosity", "rotation")
#: powers p that the fit tries; an addition to the part of a level, so that no level is neglected; a safety factor of
#: areas
FITTED_POWERS, REGARD, SAFETY = (1 / 3, 1 / 2, 1.0), 0.02, 2.0
#: factors of s0 and of s1 that are tried around the best of the shells
FINER = (0.8, 1.0, 1.25)


@dataclass(frozen=True)
class Largest:
    """``value``, the largest impact parameter; ``left``: for each temperature loss -> part of the whole beyond it, None
    where it is not known; ``pilots``, the number of pilot flights."""

    value: float
    left: list
    pilots: int

    def highest(self):
        """The largest omitted fraction of any loss; None if one is unknown."""
        every = [part for one in self.left for part in one.values()]
        return None if None in every else max(every)


@dataclass(frozen=True)
class Cells:
    """The grid of the pilots: ``edges`` (D + 1,) of the shells; ``b`` and ``energy`` (D, L, A); ``width``, of a level
    in the
    logarithm of the energy, 0 for one energy; ``random`` (D L A, m): all other random numbers."""

    edges: np.ndarray
    b: np.ndarray
    energy: np.ndarray
    width: float
    random: np.ndarray

    @property
    def number(self):
        """Number of the pilots."""
        return self.b.size

    @property
    def areas(self):
        """Of the shells, (D,)."""
        return np.pi * np.diff(self.edges**2)

    def flux(self, scale):
        """The part x exp(-x) dx of the flux (D, L, A) that the level of a pilot has at kT ``scale``."""
        if not self.width:
            return np.full(self.b.shape, 1.0)
        x = self.energy / scale
        return x**2 * np.exp(-x) * self.width


def cells(plan, cutoff, boltzmann, dimension):
    """Cells for the Plan, whose ``largest`` and density do not matter; ``dimension``: columns of ``random``."""
    random = np.random.default_rng([*plan.seed, PILOT])
    scales = plan.scales(boltzmann)
    edges = np.concatenate([[0.0], cutoff * np.geomspace(NEAREST, 1.0, SHELLS)])
    low, high = SLOWEST * scales[0], FASTEST * scales[-1]
    levels = _levels(scales)
    # for one energy all levels are the same, so they are merged
    shape = (SHELLS, levels, ALONG) if plan.energy is None else (SHELLS, 1, levels * ALONG)
    square, along = _strata(random, shape), _strata(random, shape)
    b = np.sqrt(edges[:-1, None, None] ** 2 + np.diff(edges**2)[:, None, None] * square)
    if plan.energy is not None:
        return Cells(edges, b, np.full(shape, plan.energy), 0.0, random.random((b.size, dimension)))
    width = np.log(high / low) / levels
    energy = low * np.exp((np.arange(levels)[:, None] + along) * width)
    return Cells(edges, b, energy, width, random.random((b.size, dimension)))


def number_of(plan, boltzmann):
    """Number of pilots of a Plan."""
    return SHELLS * _levels(plan.scales(boltzmann)) * ALONG


def _levels(scales):
    return int(np.ceil(np.log(FASTEST * scales[-1] / (SLOWEST * scales[0])) / LEVEL - 1e-9))


def within_cutoff(facts, value):
    """Raise DeckError if an impact parameter that the user has given is beyond the cutoff."""
    if value > facts.cutoff:
        raise DeckError(
            f"--largest {value:g}: the cutoff of {facts.cutoff:.6g} is inside it; a longer cutoff is required"
        )


def _strata(random, shape):
    """Numbers from 0 to 1 in random order, one per stratum; the last axis gives the number of strata."""
    order = np.argsort(random.random(shape), axis=-1)
    return (order + random.random(shape)) / shape[-1]


def nearest_thermal(plan, boltzmann, energy):
    """kT (n,) of the rotation of pilots with energies (n,); if there are several temperatures, it is the temperature at
    which the energy is common."""
    if plan.rotation is not None or plan.energy is not None:
        return np.full(len(energy), boltzmann * (plan.rotation or 0.0))
    scales = np.array(plan.scales(boltzmann))
    return scales[np.abs(np.log(energy[:, None] / (COMMON * scales))).argmin(axis=1)]


def settle(plan, facts, places, columns, boltzmann, allowed, given=None):
    """(Plan, Largest) from the ``columns`` of the pilots at ``places``, Cells.

    Beyond the largest impact parameter there is at most the part ``allowed`` of every loss, unless this parameter is
    ``given``.  Raises DeckError.
    """
    gone = _parted(columns)
    scales = plan.scales(boltzmann)
    lost = losses(columns, scales[0], plan.balanced(facts.freedoms), any(facts.freedoms))
    lost = lost.reshape(*places.b.shape, len(LOSSES))
    left = np.array([beyond(places, lost, scale, facts.cutoff) for scale in scales])
    value = given or rounded(_nearest(left.max(axis=0), places.edges, allowed, facts.cutoff, gone))
    known = [_left_at(value, places.edges, one) for one in left]
    s0, s1, power = fit(places, lost, value, scales)
    return replace(plan, largest=value, s0=s0, s1=s1, power=power), Largest(value, known, places.number)


def _left_at(value, edges, left):
    """Loss -> part beyond the impact parameter ``value``, None if it is unknown; ``left`` (D + 1, 3) at the edges."""
    parts = [float(np.interp(value**2, edges**2, column)) for column in left.T]
    return {name: part if np.isfinite(part) else None for name, part in zip(LOSSES, parts)}


def _parted(columns):
    """Words about pilots that have not parted, "" if all have.  Raises DeckError if most have not."""
    fate, parts = columns["fate"], []
    unparted, lost = np.count_nonzero(fate == "unparted"), np.count_nonzero(fate == "lost")
    if unparted:
        parts.append(f"{unparted} of {len(fate)} pilot flights have not parted within --steps; increase --steps")
    if lost:
        parts.append(f"LAMMPS ended {lost} of {len(fate)} pilot flights ({columns['message'][fate == 'lost'][0]})")
    words = "; ".join(parts)
    if unparted + lost > 0.5 * len(fate):
        raise DeckError(words)
    return words


def losses(columns, scale, balanced, turning):
    """Array (n, 3): sizes of F_11 and F_22 and the squared gain of rotation, of each pilot; see integrals.py."""
    pairs = Collisions.of(columns, scale, balanced)
    # the energy gained by atoms is the error of a flight
    gain = pairs.gain**2 if turning else np.zeros(len(pairs.x))
    found = np.column_stack([np.abs(pairs.change(0)), np.abs(pairs.f22), gain])
    found[found < NOTHING] = 0.0
    return found


def beyond(places, lost, scale, cutoff):
    """Part (D + 1, 3) of every loss beyond each edge, with the part removed by the cutoff; inf if it is unknown.

    ``lost`` (D, L, A, 3); ``scale``, kT.
    """
    h = (lost * places.flux(scale)[..., None]).mean(axis=2).sum(axis=1)
    shells = places.areas[:, None] * h
    outer = np.vstack([np.cumsum(shells[::-1], axis=0)[::-1], np.zeros(h.shape[1])])
    middle = np.sqrt((places.b**2).mean(axis=(1, 2)))
    missing = taken_away(middle, h, cutoff)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(outer[0] > 0.0, (outer + missing) / outer[0], 0.0)


def taken_away(b, h, cutoff):
    """Integral (3,) from the cutoff to infinity of 2 pi b times the power law of h (n, 3) between NEAR and FAR."""
    inside = (b >= NEAR * cutoff) & (b <= FAR * cutoff)
    result = np.zeros(h.shape[1])
    for k, values in enumerate(h[inside].T):
        if (values > NOTHING).all():
            slope, level = np.polyfit(np.log(b[inside] / cutoff), np.log(values), 1)
            result[k] = 2.0 * np.pi * cutoff**2 * np.exp(level) / (-slope - 2.0) if slope < -2.0 else np.inf
    return result


def _nearest(left, edges, allowed, cutoff, gone):
    """The nearest edge beyond which at most ``allowed`` is left (D + 1, 3) of every loss.

    ``gone``: text about pilots that have not parted.  Raises DeckError.
    """
    if (left[-1] > allowed).any() and gone:
        raise DeckError(f"{gone}: the largest impact parameter cannot be found")
    if (left[-1] > allowed).any():
        loss, part = LOSSES[int(np.argmax(left[-1]))], left[-1].max()
        if not np.isfinite(part):
            raise DeckError(
                f"the loss of {loss} does not decay towards the cutoff of {cutoff:.6g}, so the error due to the cutoff"
                " is not known; a longer cutoff is required, or the largest impact parameter with --largest"
            )
        raise DeckError(
            f"the cutoff of {cutoff:.6g} is inside the largest impact parameter: collisions beyond it contribute"
            f" {part:.1e} of the loss of {loss}, but only {allowed:.1e}, a tenth of --error, is allowed;"
            " a longer cutoff or a larger --error is required"
        )
    return edges[max(int(np.argmax((left <= allowed).all(axis=1))), 1)]


def fit(places, lost, largest, scales):
    """(s0, s1, p) of the density for which the losses of the pilots within ``largest`` are most likely, with a safety factor.

    The weight of a pilot is its part of the loss at its energy, times the part of this level of energies in the loss of
    momentum and of viscosity.  ``scales`` (T,): kT of the temperatures.
    """
    count = max(int(np.searchsorted(places.edges, largest * 1.01)) - 1, 1)
    area, size = places.areas[:count, None, None, None], lost[:count, ..., :2]
    at_level = (area * size).mean(axis=2).sum(axis=0)  # (L, 2)
    part = np.zeros_like(at_level)
    for share, scale in zip(shares_of(len(scales)), scales):
        level = (area * size * places.flux(scale)[:count, ..., None]).mean(axis=2).sum(axis=0)
        part += share * level / np.maximum(level.sum(axis=0), 1e-300)
    regard = (part + REGARD) / np.maximum(at_level, 1e-300)
    weight = (area * size * regard[:, None]).sum(axis=-1).ravel()
    square = (places.b[:count] ** 2).ravel()
    x = (places.energy[:count] / scales[0]).ravel()
    kept = weight > 1e-9 * weight.max()
    s0, s1, power = _likeliest(weight[kept], square[kept], x[kept], largest, places.edges[2 : count + 1 : 2] ** 2)
    return float(f"{SAFETY * s0:.3g}"), float(f"{SAFETY * s1:.3g}"), power


def _likeliest(weight, square, x, largest, tried):
    """(s0, s1, p) with the smallest cross entropy, of the squares of edges ``tried`` (k,) and then finer."""

    def entropy(s0, s1, power):
        reach = s0 + s1 * x**-power
        most = largest**2 / reach
        norm = np.where(most <= 1.0, most, 2.0 - 1.0 / np.maximum(most, 1.0))
        return float((weight * (2.0 * np.log(np.maximum(square / reach, 1.0)) + np.log(reach * norm))).sum())

    areas = (0.0, *(tried if len(tried) else (largest**2,)))
    slow, powers = (areas, FITTED_POWERS) if np.ptp(x) else ((0.0,), FITTED_POWERS[-1:])
    choices = [(s0, s1, power) for power in powers for s0 in areas for s1 in slow if s0 or s1]
    best = min(choices, key=lambda choice: entropy(*choice))
    for _ in range(2):
        s0, s1, power = best
        choices = [(s0 * one, s1 * two, power) for one in FINER for two in FINER]
        best = min(choices, key=lambda choice: entropy(*choice))
    return best


def rounded(value):
    """A number with up to three digits, so that differences in the last digits of flights do not matter."""
    unit = 10.0 ** (np.floor(np.log10(value)) - 2)
    return float(f"{np.ceil(value / unit) * unit:.3g}")
