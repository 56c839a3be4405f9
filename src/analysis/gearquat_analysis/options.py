"""Common parts of all commands: types of options, help pages, clear errors."""

from contextlib import contextmanager
from pathlib import Path

import cloup

HELP = {"help_option_names": ["-h", "--help"], "show_default": True}
POSITIVE = cloup.FloatRange(min=0, min_open=True)
COUNT = cloup.IntRange(min=1)
FILE = cloup.Path(exists=True, dir_okay=False, path_type=Path)


def epilog(*examples):
    """The end of a help page; ``examples`` are lines to paste into a shell in a checkout."""
    return "\n  ".join(["\b\nExamples, to be run in a checkout of the repository:", *examples])


def command(*examples):
    return cloup.command(epilog=epilog(*examples), show_constraints=True, context_settings=HELP)


def out_option(name, holds):
    """Option --out: the folder for the results; ``holds`` describes its contents."""
    folder = cloup.Path(file_okay=False, path_type=Path)
    return cloup.option("--out", type=folder, default=Path(name), help=f"Folder for {holds}.")


@contextmanager
def failing_clearly(*errors):
    """Decorator that turns ``errors`` of the user into messages of the command, without a traceback."""
    try:
        yield
    except errors as error:
        raise cloup.ClickException(str(error)) from error
