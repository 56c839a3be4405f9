"""The command ``gearquat``; each of its commands is a module of ``commands``."""

import click

from .commands.analyze import analyze
from .commands.cost import cost
from .commands.horizon import horizon


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="lammps-gearquat", message="%(version)s")
def main():
    """Rigid bodies in LAMMPS by Gear's predictor-corrector in quaternions (fix gear/quat)."""


for command in (analyze, cost, horizon):
    main.add_command(command)
