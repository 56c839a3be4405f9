"""The command ``gearquat scatter``."""

import os
import sys
from pathlib import Path

import cloup

from gearquat_analysis.options import COUNT, FILE, POSITIVE, command, failing_clearly, out_option

from ..launch import LammpsError
from ..trials.script import DeckError
from .common import INTERRUPTED, reading_options, shown_progress

FROM_ZERO = cloup.IntRange(min=0)
#: options for new flights; for merged parts they are already determined
OF_FLIGHTS = ("deck", "temperature", "energy", "first", "count", "replay")
#: options that determine the flights of a folder; --replay uses one of these flights
OF_FOLDERS = ("temperature", "energy", "rotation", "largest", "sigma", "first", "count")
#: the largest ratio of two neighboring temperatures, if there are several
GAP = 3.0


@command(
    "gearquat scatter examples/collisions/in.argon --temperature 300 --error 0.1",
    "gearquat scatter examples/collisions/in.argon --temperature 150 --temperature 300 --error 0.1 --out two",
    "gearquat scatter examples/collisions/in.argon --replay 7 --out two",
    "gearquat scatter examples/collisions/in.argon --temperature 300 --largest 8 --count 200 --out part1",
    "gearquat scatter examples/collisions/in.argon --temperature 300 --largest 8 --first 200 --count 200 --out part2",
    "gearquat scatter --merge part1 --merge part2 --out whole",
)
@cloup.argument("deck", type=FILE, required=False, help="LAMMPS input script with two rigid bodies.")
@cloup.option_group(
    "The collisions",
    cloup.option(
        "--temperature",
        type=POSITIVE,
        multiple=True,
        help="Temperature of the gas, in units of the deck; repeatable: several from the same flights.",
    ),
    cloup.option("--energy", type=POSITIVE, help="Energy of the relative translation, instead of --temperature."),
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
    cloup.option(
        "--seed",
        type=FROM_ZERO,
        default=1,
        help="Seed of the random numbers; a flight depends on it and on the number of the flight.",
    ),
)
@cloup.option_group(
    "How many",
    cloup.option(
        "--error",
        type=POSITIVE,
        default=0.01,
        help="Simulate flights until the relative standard errors of the first two quantities are this small.",
    ),
    cloup.option(
        "--most",
        type=COUNT,
        default=1_000_000,
        help="Largest number of flights that are simulated to reach --error.",
    ),
    cloup.option("--first", type=FROM_ZERO, help="Number of the first flight, with --count.  Default: 0."),
    cloup.option("--count", type=COUNT, help="Number of flights, which replaces --error."),
    cloup.option(
        "--steps",
        type=COUNT,
        default=200_000,
        help="Largest number of steps of a flight; longer flights are ended and counted as unparted.",
    ),
    cloup.option(
        "--processes", type=COUNT, help="Processes that simulate flights.  Default: one for each core."
    ),
)
@reading_options()
@cloup.option_group(
    "Output",
    cloup.option("--sigma", type=POSITIVE, help="Also divide by the integrals of rigid spheres of this diameter."),
    cloup.option(
        "--merge",
        "parts",
        type=cloup.Path(exists=True, file_okay=False, path_type=Path),
        multiple=True,
        metavar="FOLDER",
        help="Instead of simulating, join the flights of this folder with others; repeatable.",
    ),
    cloup.option(
        "--replay",
        type=FROM_ZERO,
        metavar="N",
        help="Instead of new flights, write flight N of the folder --out as a LAMMPS dump into it.",
    ),
    out_option("gearquat-scatter", "flights.csv, results.json, deflection.png and convergence.png"),
)
@failing_clearly(DeckError, LammpsError)
def scatter(deck, variables, without, which, parts, out, **asked):
    """Cross sections and collision integrals of the two rigid bodies of DECK.

    DECK is a LAMMPS input script with any pair style that has a cutoff, and with a fix gear/quat with
    tolerance that moves two bodies in a box that is not periodic.  The command follows it
    up to its run, and simulates thousands of flights instead of that run.  Impact parameters and energies are drawn
    by importance sampling, orientations are uniform, and angular momenta follow the Boltzmann distribution.  Every
    average is printed with its standard error.
    A run that was ended continues if it is started again.
    """
    from ..scatter import conduct
    from ..scatter.replay import replay

    scene = {"path": deck, "variables": variables, "without": without, "which": which}
    if deck is None and not parts:
        raise DeckError("DECK is required, or --merge with the folders to join")
    if parts:
        _refuse(asked | {"deck": deck}, OF_FLIGHTS, "--merge joins flights that exist")
        text = conduct.merge(parts, out, asked["sigma"])
    elif asked["replay"] is not None:
        _refuse(asked, OF_FOLDERS, "--replay takes all settings from the folder --out")
        cloup.echo(replay(scene, out, asked["replay"]))
        return
    else:
        text = _flights(scene, _settled(asked), out, conduct)
    cloup.echo(f"{text}\n\nTables and pictures are in {out.resolve()}")


