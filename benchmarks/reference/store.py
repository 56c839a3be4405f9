"""The reference state of a problem at a time, computed once: kept in memory and, if requested, on disk.

The key is the content: shapes, start, field, time, tolerance.  Every different problem is a separate entry, so a folder
of entries never has to be cleared.
"""

import hashlib
import os
from pathlib import Path

import numpy as np

from . import integrators
from .equations import State
from .fields import FreeField

#: number in the key; to be raised when a change of the code changes the states
VERSION = 1

_memory = {}


def _halves(values):
    """An array as the sum of two of float64, exact for 80-bit floats and the same anywhere."""
    high = values.astype(np.float64)
    return high, (values - high).astype(np.float64)


def _key(problem, time, accuracy):
    """Name of an entry, of the content of the problem and how it is integrated."""
    arrays = (
        problem.bodies.masses,
        problem.bodies.moments,
        problem.bodies.sites_body,
        problem.start.packed(),
        np.array([problem.dtype.type(time)]),
    )
    digest = hashlib.sha256(f"{VERSION} {problem.dtype} {accuracy!r}".encode())
    digest.update(problem.bodies.body.astype(np.int64).tobytes())
    for values in arrays:
        for half in _halves(values):
            digest.update(half.tobytes())
    digest.update(problem.field.fingerprint())
    return digest.hexdigest()[:32]


def _load(path, dtype):
    """State of a file, None if there is none that can be read."""
    try:
        packed = np.load(path)
    except (OSError, EOFError, ValueError):
        return None
    return State.of(packed) if packed.dtype == dtype else None


def _save(path, state):
    """Write a state; a reader never sees an incomplete file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}")
    with open(part, "wb") as file:
        np.save(file, state.packed())
    os.replace(part, path)


def _require_extended(dtype):
    """A float type with at least 64 bits of precision."""
    if np.finfo(dtype).eps > 1.1e-19:
        raise RuntimeError(
            f"a NumPy long double of at least 64 bits' precision is required; here {dtype} has"
            f" an epsilon of {np.finfo(dtype).eps:.1e}"
        )


def reference_states(problem, times, folder=None, tolerance=None, fixed_step=None):
    """States at ``times``, rising from 0: list of State in long double (``.double`` rounds them).

    Without forces they are exact (free_top.py).  In an extended field they are good to about 1e-14
    of the size of the scene while the motion is not chaotic; in LAMMPS' field, whose forces are double, rounding
    limits them: ten times less accurate in the paper's cage.  ``folder`` keeps results from one process to the next.
    ``tolerance`` and ``fixed_step``, for forces that jump, as in integrators.integrate.
    """
    _require_extended(problem.dtype)
    accuracy = {"tolerance": tolerance, "fixed_step": fixed_step}
    keys = [_key(problem, time, accuracy) for time in times]
    if folder is not None:
        for key in set(keys) - set(_memory):
            stored = _load(Path(folder) / f"{key}.npy", problem.dtype)
            if stored is not None:
                _memory[key] = stored
    missing = {key: time for key, time in zip(keys, times) if key not in _memory}
    if missing:
        states = _compute(problem, list(missing.values()), accuracy)
        for key, state in zip(missing, states):
            _memory[key] = state
            if folder is not None:
                _save(Path(folder) / f"{key}.npy", state)
    return [_memory[key] for key in keys]


def _compute(problem, times, accuracy):
    """States at ``times``, computed without the cache."""
    if isinstance(problem.field, FreeField):
        from .free_top import exact_state  # needs mpmath

        return [exact_state(problem, time) for time in times]
    return integrators.integrate(problem, times, **accuracy)


def reference_state(problem, time, **options):
    """State at ``time``; options as in reference_states."""
    return reference_states(problem, [time], **options)[0]
