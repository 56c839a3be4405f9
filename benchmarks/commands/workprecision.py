"""The command ``benchmarks/run workprecision``."""

from pathlib import Path

import click

from .measuring import counted, measurement, out_option, publish_option, quick_option

SCENES = ("case1", "top", "water", "water-plain")


@click.command()
@out_option("workprecision", "tables, pictures, reference solutions and logs")
@click.option(
    "--scene",
    "scenes",
    type=click.Choice(SCENES),
    multiple=True,
    help="Scene to run; repeatable.  Default: all.",
)
@click.option(
    "--timings",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    help="Timings of every run, at least; competitors are interleaved.",
)
@quick_option("A first look: few settings, few steps.")
@click.option(
    "--drift",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Folder that `benchmarks/run drift` left; its table and picture join the page.",
)
@publish_option(
    "doc/accuracy_cost.md, doc/accuracy_cost and README.md are to show the results; needs all scenes"
)
def workprecision(out, scenes, timings, quick, drift, publish_to):
    """What accuracy costs: errors against force evaluations and against wall time.

    Both formulations with every number of values, fix rigid/nve/small, fix rigid/small and SciPy's
    DOP853 and LSODA, in the paper's test case 1, on a free top and in water.  Leaves a page
    (accuracy_cost.md), tables as CSV and pictures as PNG.  Timings want a quiet machine: nothing
    else should run.
    """
    if publish_to and (scenes or quick or timings < 5):
        raise click.UsageError("--publish needs all scenes in full and at least five --timings")
    if drift and not (drift / "drift.md").is_file():
        raise click.UsageError(f"--drift: {drift} has no drift.md: run `benchmarks/run drift` first")
    from benchmarks.studies.workprecision import conduct, figures, page, plan
    from benchmarks.studies.workprecision.measure import Session

    chosen = [plan.SCENES[name](quick) for name in scenes or SCENES]
    with measurement(out, publish_to, page.COMMAND) as out:
        with Session(out / "logs") as session, counted(1) as progress:

            def tell(seconds, text):
                progress.set_description(text, refresh=False)
                progress.update(seconds)

            conductor = conduct.Conductor(session, out, timings, tell)
            progress.reset(total=conductor.expected(chosen))
            results = conductor.run(chosen)
        results.write(out)
        figures.draw_all(out / "figures", results)
        page.write(out, results, drift)
    if publish_to:
        page.publish(publish_to, out, results, drift)
    click.echo((out / "accuracy_cost.md").read_text(encoding="utf-8"))
    click.echo(f"Page, tables and pictures are in {out}")
