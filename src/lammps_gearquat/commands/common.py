"""What the commands that run LAMMPS have in common: the options that say how a deck is read."""

import functools
import sys

import cloup

from gearquat_analysis.options import COUNT, FILE


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


def announce(path, progress):
    """Function that says what is done with a deck before its trials, above a progress bar."""
    return lambda text: progress.write(f"{path.name}: {text}", file=sys.stderr)
