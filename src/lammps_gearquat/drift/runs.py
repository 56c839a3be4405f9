"""Energy over very long runs: what is run, and how a series of the total energy is judged.

Two scenes of ``examples`` that no method has to lose: the body without bare charges in the paper's
cage, bound because its energy is below zero, and the free asymmetric top.  Every method runs the
same number of steps at the same few steps, from one that is small for all of them to one that is
usual with fix rigid/nve/small.  Samples are sparse; the largest error is that of the samples.
"""

import csv
import math
import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import decks, series
from ..lammps_runner import Job, LammpsError, run_many
from ..tables import markdown_table

SAMPLES = 2000
#: LAMMPS' word for coordinates and energies that are not finite any more, and the fix's own
NOT_FINITE = ("Non-numeric", "Fix gear/quat: blow-up")
#: a slope of less than so many standard errors, which are themselves estimates, is no drift
SIGNIFICANT = 4.0
#: an error of more than this part of the kinetic energy at the start spoils a run
SPOILS = 0.1
#: errors within this factor are called equal: chaotic motions differ by as much from run to run
EQUAL = 2.0


# --- what is run --------------------------------------------------------------------------------
@dataclass(frozen=True)
class Method:
    """A method: name in files, name in texts, variables of the decks; ``gear``: fix gear/quat."""

    key: str
    label: str
    variables: dict
    gear: bool = True

    def __hash__(self):
        return hash(self.key)


@dataclass(frozen=True)
class Scene:
    """A scene: its deck is ``examples/KEY/in.KEY``; ``dts``: time steps, in units of the scene."""

    key: str
    title: str
    dts: tuple


def _gear(formulation, values, compensate=False):
    variables = {"formulation": formulation, "values": values}
    key, label = f"{formulation}-{values}", f"{formulation}, N = {values}"
    if compensate:
        return Method(
            f"{key}-compensated", f"{label}, compensated", variables | {"compensate": "yes"}
        )
    return Method(key, label, variables)


def _rigid(style, method):
    return Method(style.replace("/", "-"), f"fix {style}", {"method": method}, gear=False)


DEFAULT, DEFAULT_COMPENSATED = _gear("second", 8), _gear("second", 8, compensate=True)
NO_SQUISH, VERLET = _rigid("rigid/nve/small", "rigid"), _rigid("rigid/small", "rigid_verlet")
METHODS = (
    _gear("first", 5),
    _gear("first", 6),
    _gear("first", 8),
    _gear("second", 6),
    DEFAULT,
    DEFAULT_COMPENSATED,
    _gear("second", 10),
    NO_SQUISH,
    _rigid("rigid/nve", "rigid_big"),
    VERLET,
)
SCENES = (
    Scene("coated", "Body without bare charges in the cage", (0.02, 0.05, 0.125)),
    Scene("top", "Free asymmetric top", (0.02, 0.05, 0.1)),
)


