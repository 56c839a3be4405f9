"""The command ``gearquat cost``."""

from pathlib import Path

import click

from ..trials.options import deck_options, failing_clearly, open_deck


@click.command()
@deck_options
@click.option(
    "--error",
    "errors",
    type=click.FloatRange(min=0, min_open=True),
    multiple=True,
    help="Error to price, in the deck's unit of length (orientations: radians); repeatable."
    "  Default: powers of ten of the size of the bodies.",
)
@click.option(
    "--time",
    type=click.FloatRange(min=0, min_open=True),
    help="Time of the trials.  Default: that of the deck's run, or what budget and chaos allow.",
)
@click.option(
    "--of",
    "norm",
    type=click.Choice(
        ["largest position", "rms position", "largest orientation", "rms orientation"]
    ),
    default="largest position",
    show_default=True,
    help="What the error is of: over all bodies.",
)
@click.option(
    "--budget",
    type=click.FloatRange(min=0, min_open=True),
    default=180.0,
    show_default=True,
    help="Seconds of wall time that all trials may take, about.",
)
@click.option(
    "--timings",
    type=click.IntRange(min=1),
    default=5,
    show_default=True,
    help="Timings of each trial that matters, interleaved.",
)
@click.option(
    "--try",
    "tries",
    multiple=True,
    help='Further keywords of the fix to try, such as "formulation second values 9 passes 2".',
)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-cost"),
    show_default=True,
    help="Folder for cost.csv, trials.csv and cost.png.",
)
@failing_clearly
def cost(deck, variables, without, which, errors, time, norm, budget, timings, tries, out):
    """What accuracy costs in the scene of DECK, and the lines to put into it.

    DECK is any LAMMPS input script with fix gear/quat, rigid, rigid/nve, rigid/small or
    rigid/nve/small.  It is followed up to its run; from there short trials over time steps and
    orders are compared with a finer one, and with the deck's own fix.  Errors are judged only as
    far as the finest trial is confirmed by a second one of the other formulation.
    """
    from tqdm import tqdm

    from ..trials import cost as trials
    from ..trials import figures, report, script

    for text in tries:
        script.pairs(text)
    with open_deck(deck, variables, without, which) as scene:
        with tqdm(total=round(budget), bar_format="{l_bar}{bar}| {elapsed}") as progress:
            costs = trials.measure(
                scene, errors, time, budget, timings, trials.NORMS.index(norm), tries, progress
            )
        out = out.resolve()
        out.mkdir(parents=True, exist_ok=True)
        report.write_costs(out, scene, costs)
        figures.draw_cost(out / "cost.png", scene, costs)
        click.echo(report.cost_text(scene, costs))
    click.echo(f"\nTables and picture are in {out}")
