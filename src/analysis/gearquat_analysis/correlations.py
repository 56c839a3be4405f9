"""Mean squares and autocorrelations of poses and motion, averaged over bodies and origins of time.

All functions take arrays (F, B, ...) from ``Poses``, in memory or in a file, and process a few bodies at a time, so
memory does not grow with the number of bodies, unless the box changes, which needs copies of all centers.  They return
(F,): entry k belongs to a lag of k frames, see ``lags``; the last entries are means over few origins of time.  Sums over
origins are computed by Fourier transforms (V. Calandrini et al., Collection SFN 12, 201 (2011), Sec. 4.2).
"""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from scipy import fft
from scipy.spatial.transform import Rotation

from . import box, export
from .bodies import axis_groups, directions
from .kinds import kinds, of_kind

#: largest number of elements of an array in memory
HELD = 1_000_000


def lags(time):
    """Lags (F,) in units of time.  Raises ValueError unless ``time`` (F,) is evenly spaced."""
    time = np.asarray(time, dtype=float)
    gaps = np.diff(time)
    if not len(gaps):
        return time - time[0]
    usual = np.median(gaps)
    # formats such as xtc store times in single precision
    uneven = np.abs(gaps - usual) > 1e-6 * abs(usual) + 2.0 * np.spacing(np.float32(np.abs(time).max()))
    if usual <= 0.0 or uneven.any():
        k = int(np.argmax(uneven))
        raise ValueError(
            "correlations and diffusion need frames that are evenly spaced in time (dump_modify every/time), and these are"
            f" not: the time after frame {k} at {time[k]:.9g} is {time[k + 1]:.9g}"
        )
    return time - time[0]


def portions(values):
    """Slices of bodies such that values (F, b, ...) have a bounded size."""
    frames, bodies = values.shape[:2]
    width = max(1, HELD // (frames * max(1, int(np.prod(values.shape[2:])))))
    for begin in range(0, bodies, width):
        yield slice(begin, min(begin + width, bodies))


def _power(x):
    """Power spectrum of series x (F, b, k), summed over b and k, for lags without wrapping around."""
    transform = fft.rfft(x.reshape(len(x), -1), n=fft.next_fast_len(2 * len(x), real=True), axis=0)
    return (transform.real**2 + transform.imag**2).sum(axis=1)


def _products(power, frames):
    """Sum over origins of x(t) . x(t + lag), (F,), from the power spectrum."""
    return fft.irfft(power, n=fft.next_fast_len(2 * frames, real=True))[:frames]


def _origins(frames):
    return np.arange(frames, 0, -1)


def autocorrelation(values):
    """Mean of x(t) . x(t + lag), of values (F, B, k), such as velocities; units squared."""
    frames, bodies = values.shape[:2]
    power = sum(_power(values[:, own]) for own in portions(values))
    return _products(power, frames) / (_origins(frames) * bodies)


def _square_displacements(x):
    """Sum over bodies and origins of |x(t + lag) - x(t)|^2 of x (F, b, 3), (F,)."""
    x = x - x.mean(axis=0)  # against round-off far from the origin
    square = np.einsum("fbk,fbk->f", x, x)
    ends = np.concatenate([[0.0], np.cumsum(square)])
    both = ends[-1] - ends[:-1] + ends[1:][::-1]  # sum of |x(t + lag)|^2 + |x(t)|^2 over origins
    return both - 2.0 * _products(_power(x), len(x))


def mean_square_displacement(center):
    """Mean of ``|x(t + lag) - x(t)|^2``, (F,), of unwrapped centers (F, B, 3); length squared."""
    frames, bodies = center.shape[:2]
    total = sum(_square_displacements(center[:, own]) for own in portions(center))
    return np.maximum(total, 0.0) / (_origins(frames) * bodies)


def rotation_path(q, axis=None):
    """Rotation since the first frame, summed over turns from frame to frame, (F, b, 3), radians.

    Unlike an angle it is not bounded (S. Kaemmerer, W. Kob, R. Schilling, Phys. Rev. E 56, 5450 (1997),
    Eq. 10).  Components are along space axes.  ``q`` (F, b, 4); ``axis`` (b, 3): axes of linear bodies in the body
    frame, NaN for other bodies; a linear body turns by the shortest rotation of its axis.
    """
    frames, bodies = q.shape[:2]
    turn = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True)
    steps = (turn[bodies:] * turn[:-bodies].inv()).as_rotvec().reshape(-1, bodies, 3)
    if axis is not None:
        linear = np.isfinite(axis[:, 0])
        along = turn.apply(np.tile(axis, (frames, 1))).reshape(frames, bodies, 3)[:, linear]
        cross = np.cross(along[:-1], along[1:])
        sine = np.linalg.norm(cross, axis=-1, keepdims=True)
        angle = np.arctan2(sine, np.einsum("fbi,fbi->fb", along[:-1], along[1:])[..., None])
        steps[:, linear] = cross * np.divide(angle, sine, out=np.ones_like(sine), where=sine > 0)
    return np.concatenate([np.zeros((1, bodies, 3)), np.cumsum(steps, axis=0)])


