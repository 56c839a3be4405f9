"""What the commands that take a deck have in common."""

import functools
from pathlib import Path

import click


def deck_options(command):
    """The argument DECK and the options that say how it is read."""
    for decorate in (
        click.option(
            "--run",
            "which",
            type=click.IntRange(min=1),
            default=1,
            show_default=True,
            metavar="N",
            help="Measure the Nth of the runs in which the deck moves rigid bodies.",
        ),
        click.option(
            "--without",
            multiple=True,
            metavar="ID",
            help="Leave out the fix ID, for example a thermostat; repeatable.",
        ),
        click.option(
            "--var",
            "variables",
            nargs=2,
            multiple=True,
            metavar="NAME VALUE",
            help="Set a variable of the deck, as -var does; repeatable.",
        ),
        click.argument("deck", type=click.Path(exists=True, dir_okay=False, path_type=Path)),
    ):
        command = decorate(command)
    return command


def open_deck(path, variables, without, which):
    """The Deck of these options; to be used in a with statement."""
    from .measure import Deck

    def say(text):
        click.echo(f"{path.name}: {text}", err=True)

    return Deck(path, variables, without, which, say)


def failing_clearly(command):
    """Decks that cannot be used, and trials that LAMMPS ends, become messages of the command."""

    @functools.wraps(command)
    def run(*args, **kwargs):
        from .script import DeckError
        from .worker import TrialError

        try:
            return command(*args, **kwargs)
        except (DeckError, TrialError) as error:
            raise click.ClickException(str(error)) from error

    return run
