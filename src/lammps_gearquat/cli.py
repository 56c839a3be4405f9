"""The command ``gearquat``: ``analyze`` of the package gearquat_analysis, and the modules of ``commands``."""

try:
    import cloup

    from gearquat_analysis.command import analyze
    from gearquat_analysis.options import HELP, epilog
except ModuleNotFoundError as error:
    raise SystemExit(
        f"Error: gearquat needs {error.name}, which the extra [analysis] brings: run"
        " pip install ./src/analysis '.[analysis]' in a checkout of the repository"
    ) from error

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