def mean_square_rotation(q, bodies=None):
    """Mean of ``|phi(t + lag) - phi(t)|^2``, (F,), radians squared; and the largest turn between frames.

    phi is ``rotation_path``.  If bodies turn by more than pi / 2 between frames, some turns may be mistaken for shorter
    turns.  ``q`` (F, B, 4); ``bodies`` (Bodies): needed if some are linear.
    """
    frames, number = q.shape[:2]
    axis = None
    if bodies is not None and bodies.linear.any():
        axis = np.where(bodies.linear[:, None], bodies.axes[:, 2], np.nan)
    total, largest = np.zeros(frames), 0.0
    for own in portions(q):
        path = rotation_path(q[:, own], None if axis is None else axis[own])
        total += _square_displacements(path)
        turns = np.linalg.norm(np.diff(path, axis=0), axis=-1)
        largest = max(largest, turns.max(initial=0.0))
    return np.maximum(total, 0.0) / (_origins(frames) * number), float(largest)


def orientation_correlation(q, axis, order=1):
    """Mean of P(u(t) . u(t + lag)), (F,), of a body's axis u; P is the Legendre polynomial of ``order``.

    ``q`` (F, B, 4); ``axis`` (3,) or (B, 3), in the body frame, or (N, B, 3) for a mean over N axes, such as
    ``bodies.directions``; ``order`` 1 or 2.  Raises ValueError for another order or an axis of zero length.
    """
    if np.ndim(axis) == 3:
        return np.mean([orientation_correlation(q, single, order) for single in axis], axis=0)
    if order not in (1, 2):
        raise ValueError(f"order {order}: 1 or 2 is required")
    axis = np.broadcast_to(np.asarray(axis, dtype=float), (q.shape[1], 3))
    length = np.linalg.norm(axis, axis=1, keepdims=True)
    if not (length > 0).all():
        raise ValueError("an axis must not have zero length")
    axis, frames, power = axis / length, len(q), 0.0
    for own in portions(q):
        turn = Rotation.from_quat(q[:, own].reshape(-1, 4), scalar_first=True)
        along = np.tile(axis[own], (frames, 1))
        u = turn.apply(along).reshape(frames, -1, 3)
        if order == 2:
            # (u . w)^2 is the product of the tensors u u and w w: six different elements
            i, j = np.triu_indices(3)
            u = u[..., i] * u[..., j] * np.where(i == j, 1.0, np.sqrt(2.0))
        power = power + _power(u)
    mean = _products(power, frames) / (_origins(frames) * q.shape[1])
    return mean if order == 1 else 1.5 * mean - 0.5


@dataclass(frozen=True)
class Correlations:
    """Functions of the lag.

    * ``functions``: name -> (F,), ``lag`` first.  In a mixture there is a function for each kind, such as
      ``mean_square_displacement_H2O``.
    * ``units``: name -> unit, as text
    * ``largest_turn``: of a body between two frames, radians; above pi / 2 ``mean_square_rotation`` is not reliable
    * ``kinds``: names of the kinds of bodies, "" if there is only one

    >>> from gearquat_analysis import Poses, correlations, open_dump
    >>> found = correlations.all_correlations(Poses(open_dump("nitrogen.dump").atoms).run(step=4))
    >>> list(found.functions)[:3], found.units["mean_square_displacement"]
    (['lag', 'mean_square_displacement', 'velocity_autocorrelation'], 'Å²')
    >>> found.to_dataframe()["axis3_order1"].shape
    (201,)
    """

    functions: dict
    units: dict
    largest_turn: float
    kinds: tuple = ("",)

    def of_kind(self, kind):
        """Functions of one kind of bodies, by their names without the name of the kind."""
        ending = f"_{kind}" if kind else ""
        return {name.removesuffix(ending): one for name, one in self.functions.items() if name.endswith(ending)}

    def to_dataframe(self):
        """pandas.DataFrame with a row for each lag."""
        return export.dataframe(self.functions, self.units)


def turning(poses):
    """Data of the T bodies that are not points.

    * q (F, T, 4)
    * their ``linear`` and ``axes`` as in Bodies; None for a table of the fix
    * dict: group of principal axes with equal moments -> directions (N, T, 3) or (3,); only the third axis if a body is
      linear

    Returns (None, None, {}) if all bodies are points.
    """
    q, bodies = poses.results.q, getattr(poses, "bodies", None)
    if bodies is None:
        return q, None, {(k,): axis for k, axis in enumerate(np.eye(3))}
    own = ~bodies.point
    if not own.any():
        return None, None, {}
    some, moments = SimpleNamespace(linear=bodies.linear[own], axes=bodies.axes[own]), bodies.moments[own]
    groups = [(2,)] if some.linear.any() else axis_groups(moments)
    axes = {group: directions(moments, some.axes, group[0]) for group in groups}
    return q if own.all() else q[:, own], some, axes


