"""Averages over a run with standard errors: temperatures, the volume, diffusion, rotational correlation times.

Each error rests on an assumption, which is checked: independent blocks for temperatures, a linear range of the
mean-square displacement for diffusion, an exponential tail for correlation times.  If an assumption fails, the error is
NaN, and ``why`` has the reason; only means over all frames, such as temperatures, have a value then.  All functions take finished ``Poses``, which contain masses and moments.
"""

import math
import warnings
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from .units import UNITS
from . import box, correlations, export
from .blocks import Estimate, of_series, scatter, widening
from .bodies import axes_named, axis_groups, equal_moments
from .diffusion import diffusion
from .fluctuations import compressibility, dielectric_constant
from .kinds import kinds, of_kind, too_many
from .tables import with_error

#: number of blocks of a run and number of groups of bodies; the scatter among them is the error of a correlation time
LONG_BLOCKS, GROUPS = 5, 10
#: fewest frames of a block
FEWEST = 20
#: the total momentum counts as zero if its energy is below this fraction of the energy of a degree of freedom
AT_REST = 1e-3
#: in a run of dimension 2, angular velocities about x and y up to this fraction of the angular velocities about z are
#: round-off
IN_PLANE = 1e-6
#: value of the correlation at which its sum ends, lower values if the tail is not exponential there, and the multiple of
#: this value at which the fit of the tail begins
TAIL, LOWER, BEFORE_TAIL = 0.1, (0.05, 0.02), 3.0
#: its error is from its own series, because at constant energy the two temperatures are anticorrelated
DIFFERENCE = "temperature difference of translation minus rotation"
#: fewest frames up to the end of the sum
RESOLVED = 3
#: the tail is compared with the exponential up to this multiple of the lag where it begins, and up to this fraction of a
#: block; a difference is significant above this number of standard errors, and too large above this fraction of the
#: correlation time
LATER, OF_BLOCK, SIGNIFICANT, TOO_LARGE = 3, 0.8, 3.0, 0.05


class Average(NamedTuple):
    """An average over a run with its standard error, which is NaN, with the reason in ``why``, if its assumption fails.

    >>> from gearquat_analysis.averages import Average
    >>> Average("diffusion coefficient", 0.3124, 0.0153, "Å²/ps").text()
    '0.312 ± 0.015 Å²/ps'
    """

    name: str
    value: float
    error: float
    unit: str
    why: str = ""

    @property
    def known(self):
        return bool(np.isfinite([self.value, self.error]).all())

    def text(self):
        """Value and error as text, with two digits of the error: 0.312 ± 0.015 Å²/ps, (2.74 ± 0.19)e-4 Å²/fs."""
        return with_error(self.value, self.error, self.unit)


class Averages(list):
    """A list of every Average.

    >>> from gearquat_analysis import Poses, averages, open_dump
    >>> found = averages.averages(Poses(open_dump("nitrogen.dump").atoms).run(step=4))
    >>> found.to_dataframe()["name"][1], len(found)
    ('temperature of rotation', 6)
    """

    def to_dataframe(self):
        """pandas.DataFrame with the columns name, value, error, unit and why."""
        columns = dict(zip(Average._fields, zip(*self)))
        return export.dataframe(columns, {})


def weights_of(time):
    """Weights (F,) of frames at ``time`` (F,): half of the time from the frame before to the frame after.

    The first and the last frame have the whole distance to their neighbor, so that evenly spaced frames have equal
    weights.  Returns None, which means equal weights, if times decrease or are all the same.
    """
    gaps = np.diff(time)
    return np.gradient(time) if gaps.any() and (gaps >= 0.0).all() else None


def _boltzmann(poses):
    return UNITS[poses.units or "lj"].boltzmann


def dimension(results):
    """2 if no center moves along z and bodies rotate about z only, as in a run of dimension 2; else 3."""
    moved = np.ptp(results.center, axis=0).max(axis=0)
    if moved[2] > 0.0 or not moved.any():
        return 3
    if "omega_space" not in results:
        return 2
    largest = np.abs(results.omega_space).max(axis=(0, 1))
    return 2 if largest[:2].max() <= IN_PLANE * largest[2] else 3


