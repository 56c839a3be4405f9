"""The command ``gearquat``; each of its commands is a module of ``commands``."""

import cloup

from .commands.analyze import analyze
from .commands.common import HELP, epilog
from .commands.cost import cost
from .commands.horizon import horizon
from .commands.scatter import scatter


@cloup.group(
    sections=[
        cloup.Section("Before a long run", [cost, horizon]),
        cloup.Section("After it", [analyze]),
        cloup.Section("Many short runs", [scatter]),
    ],
    context_settings=HELP,
    epilog=epilog(
        "gearquat cost examples/water/in.water --var method rigid --budget 30",
        "gearquat horizon examples/case1/in.case1 --time 100",
    ),
)
@cloup.version_option(package_name="lammps-gearquat", message="%(version)s")
def main():
    """Rigid bodies in LAMMPS by Gear's predictor-corrector in quaternions (fix gear/quat).

    Each command has a help page of its own: gearquat COMMAND -h
    """
