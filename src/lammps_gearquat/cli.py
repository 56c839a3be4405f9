"""The command ``gearquat``; each of its commands is a module of ``commands``."""

import click

import lammps_gearquat

from .commands.analyze import analyze
from .commands.bench import bench
from .commands.cases import cases
from .commands.cost import cost
from .commands.drift import drift
from .commands.effects import effects
from .commands.hard import hard
from .commands.horizon import horizon
from .commands.isokinetic import isokinetic
from .commands.pictures import pictures
from .commands.workprecision import workprecision


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def main():
    """Rigid bodies in LAMMPS by Gear's predictor-corrector in quaternions (fix gear/quat)."""


@main.command()
def version():
    """Print the version of the package."""
    click.echo(lammps_gearquat.__version__)


for command in (
    analyze,
    bench,
    cases,
    cost,
    drift,
    effects,
    hard,
    horizon,
    isokinetic,
    pictures,
    workprecision,
):
    main.add_command(command)
