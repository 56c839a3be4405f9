"""LAMMPS runs of the liquids, and what they leave."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine import EXAMPLES, Job
from benchmarks.studies.drift import is_lost

from .plan import FLOOR_STEP, FLOORS, LIQUIDS, QUICK, SCENES, SPCE, Plan

#: LAMMPS' real units: g/mol (Angstrom/fs)^2 in kcal/mol
ENERGY = 48.88821291**2


@dataclass(frozen=True)
class Run:
    """A run of one method: samples (n,) at ``time`` in fs, energies in kcal/mol, ``pressure`` in atm.

    ``duration``: what was asked for, fs.  ``seconds``: per step, NaN if the run failed.
    """

    time: np.ndarray
    total: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    pressure: np.ndarray
    duration: float
    seconds: float

    @property
    def lost(self):
        """Whether it ended early, or numbers are not finite."""
        return not len(self.time) or self.time[-1] < 0.999 * self.duration


@dataclass(frozen=True)
class Results:
    """What was measured.

    ``runs``: (key of scene, key of method, step) -> Run.  ``floors``: (text of Forces, key of method) ->
    Run.
    """

    plan: Plan
    runs: dict
    floors: dict


def _deck(name):
    return Path(__file__).with_name(f"in.{name}")


def template(liquid):
    """File of a molecule of the liquid; examples/water has that of SPC/E."""
    name = f"molecule.{liquid.key}"
    own = Path(__file__).with_name(name)
    return own if own.is_file() else EXAMPLES / "water" / name


def equilibrate(lab, plan):
    """Key of liquid -> path of its data file."""
    jobs, data = {}, {}
    for liquid in LIQUIDS:
        names = "edge", "density", "mass", "temperature", "pair", "kspace"
        variables = {"liquid": liquid.key} | {name: getattr(liquid, name) for name in names}
        variables |= {"template": template(liquid), "steps": plan.equilibration}
        name = f"equilibrate_{liquid.key}"
        jobs[name] = Job(_deck("equilibrate"), variables, plan.equilibration)
        data[liquid.key] = lab.dump(name).with_suffix(".data").resolve()
    lab.many(jobs, keep=True)
    return data


def job(liquid, data, forces, method, dt, duration):
    """Job of in.liquid; ``dt`` and ``duration`` in fs."""
    every = round(liquid.interval / dt)
    steps = every * math.ceil(duration / (every * dt) - 1e-9)
    variables = {"liquid": liquid.key, "data": data[liquid.key], **forces.variables}
    variables |= {"dt": f"{dt:.17g}", "every": every, "steps": steps, **method.variables}
    return Job(_deck("liquid"), variables, steps)


def read(finished, liquid, steps, dt):
    """Run of a log.  It may have been refused before its first sample."""
    if not finished.log.tables or not len(finished.thermo["Step"]):
        return Run(*np.zeros((5, 0)), steps * dt, math.nan)
    thermo = finished.thermo
    translation = 0.5 * ENERGY * liquid.mass * thermo["v_squares"]
    columns = [thermo["Time"], thermo["TotEng"], translation, thermo["KinEng"] - translation]
    columns = np.array([*columns, thermo["Press"]])
    columns = columns[:, np.isfinite(columns).all(axis=0)]
    seconds = math.nan if finished.error else finished.log.seconds / steps
    return Run(*columns, steps * dt, seconds)


def measure(lab, plan=None, scenes=SCENES, floors=FLOORS):
    """Results.  What a call with the same input has finished is not run again."""
    plan = plan or (QUICK if lab.quick else Plan())
    with lab.share(0.03):
        data = equilibrate(lab, plan)
    jobs, keys = {}, {}
    for scene in scenes:
        for method in scene.methods:
            for dt in scene.liquid.steps:
                name = f"{scene.key}_{method.key}_dt{dt:g}"
                keys[name] = scene.liquid, (scene.key, method.key, dt)
                duration = plan.duration(scene)
                jobs[name] = job(scene.liquid, data, scene.forces, method, dt, duration)
    for k, (forces, methods) in enumerate(floors.items()):
        for method in methods:
            name = f"floor{k}_{method.key}"
            keys[name] = SPCE, (forces, method.key, FLOOR_STEP)
            jobs[name] = job(SPCE, data, forces, method, FLOOR_STEP, 1000 * plan.floor)
    with lab.share(0.97):
        finished = lab.many(jobs, may_fail=is_lost, keep=True)
    runs, limits = {}, {}
    for name, (liquid, key) in keys.items():
        run = read(finished[name], liquid, jobs[name].steps, key[-1])
        if isinstance(key[0], str):
            runs[key] = run
        else:
            limits[key[0].text, key[1]] = run
    return Results(plan, runs, limits)
