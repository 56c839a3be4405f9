"""Options of the commands that run LAMMPS: how a deck is read."""

import functools
import signal
import sys
from contextlib import contextmanager
from time import monotonic

import cloup

from gearquat_analysis.folder import Folder
from gearquat_analysis.options import COUNT, FILE, progress_bar

from ..trials.script import DeckError

#: seconds between two lines of progress where there is no terminal
EVERY = 60.0
#: a line of progress
LINE = "{desc}{percentage:.0f} % after {elapsed}"
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


class _Log:
    """A file for a progress bar that passes one line to ``stream`` every EVERY seconds.

    It has no method isatty, so that the bar is not left out.
    """

    def __init__(self, stream):
        self._stream, self._told = stream, monotonic()

    def write(self, text):
        line = text.strip()
        if line and monotonic() - self._told >= EVERY:
            self._told = monotonic()
            self._stream.write(f"{line}\n")

    def flush(self):
        self._stream.flush()


def shown_progress(**options):
    """tqdm's progress bar; without a terminal, as in a batch job, a line every EVERY seconds instead."""
    if sys.stderr.isatty():
        return progress_bar(**options)
    return progress_bar(file=_Log(sys.stderr), **{**options, "bar_format": LINE})


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
