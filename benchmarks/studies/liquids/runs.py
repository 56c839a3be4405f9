"""LAMMPS runs of the liquids, and their results."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine import EXAMPLES, Job
from benchmarks.engine.methods import DEFAULT_VALUES
from benchmarks.engine.sites import read_sites
from benchmarks.studies import drift
from benchmarks.studies.coefficients import prediction

from .heavier import write_bodies
from .plan import DEFAULT, FLOOR_INTERVAL, FLOOR_STEP, FLOORS, FULL, HEAVY, INTERVAL, LIQUIDS
from .plan import QUICK, SCENES, SPCE, Plan

#: LAMMPS' messages, in addition to numbers that are not finite, if atoms move too far
FLOWN = ("Out of range atoms", "Lost atoms", "Rigid body atoms", "Bond atoms missing")
#: step of the runs for spectra, fs
SPECTRUM_STEP = 1.0


@dataclass(frozen=True)
class Run:
    """A run of one method: samples (n,) at ``time`` in fs, energies in kcal/mol, ``pressure`` in atm.

    ``kinetic``: kinetic energy of the atoms, equal to the energy of the bodies unless their inertia is changed.
    ``duration``: requested duration, fs.  ``seconds``: per step, NaN if the run failed.  ``values``: number of values of
    fix gear/quat, 0 for another fix.
    """

    time: np.ndarray
    total: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    kinetic: np.ndarray
    pressure: np.ndarray
    duration: float
    seconds: float
    values: int = 0

    @property
    def lost(self):
        """True if the run ended early or has numbers that are not finite."""
        return not len(self.time) or self.time[-1] < 0.999 * self.duration

    @property
    def potential(self):
        """Potential energy (n,)."""
        return self.total - self.translation - self.rotation


@dataclass(frozen=True)
class Results:
    """All measurements.

    * ``runs``: (key of scene, key of method, step) -> list of Run, one for each start
    * ``floors``: (text of Forces, key of method) -> Run
    * ``spectra``: key of liquid -> Spectrum
    * ``pairs``: (key of scene, step) -> radial distribution functions (starts, bins, 3): distance in Angstrom, g(r)
      between sites of the first type, and g(r) between sites of the first and the second type
    """

    plan: Plan
    runs: dict
    floors: dict
    spectra: dict
    pairs: dict


def is_lost(text):
    """True if LAMMPS' message says that a run ended because numbers were not finite or atoms were lost."""
    return drift.is_lost(text) or any(words in text for words in FLOWN)


def _deck(name):
    return Path(__file__).with_name(f"in.{name}")


def template(liquid):
    """Molecule file of the liquid; the one for SPC/E is in examples/water."""
    name = f"molecule.{liquid.key}"
    own = Path(__file__).with_name(name)
    return own if own.is_file() else EXAMPLES / "water" / name


def equilibrate(lab, plan, liquids=LIQUIDS, numbers=None):
    """(key of liquid, number of start) -> path of its data file; a dump with suffix .start is next to it.

    ``numbers``: numbers of the starts, by default all starts of the Plan.
    """
    jobs, data = {}, {}
    names = "types", "edge", "density", "mass", "temperature", "pair", "kspace"
    for liquid in liquids:
        own = {"liquid": liquid.key} | {name: getattr(liquid, name) for name in names}
        own |= {"template": template(liquid), "steps": plan.equilibration, "shrinking": plan.shrinking}
        for start in numbers or range(plan.starts):
            name = f"equilibrate_{liquid.key}_{start}"
            jobs[name] = Job(_deck("equilibrate"), own | {"seed": 4711 + start}, plan.equilibration, plugin=False)
            data[liquid.key, start] = lab.dump(name).with_suffix(".data").resolve()
    lab.many(jobs, keep=True)
    return data


def job(liquid, data, forces, method, dt, duration, interval=INTERVAL, **more):
    """Job of in.liquid; ``data``: path, ``dt``, ``duration`` and ``interval`` in fs, ``more``: variables."""
    every = round(interval / dt)
    steps = every * math.ceil(duration / (every * dt) - 1e-9)
    variables = {"liquid": liquid.key, "data": data, **forces.variables}
    variables |= {"dt": f"{dt:.17g}", "every": every, "steps": steps, **method.variables, **more}
    return Job(_deck("liquid"), variables, steps, plugin=method.gear)


