"""The runs behind the pictures: test cases 1 and 3 with the defaults of the fix, and their poses."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.engine import decks, series
from lammps_gearquat.analysis import Poses, open_dump
from benchmarks.engine.lammps_runner import Job, run_many

#: case: (step, end, time between samples)
RUNS = {1: (0.01, 1000.0, 0.5), 3: (0.005, 1400.0, 2.0)}


@dataclass(frozen=True)
class Scene:
    """One run of one body, F samples; lj units.

    ``time`` (F,); ``centre`` (F, 3); ``sites`` (F, n, 3); ``axes`` (F, 3, 3): principal axes as rows, in space;
    ``omega_body`` (F, 3): along them; ``potential``, ``translation``, ``rotation`` (F,): energies.
    """

    case: int
    time: np.ndarray
    centre: np.ndarray
    sites: np.ndarray
    axes: np.ndarray
    omega_body: np.ndarray
    potential: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray

    @property
    def total(self):
        """Total energy (F,)."""
        return self.potential + self.translation + self.rotation


def job(case, folder):
    """The job of a case; log and dump are log.caseN and caseN.dump in ``folder``."""
    step, end, every = RUNS[case]
    steps, between = round(end / step), round(every / step)
    out = (folder / f"case{case}").resolve()
    variables = {"dt": step, "steps": steps, "every": between, "dump": between, "out": out}
    return Job(decks.deck_of_case(case), folder / f"log.case{case}", variables, steps)


def read(case, folder):
    """Scene of a finished job."""
    step = RUNS[case][0]
    universe = open_dump(folder / f"case{case}.dump", timestep=step)
    poses = Poses(universe.atoms, reference="principal").run()
    found, energies = poses.results, series.read_log(folder / f"log.case{case}")
    turn = Rotation.from_quat(found.q[:, 0], scalar_first=True)
    matrices = turn.as_matrix()
    sites = found.center + np.einsum("fij,nj->fni", matrices, poses.bodies.shape)
    return Scene(
        case,
        found.time,
        found.center[:, 0],
        sites,
        np.swapaxes(matrices, 1, 2),
        turn.inv().apply(found.omega_space[:, 0]),
        energies.potential,
        found.ke_translation[:, 0],
        found.ke_rotation[:, 0],
    )


def run(folder, lmp=None, progress=None):
    """Run all; returns case -> Scene.  ``progress`` is a tqdm bar or None."""
    jobs = [job(case, folder) for case in RUNS]
    if progress is not None:
        progress.reset(total=sum(each.steps for each in jobs))
    run_many(jobs, lmp, progress=progress.update if progress is not None else None)
    return {case: read(case, folder) for case in RUNS}
