"""The command ``benchmarks/run cases``."""

import click

from .measuring import jobs_option, lmp_option, measurement, out_option, publish_option, shares


@click.command()
@out_option("cases", "tables, figures, series and logs")
@click.option("--full", is_flag=True, help="Also run the paper's 50 million steps of 0.0001.")
@jobs_option()
@lmp_option()
@publish_option("doc/results.md, doc/figures and README.md are to show the results")
def cases(out, full, jobs, lmp, publish_to):
    """Run the paper's three test cases and judge every claim of the paper.

    Leaves table.md, table.csv, table7.csv, accuracy.csv, the paper's Figures 2 to 13 as PNG
    (figures) and every series as CSV (series).
    """
    from benchmarks.studies.cases import figures, page, tables
    from benchmarks.studies.cases.runs import run_cases

    with measurement(out, publish_to) as out:
        with shares() as progress:
            results = run_cases(out, full, lmp, jobs, progress)
        claims = tables.write_tables(out, results)
        figures.draw_all(out / "figures", results)
    if publish_to:
        page.publish(publish_to, out, claims, results)
    click.echo(tables.console_text(claims, results))
    click.echo(f"\nTables, figures and series are in {out}")
