"""``python -m gearquat_analysis DUMP``: the command ``gearquat analyze`` without LAMMPS."""

from .command import analyze

analyze(prog_name="python -m gearquat_analysis")
