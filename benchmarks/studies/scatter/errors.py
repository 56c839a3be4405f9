"""Test of the errors that ``gearquat scatter`` states, with many seeds; each seed runs until its errors reach the request.

Flights of atoms are from atoms.py, and the reference is a quadrature.  Flights of molecules are LAMMPS runs, and the
reference is the mean over all seeds.  Every finished seed is stored, so that an interrupted study can continue.
"""

import json
import shutil
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from benchmarks.reference.central import LennardJones, TwelveFour

from .atoms import Atoms
from .flown import BOLTZMANN, DECKS

#: first seed, and numbers of seeds of atoms and of molecules
FIRST, ATOMS, MOLECULES = 1001, 200, 40
#: requested relative errors
ASKED = (0.1, 0.03, 0.01)
AIMS = ("Omega(1,1)", "Omega(2,2)")
#: a cutoff of 30 Å of argon; an ion with a well of 0.2 kcal/mol and a diameter of 2.8 Å, with cutoffs of 25 and 60 Å
ARGON = Atoms(LennardJones(), 30.0 / 3.405)
IONS = {300.0: Atoms(TwelveFour(), 25.0 / 2.8), 20.0: Atoms(TwelveFour(), 60.0 / 2.8)}
CENTRAL = {f"argon, T* = {reduced:g}": (ARGON, reduced) for reduced in (0.5, 2.0, 10.0)}
CENTRAL |= {f"12-4 ion, {kelvin:g} K": (ion, BOLTZMANN * kelvin / 0.2) for kelvin, ion in IONS.items()}
#: deck, its variables, and the temperature
PAIRS = {
    "dumbbells, T = 2": (DECKS / "in.dumbbells", (("tolerance", "1e-8"),), 2.0),
    "carbon dioxide, 300 K": (Path(__file__).with_name("in.co2"), (), 300.0),
}


class Kept:
    """Rows [seed, flights, value, error, value, error] of one pair and one requested error, in a file."""

    def __init__(self, folder, name, asked):
        self.path = folder / f"{name.replace(' ', '_').replace('*', '').replace(',', '')}_{asked:g}.json"
        self.path.parent.mkdir(parents=True, exist_ok=True)
        self.rows = json.loads(self.path.read_text()) if self.path.is_file() else []

    def missing(self, seeds):
        """The ``seeds`` without a row, in order."""
        done = {row[0] for row in self.rows}
        return [seed for seed in seeds if seed not in done]

    def add(self, seed, number, answer, names):
        """Store the estimates ``names`` of an Answer."""
        cells = [x for name in names for x in (answer.estimates[name].value, answer.estimates[name].error)]
        self.rows.append([seed, number, *cells])
        self.path.write_text(json.dumps(self.rows))


def of_atoms(folder, count, asked, tick):
    """Rows of all CENTRAL pairs: (name, asked) -> array (count, 6), by quadrature."""
    found = {}
    for name, (atoms, temperature) in CENTRAL.items():
        for error in asked:
            kept = Kept(folder, name, error)
            for seed in kept.missing(range(FIRST, FIRST + count)):
                number, answer = until(atoms, temperature, seed, error)
                kept.add(seed, number, answer, [f"{aim}*" for aim in AIMS])
            tick()
            found[name, error] = np.array(sorted(kept.rows))[:count]
    return found


def until(atoms, temperature, seed, error, most=1_000_000):
    """(number of flights, Answer) at which the command would stop."""
    from lammps_gearquat.scatter.conduct import rounds

    plan, farthest = atoms.plan(seed, (temperature,), error)
    for number in rounds(most):
        found = atoms.results(plan, farthest, atoms.flights(plan, number), number)
        if found.relative <= error:
            break
    return number, found.answers[0]


def of_molecules(folder, count, asked, jobs, tick, pairs=PAIRS):
    """Rows of all ``pairs``: (name, asked) -> array (count, 6), from LAMMPS runs."""
    from lammps_gearquat.scatter.pool import Pool

    found = {}
    for error in asked:
        for name, (deck, variables, temperature) in pairs.items():
            kept = Kept(folder, name, error)
            missing = kept.missing(range(FIRST, FIRST + count))
            if missing:
                with Pool({"path": deck, "variables": variables}, jobs, 200_000) as pool:
                    for seed in missing:
                        _simulated(pool, temperature, seed, error, kept.path.with_suffix(""), kept)
            tick()
            found[name, error] = np.array(sorted(kept.rows))[:count]
    return found


def _simulated(pool, temperature, seed, error, out, kept):
    """Results for one seed of a molecule."""
    from lammps_gearquat.scatter import conduct, flights, store
    from lammps_gearquat.scatter.results import results

    if (out / store.SETTINGS).is_file() and store.read_settings(out)["plan"]["seed"] != [seed]:
        shutil.rmtree(out)
    asked = {"seed": seed, "temperature": (temperature,), "energy": None, "rotation": None, "largest": None}
    settings, rows = conduct.simulate(pool, asked, None, error, 1_000_000, out, _Silent())
    facts, plan, farthest = store.facts_of(settings)
    found = results(flights.columns(rows), plan, facts, left=farthest.left)
    kept.add(seed, len(rows), found.answers[0], AIMS)
    shutil.rmtree(out)


def reference(name, rows):
    """Both integrals of a pair: by quadrature, or the mean over all seeds of molecules."""
    if name in CENTRAL:
        atoms, temperature = CENTRAL[name]
        return [atoms.exact(k, k, temperature) for k in (1, 2)]
    return [float(rows[:, column].mean()) for column in (2, 4)]


def squares(value, error, exact, mean):
    """Squares (n,) of deviations divided by the stated errors.

    ``mean``: ``exact`` is the mean of the values, so the squares are smaller by (n - 1) / n than with the true value.
    """
    number = len(value)
    return ((value - exact) / error) ** 2 * (number / (number - 1.0) if mean else 1.0)


def interval(number, part=0.999):
    """Interval of the root mean square of normal random numbers with this probability."""
    tails = 0.5 * (1.0 - part), 0.5 * (1.0 + part)
    return tuple(float(np.sqrt(chi2.ppf(tail, number) / number)) for tail in tails)


class _Silent:
    """A Progress without output."""

    begin = advance = tell = staticmethod(lambda *_: None)
