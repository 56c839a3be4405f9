"""The command ``gearquat``: ``analyze`` of the package gearquat_analysis, and the modules of ``commands``."""

import copy
import subprocess
import sys

try:
    import cloup

    from gearquat_analysis import command as analysis
    from gearquat_analysis.options import HELP, epilog
except ModuleNotFoundError as error:
    raise SystemExit(
        f"Error: gearquat needs {error.name}, which the extra [analysis] brings: run"
        " pip install ./src/analysis '.[analysis]' in a checkout of the repository"
    ) from error

from .commands.cost import cost
from .commands.scatter import scatter


def _apart(command, module):
    """The command, executed by ``python -m module`` in a separate process after its arguments have been parsed.

    The analysis imports MDAnalysis, which is under the LGPL 3 or later.  Code under the GPL 2 alone, such as this
    package, must not be combined with it.
    """

    def parse_args(context, words):
        context.obj = list(words)
        return command.parse_args(context, words)

    @cloup.pass_context
    def callback(context, **_options):
        context.exit(subprocess.call([sys.executable, "-m", module, *context.obj]))

    apart = copy.copy(command)
    apart.parse_args, apart.callback = parse_args, callback
    return apart


@cloup.group(
    sections=[
        cloup.Section("Before a long run", [cost]),
        cloup.Section("After it", [_apart(analysis.analyze, "gearquat_analysis")]),
        cloup.Section("Many short runs", [scatter]),
    ],
    context_settings=HELP,
    epilog=epilog(
        "gearquat cost examples/water/in.water --var forces plain --budget 30",
    ),
)
@cloup.version_option(package_name="lammps-gearquat", message="%(version)s")
def main():
    """Rigid bodies in LAMMPS by Gear's predictor-corrector in quaternions (fix gear/quat).

    Each command has a help page of its own: gearquat COMMAND -h
    """
