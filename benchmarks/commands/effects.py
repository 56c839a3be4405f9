"""The command ``benchmarks/run effects``."""

import click

from .measuring import (
    counted,
    lmp_option,
    measurement,
    out_option,
    publish_option,
    quick_option,
)


@click.command()
@out_option("effects", "page, tables, picture, profiles, decks and logs")
@quick_option("All counts, but times from one short run each.")
@lmp_option(
    "LAMMPS program, not stripped; default: build/tree/lmp of the checkout that is published to, "
    "the one beside this Python, or on the PATH."
)
@publish_option("doc/effects.md and doc/effects are to show the results")
def effects(out, quick, lmp, publish_to):
    """What each effect of a scene costs, on and off: instructions, counted by valgrind, and time.

    Leaves a page (effects.md), tables as CSV and a picture of the ladder from point particles to
    bodies with everything.  Timings want a quiet machine: nothing else should run.
    """
    if publish_to and quick:
        raise click.UsageError("--publish needs the times in full")
    from benchmarks.studies.effects import figures, page, runs

    sizes = runs.QUICK if quick else runs.Sizes()
    tree = publish_to and (publish_to / "build/tree/lmp").resolve()
    if not lmp and tree and tree.is_file():
        lmp = tree
    with measurement(out, publish_to) as out:
        with counted(runs.work(sizes)) as progress:
            results = runs.measure(out, sizes, lmp, progress.update)
        figures.draw(out / page.PICTURE, results)
        page.write(out, results)
    if publish_to:
        page.publish(publish_to, out, results)
    click.echo((out / page.PAGE).read_text(encoding="utf-8"))
    click.echo(f"Page, tables, picture, profiles, decks and logs are in {out}")
