"""The command ``gearquat scatter``."""

import os

import cloup
from tqdm import tqdm

from gearquat_analysis.options import COUNT, FILE, POSITIVE, command, failing_clearly, out_option

from ..launch import LammpsError
from ..trials.script import DeckError
from .common import ending_cleanly, reading_options, results_folder


@command(
    "gearquat scatter examples/collisions/in.argon --temperature 300 --error 0.1",
    "gearquat scatter examples/collisions/in.dumbbells --energy 2 --count 512 --out one-energy",
)
@cloup.argument("deck", type=FILE, help="LAMMPS input script with two rigid bodies.")
@cloup.option_group(
    "The collisions",
    cloup.option("--temperature", type=POSITIVE, help="Temperature of the gas, in units of the deck."),
    cloup.option("--energy", type=POSITIVE, help="Energy of the relative translation, instead of --temperature."),
    cloup.option(
        "--rotation",
        type=cloup.FloatRange(min=0),
        metavar="T",
        help="Temperature of rotation, 0 for none.  Default: --temperature; 0 with --energy.",
    ),
    cloup.option("--seed", type=cloup.IntRange(min=0), default=1, help="Seed of the random numbers."),
)
@cloup.option_group(
    "How many",
    cloup.option(
        "--error",
        type=POSITIVE,
        default=0.01,
        help="Simulate flights until the relative standard errors of the first two quantities are this small.",
    ),
    cloup.option("--count", type=COUNT, default=1_000_000, help="Largest number of flights, of 512, 1024, 2048 ..."),
    cloup.option(
        "--steps",
        type=COUNT,
        default=200_000,
        help="Largest number of steps of a flight; longer flights are ended and counted as unparted.",
    ),
    cloup.option("--processes", type=COUNT, help="Processes that simulate flights.  Default: one for each core."),
)
@reading_options()
@out_option("gearquat-scatter", "flights.csv, results.json and deflection.png")
@failing_clearly(DeckError, LammpsError)
def scatter(deck, variables, without, which, temperature, energy, rotation, seed, error, count, steps, processes, out):
    """Cross sections and collision integrals of the two rigid bodies of DECK.

    DECK is a LAMMPS input script with any pair style that has a cutoff, and with a fix gear/quat with
    tolerance that moves two bodies in a box that is not periodic.  The command follows it
    up to its run, and simulates thousands of flights instead of that run.  Impact parameters and energies are drawn
    by importance sampling, orientations are uniform, and angular momenta follow the Boltzmann distribution.  Every
    average is printed with its standard error.  After Ctrl-C it is that of the flights so far.
    """
    from ..scatter import run

    if (temperature is None) == (energy is None):
        raise DeckError("either --temperature or --energy is required")
    rotation = rotation if rotation is not None else temperature or 0.0
    scene = {"path": deck, "variables": variables, "without": without, "which": which}
    asked = {"temperature": temperature, "energy": energy, "rotation": rotation, "seed": seed, "steps": steps}
    folder = results_folder(out, scene, asked, run.LEAVES, error=error, count=count)
    cores = processes or len(os.sched_getaffinity(0))
    with ending_cleanly(out), tqdm(total=0, unit=" flights", desc="flights", disable=None) as bar:
        start = (seed, temperature, energy, rotation)
        found = run.scatter(scene, start, error, count, steps, cores, bar)
    cloup.echo(f"{run.conclude(folder, deck.name, *found)}\n\nResults are in {out.resolve()}")