def _flights(scene, asked, out, conduct):
    """Simulate flights of the ``scene``; results as text."""
    from ..scatter.store import read_lines

    count, first = asked["count"], asked["first"] or 0
    numbers = count and range(first, first + count)
    task = asked | {"most_steps": asked["steps"]}
    try:
        with shown_progress(total=0, unit=" flights", desc="reading the deck") as bar:
            return conduct.scatter(scene, task, numbers, asked["error"], asked["most"], out, _Progress(bar))
    except KeyboardInterrupt as interrupt:
        number = len(read_lines(out))
        kept = "no flight has ended" if not number else f"{number} flights are kept in {out.resolve()}"
        cloup.echo(f"\nInterrupted: {kept}; the same command continues after them", err=True)
        raise SystemExit(INTERRUPTED) from interrupt


class _Progress:
    """A progress ``bar`` over flights of several kinds."""

    def __init__(self, bar):
        self._bar, self.advance = bar, bar.update

    def begin(self, what, count, done=0):
        """Begin to simulate ``count`` of ``what``, flights of some kind; ``done`` of them are known."""
        self._bar.set_description(what)
        self._bar.reset(count + done)
        self._bar.update(done)

    def tell(self, text):
        """Write a line above the bar."""
        self._bar.write(text, file=sys.stderr)


def _refuse(given, names, why):
    """Rejects options that have no meaning because of ``why``."""
    for name in names:
        if given[name] not in (None, ()):
            raise DeckError(f"{why}: {name} has to be left out")


def _settled(asked):
    """``asked`` with its defaults.  Raises DeckError for options that cannot be combined."""
    asked = asked | {"temperature": tuple(sorted(set(asked["temperature"])))}
    temperatures, energy, rotation = asked["temperature"], asked["energy"], asked["rotation"]
    if not temperatures and energy is None:
        raise DeckError("either --temperature or --energy is required")
    if temperatures and energy is not None:
        raise DeckError("not both --temperature and --energy: only one of them determines the translation")
    if asked["sigma"] is not None and energy is not None:
        raise DeckError("--sigma is for collision integrals at a temperature: it has to be left out with --energy")
    if asked["first"] is not None and asked["count"] is None:
        raise DeckError("--first needs --count, the number of flights")
    for low, high in zip(temperatures, temperatures[1:]):
        if high > GAP * low * (1.0 + 1e-12):
            raise DeckError(
                f"--temperature {low:g} and {high:g}: flights at one of them contribute little to averages at the other, because"
                f" they are more than a factor of {GAP:g} apart; a temperature between them is required, or a run for each"
            )
    if energy is not None:
        asked |= {"temperature": None, "rotation": rotation or 0.0}
    elif temperatures == (rotation,):
        asked["rotation"] = None  # the temperature of translation
    asked["processes"] = asked["processes"] or len(os.sched_getaffinity(0))
    return asked
