"""The command ``benchmarks/run isokinetic``."""

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
@out_option("isokinetic", "page, tables, picture and logs")
@quick_option("A first look: few steps.")
@jobs_option()
@lmp_option()
@publish_option("doc/isokinetic.md and doc/isokinetic are to show the results")
def isokinetic(out, quick, jobs, lmp, publish_to):
    """Constant kinetic energy: how well it is kept, and what configurations come of it.

    Keyword isokinetic over a million steps of a few bodies, and in water beside
    fix rigid/nvt/small.  Leaves a page (isokinetic.md) with what is asked beside what was
    measured, tables as CSV and a picture.  About six minutes on two cores.
    """
    if publish_to and quick:
        raise click.UsageError("--publish needs the runs in full")
    from benchmarks.studies.isokinetic import figures, page, runs

    plan = runs.QUICK if quick else runs.FULL
    with measurement(out, publish_to) as out:
        with counted(runs.work(plan)) as progress:
            results = runs.measure(out, plan, lmp, jobs, progress.update)
        figures.draw(out / page.PICTURE, results)
        page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture and logs are in {out}")
