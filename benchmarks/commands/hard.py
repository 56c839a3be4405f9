"""The command ``benchmarks/run hard``."""

import click

from .measuring import (
    counted,
    jobs_option,
    lmp_option,
    measurement,
    out_option,
    publish_option,
)


@click.command()
@click.option("--only", metavar="CASE", multiple=True, help="Case to run; repeatable.  All: none.")
@out_option("hard", "page, table, pictures, logs and dumps")
@jobs_option()
@lmp_option()
@publish_option(
    "doc/hard_cases.md and pictures in examples/hard are to show the results; needs all cases"
)
def hard(only, out, jobs, lmp, publish_to):
    """Scenes that are hard to integrate, each with an exact or independent answer.

    Leaves a page (hard_cases.md) with what is asked beside what was measured, hard.csv, and a
    picture for each case.
    """
    from benchmarks.studies.hard import figures, page
    from benchmarks.studies.hard.cases import CASES
    from benchmarks.studies.hard.runs import Runs

    known = {case.key: case for case in CASES}
    unknown = set(only) - set(known)
    if unknown:
        raise click.UsageError(f"--only: no case {unknown.pop()}; there are {', '.join(known)}")
    if publish_to and only:
        raise click.UsageError("--publish needs all cases: leave out --only")
    chosen = [case for case in CASES if case.key in only or not only]
    findings = {}
    with measurement(out, publish_to) as out:
        with counted(sum(case.seconds for case in chosen)) as progress:
            for case in chosen:
                progress.set_description(case.key)
                before = progress.n

                def tell(part):
                    progress.update(before + part * case.seconds - progress.n)

                findings[case] = case.run(Runs(out, lmp, jobs, tell))
                tell(1.0)
        for case, finding in findings.items():
            figures.draw(out / "figures" / f"{case.key}.png", finding)
        page.write(out, findings)
    if publish_to:
        page.publish(publish_to, out, findings)
    click.echo(page.console_text(findings))
    click.echo(f"Page, table and pictures are in {out}")
