"""Pictures of the paper's test cases 1 and 3 for a talk, and a film.

figures.py (orbit, tumbling body, energy), film.py, view.py (camera, spheres and rods).
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.engine import Finding, Job, Study, deck, series
from gearquat_analysis import Poses, open_dump

from .figures import draw_energy, draw_orbit, draw_tumbling
from .film import draw_film

#: case: (step, end, time between samples)
RUNS = {1: (0.01, 1000.0, 0.5), 3: (0.005, 1400.0, 2.0)}
QUICK_END = 300.0


@dataclass(frozen=True)
class Scene:
    """One run of one body, F samples; lj units.

    ``time`` (F,); ``center`` (F, 3); ``sites`` (F, n, 3); ``axes`` (F, 3, 3): principal axes as rows, in
    space; ``omega_body`` (F, 3): along them; ``energies``: "potential", "translation", "rotation" and
    "total" -> (F,).
    """

    time: np.ndarray
    center: np.ndarray
    sites: np.ndarray
    axes: np.ndarray
    omega_body: np.ndarray
    energies: dict


def read(finished, step):
    """Scene of a run: poses of its dump, energies of its log."""
    poses = Poses(open_dump(finished.dump, timestep=step).atoms, reference="principal").run()
    motion, log = poses.results, series.of_log(finished.log)
    turn = Rotation.from_quat(motion.q[:, 0], scalar_first=True)
    matrices = turn.as_matrix()
    sites = motion.center + np.einsum("fij,nj->fni", matrices, poses.bodies.shape)
    axes, omega = np.swapaxes(matrices, 1, 2), turn.inv().apply(motion.omega_space[:, 0])
    energies = {"potential": log.potential, "translation": motion.ke_translation[:, 0]}
    energies["rotation"] = motion.ke_rotation[:, 0]
    energies["total"] = sum(energies.values())
    return Scene(motion.time, motion.center[:, 0], sites, axes, omega, energies)


def measure(lab):
    """Test case -> Scene, with the defaults of the fix."""
    jobs = {}
    for case, (step, end, every) in RUNS.items():
        steps, between = round((QUICK_END if lab.quick else end) / step), round(every / step)
        variables = {"dt": step, "steps": steps, "every": between, "dump": between}
        jobs[case] = Job(deck(f"case{case}"), variables, steps)
    found = lab.many({f"case{case}": job for case, job in jobs.items()})
    return {case: read(found[f"case{case}"], RUNS[case][0]) for case in jobs}


def find(scenes):
    """Finding of what ``measure`` returns."""
    orbit = {"orbit": draw_orbit, "tumbling": draw_tumbling, "energy": draw_energy}
    drawn = {name: partial(draw, scene=scenes[1]) for name, draw in orbit.items()}
    return Finding(pictures=drawn | {"leaving.gif": partial(draw_film, scene=scenes[3])})


STUDY = Study("pictures", "Pictures for a talk", 60.0, measure, find)
