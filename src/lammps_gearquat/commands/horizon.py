"""The command ``gearquat horizon``."""

from pathlib import Path

import click

from ..trials.options import deck_options, failing_clearly, open_deck

_POSITIVE = click.FloatRange(min=0, min_open=True)


@click.command()
@deck_options
@click.option(
    "--time",
    type=_POSITIVE,
    help="Time to follow.  Default: that of the deck's run, if affordable.",
)
@click.option(
    "--threshold",
    "thresholds",
    type=_POSITIVE,
    multiple=True,
    help="Distance at which the runs have parted; repeatable.  Default: 0.1, 1 and 3 times the"
    " power of ten of the size of the bodies.",
)
@click.option("--every", type=_POSITIVE, help="Time between samples.  Default: a 500th of it all.")
@click.option(
    "--a",
    "first",
    help="One run: keywords of fix gear/quat, changing those of the deck.  Default: the deck as"
    " it is.",
)
@click.option(
    "--b",
    "second",
    help='The other run, in the same way.  Default: "formulation second values 8 compensate yes".',
)
@click.option("--step-a", type=_POSITIVE, help="Time step of one run.  Default: that of the deck.")
@click.option(
    "--step-b",
    type=_POSITIVE,
    help="Time step of the other run.  Default: half of the first, or the same with --b.",
)
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-horizon"),
    show_default=True,
    help="Folder for horizon.csv, parting.csv and horizon.png.",
)
@failing_clearly
def horizon(
    deck, variables, without, which, time, thresholds, every, first, second, step_a, step_b, out
):
    """Until what time the trajectory of DECK can be trusted.

    Runs the scene twice, at two accuracies, and reports when the two part, and the Lyapunov time
    if their difference grows exponentially.  Two formulations can be compared as well:

        gearquat horizon in.case1 --var choices paper --every 1 --time 2000
        --threshold 0.1 --threshold 1 --threshold 3
        --a "formulation first values 5 momentum predicted" --b "formulation second"
    """
    from tqdm import tqdm

    from ..trials import figures, report
    from ..trials import horizon as trials

    with open_deck(deck, variables, without, which) as scene:
        with tqdm(total=1, unit="step", unit_scale=True, desc="running LAMMPS") as progress:
            found = trials.measure(
                scene, first, second, (step_a, step_b), time, every, thresholds, progress
            )
        out = out.resolve()
        out.mkdir(parents=True, exist_ok=True)
        report.write_horizon(out, found)
        figures.draw_horizon(out / "horizon.png", scene, found)
        click.echo(report.horizon_text(scene, found))
    click.echo(f"\nTables and picture are in {out}")
