"""The command ``gearquat horizon``."""

import cloup

from gearquat_analysis.options import POSITIVE, command, failing_clearly, out_option

from ..launch import LammpsError
from ..trials.script import DeckError
from .common import announce, deck_options, ending_cleanly, results_folder, shown_progress

LEAVES = ("horizon.csv", "parting.csv", "growth.csv", "horizon.png")


@command(
    "gearquat horizon examples/case1/in.case1 --time 100",
    "gearquat horizon examples/case2/in.case2 --var choices paper --time 500 --every 1 --out case2 \\",
    '    --a "formulation first values 5 momentum predicted" --b "formulation second"',
)
@deck_options
@cloup.option_group(
    "Measurement",
    cloup.option(
        "--time", type=POSITIVE, help="Time to follow.  Default: the time of the deck's run, if affordable."
    ),
    cloup.option(
        "--threshold",
        "thresholds",
        type=POSITIVE,
        multiple=True,
        help="Distance at which the runs have parted; repeatable.  Default: 0.1, 1 and 3 times the"
        " power of ten of the size of the bodies.",
    ),
    cloup.option("--every", type=POSITIVE, help="Time between samples.  Default: a 500th of the whole time."),
)
@cloup.option_group(
    "The two runs",
    cloup.option(
        "--a",
        "first",
        metavar="KEYWORDS",
        help="First run: keywords of fix gear/quat that change the deck's.  Default: the deck as"
        " it is.",
    ),
    cloup.option(
        "--b",
        "second",
        metavar="KEYWORDS",
        help="Second run, in the same way.  Default: keywords for small errors, which the command prints.",
    ),
    cloup.option("--step-a", type=POSITIVE, help="First time step.  Default: the time step of the deck."),
    cloup.option(
        "--step-b", type=POSITIVE, help="Second time step.  Default: half of the first, or with --b the same."
    ),
)
@cloup.option_group(
    "Output", out_option("gearquat-horizon", "horizon.csv, parting.csv, growth.csv (the Lyapunov time) and horizon.png")
)
@failing_clearly(DeckError, LammpsError)
def horizon(scene, time, thresholds, every, first, second, step_a, step_b, out):
    """Measure the time up to which the trajectory of DECK is accurate.

    The scene is run twice, at two accuracies.  The command reports when the two runs part, and the Lyapunov
    time if their difference grows exponentially.  Two formulations can be compared as well (--a, --b).
    """
    from .. import figures
    from ..trials import horizon as trials
    from ..trials import report
    from ..trials.measure import Deck

    steps = (step_a, step_b)
    asked = {"time": time, "threshold": thresholds, "every": every}
    asked |= {"a": first, "b": second, "step_a": step_a, "step_b": step_b}
    folder = results_folder(out, scene, asked, LEAVES)
    bar = shown_progress(total=1, unit="step", unit_scale=True, desc="following the deck")
    with ending_cleanly(out), bar as progress:
        say = announce(scene["path"], progress)
        with Deck(**scene, say=say, on_wait=progress.refresh) as deck:
            runs = trials.measure(deck, first, second, steps, time, every, thresholds, progress)
    folder.fill(cloup.echo)
    report.write_horizon(out, runs)
    figures.draw_horizon(out / "horizon.png", deck, runs)
    text = report.horizon_text(deck, runs)
    cloup.echo(f"{text}\n\nTables and picture are in {out.resolve()}")
