"""Options of the commands that run LAMMPS: how a deck is read."""

import functools
import signal
import sys
from contextlib import contextmanager

import cloup

from gearquat_analysis.folder import Folder
from gearquat_analysis.options import COUNT, FILE

from ..trials.script import DeckError

#: exit status after Ctrl-C, as in a shell
INTERRUPTED = 130


def reading_options(*more):
    """The group of options about reading a deck, with ``more`` options."""
    return cloup.option_group(
        "The deck",
        cloup.option(
            "--var",
            "variables",
            nargs=2,
            multiple=True,
            metavar="NAME VALUE",
            help="Set a variable of the deck, as -var of lmp does; repeatable.",
        ),
        cloup.option(
            "--without",
            multiple=True,
            metavar="ID",
            help="Leave out the fix ID, for example a thermostat; repeatable.",
        ),
        cloup.option(
            "--run",
            "which",
            type=COUNT,
            metavar="N",
            help="Measure the Nth of the runs in which the deck moves rigid bodies.  Default: the first that"
            " can be measured, where no thermostat and no random force acts on the bodies.",
        ),
        *more,
    )


def deck_options(function):
    """The argument DECK and the options about reading it, which become the argument ``scene``."""

    @cloup.argument("deck", type=FILE, help="LAMMPS input script with a fix that moves rigid bodies.")
    @reading_options(
        cloup.option(
            "--ranks", type=COUNT, default=1, metavar="N", help="Run LAMMPS on N ranks, started with mpiexec."
        ),
    )
    @functools.wraps(function)
    def collect(deck, variables, without, which, ranks, **rest):
        scene = {"path": deck, "variables": variables, "without": without}
        return function(scene={**scene, "which": which, "ranks": ranks}, **rest)

    return collect


def results_folder(out, scene, options, names, **more):
    """Folder for the files ``names`` with the results of a scene of ``deck_options``.  Raises DeckError if it has others."""
    reading = {"var": scene["variables"], "without": scene["without"], "run": scene["which"], "ranks": scene.get("ranks", 1)}
    try:
        return Folder(out, scene["path"], reading | options, names, "deck", more)
    except ValueError as error:
        raise DeckError(str(error)) from error


def announce(path, progress):
    """Function that prints the actions on a deck before its trials, above a progress bar."""
    return lambda text: progress.write(f"{path.name}: {text}", file=sys.stderr)


@contextmanager
def ending_cleanly(out):
    """Make Ctrl-C and SIGTERM end the command with a message that the folder ``out`` is unchanged."""

    def stop(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    except KeyboardInterrupt as interrupt:
        cloup.echo(f"\nInterrupted: trials are not kept, and nothing was written to {out.resolve()}", err=True)
        raise SystemExit(INTERRUPTED) from interrupt
    finally:
        signal.signal(signal.SIGTERM, before)
