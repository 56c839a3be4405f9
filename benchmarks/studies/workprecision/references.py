"""The reference of each scene: where its sites are at the end, independent of the fix."""

from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from benchmarks.engine import decks
from benchmarks.reference import FreeField, paper_problem, reference_state
from benchmarks.reference.lammps_forces import deck_problem
from .plan import RIGID_NVE, Run


@dataclass(frozen=True)
class Reference:
    """``problem`` and its ``state`` at the end; ``ids`` (S,) of the sites and their ``sites`` (S, 3).

    ``problem`` is None where the reference is itself a run of LAMMPS.
    """

    problem: object
    state: object
    ids: np.ndarray
    sites: np.ndarray

    def positions(self, outcome):
        """Positions (n, 3) of all atoms of an Outcome; those in no body stay."""
        positions = outcome.before.copy()
        positions[np.searchsorted(outcome.ids, self.ids)] = self.sites
        return positions


def _of_problem(problem, ids, scene, folder):
    state = reference_state(problem, scene.end, folder=folder)
    return Reference(problem, state, ids, problem.site_positions(state).astype(np.float64))


def cage(scene, folder, _session):
    """The paper's cage, written down a second time, in extended precision."""
    problem = paper_problem(1, "consistent")
    return _of_problem(problem, np.arange(1, 5), scene, folder)


def free(scene, folder, _session):
    """The bodies of the deck without forces: exact."""
    with _field_of(scene) as (problem, ids):
        return _of_problem(problem.with_field(FreeField()), ids, scene, folder)


def deck(scene, folder, _session):
    """The bodies of the deck in LAMMPS' own forces, which are double precision."""
    problem = deck_problem(decks.examples_folder() / scene.deck, dict(scene.variables))
    return _of_problem(problem, problem.field.ids, scene, folder)


def finest(scene, _folder, session):
    """fix rigid/nve/small at a step FINER times smaller than its finest one: no more is known."""
    steps = FINER * scene.steps(RIGID_NVE)[-1]
    outcome = session.run(Run(scene, RIGID_NVE, steps))
    return Reference(None, None, outcome.ids, outcome.after)


@contextmanager
def _field_of(scene):
    """Problem of the deck and IDs of its sites; its LAMMPS is closed at the end."""
    problem = deck_problem(decks.examples_folder() / scene.deck, dict(scene.variables))
    try:
        yield problem, problem.field.ids
    finally:
        problem.field.close()


#: how much finer the run is that judges the others where nothing better is known
FINER = 16
REFERENCES = {"cage": cage, "free": free, "deck": deck, "finest": finest}


def reference_of(scene, folder, session):
    """The Reference of a scene; ``folder`` keeps it, ``session`` runs LAMMPS if it has to."""
    return REFERENCES[scene.reference](scene, folder, session)