def all_correlations(poses, progress=iter):
    """Correlations with all functions above that can be computed from finished ``Poses``.

    Axes 1 to 3 are the principal axes, the largest moment first; if bodies are linear, only the third, the axis of the
    body, is used.  Axes with equal moments in all bodies are arbitrary; they share one function, the mean over all
    directions in their plane or in space (``axes23_order1``).  Points are excluded from functions of rotation, but not
    in a table of the fix, which does not mark them.  Mixtures are split by ``kinds``.  ``progress`` wraps the list of
    functions, as tqdm does.  Raises ValueError if frames are not evenly spaced in time.
    """
    lag = lags(poses.results.time)
    tasks, units, chosen = [], {"lag": poses.unit("lag")}, kinds(poses)
    for kind in chosen:
        for name, *task in _tasks(of_kind(poses, kind)):
            ending = f"_{kind.name}" if kind.name else ""
            tasks.append((name + ending, *task))
            units[name + ending] = poses.unit(name)
    functions, largest = {"lag": lag}, 0.0
    for name, function, arguments in progress(tasks):
        functions[name] = function(*arguments)
        if function is mean_square_rotation:
            functions[name], turn = functions[name]
            largest = max(largest, turn)
    return Correlations(functions, units, largest, tuple(kind.name for kind in chosen))


def _axes_word(group):
    """ "axis3" of (2,), "axes23" of (1, 2)."""
    return ("axis" if len(group) == 1 else "axes") + "".join(str(k + 1) for k in group)


def _groups(bodies):
    """Principal axes with inertia, as tuples of axes with equal moments; for a table of the fix each axis is alone."""
    if bodies is None:
        return [(0,), (1,), (2,)]
    moments = bodies.moments[~bodies.point]
    return [group for group in axis_groups(moments) if (moments[:, group] > 0.0).all()]


def axis_autocorrelation(omega, q, axes, group):
    """Mean of w(t) w(t + lag), (F,), of the angular velocity w about a principal axis, radians squared / time squared.

    ``omega`` (F, B, 3), in space; ``q`` (F, B, 4); ``axes`` (B, 3, 3) as in Bodies, or None for the axes of the body
    frame; ``group``: numbers of the axes to average over, which have equal moments.
    """
    frames, number, power = len(omega), omega.shape[1], 0.0
    for own in portions(q):
        turn = Rotation.from_quat(q[:, own].reshape(-1, 4), scalar_first=True)
        body = turn.inv().apply(omega[:, own].reshape(-1, 3)).reshape(frames, -1, 3)
        if axes is not None:
            body = np.einsum("bkj,fbj->fbk", axes[own], body)
        power = power + _power(body[..., list(group)])
    return _products(power, frames) / (_origins(frames) * number * len(group))


def spectrum(lag, function):
    """Frequencies (n,) in 1 / time and the spectrum (n,) of an autocorrelation function (F,), function x time.

    It is twice the cosine transform of the first half of the lags with a Hann window; its integral over positive
    frequencies is the function at lag 0.
    """
    kept = len(lag) // 2
    window = 0.5 + 0.5 * np.cos(np.pi * np.arange(kept) / kept)
    even = np.concatenate([function[:kept] * window, [0.0], (function[1:kept] * window[1:])[::-1]])
    step = lag[1] - lag[0]
    return fft.rfftfreq(len(even), step), 2.0 * step * fft.rfft(even).real


def spectra(found):
    """The frequency and, for each velocity autocorrelation in Correlations, its spectrum, name -> (n,)."""
    functions, lag = found.functions, found.functions["lag"]
    named = {name.replace("autocorrelation", "spectrum"): one for name, one in functions.items() if "autocorrelation" in name}
    both = {name: spectrum(lag, one) for name, one in named.items()}
    return {"frequency": next(iter(both.values()))[0], **{name: one for name, (_, one) in both.items()}} if both else {}


def _tasks(poses):
    """(name, function, arguments) for every correlation of the bodies of one kind."""
    results, bodies = poses.results, getattr(poses, "bodies", None)
    tasks = [("mean_square_displacement", mean_square_displacement, (box.own_motion(results),))]
    if "velocity" in results:
        tasks.append(("velocity_autocorrelation", autocorrelation, (results.velocity,)))
    q, some, axes = turning(poses)
    if axes:
        if "omega_space" in results:
            omega = results.omega_space
            if bodies is not None and bodies.point.any():
                omega = omega[:, ~bodies.point]
            tasks.append(("omega_space_autocorrelation", autocorrelation, (omega,)))
            for group in _groups(bodies):
                name = f"omega_{_axes_word(group)}_autocorrelation"
                tasks.append((name, axis_autocorrelation, (omega, q, None if some is None else some.axes, group)))
        tasks.append(("mean_square_rotation", mean_square_rotation, (q, some)))
    for group, axis in axes.items():
        for order in (1, 2):
            tasks.append((f"{_axes_word(group)}_order{order}", orientation_correlation, (q, axis, order)))
    return tasks
