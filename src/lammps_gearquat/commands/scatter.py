"""The command ``gearquat scatter``."""

import os
from pathlib import Path

import cloup

from gearquat_analysis.options import COUNT, FILE, POSITIVE, command, failing_clearly, out_option, progress_bar

from ..trials.script import DeckError
from ..trials.worker import TrialError
from .common import reading_options

FROM_ZERO = cloup.IntRange(min=0)
#: what flights need, and parts that are merged have
OF_FLIGHTS = ("deck", "temperature", "energy", "first", "count")


@command(
    "gearquat scatter examples/collisions/in.argon --temperature 300 --error 0.1",
    "gearquat scatter examples/collisions/in.argon --temperature 300 --largest 8 --count 200 --out part1",
    "gearquat scatter examples/collisions/in.argon --temperature 300 --largest 8 --first 200 --count 200 --out part2",
    "gearquat scatter --merge part1 --merge part2 --out whole",
)
@cloup.argument("deck", type=FILE, required=False, help="LAMMPS input script with two rigid bodies.")
@cloup.option_group(
    "The collisions",
    cloup.option("--temperature", type=POSITIVE, help="Temperature of the gas, in units of the deck."),
    cloup.option("--energy", type=POSITIVE, help="Instead of it, one energy of the relative translation."),
    cloup.option(
        "--rotation",
        type=cloup.FloatRange(min=0),
        metavar="T",
        help="Temperature of rotation, 0 for none.  Default: --temperature; 0 with --energy.",
    ),
    cloup.option(
        "--largest",
        type=POSITIVE,
        help="Largest impact parameter.  Default: found by pilot flights, from --error.",
    ),
    cloup.option("--seed", type=FROM_ZERO, default=1, help="Flights are a function of it and of their number."),
)
@cloup.option_group(
    "How many",
    cloup.option(
        "--error",
        type=POSITIVE,
        default=0.01,
        help="Fly until the relative standard errors of the first two quantities are this small.",
    ),
    cloup.option("--most", type=COUNT, default=1_000_000, help="Flights after which --error is given up."),
    cloup.option("--first", type=FROM_ZERO, help="Number of the first flight, with --count.  Default: 0."),
    cloup.option("--count", type=COUNT, help="So many flights, whatever their error."),
    cloup.option(
        "--steps", type=COUNT, default=200_000, help="Steps after which a flight is given up, as unparted."
    ),
    cloup.option("--processes", type=COUNT, help="Processes that fly.  Default: one for each core."),
)
@reading_options()
@cloup.option_group(
    "What it leaves",
    cloup.option("--sigma", type=POSITIVE, help="Also divide by the integrals of rigid spheres of this diameter."),
    cloup.option(
        "--merge",
        "parts",
        type=cloup.Path(exists=True, file_okay=False, path_type=Path),
        multiple=True,
        metavar="FOLDER",
        help="Instead of flying, join the flights of this folder with those of others; repeatable.",
    ),
    out_option("gearquat-scatter", "flights.csv, results.json, deflection.png and convergence.png"),
)
@failing_clearly(DeckError, TrialError)
def scatter(deck, variables, without, which, first, count, error, most, steps, parts, out, sigma, **asked):
    """Cross sections and collision integrals of the two rigid bodies of DECK.

    DECK is a LAMMPS input script with any pair style that has a cutoff, and with a fix gear/quat with
    tolerance that moves two bodies in a box that is not periodic.  The command follows it
    up to its run, and makes thousands of flights instead of that run.  Impact parameters, velocities, orientations and angular momenta
    are drawn evenly, and every average comes with its standard error.  A run that was ended goes on where it
    was if it is started again.
    """
    from ..scatter import conduct

    if parts:
        _refuse({"deck": deck, "first": first, "count": count, **asked})
        text = conduct.merge(parts, out, sigma)
    else:
        asked = _settled(deck, first, count, sigma, asked)
        scene = {"path": deck, "variables": variables, "without": without, "which": which}
        numbers = count and range(first or 0, (first or 0) + count)
        with progress_bar(total=0, unit=" flights", desc="reading the deck") as progress:
            task = {**asked, "most_steps": steps, "sigma": sigma}
            text = conduct.scatter(scene, task, numbers, error, most, out, progress)
    cloup.echo(f"{text}\n\nTables and pictures are in {out.resolve()}")


def _refuse(given):
    """Options that are about flights do not go with --merge."""
    for name in OF_FLIGHTS:
        if given[name] is not None:
            raise DeckError(f"--merge joins flights that were flown: {name} has to be left out")


def _settled(deck, first, count, sigma, asked):
    """``asked`` with its defaults.  Raises DeckError for what does not go together."""
    if deck is None:
        raise DeckError("DECK is required, or --merge with the folders to join")
    if asked["temperature"] is None and asked["energy"] is None:
        raise DeckError("either --temperature or --energy is required")
    if asked["temperature"] is not None and asked["energy"] is not None:
        raise DeckError("not both --temperature and --energy: translation has either of them")
    if sigma is not None and asked["energy"] is not None:
        raise DeckError("--sigma is for collision integrals at a temperature: it has to be left out with --energy")
    if first is not None and count is None:
        raise DeckError("--first needs --count, the number of flights")
    if asked["rotation"] is None:
        asked["rotation"] = asked["temperature"] or 0.0
    asked["processes"] = asked["processes"] or len(os.sched_getaffinity(0))
    return asked
