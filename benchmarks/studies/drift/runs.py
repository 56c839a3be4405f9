"""Energy over very long runs: what is run.

Two scenes of ``examples`` that no method has to lose: the body without bare charges in the paper's
cage, bound because its energy is below zero, and the free asymmetric top.  Every method runs the
same number of steps at the same few steps, from one that is small for all of them to one that is
usual with fix rigid/nve/small.  Samples are sparse; the largest error is that of the samples.
"""

import threading
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from benchmarks.engine import decks, series
from benchmarks.engine.lammps_runner import Job, LammpsError, run_many
from .judge import judge, lost

SAMPLES = 2000
#: LAMMPS' word for coordinates and energies that are not finite any more, and the fix's own
NOT_FINITE = ("Non-numeric", "Fix gear/quat: blow-up", "values can follow")


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


def _finite_until(log):
    """Time of the last sample that a log holds; 0 if the run was refused before the first one."""
    rows = (line.split() for line in Path(log).read_text(encoding="utf-8").splitlines())
    samples = (row for row in rows if len(row) == len(series.COLUMNS) and row[0].isdigit())
    return max((float(row[1]) for row in samples), default=0.0)


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


def measure(folder, steps, lmp=None, workers=2, progress=None, scenes=SCENES, methods=METHODS):
    """Run and judge everything; leaves ``logs`` in ``folder``.

    ``progress``: an object with ``total`` and ``update(steps)``, such as a tqdm bar, or None.
    Returns Run -> Drift.
    """
    folder = Path(folder)
    runs = planned_runs(steps, scenes, methods)
    if progress is not None:
        progress.reset(total=steps * len(runs))
    run_all(runs, folder / "logs", lmp, workers, progress.update if progress is not None else None)
    return {run: read_drift(run, folder / "logs") for run in runs}