def _sums(poses):
    """Twice the kinetic energies of translation (F,), of rotation (F,), of the total momentum (F,) and of rotation about
    each principal axis (F, 3), in units of energy.  Axes with equal moments have their mean."""
    bodies, results = poses.bodies, poses.results
    energy, frames = UNITS[poses.units or "lj"].energy, len(results.time)
    equal = equal_moments(bodies.moments)
    share = equal / equal.sum(axis=1, keepdims=True)
    translation, rotation, total, about = np.empty(frames), np.empty(frames), np.empty(frames), np.empty((frames, 3))
    for k in range(frames):
        translation[k] = 2.0 * results.ke_translation[k].sum()
        rotation[k] = 2.0 * results.ke_rotation[k].sum()
        total[k] = energy * np.sum((bodies.mass @ results.velocity[k]) ** 2) / bodies.mass.sum()
        omega_body = Rotation.from_quat(results.q[k], scalar_first=True).inv().apply(results.omega_space[k])
        spin = np.einsum("bkj,bj->bk", bodies.axes, omega_body)
        about[k] = energy * np.einsum("bkl,bl->k", share, bodies.moments * spin**2)
    return translation, rotation, total, about


def temperatures(poses):
    """Temperatures of all frames, name -> (F,): of translation, of rotation and about each principal axis.

    Axes with equal moments are arbitrary, so each has their mean temperature; if the moments are equal in all bodies,
    the mean is given once.

    The total momentum is not counted as a degree of freedom if it is zero.  In two dimensions (``dimension``) a body has
    two degrees of freedom of translation and one of rotation.  Empty without velocities or masses.  In LAMMPS' units;
    without ``units``, in units of mass x velocity^2.
    """
    bodies, results, k = getattr(poses, "bodies", None), poses.results, _boltzmann(poses)
    if bodies is None or "velocity" not in results:
        return {}
    translation, rotation, total, about = _sums(poses)
    dimensions = dimension(results)
    resting = total.mean() < AT_REST * translation.mean() / (dimensions * len(bodies))
    freedoms = dimensions * (len(bodies) - (1 if resting and len(bodies) > 1 else 0))
    found = {"translation": translation / (freedoms * k)}
    turning = bodies.moments > 0.0
    if not turning.any():
        return found
    if dimensions == 2:
        found["rotation"] = rotation / (turning.any(axis=1).sum() * k)
        return found
    found["rotation"] = rotation / (turning.sum() * k)
    groups = [axes for axes in axis_groups(bodies.moments[turning[:, 0]]) if turning[:, axes[0]].any()]
    if len(groups) > 1:  # a single group has the temperature of rotation
        for axes in groups:
            own = turning[:, axes[0]].sum()
            found[f"rotation about {axes_named(axes)}"] = about[:, axes[0]] / (own * k)
    return found


def of_box(poses):
    """Volume and density of all frames, name -> (F,), in units of LAMMPS; empty if the box does not change or is not periodic.

    There is a density only if all atoms of the trajectory are in bodies.
    """
    results, bodies = poses.results, getattr(poses, "bodies", None)
    if not box.changes(results) or not poses.periodic.all():
        return {}
    volume = np.abs(np.linalg.det(results.cell[:, 1:]))
    if bodies is None or len(bodies.masses) < len(poses.atoms.universe.atoms):
        return {"volume": volume}
    return {"volume": volume, "density": UNITS[poses.units or "lj"].density * bodies.mass.sum() / volume}


def _long_blocks(frames):
    """Slices of the blocks in which functions of time are computed; no slices if the blocks would be too short."""
    length = frames // LONG_BLOCKS
    first = frames - length * LONG_BLOCKS
    return [slice(first + i * length, first + (i + 1) * length) for i in range(LONG_BLOCKS)] if length >= FEWEST else []