@dataclass(frozen=True)
class Run:
    """One run."""

    scene: Scene
    method: Method
    dt: float
    steps: int

    @property
    def name(self):
        """Name of its files."""
        return f"{self.scene.key}_{self.method.key}_dt{self.dt:g}"

    @property
    def every(self):
        """Steps between samples."""
        return max(1, self.steps // SAMPLES)

    def job(self, folder):
        """The job that runs it and leaves its log in ``folder``."""
        variables = dict(self.method.variables)
        variables |= {"dt": f"{self.dt:.17g}", "steps": self.steps, "every": self.every}
        deck = decks.examples_folder() / self.scene.key / f"in.{self.scene.key}"
        return Job(deck, Path(folder) / f"log.{self.name}", variables, self.steps)


def planned_runs(steps, scenes=SCENES, methods=METHODS):
    """All runs, each of ``steps`` steps."""
    return [
        Run(scene, method, dt, steps) for scene in scenes for dt in scene.dts for method in methods
    ]


def is_lost(text):
    """Whether LAMMPS' words say that a run ended because its numbers did."""
    return any(words in text for words in NOT_FINITE)


def run_all(runs, folder, lmp=None, workers=2, progress=None):
    """Run everything, logs in ``folder``.

    A run that ends because numbers are no longer finite is a result; any other error is raised.
    ``progress(steps)`` is called with steps done.
    """
    lock = threading.Lock()

    def one(run):
        left = run.steps

        def advance(steps):
            nonlocal left
            left -= steps
            with lock:
                if progress:
                    progress(steps)

        try:
            run_many([run.job(folder)], lmp, 1, advance)
        except LammpsError as error:
            if not is_lost(str(error)):
                raise
        advance(left)

    with ThreadPoolExecutor(max_workers=workers) as pool:
        futures = [pool.submit(one, run) for run in runs]
        try:
            for future in as_completed(futures):
                future.result()
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


# --- how it is judged ---------------------------------------------------------------------------
def slope(time, error):
    """Least-squares slope of ``error`` (n,) against ``time`` (n,), and its standard error.

    Neighbouring errors are alike, so the scatter about the line does not shrink as it would with n
    independent samples: the standard error is that of W. K. Newey and K. D. West, Econometrica 55,
    703 (1987), Eq. 5, with lags up to a twentieth of the series.
    """
    n = len(time)
    if n < 20:
        raise ValueError(f"a slope needs 20 samples or more, not {n}")
    x = time - time.mean()
    found = x @ error / (x @ x)
    score = x * (error - error.mean() - found * x)
    lags = n // 20
    total = score @ score
    for lag in range(1, lags + 1):
        total += 2 * (1 - lag / (lags + 1)) * (score[lag:] @ score[:-lag])
    return float(found), float(math.sqrt(max(total, 0.0) * n / (n - 2)) / (x @ x))


@dataclass(frozen=True)
class Drift:
    """What a run did to the energy: ``time``, ``error`` (n,) of the samples, error = E(t) - E(0).

    ``slope`` and ``uncertainty`` (one standard error), energy per unit of time; ``largest`` |error|.
    ``spoiled``: whether that is more than SPOILS of the kinetic energy at the start.
    ``lost``: the time by which numbers were no longer finite, None if they always were; slope and
    uncertainty are then NaN, ``largest`` is infinite.
    """

    time: np.ndarray
    error: np.ndarray
    slope: float
    uncertainty: float
    largest: float
    spoiled: bool = False
    lost: float = None

    @property
    def drifts(self):
        """Whether the slope is significant; a run that was spoiled or lost counts."""
        return self.spoiled or abs(self.slope) > SIGNIFICANT * self.uncertainty

    @property
    def largest_so_far(self):
        """Largest |error| up to each sample, shape (n,)."""
        return np.maximum.accumulate(np.abs(self.error))


def judge(time, total, kinetic):
    """Drift of a complete series: ``time`` and ``total`` energy (n,), kinetic energy at the start."""
    error = total - total[0]
    largest = float(np.abs(error).max())
    return Drift(time, error, *slope(time, error), largest, largest > SPOILS * kinetic)


def lost(time):
    """Drift of a run whose numbers were not finite any more at ``time``."""
    return Drift(np.empty(0), np.empty(0), math.nan, math.nan, math.inf, True, time)


def _finite_until(log):
    """Time of the last sample that a log holds."""
    rows = (line.split() for line in Path(log).read_text(encoding="utf-8").splitlines())
    return max(
        float(row[1]) for row in rows if len(row) == len(series.COLUMNS) and row[0].isdigit()
    )


def read_drift(run, folder):
    """Drift of a run whose log is in ``folder``."""
    log = run.job(folder).log
    text = log.read_text(encoding="utf-8", errors="replace")
    if is_lost(text):
        return lost(_finite_until(log) + run.every * run.dt)
    values = series.read_log(log)
    if len(values.step) == 0 or values.step[-1] != run.steps:  # samples that are nan are not read
        return lost(float(values.time.max(initial=0.0)))
    return judge(values.time, values.total, values.kinetic[0])


# --- what is written ----------------------------------------------------------------------------
CSV_HEADER = ("scene", "method", "dt", "steps", "slope", "uncertainty", "largest", "lost")


def write_csv(path, results):
    """One line a run; ``results``: Run -> Drift."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(CSV_HEADER)
        for run, drift in results.items():
            head = (run.scene.key, run.method.label, f"{run.dt:g}", run.steps)
            numbers = (f"{x:.6e}" for x in (drift.slope, drift.uncertainty, drift.largest))
            writer.writerow((*head, *numbers, "" if drift.lost is None else f"{drift.lost:g}"))


def show_largest(drift):
    """Largest error as text."""
    return f"lost, t = {drift.lost:.0f}" if drift.lost is not None else f"{drift.largest:.1e}"


def show_slope(drift):
    """Slope as text, in parentheses where it is none to speak of."""
    if drift.lost is not None:
        return "lost"
    text = f"{drift.slope:.1e} ± {drift.uncertainty:.0e}"
    return text if abs(drift.slope) > SIGNIFICANT * drift.uncertainty else f"({text})"


def _methods(results):
    return list(dict.fromkeys(run.method for run in results))


def _scenes(results):
    return list(dict.fromkeys(run.scene for run in results))


def _by(results, scene):
    """(method, dt) -> Drift of one scene."""
    return {(run.method, run.dt): drift for run, drift in results.items() if run.scene == scene}


def table(results, scene, first, show):
    """Markdown lines of one table: a row a method, a column a step."""
    found = _by(results, scene)
    header = [first, *(f"step {dt:g}" for dt in scene.dts)]
    rows = [
        [method.label, *(show(found[method, dt]) for dt in scene.dts)]
        for method in _methods(results)
    ]
    return markdown_table(header, rows)


def times(ratio):
    """A ratio of errors as text; nothing for one that is infinite."""
    if not math.isfinite(ratio):
        return ""
    return f" ({ratio:.0e} times)" if ratio >= 1e4 else f" ({float(f'{ratio:.1e}'):g} times)"


def compare(found, dts, ours, theirs):
    """At which steps methods hold the energy better, equally well, and worse than others.

    ``ours`` and ``theirs`` are lists of methods; the best of each counts at every step.  Returns
    three lists of (step, ratio of the errors); errors within the factor EQUAL are equal.
    """
    better, equal, worse = [], [], []
    for dt in dts:
        own, other = (min(found[m, dt].largest for m in methods) for methods in (ours, theirs))
        if own <= EQUAL * other and other <= EQUAL * own:
            equal.append((dt, 1.0))
        elif own < other:
            better.append((dt, other / own))
        else:
            worse.append((dt, own / other))
    return better, equal, worse


def _comparison(subject, other, lists):
    words = ("better", f"equally well (within a factor {EQUAL:g})", "worse")
    parts = []
    for word, steps in zip(words, lists):
        shown = [f"{dt:g}" + (times(ratio) if ratio > EQUAL else "") for dt, ratio in steps]
        parts += [f"{word} at {', '.join(shown)}"] if shown else []
    return f"{subject} against {other}, by step: {'; '.join(parts)}."


def _winner(lists):
    """Who holds the energy best at which step: lists of the best of fix gear/quat for each step."""
    parts = []
    for name, steps in zip(("`fix gear/quat`", "neither", "NO_SQUISH"), lists):
        parts += [f"{name} at {', '.join(f'{dt:g}' for dt, _ in steps)}"] if steps else []
    return f"Who holds the energy best, with the best setting for each step: {'; '.join(parts)}."


def _where(found, dts, methods, true_of):
    """Methods and the steps at which something is true of them, as text."""
    parts = []
    for method in methods:
        steps = [f"{dt:g}" for dt in dts if true_of(found[method, dt])]
        if steps:
            parts.append(f"{method.label} at {', '.join(steps)}")
    return "; ".join(parts) or "none"


def verdict(results, scene):
    """Sentences, from the numbers alone: who holds the energy at which step, and who drifts."""
    found, methods = _by(results, scene), _methods(results)
    gear = [method for method in methods if method.gear]
    squish = [method for method in methods if not method.gear and method != VERLET]
    name = "NO_SQUISH (`fix rigid/nve/small`, `fix rigid/nve`)"
    contests = [
        ("The default of `fix gear/quat`", [DEFAULT], name, squish),
        ("The best setting of `fix gear/quat` for each step", gear, name, squish),
        ("The default with compensated sums", [DEFAULT_COMPENSATED], "without", [DEFAULT]),
        (f"`{VERLET.label}`", [VERLET], name, squish),
    ]
    sentences = [
        _comparison(subject, other, compare(found, scene.dts, ours, theirs))
        for subject, ours, other, theirs in contests
        if set(ours) | set(theirs) <= set(methods)
    ]
    best = compare(found, scene.dts, gear, squish)
    return (
        [_winner(best)]
        + sentences
        + [
            f"No drift: {_where(found, scene.dts, methods, lambda d: not d.drifts)}.",
            f"Energy wrong by more than {SPOILS:.0%} of the kinetic energy at the start: "
            f"{_where(found, scene.dts, methods, lambda d: d.spoiled and d.lost is None)}.",
            f"Numbers no longer finite: {_where(found, scene.dts, methods, lambda d: d.lost is not None)}.",
        ]
    )


def markdown(results, picture="drift.png"):
    """The whole account as Markdown lines, headings of the second level."""
    steps = next(iter(results)).steps
    lines = [f"## Energy over {steps:,} steps".replace(",", " "), ""]
    lines += [
        "Total energy of the corrected pose, error against its start. A slope is that of a "
        f"least-squares line, ± one standard error; one of less than {SIGNIFICANT:g} of them is in "
        "parentheses and, unless the energy is quite wrong, called no drift. `lost`: energies or "
        "positions stopped being finite numbers. Gear's method is not symplectic; NO_SQUISH is. Units are those of the scene (lj).",
        "",
        f"![Largest error and drift of the energy.]({picture})",
    ]
    for scene in _scenes(results):
        lines += ["", f"### {scene.title}", ""]
        lines += table(results, scene, "largest error of the energy", show_largest)
        lines += [""] + table(results, scene, "drift, energy per unit of time", show_slope)
        lines += [""] + [f"- {sentence}" for sentence in verdict(results, scene)]
    return lines


def measure(folder, steps, lmp=None, workers=2, progress=None, scenes=SCENES, methods=METHODS):
    """Run and judge everything; leaves ``logs``, ``drift.csv`` and ``drift.md`` in ``folder``.

    ``progress``: an object with ``total`` and ``update(steps)``, such as a tqdm bar, or None.
    Returns Run -> Drift.
    """
    folder = Path(folder)
    runs = planned_runs(steps, scenes, methods)
    if progress is not None:
        progress.reset(total=steps * len(runs))
    run_all(runs, folder / "logs", lmp, workers, progress.update if progress is not None else None)
    results = {run: read_drift(run, folder / "logs") for run in runs}
    write_csv(folder / "drift.csv", results)
    (folder / "drift.md").write_text("\n".join(markdown(results)) + "\n", encoding="utf-8")
    return results
