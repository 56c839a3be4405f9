"""The command ``benchmarks/run``."""

import click

from .commands.bench import bench
from .commands.cases import cases
from .commands.drift import drift
from .commands.effects import effects
from .commands.hard import hard
from .commands.isokinetic import isokinetic
from .commands.pictures import pictures
from .commands.workprecision import workprecision


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def main():
    """Measure what the pages of doc/ show."""


for command in (bench, cases, drift, effects, hard, isokinetic, pictures, workprecision):
    main.add_command(command)

if __name__ == "__main__":
    main(prog_name="benchmarks/run")
