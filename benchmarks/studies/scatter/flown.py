"""Runs of the command ``gearquat scatter``, and comparison of flights with encounters.py."""

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.engine import provenance
from benchmarks.engine.decks import EXAMPLES
from benchmarks.engine.runner import LammpsError
from benchmarks.reference.encounters import Charges, Dispersion, Encounter

DECKS = EXAMPLES / "collisions"
#: LAMMPS' constants in units real: Boltzmann's, and Coulomb's
BOLTZMANN, COULOMB = 0.0019872067, 332.06371


@dataclass(frozen=True)
class Run:
    """Results of the command: ``quantities``: name -> (value, standard error); ``unit``: name -> its unit;
    ``counts``: numbers of flights by outcome; ``errors``: name -> largest error of all flights."""

    quantities: dict
    unit: dict
    counts: dict
    errors: dict


def kept(lab):
    """Folder of the flights that a later run of this study uses again: there is one for each commit."""
    commit = provenance.commit("src", "examples/collisions", "benchmarks/studies/scatter").replace(" ", "_")
    return lab.out / ("quick" if lab.quick else f"commit_{commit}")


def command(lab, name, deck, *options):
    """Run of ``gearquat scatter`` on a deck of the examples; its output is in ``name`` in the folder ``kept``.

    Raises LammpsError.
    """
    out = kept(lab) / name
    arguments = [str(Path(sys.executable).with_name("gearquat")), "scatter", str(DECKS / deck)]
    arguments += [*map(str, options), "--processes", str(lab.jobs), "--out", str(out)]
    done = subprocess.run(arguments, capture_output=True, text=True, cwd=lab.out)
    if done.returncode != 0:
        raise LammpsError(f"gearquat scatter {deck}: {done.stderr.strip()[-500:]}")
    found = json.loads((out / "results.json").read_text(encoding="utf-8"))
    every = found["quantities"]
    return Run(
        {key: (entry["value"], entry["error"]) for key, entry in every.items()},
        {key: entry["unit"] for key, entry in every.items()},
        found["flights"],
        {key: entry["largest"] for key, entry in found["errors"].items()},
    )


def encounter_of(deck, pair):
    """Encounter with the potential of in.dumbbells or in.nitrogen, for its Pair."""
    bodies = pair.bodies
    sites = [bodies.shape[bodies.of == k] for k in (0, 1)]
    masses = [bodies.masses[bodies.of == k] for k in (0, 1)]
    if deck == "in.dumbbells":
        forces = [Dispersion(np.ones((2, 2)), np.ones((2, 2)), 4.0, 10.0)]
    else:
        charge = np.array([-0.482, -0.482, 0.964])
        well = 36.0 * BOLTZMANN * np.outer(charge < 0, charge < 0)
        forces = [
            Dispersion(well, np.full((3, 3), 3.31), 12.0, 30.0),
            Charges(COULOMB * np.outer(charge, charge), 0.08, 60.0),
        ]
    return Encounter(sites, masses, forces, pair.units.energy)


def packed(state):
    """Start or End from the command as a state (26,) of encounters.py."""
    return np.concatenate([state.center, state.velocity, state.quaternion, state.momentum], axis=1).ravel()


def beside_reference(deck, temperature, largest, count, tick):
    """Array (count, 4) with the comparison of flights with DOP853.

    The first two columns are the deviations of velocities, relative to the initial relative speed, and of angular
    momenta, relative to the largest final one.  The others are the number of sign changes of the radial velocity, and
    the relative deviation of the relative velocity after the reversed flight.
    """
    from lammps_gearquat.scatter.pair import open_pair
    from lammps_gearquat.scatter.sampling import Plan

    rows = []
    with open_pair(DECKS / deck) as pair:
        encounter = encounter_of(deck, pair)
        plan = Plan((2,), (temperature,), None, None, largest)
        for _, _, start in plan.starts(pair, range(count)):
            end = pair.fly(start)
            back = pair.fly(end.reversed())
            states = packed(end), encounter.fly(packed(start), end.time)[-1]
            one, two = (state.reshape(2, 13) for state in states)
            speed = np.ptp(start.velocity[:, 2])
            velocity = np.abs(one[:, 3:6] - two[:, 3:6]).max() / speed
            momentum = np.abs(one[:, 10:] - two[:, 10:]).max() / np.abs(two[:, 10:]).max()
            returned = np.abs(back.velocity + start.velocity).max() / speed
            rows.append((velocity, momentum, end.turnings, returned))
            tick()
    return np.array(rows)
