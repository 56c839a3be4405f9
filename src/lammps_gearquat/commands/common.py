"""What the commands have in common: options, progress bars, and errors that say what to do."""

import functools
import sys
from contextlib import contextmanager
from pathlib import Path

import cloup

from .. import EXTRA

HELP = {"help_option_names": ["-h", "--help"], "show_default": True}
POSITIVE = cloup.FloatRange(min=0, min_open=True)
COUNT = cloup.IntRange(min=1)
FILE = cloup.Path(exists=True, dir_okay=False, path_type=Path)
#: modules of the extra [analysis], which commands import only when they are run
ANALYSIS = ("numpy", "scipy", "matplotlib", "MDAnalysis", "tqdm")


def epilog(*examples):
    """The end of a help page: ``examples`` are lines that can be pasted into a shell in a checkout."""
    return "\n  ".join(["\b\nExamples, to be run in a checkout of the repository:", *examples])


def command(*examples):
    return cloup.command(epilog=epilog(*examples), show_constraints=True, context_settings=HELP)


def out_option(name, holds):
    """Option --out: the folder for the results; ``holds``: what it gets."""
    folder = cloup.Path(file_okay=False, path_type=Path)
    return cloup.option("--out", type=folder, default=Path(name), help=f"Folder for {holds}.")


def reading_options(*more):
    """The options that say how a deck is read, in a group, and ``more`` of them."""
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
    """The argument DECK and the options that say how it is read; they become the argument ``scene``."""

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


@contextmanager
def failing_clearly(*errors):
    """Decorator: ``errors``, which a user can mend, and missing modules become messages of the command."""
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "").split(".")[0] not in ANALYSIS:
            raise
        raise cloup.ClickException(f"this command needs {error.name}, {EXTRA}") from error
    except errors as error:
        raise cloup.ClickException(str(error)) from error


def progress_bar(iterable=None, **options):
    """tqdm's progress bar, silent where the output is no terminal."""
    from tqdm import tqdm

    return tqdm(iterable, disable=None, **options)


def announce(path, progress):
    """Function that says what is done with a deck before its trials, above a progress bar."""
    return lambda text: progress.write(f"{path.name}: {text}", file=sys.stderr)
