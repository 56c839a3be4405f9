"""The command ``benchmarks/run bench``."""

import click

from .measuring import (
    counted,
    jobs_option,
    lmp_option,
    measurement,
    out_option,
    publish_option,
    quick_option,
)


@click.command()
@out_option("bench", "page, tables, picture, decks and logs")
@click.option(
    "--rounds",
    type=click.IntRange(min=1),
    help="Timings of every competitor.  Default: 5, with --quick 2.",
)
@quick_option("A first look: few molecules, few steps.")
@jobs_option("Runs at once where nothing is timed.")
@lmp_option()
@click.option("--mpiexec", help="Starts it on two ranks; default: beside LAMMPS, or on the PATH.")
@publish_option("doc/many_bodies.md is to show the results")
def bench(out, rounds, quick, jobs, lmp, mpiexec, publish_to):
    """Many bodies: time, memory, growth, pressure and temperature in water.

    Both formulations of fix gear/quat beside fix rigid/nve/small and fix rigid/small.  Leaves a page
    (many_bodies.md) with what is asked beside what was measured, tables as CSV and a picture.
    Timings want a quiet machine: nothing else should run.
    """
    if publish_to and (quick or (rounds or 5) < 5):
        raise click.UsageError("--publish needs the runs in full and at least five --rounds")
    from dataclasses import replace

    from benchmarks.studies.bench import figures, page, runs

    plan = runs.QUICK if quick else runs.FULL
    plan = replace(plan, rounds=rounds or plan.rounds)
    with measurement(out, publish_to) as out:
        with counted(runs.work(plan)) as progress:
            results = runs.measure(out, plan, lmp, mpiexec, jobs, progress.update)
        figures.draw(out / page.PICTURE, results)
        page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture, decks and logs are in {out}")
