"""Kinds of bodies in a mixture, and their names."""

from collections import Counter
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np


#: largest number of kinds in a mixture; if there are more, all bodies count as different
MOST = 8
#: relative differences of masses and of principal moments within a kind; with six digits, moments are uncertain by about
#: 1e-3
SAME_MASS, SAME_MOMENTS = 1e-4, 0.02


class Kind(NamedTuple):
    """Bodies with the same sites: their ``name``, "" if all are of one kind, and their indices (b,) among all bodies.

    >>> from gearquat_analysis import Poses, open_dump
    >>> from gearquat_analysis.kinds import kinds
    >>> [(kind.name, len(kind.bodies)) for kind in kinds(Poses(open_dump("nitrogen.dump").atoms).run(stop=2))]
    [('', 64)]
    """

    name: str
    bodies: np.ndarray


class _Results(dict):
    """A dict of results whose keys are also attributes."""

    __getattr__ = dict.__getitem__


def kinds(poses):
    """Kinds of the bodies of ``Poses``, in order of their first bodies; a single Kind without a name if there is only one.

    Bodies are of one kind if their sites have the same types and masses, and if their principal moments agree within 2 %.
    The name is the chemical formula if all masses are masses of elements (H2O).  Otherwise it consists of types of
    atoms: T1(T2)2 has one site of type 1 and two of type 2.  Kinds with the same formula are numbered (C8H10-1).  With more than 8 kinds (``too_many``), all bodies are
    treated as one kind.
    """
    groups = _groups(poses)
    if len(groups) == 1 or len(groups) > MOST:
        return [Kind("", np.arange(poses.results.center.shape[1]))]
    names = [_name(poses, own[0]) for own in groups]
    often, seen, found = Counter(names), Counter(), []
    for name, own in zip(names, groups):
        seen[name] += 1
        found.append(Kind(f"{name}-{seen[name]}" if often[name] > 1 else name, own))
    return found


def too_many(poses):
    """True if there are more kinds of bodies than ``kinds`` distinguishes."""
    return len(_groups(poses)) > MOST


def of_kind(poses, kind):
    """Finished ``poses`` restricted to the bodies of one Kind, with the attributes that averages and correlations need."""
    if not kind.name:
        return poses
    results = _Results(time=poses.results.time)
    for name in ("center", "q", "velocity", "omega_space"):
        if name in poses.results:
            results[name] = poses.results[name][:, kind.bodies]
    if "cell" in poses.results:
        results["cell"] = poses.results.cell
    names = ("mass", "moments", "axes", "point", "linear")
    bodies = SimpleNamespace(**{name: getattr(poses.bodies, name)[kind.bodies] for name in names})
    return SimpleNamespace(results=results, bodies=bodies, unit=poses.unit)


def _groups(poses):
    """Indices of the bodies of each kind; the search stops after more than MOST kinds."""
    bodies, atoms = getattr(poses, "bodies", None), getattr(poses, "atoms", None)
    if bodies is None or atoms is None:
        return [np.arange(1)]
    left, groups = _composition(bodies, _types(atoms)[bodies.index]), []
    while (left >= 0).any() and len(groups) <= MOST:
        first = int(np.argmax(left >= 0))
        moments = bodies.moments[first]
        near = np.abs(bodies.moments - moments).max(axis=1) <= SAME_MOMENTS * moments[0]
        groups.append(np.flatnonzero((left == left[first]) & near))
        left[groups[-1]] = -1
    return groups


def _types(atoms):
    return np.asarray(atoms.types) if hasattr(atoms, "types") else np.ones(len(atoms), int)


def _composition(bodies, types):
    """Numbers (B,), equal for bodies whose sites have the same types and masses."""
    number = np.unique(types, return_inverse=True)[1]
    light = np.round(np.log(np.where(bodies.masses > 0.0, bodies.masses, 1e-300)) / SAME_MASS)
    rows = np.column_stack([bodies.of, number, light])
    rows = rows[np.lexsort(rows.T[::-1])][:, 1:]
    seen, ends = {}, np.cumsum(bodies.counts)
    texts = (rows[end - count : end].tobytes() for end, count in zip(ends, bodies.counts))
    return np.array([seen.setdefault(text, len(seen)) for text in texts])


def _name(poses, body):
    """Formula of the body with this index."""
    bodies, atoms = poses.bodies, poses.atoms
    own = bodies.index[bodies.of == body]
    if not hasattr(atoms, "elements"):
        count = Counter(f"T{kind}" for kind in _types(atoms)[own].tolist())
        return "".join(f"({name}){n}" if n > 1 else name for name, n in sorted(count.items()))
    count = Counter(atoms.elements[own].tolist())
    # carbon, hydrogen, then the other elements in alphabetical order (E. A. Hill, J. Am. Chem. Soc. 22, 478 (1900))
    order = sorted(count, key=lambda name: ("CH".find(name) % 3 if "C" in count else 0, name))
    return "".join(f"{name}{count[name] if count[name] > 1 else ''}" for name in order)
