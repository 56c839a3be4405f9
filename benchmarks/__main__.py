"""The command ``benchmarks/run``."""

import sys
from pathlib import Path

import click

from benchmarks.engine import ROOT, LammpsError
from benchmarks.engine.conduct import all_studies, conduct
from benchmarks.engine.publish import PublishError


def list_studies(_context, _option, wanted):
    """--list: every study with its duration and its pages."""
    if not wanted:
        return
    for study in all_studies().values():
        minutes = max(1, round(study.seconds / 60))
        click.echo(f"{study.key:12} {minutes:4} min  {study.title} ({', '.join(study.blocks)})")
    sys.exit()


def chosen(names):
    """The studies with these names."""
    known = all_studies()
    for name in names:
        if name not in known:
            raise click.UsageError(f"there is no study {name}; there are {', '.join(known)}")
    return [known[name] for name in dict.fromkeys(names)]


def report(finding, check):
    """Print the finding; returns the number of measurements that are out of bounds, if they are checked."""
    failed = 0
    for measurement in finding.measurements:
        line = f"{measurement.what}: {measurement.text}"
        if check and not measurement.holds:
            failed += 1
            line = f"FAILED {line}; it must be {measurement.bounds}"
        click.echo(line)
    if check:
        bounded = sum(bool(measurement.bounds) for measurement in finding.measurements)
        click.echo(f"{bounded - failed} of {bounded} bounds hold.")
    return failed


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("names", nargs=-1, required=True, metavar="NAME...")
@click.option("--list", is_flag=True, is_eager=True, expose_value=False, callback=list_studies)
@click.option("--publish", "publish_it", is_flag=True)
@click.option("--check", is_flag=True)
@click.option("--render", "render_only", is_flag=True)
@click.option("--jobs", type=click.IntRange(min=1), default=2)
@click.option("--quick", is_flag=True)
@click.option("--hours", type=click.FloatRange(min=0), default=1.0)
@click.option("--lmp")
@click.option("--out", type=click.Path(file_okay=False, path_type=Path))
def main(names, out, publish_it, check, render_only, **options):
    """Measure the numbers on the pages of doc/; the head of the script explains the options."""
    failed, studies = 0, chosen(names)
    for study in studies:
        folder = out or ROOT / "build" / "benchmarks" / study.key
        if out and len(studies) > 1:
            folder = out / study.key
        try:
            finding = conduct(study, folder, render_only, publish_it, **options)
        except PublishError as error:
            raise click.UsageError(str(error)) from error
        except (LammpsError, FileNotFoundError) as error:
            raise click.ClickException(str(error)) from error
        failed += report(finding, check)
        click.echo(f"All results of {study.key} are in {folder}")
    if failed:
        sys.exit(1)


if __name__ == "__main__":
    main(prog_name="benchmarks/run")
