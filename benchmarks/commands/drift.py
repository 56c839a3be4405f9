"""The command ``benchmarks/run drift``."""

import click

from .measuring import jobs_option, lmp_option, measurement, out_option, shares


@click.command()
@out_option("drift", "table, picture and logs")
@click.option(
    "--steps",
    type=click.IntRange(min=100),
    default=10_000_000,
    show_default=True,
    help="Steps of every run.",
)
@jobs_option()
@lmp_option()
def drift(out, steps, jobs, lmp):
    """How well every method holds the energy over very long runs.

    A body in the paper's cage, coated so that nothing is singular, and a free asymmetric top, with
    settings of fix gear/quat and with LAMMPS' own rigid fixes.  Leaves drift.csv, drift.png,
    drift.md and the logs.
    """
    from benchmarks.studies.drift import figures, page
    from benchmarks.studies.drift import runs as long_runs

    with measurement(out) as out:
        with shares() as progress:
            results = long_runs.measure(out, steps, lmp, jobs, progress)
        page.write(out, results)
        figures.draw(out / "drift.png", results)
    click.echo((out / "drift.md").read_text(encoding="utf-8"))
    click.echo(f"Table, picture and logs are in {out}")