def values_of(log, method):
    """Number of values of a method from its Log: the last choice of the fix, or the keyword, or the default."""
    if not method.gear:
        return 0
    return [method.variables.get("values", DEFAULT_VALUES[method.kind]), *log.chosen_values][-1]


def read(finished, steps, dt, method):
    """Run of a method from its log; the run may have been refused before its first sample."""
    if not finished.log.tables or not len(finished.thermo["Step"]):
        return Run(*np.zeros((6, 0)), steps * dt, math.nan)
    names = "Time", "v_total", "v_ketrans", "v_kerot", "KinEng", "Press"
    columns = np.array([finished.thermo[name] for name in names])
    columns = columns[:, np.isfinite(columns).all(axis=0)]
    seconds = math.nan if finished.error else finished.log.seconds / steps
    return Run(*columns, steps * dt, seconds, values_of(finished.log, method))


def _of_scene(scene, plan, data, lab):
    """Name -> (Job, (key of scene, method, step)) of a scene."""
    jobs = {}
    for method, extent in scene.methods.items():
        for dt in extent.steps:
            starts, duration = plan.extent(scene, method, dt)
            for start in range(starts):
                own, more = data[scene.liquid.key, start], {}
                if scene.inertia != 1.0:
                    path = lab.dump(f"{scene.key}_{start}").with_suffix(".infile").resolve()
                    write_bodies(path, read_sites(own.with_suffix(".start")), scene)
                    more["infile"] = path
                if method is DEFAULT and dt in scene.pairs:
                    more["pairs"] = "yes"
                made = job(scene.liquid, own, scene.forces, method, dt, duration, **more)
                name = f"{scene.key}_{method.key}_dt{dt:g}_{start}"
                jobs[name] = made, (scene.key, method, dt)
    return jobs


def _of_floors(floors, plan, data):
    """Name -> (Job, (text of Forces, method))."""
    jobs, one = {}, data[SPCE.key, 0]
    for k, (forces, methods) in enumerate(floors.items()):
        for method in methods:
            made = job(SPCE, one, forces, method, FLOOR_STEP, 1000 * plan.floor, FLOOR_INTERVAL)
            jobs[f"floor{k}_{method.key}"] = made, (forces.text, method)
    return jobs


def _of_spectra(scenes, plan, data):
    """Name -> (Job, key of liquid)."""
    jobs = {}
    for scene in scenes:
        liquid, length = scene.liquid, 1000 * plan.spectrum
        own = data[liquid.key, 0], scene.forces, DEFAULT, SPECTRUM_STEP, length
        jobs[f"spectrum_{scene.key}"] = job(liquid, *own, bodies="yes"), liquid.key
    return jobs


def read_pairs(path):
    """Distance and two radial distribution functions (bins, 3) of a file of in.liquid."""
    return np.loadtxt(path, skiprows=4)[:, [1, 2, 4]]


def measure(lab, plan=None, scenes=SCENES, heavy=HEAVY, floors=FLOORS):
    """Results.  Except for ``floors``, finished runs of an earlier call with the same input are not repeated."""
    plan = plan or (QUICK if lab.quick else FULL if lab.full else Plan())
    with lab.share(0.08):
        data = equilibrate(lab, plan, [scene.liquid for scene in scenes])
    followed, foreseen = {}, _of_spectra(scenes, plan, data)
    for scene in (*scenes, heavy):
        followed |= _of_scene(scene, plan, data, lab)
    limits = _of_floors(floors, plan, data)
    jobs = {name: made for name, (made, _) in (followed | foreseen).items()}
    with lab.share(0.84):
        finished = lab.many(jobs, may_fail=is_lost, keep=True)
    with lab.share(0.08):  # one after the other, because the page has their times
        timed = lab.in_turn({name: made for name, (made, _) in limits.items()}, rounds=1)
    results = Results(plan, {}, {}, {}, {})
    for name, (made, (key, method, dt)) in followed.items():
        run = read(finished[name], made.steps, dt, method)
        results.runs.setdefault((key, method.key, dt), []).append(run)
        if "pairs" in made.variables and not run.lost:
            found = read_pairs(lab.dump(name).with_suffix(".pairs"))
            results.pairs.setdefault((key, dt), []).append(found)
    for name, (made, (text, method)) in limits.items():
        results.floors[text, method.key] = read(timed[name][0], made.steps, FLOOR_STEP, method)
    for name, (made, key) in foreseen.items():
        results.spectra[key] = prediction.read(lab.dump(name).with_suffix(".bodies"), SPECTRUM_STEP)
    return results
