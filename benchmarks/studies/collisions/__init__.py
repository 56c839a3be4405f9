"""Random collisions of rigid bodies: force evaluations against the energy error.

The step control of the kernel is compared with SciPy's solvers and CVODE; scene.py and kernel.cpp have one scene.
"""

import warnings
from dataclasses import dataclass
from functools import partial

import numpy as np
from tqdm import tqdm

from benchmarks.engine import Curve, Finding, Measurement, Panel, Study, Table, draw
from benchmarks.reference import solvers

from .scene import Scene

#: label -> True if eps is an energy
OURS = {"eps an energy": True, "eps a length": False}
PEERS = (*solvers.METHODS, *solvers.CVODE)
#: solvers of the picture, and colors
SHOWN = ("DOP853", "LSODA", "CVODE Adams")
LOOKS = dict(zip(("eps an energy", *SHOWN), ("momentum", "#e69f00", "#009e73", "#9467bd")))
EPS = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14)
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 3e-14)
#: energy errors, relative to the depth, at which evaluations are compared
LEVELS = 10.0 ** -np.arange(6, 12)
#: number of scenes: by default (five minutes on one core), and with --quick
SCENES, QUICK = 75, 2


@dataclass(frozen=True)
class Results:
    """``points``: label -> array (scenes, tolerances, 2) of evaluations and the largest energy error relative to the
    depth; NaN if the scene is lost."""

    points: dict


# --- measuring ----------------------------------------------------------------------------------
def of_peer(scene, name, tolerance):
    """(evaluations, energy error) of a solver; NaN if it gives up."""
    try:
        return solvers.largest_energy_error(scene, scene.time, name, tolerance)
    except RuntimeError:
        return np.nan, np.nan


def points_of(scene):
    """Label -> array (tolerances, 2), see Results."""
    runs = {name: [scene.follow(eps, energy) for eps in EPS] for name, energy in OURS.items()}
    depth = next(iter(runs.values()))[-1].depth
    points = {name: [run[:2] for run in own] for name, own in runs.items()}
    for name in solvers.available():
        points[name] = [of_peer(scene, name, tolerance) for tolerance in TOLERANCES]
    return {name: np.array(own) / (1.0, depth) for name, own in points.items()}


def measure(lab):
    """Results."""
    count, every = QUICK if lab.quick else SCENES, []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # solvers that give up warn; these runs are counted
        for which in tqdm(range(count), unit="scene", disable=None):
            every.append(points_of(Scene(which)))
    return Results({name: np.array([own[name] for own in every]) for name in every[0]})


# --- judging ------------------------------------------------------------------------------------
def lost(points):
    """True for points (..., 2) whose energy is not finite, or has an error above the depth."""
    return ~(points[..., 1] <= 1.0)


def evaluations(points, levels=LEVELS):
    """Fewest evaluations (n,) for errors of at most ``levels`` (n,), from ``points`` (tolerances, 2).

    Logarithms are interpolated between points that are not worse in both numbers than another point.  Infinite if no
    point reaches the level; for a level above all errors, the fewest evaluations of all points.
    """
    points = points[~lost(points)]
    points = points[np.lexsort(points.T[::-1])]
    before = np.minimum.accumulate(np.append(np.inf, points[:, 1]))[:-1]
    work, error = np.log(np.maximum(points[points[:, 1] < before], 1e-17)).T[:, ::-1]
    if not len(work):
        return np.full(len(levels), np.inf)
    return np.exp(np.interp(np.log(levels), error, work, left=np.inf))


def counted(results):
    """Label -> evaluations (scenes, levels)."""
    return {name: np.array([*map(evaluations, own)]) for name, own in results.points.items()}


def ratios(counts, name):
    """Ratio of evaluations to the best solver (scenes, levels).

    NaN if neither reaches the error, infinite if only the solver does, and 0 if only ours does.
    """
    with np.errstate(invalid="ignore"):
        return counts[name] / np.min([counts[peer] for peer in PEERS if peer in counts], axis=0)


def median(values):
    """Median of the values that are not NaN; NaN if all are."""
    values = values[~np.isnan(values)]
    return float(np.median(values)) if len(values) else np.nan


def tables(results, counts):
    """Medians of evaluations and ratios at every level, and the number of lost runs."""
    levels, every = [f"{level:.0e}" for level in LEVELS], {name: ratios(counts, name) for name in OURS}
    gone = {name: lost(own) for name, own in results.points.items()}
    work = [
        (name, *(f"{median(x):.0f}" for x in own.T), f"{gone[name].sum()} of {gone[name].size}")
        for name, own in counts.items()
    ]
    parts = [(name, *(f"{median(x):.2f}" for x in (*own.T, own))) for name, own in every.items()]
    header = ("tolerance", *levels, "all")
    return {"evaluations": Table(("method", *levels, "lost"), work), "ratios": Table(header, parts)}


def panels(counts):
    """Median evaluations of the fix and of three solvers, and the distribution of the ratios."""
    own, *_ = OURS
    shown = [name for name in (own, *SHOWN) if name in counts]
    work = [Curve("fix gear/quat" if name == own else name, LEVELS, np.median(counts[name], axis=0), LOOKS[name]) for name in shown]
    spread = []
    for name, line in zip(OURS, ("-", "--")):
        found = np.sort(ratios(counts, name), axis=None)  # NaN are last
        found = found[: np.count_nonzero(~np.isnan(found))]
        spread.append(Curve(name, found, np.linspace(0.0, 1.0, len(found)), LOOKS[own], line))
    x, part = "largest error of the energy, divided by the depth", "fraction of all scenes and errors"
    quotient = "evaluations of the fix, divided by those of the best solver"
    title = f"The best solver needs {1.0 / median(ratios(counts, own)):.1f} times as many evaluations"
    return (
        Panel("The fix needs fewer evaluations than the solvers", x, "evaluations, median over the scenes", work, "xy"),
        Panel(title, quotient, part, spread, "", xlim=(0.0, 1.0)),
    )


def find(results):
    """Finding of Results."""
    counts, rows = counted(results), []
    for name in OURS:
        ratio = median(ratios(counts, name))
        rows.append(Measurement(f"{name}: median ratio to the best solver", ratio, spec=".2f", most=0.7))
        gone = int(lost(results.points[name]).sum())
        rows.append(Measurement(f"{name}: lost", gone, spec=".0f", most=0))
    context = {"scenes": len(results.points[name]), "eps": EPS, "tolerances": TOLERANCES}
    context["medians"] = [f"{median(ratios(counts, name)):.2f}" for name in OURS]
    context["missing"] = [peer for peer in PEERS if peer not in results.points]
    picture = partial(draw, panels=panels(counts))
    return Finding(rows, tables(results, counts), {"collisions": picture}, context)


STUDY = Study("collisions", "Collisions under a tolerance", 300.0, measure, find, blocks={"doc/collisions.md": "collisions.md.j2"})
