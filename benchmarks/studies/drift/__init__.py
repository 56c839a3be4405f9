"""Energy over very long runs.

There are two scenes of ``examples`` that all methods can simulate: the body without bare charges in the paper's
cage, bound because its energy is negative, and the free asymmetric top.  Every method runs the same number of steps
with the same few step sizes, from one that is small for all methods to one that is common with fix rigid/nve/small.
Samples are sparse; the largest error is taken over the samples.  In test case 1, peers.py compares further methods at
equal numbers of force evaluations.
"""

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from benchmarks.engine import Curve, Finding, Job, Measurement, Panel, Study, Table, deck, series
from benchmarks.engine.methods import DEFAULT_VALUES, gear, looks, rigid
from benchmarks.engine.page import grouped
from benchmarks.engine.panels import draw
from benchmarks.engine.statistics import slope

from . import peers

STEPS, QUICK_STEPS, SAMPLES = 10_000_000, 20_000, 2000
#: messages of LAMMPS and of the fix for coordinates and energies that are no longer finite
NOT_FINITE = ("Non-numeric", "Fix gear/quat: blow-up")
#: a slope below this number of standard errors, which are estimates themselves, is not a drift
SIGNIFICANT = 4.0
#: an error above this fraction of the initial kinetic energy spoils a run
SPOILS = 0.1

DEFAULT, DEFAULT_COMPENSATED = (
    gear("momentum", DEFAULT_VALUES["momentum"], compensate) for compensate in (False, True)
)
NO_SQUISH, VERLET = rigid("rigid/nve/small", "rigid"), rigid("rigid/small", "rigid_verlet")
METHODS = {
    method.label: method
    for method in (
        gear("first", 5),
        gear("first", 6),
        gear("second", 6),
        gear("second", 8),
        gear("momentum", 5),
        DEFAULT,
        DEFAULT_COMPENSATED,
        NO_SQUISH,
        rigid("rigid/nve", "rigid_big"),
        VERLET,
    )
}
#: folder under examples -> (title, steps)
SCENES = {
    "coated": ("Body without bare charges in the cage", (0.02, 0.05, 0.125)),
    "top": ("Free asymmetric top", (0.02, 0.05, 0.1)),
}


@dataclass(frozen=True)
class Run:
    """A run: ``time`` and ``total`` energy (n,) of its samples, initial ``kinetic`` energy.

    ``lost``: the time at which numbers were no longer finite, None if all are finite.
    """

    time: np.ndarray
    total: np.ndarray
    kinetic: float
    lost: float = None

    @property
    def error(self):
        """E(t) - E(0), shape (n,)."""
        return self.total - self.total[0]

    @property
    def largest(self):
        """Largest |error|, infinite if the run was lost."""
        return math.inf if self.lost is not None else float(np.abs(self.error).max())

    @property
    def slope(self):
        """Drift of the energy per unit of time, and its standard error."""
        return slope(self.time, self.error)

    @property
    def spoiled(self):
        """True if the largest error is above SPOILS times the initial kinetic energy."""
        return self.largest > SPOILS * self.kinetic


# --- measuring ----------------------------------------------------------------------------------
def is_lost(text):
    """True if LAMMPS' message says that a run ended because of numbers that are not finite."""
    return any(words in text for words in NOT_FINITE)


def read(finished, steps, interval):
    """Run of a log; ``interval``: time between samples.

    A run that was refused before its first sample counts as lost at the start.
    """
    if not finished.log.tables or not len(finished.thermo["Step"]):
        return Run(np.zeros(0), np.zeros(0), math.nan, interval)
    samples = series.of_log(finished.log)
    finite = np.isfinite(samples.total)
    time, total, lost = samples.time[finite], samples.total[finite], None
    if finished.error:
        lost = float(time.max(initial=0.0)) + interval
    elif not finite.all() or samples.step[-1] != steps:
        lost = float(time.max(initial=0.0))
    return Run(time, total, float(samples.kinetic[0]), lost)