def _end(correlation, tail):
    """Index of the first lag, within the first half, at which a correlation function (F,) is below ``tail``; 0 if none is."""
    return int(np.argmax(correlation[: len(correlation) // 2] < tail))


def _decay(lag, correlation, end, tail):
    """Decay time (factor e) of a correlation function between the lag where it is three times ``tail`` and lag ``end``."""
    before = min(int(np.argmax(correlation < BEFORE_TAIL * tail)), end - 1)
    if not correlation[end] > 0.0:
        return 0.0
    return (lag[end] - lag[before]) / math.log(correlation[before] / correlation[end])


def integral_time(lag, correlation, tail=TAIL):
    """Integral over all times of a correlation function (F,) that begins with 1.

    The function is summed until it falls below ``tail``.  The rest is the integral of an exponential with the decay
    time between three times ``tail`` and ``tail``.  NaN if the function does not fall below ``tail`` within half of the
    lags.
    """
    if not (end := _end(correlation, tail)):
        return math.nan
    rest = correlation[end] * _decay(lag, correlation, end, tail)
    return float(np.trapezoid(correlation[: end + 1], lag[: end + 1]) + rest)


def _beyond(lag, correlation, tail, last):
    """Integral of the function minus the exponential, from the beginning of the tail to lag number ``last``; NaN without a tail."""
    if not (end := _end(correlation, tail)):
        return math.nan
    decay = _decay(lag, correlation, end, tail)
    rest = correlation[end] * decay * -math.expm1(-(lag[last] - lag[end]) / decay) if decay else 0.0
    return float(np.trapezoid(correlation[end : last + 1], lag[end : last + 1]) - rest)


def rotational_time(time, q, axis, order):
    """Estimate of the correlation time of a body's axis, the integral of ``orientation_correlation`` over all times.

    ``integral_time`` computes it, with a tail below 0.1, or below 0.05 or 0.02 if the function is not exponential below
    0.1.  The statistical error is the larger of two: the scatter of blocks of the run and, from 10 bodies on, the
    scatter of groups of bodies.  Errors from the spacing of frames and from the tail are added in quadrature.  NaN if
    blocks are too short for the correlation to decay, if it decays within few frames, or if its tail is never
    exponential, for example if the function oscillates or has a slow part.  ``q`` (F, B, 4); ``time`` (F,), evenly spaced.
    """
    blocks, lag = _long_blocks(len(time)), correlations.lags(time)
    if not blocks:
        return Estimate.missing(f"{len(time)} frames are too few: {LONG_BLOCKS * FEWEST} are required")
    parts = [correlations.orientation_correlation(q[own], axis, order) for own in blocks]
    whole, without = _without_groups(q, axis, order)
    found = Estimate.missing(f"the correlation does not fall below {TAIL} within a tenth of the run")
    for tail in (TAIL, *LOWER):
        if not all(_end(one, tail) for one in (*parts, whole)):
            return found
        found = _correlation_time(lag, whole, parts, without, tail)
        if not np.isnan(found.value):
            return found
    return found


def _correlation_time(lag, whole, parts, without, tail):
    """Estimate of the integral of a function (F,) that is exponential below ``tail``."""
    end = _end(whole, tail)
    if end < RESOLVED:
        return Estimate.missing(f"the correlation falls below {tail} within {end + 1} frames; dump more often")
    last = min(LATER * end, int(OF_BLOCK * len(parts[0])))
    value, statistical = _with_error(integral_time, lag, whole, parts, without, tail)
    beyond, uncertain = _with_error(_beyond, lag, whole, parts, without, tail, last)
    significant = abs(beyond) > SIGNIFICANT * uncertain
    if significant and abs(beyond) > TOO_LARGE * value:
        return Estimate.missing(f"the correlation does not decay as an exponential below {tail}")
    # error of the trapezoidal rule from twice the spacing (Richardson)
    spacing = (integral_time(lag[::2], whole[::2], tail) - value) / 3.0
    return Estimate(value, math.hypot(statistical, spacing, beyond if significant else 0.0))


def _without_groups(q, axis, order):
    """Correlation (F,) of all bodies, and a list of the correlations without each group, empty if there are few bodies."""
    number = q.shape[1]
    if number < GROUPS:
        return correlations.orientation_correlation(q, axis, order), []
    axis = np.asarray(axis, dtype=float)
    axis = np.broadcast_to(axis, (*axis.shape[:-2], number, 3))
    groups = np.array_split(np.arange(number), GROUPS)
    sums = [
        len(own) * correlations.orientation_correlation(q[:, own], axis[..., own, :], order) for own in groups
    ]
    total = np.sum(sums, axis=0)
    return total / number, [(total - part) / (number - len(own)) for part, own in zip(sums, groups)]


def _with_error(find, lag, whole, blocks, without, *more):
    """Result of ``find`` for a function (F,), and its error: the larger of the errors from blocks and from leaving out
    groups of bodies."""
    errors = [float(scatter([find(lag[: len(one)], one, *more) for one in blocks]))]
    if without:
        values = np.array([find(lag, one, *more) for one in without])  # the jackknife
        errors.append(math.sqrt((len(values) - 1) * values.var()) * widening(len(values)))
    return find(lag, whole, *more), max(errors)


# --- the analyses ---------------------------------------------------------------------------------
# a function of one analysis returns name -> Estimate; {} if the run does not have what it takes
class _Run(NamedTuple):
    """Finished ``poses``, ``weights`` of frames, and the series of ``temperatures`` and ``of_box``."""

    poses: object
    weights: np.ndarray
    warm: dict
    box: dict

    def means(self, series):
        return {name: of_series(values, self.weights) for name, values in series.items()}


def _temperatures(run):
    named = {f"temperature of {name}": series for name, series in run.warm.items()}
    if "rotation" in run.warm:
        named[DIFFERENCE] = run.warm["translation"] - run.warm["rotation"]
    return run.means(named)


def _fluctuations(run):
    if not run.warm:
        return {}
    found, temperature = {}, float(np.average(run.warm["translation"], weights=run.weights))
    if run.box:
        found["compressibility"] = compressibility(run.poses, run.box["volume"], temperature, run.weights)
    if np.any(getattr(getattr(run.poses, "atoms", None), "charges", 0.0)):
        found["dielectric constant"] = dielectric_constant(run.poses, temperature, run.weights)
    return found


def _diffusion(poses, of, dimensions):
    results = poses.results
    return {f"diffusion coefficient{of}": diffusion(results.time, box.own_motion(results), dimensions)}


def _correlation_times(poses, of, _dimensions):
    q, _, axes = correlations.turning(poses)
    every = [(group, axis, order) for group, axis in axes.items() for order in (1, 2)]
    words, time = f"correlation time{of + ',' if of else ' of'}", poses.results.time
    return {f"{words} {axes_named(group)}, order {n}": rotational_time(time, q, axis, n) for group, axis, n in every}


#: (function of a _Run, result whose unit its averages have, by default their names)
OF_ALL_FRAMES = ((_temperatures, "temperature"), (lambda run: run.means(run.box), None), (_fluctuations, None))
#: the same, of the poses of one kind at even times, words for the kind, and dimensions
OF_MOTION = ((_diffusion, "diffusion coefficient"), (_correlation_times, "correlation time"))


def _listed(analyses, unit, *arguments):
    """List of Average of all ``analyses``; ``unit``: that of Poses."""
    return [
        Average(name, value, error, unit(result or name), why)
        for function, result in analyses
        for name, (value, error, why) in function(*arguments).items()
    ]


def averages(poses):
    """All Averages that can be computed from finished ``Poses``.

    Frames are weighted by time (``weights_of``).  The difference of the temperatures of translation and rotation, zero in
    equilibrium, has an error of its own.  If the box changes, the Averages include volume and density, and the
    diffusion coefficient describes motion relative to the box.  If frames are not evenly spaced in time, diffusion
    coefficients and correlation times are left out with a warning.  In a mixture each of the ``kinds`` has its own
    diffusion coefficient and correlation times.
    """
    times = poses.results.time
    run = _Run(poses, weights_of(times), temperatures(poses), of_box(poses))
    found = Averages(_listed(OF_ALL_FRAMES, poses.unit, run))
    try:
        correlations.lags(times)
    except ValueError as error:
        warnings.warn(f"there are no diffusion coefficients and correlation times: {error}", stacklevel=2)
        return found
    if too_many(poses):
        warnings.warn("there are too many kinds of bodies: diffusion and correlation times are averages over all bodies", stacklevel=2)
    dimensions = dimension(poses.results)
    for kind in kinds(poses):
        of = f" of {kind.name}" if kind.name else ""
        found += _listed(OF_MOTION, poses.unit, of_kind(poses, kind), of, dimensions)
    return found
