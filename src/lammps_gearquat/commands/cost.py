"""The command ``gearquat cost``."""

import json
from functools import partial
from time import monotonic

import cloup
from tqdm import tqdm

from gearquat_analysis.options import COUNT, POSITIVE, command, failing_clearly, out_option
from gearquat_analysis.tables import write_rows

from ..launch import LammpsError
from ..trials import BOUND, NORMS
from ..trials.script import DeckError, pairs
from .common import announce, deck_options, ending_cleanly, results_folder

LEAVES = ("cost.csv", "trials.csv", "cost.png", "until.csv")


@command(
    "gearquat cost examples/water/in.water --var forces plain --budget 30",
    "gearquat cost examples/case1/in.case1 --error 1e-3 --error 1e-6 --time 20 --out case1",
    "gearquat cost examples/case1/in.case1 --until 1e-3 --time 100 --out until",
)
@deck_options
@cloup.option_group(
    "Measurement",
    cloup.option(
        "--error",
        "errors",
        type=POSITIVE,
        multiple=True,
        help="Target error, in the deck's unit of length (orientations: radians);"
        " repeatable.  Default: powers of ten of the size of the bodies.",
    ),
    cloup.option(
        "--of",
        "norm",
        type=cloup.Choice(NORMS),
        default=NORMS[0],
        help="Quantity whose error is measured, over all bodies.",
    ),
    cloup.option(
        "--time",
        type=POSITIVE,
        help="Time of the trials.  Default: the time of the deck's run, or as long as budget and chaos allow.",
    ),
    cloup.option(
        "--drift",
        "bound",
        type=POSITIVE,
        default=BOUND,
        show_default=True,
        help="Where trajectories diverge: drift of the energy, in kT per degree of freedom and ns (units lj: 1000 time"
        " units), above which no step is recommended.",
    ),
    cloup.option(
        "--try",
        "tries",
        multiple=True,
        metavar="KEYWORDS",
        help='Further keywords of the fix to try, such as "values 8 corrector gear".',
    ),
    cloup.option(
        "--until",
        "distances",
        type=POSITIVE,
        multiple=True,
        metavar="LENGTH",
        help="Instead of costs, find the time until which all bodies stay within this distance of an accurate run;"
        " repeatable.",
    ),
)
@cloup.option_group(
    "Budget and output",
    cloup.option(
        "--budget",
        type=POSITIVE,
        default=300.0,
        help="Seconds of wall time for everything, runs before the measured one included.",
    ),
    cloup.option("--timings", type=COUNT, default=5, help="Timings of each trial that matters, interleaved."),
    out_option("gearquat-cost", "cost.csv, trials.csv and cost.png, or until.csv"),
    cloup.option("--json", "as_json", is_flag=True, help="Print the first table as JSON instead of text."),
)
@failing_clearly(DeckError, LammpsError)
def cost(scene, errors, time, norm, bound, budget, timings, tries, distances, out, as_json):
    """Measure the cost of accuracy in the simulation of DECK, and print the lines to put into it.

    DECK is any LAMMPS input script with fix gear/quat, rigid, rigid/nve, rigid/small or
    rigid/nve/small.  It is followed up to its run; runs before that one are executed once, and all
    trials start from their end.  Short trials over time steps and orders are compared with a finer
    one and with the deck's own fix, which is recommended where no other is faster.  Errors are judged only as
    far as the finest trial is confirmed by a second one of another formulation.  For few bodies, notes compare the
    evaluations of the forces with those of keyword tolerance, whose steps follow the error.

    Trajectories of a liquid diverge before the end of the run.  Then, unless --error or --time is given, long runs
    are compared instead: by energy drift, of at most --drift, and by the temperatures of translation and rotation.

    With --until, the deck as it is runs beside the fix with small errors at half of its step, and the command reports
    when the two runs part.
    """
    begin = monotonic()
    from .. import figures
    from ..trials import cost as trials
    from ..trials import report, sampling, until
    from ..trials.measure import Deck

    for text in tries:
        pairs(text)
    asked = {"error": errors, "of": norm, "time": time, "drift": bound, "try": tries, "until": distances}
    folder = results_folder(out, scene, asked, LEAVES, budget=budget, timings=timings)
    bar = tqdm(total=round(budget), bar_format="{l_bar}{bar}| {elapsed}", disable=None)
    with ending_cleanly(out), bar as progress:
        clock = trials.Budget(budget, progress, begin)
        clock.say("following the deck")
        say = announce(scene["path"], progress)
        with Deck(**scene, say=say, on_wait=clock.spent, timeout=trials.SHARE_BEFORE * budget) as deck:
            if distances:
                answer = until.measure(deck, clock, distances, time)
            else:
                answer = trials.measure(deck, clock, errors, time, timings, NORMS.index(norm), tries, bound)
    folder.fill(partial(cloup.echo, err=True))
    if isinstance(answer, until.Parting):
        tables, text = report.parting_tables(answer), report.parting_text(deck, answer)
    elif isinstance(answer, sampling.Sampling):
        figures.draw_drifts(out / "cost.png", deck, answer)
        tables, text = report.drift_tables(answer), report.drift_text(deck, answer)
    else:
        figures.draw_cost(out / "cost.png", deck, answer)
        tables, text = report.cost_tables(answer), report.cost_text(deck, answer)
    for name, table in tables.items():
        write_rows(out / f"{name}.csv", *table)
    if as_json:
        header, rows = next(iter(tables.values()))
        cloup.echo(json.dumps([dict(zip(header, row)) for row in rows]))
    else:
        cloup.echo(f"{text}\n\nResults are in {out.resolve()}")