def measure(lab, scenes=SCENES, methods=METHODS, steps=None):
    """(scene, label of the method, step) -> Run."""
    steps = steps or (QUICK_STEPS if lab.quick else STEPS)
    every, jobs, keys = max(1, steps // SAMPLES), {}, {}
    for scene, (_, dts) in scenes.items():
        for label, method in methods.items():
            for dt in dts:
                name = f"{scene}_{method.key}_dt{dt:g}"
                variables = method.variables | {"dt": f"{dt:.17g}", "steps": steps, "every": every}
                jobs[name], keys[name] = Job(deck(scene), variables, steps), (scene, label, dt)
    runs = lab.many(jobs, may_fail=is_lost)
    return {keys[name]: read(run, steps, every * keys[name][2]) for name, run in runs.items()}


# --- judging ------------------------------------------------------------------------------------
def show_largest(run):
    """Largest error as text, with a star if it spoils the run."""
    if run.lost is not None:
        return f"lost, t = {run.lost:.0f}"
    return f"{run.largest:.1e}" + ("*" if run.spoiled else "")


def show_slope(run):
    """Slope as text, in parentheses if it is not significant."""
    if run.lost is not None:
        return "lost"
    rate, error = run.slope
    text = f"{rate:.1e} ± {error:.0e}"
    return text if abs(rate) > SIGNIFICANT * error else f"({text})"


SQUISH_NAME = "NO_SQUISH (`fix rigid/nve/small`, `fix rigid/nve`)"
SQUISH = [m.label for m in METHODS.values() if not m.gear and m is not VERLET]
GEAR = [m.label for m in METHODS.values() if m.gear]
#: ratios of errors in the tables: words -> (labels, labels for comparison)
CONTESTS = {
    f"default of `fix gear/quat` over {SQUISH_NAME}": ([DEFAULT.label], SQUISH),
    f"best setting of `fix gear/quat` over {SQUISH_NAME}": (GEAR, SQUISH),
    "default with compensated sums over default": ([DEFAULT_COMPENSATED.label], [DEFAULT.label]),
    f"`{VERLET.label}` over {SQUISH_NAME}": ([VERLET.label], SQUISH),
}


def ratios(runs, dts):
    """Rows of CONTESTS, for the methods that were run: the best of some over the best of others."""
    rows, labels = [], {label for label, _ in runs}
    for words, pair in CONTESTS.items():
        ours, theirs = (labels.intersection(some) for some in pair)
        if ours and theirs:
            own, other = (
                np.array([min(runs[label, dt].largest for label in some) for dt in dts])
                for some in (ours, theirs)
            )
            with np.errstate(invalid="ignore"):  # no ratio if all are lost
                rows.append([words, *(f"{ratio:.1e}" for ratio in own / other)])
    return rows


def tables(scene, runs, dts):
    """Tables of one scene by name; ``runs``: (label, step) -> Run."""
    labels = list(dict.fromkeys(label for label, _ in runs))
    steps = [f"step {dt:g}" for dt in dts]

    def table(first, show):
        return Table((first, *steps), [[m, *(show(runs[m, dt]) for dt in dts)] for m in labels])

    return {
        f"largest_{scene}": table("largest error of the energy", show_largest),
        f"drift_{scene}": table("drift, energy per unit of time", show_slope),
        f"ratios_{scene}": Table(("ratio of largest errors", *steps), ratios(runs, dts)),
    }


def find(results):
    """Finding of the results of ``measure``."""
    scenes, measurements, shown, panels = {}, [], {}, ()
    for scene in dict.fromkeys(scene for scene, *_ in results):
        runs = {key[1:]: run for key, run in results.items() if key[0] == scene}
        dts = list(dict.fromkeys(dt for _, dt in runs))
        scenes[scene] = SCENES[scene][0]
        shown |= tables(scene, runs, dts)
        panels += panels_of(scenes[scene], runs, dts)
        for (label, dt), run in runs.items():
            what = f"{scene}, {label}, step {dt:g}"
            measurements.append(Measurement(f"{what}: largest error of the energy", run.largest))
            if run.lost is None:
                measurements.append(Measurement(f"{what}: drift of the energy", *run.slope))
    steps = round(max(run.time[-1] / dt for (*_, dt), run in results.items() if len(run.time)))
    note = f"{grouped(steps)} steps; crosses: no longer finite; hollow: no drift, one standard "
    note += "error; charges of the cage: reconstructed"
    picture = partial(draw, panels=panels, columns=3, note=note)
    context = {"scenes": scenes, "steps": steps, "significant": SIGNIFICANT, "spoils": SPOILS}
    return Finding(measurements, shown, {"drift": picture}, context)


@dataclass(frozen=True)
class Results:
    """``runs``: results of ``measure``; ``peers``: results of peers.measure."""

    runs: dict
    peers: dict


def measure_all(lab):
    """Results of everything."""
    with lab.share(0.8):
        runs = measure(lab)
    with lab.share(0.2):
        return Results(runs, peers.measure(lab, read, is_lost))


def find_all(results):
    """Finding of Results."""
    finding = find(results.runs)
    finding.tables["peers"], measurements = peers.find(results.peers)
    context = finding.context | {"end": peers.END}
    return replace(finding, measurements=finding.measurements + measurements, context=context)


# --- picture ------------------------------------------------------------------------------------
def panels_of(title, runs, dts):
    """Error over time at the second step, largest error and slope against the step."""
    look = looks([METHODS[label] for label in dict.fromkeys(label for label, _ in runs)])
    history, largest, drifts, lost = [], [], [], []
    for method, own in look.items():
        of = {dt: runs[method.label, dt] for dt in dts}
        kept = {dt: run for dt, run in of.items() if run.lost is None}
        lost += [(dt, own["color"]) for dt in of if dt not in kept]
        run = of[dts[1]]
        if len(run.time):
            worst = np.maximum.accumulate(np.abs(run.error))[1:]
            history.append(Curve("", run.time[1:], worst, own["color"], own["line"]))
        x, errors = np.array(list(kept)), [run.largest for run in kept.values()]
        largest.append(Curve(method.label, x, np.array(errors), **own))
        slopes = np.array([run.slope for run in kept.values()]).reshape(-1, 2)
        seen = np.abs(slopes[:, 0]) > SIGNIFICANT * slopes[:, 1]
        y = np.where(seen, np.abs(slopes[:, 0]), slopes[:, 1])
        drifts.append(Curve("", x, y, **own))
        drifts.append(Curve("", x[~seen], y[~seen], **(own | {"line": ""}), hollow=True))
    by_step = {"log": "xy", "xticks": tuple(dts), "lost": tuple(lost), "legend": False}
    at = f"{title}, step {dts[1]:g}"
    return (
        Panel(at, "time", "largest error so far", tuple(history), log="xy", legend=False),
        Panel(title, "step", "largest error", tuple(largest), **by_step),
        Panel(title, "step", "drift, energy per unit of time", tuple(drifts), **by_step),
    )


STUDY = Study("drift", "Energy over long runs", 1080.0, measure_all, find_all)
