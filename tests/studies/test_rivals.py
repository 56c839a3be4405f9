"""Scenes with other methods: their forces and starts are those of LAMMPS, and the best method of each is found."""

import numpy as np
import pytest

from benchmarks.engine.lab import Lab
from benchmarks.engine.session import Session
from benchmarks.reference.lammps_forces import LammpsForces
from benchmarks.studies.rivals import peers, scenes, strongest


def test_forces_of_the_encounter_are_those_of_its_deck(tmp_path):
    scene, problem = next(both for both in scenes.scenes(tmp_path, quick=True) if both[0].key == "encounter")
    places = problem.site_positions(problem.start).astype(float)
    with LammpsForces(scene.deck) as field:
        field.choose(np.arange(1, 5))
        (energy, forces), (right, exact) = (one.energy_and_forces(places) for one in (field, problem.field))
    assert float(right) == pytest.approx(energy, rel=1e-13) and np.abs(exact - forces).max() < 1e-12
    assert places[2] == pytest.approx([scenes.PASSES, -1, 0], abs=1e-14)


def test_best_methods_of_scenes(tmp_path):
    """A splitting is the best in a weak field; the fix under a tolerance reaches the error in an encounter."""
    with Session(tmp_path / "logs") as session:
        results = scenes.measure(Lab(tmp_path, quick=True), session)
    case1, weak, encounter, start = strongest.compared(results).values()
    assert all(own[scenes.TOLERANCE].value < cost.value for own, (_, cost) in case1[:2])
    for own, (name, cost) in weak[:3]:
        assert name == "SABA4, 4 stages" and cost.value < own[scenes.FIXED].value
    assert weak[2][0][scenes.FIXED].value < 900  # the fix reaches 1e-8 of the same motion
    own, (name, cost) = encounter[0]
    assert name == "DDEABM" and own[scenes.FIXED] is None and own[scenes.TOLERANCE].value < cost.value
    assert all(own[scenes.FIXED] for own, _ in start)
    texts, (number, _) = strongest.losses(results)
    assert [title for title, *_ in texts] == [list(results)[1]] and number == 4
    tables = strongest.of_scenes(results)
    assert len(tables["rivals"].rows) == 6 and len(tables["starts"].rows) == 2


def test_a_curve_ends_at_a_small_error_and_keeps_lost_runs():
    def run(setting):
        if setting == 2:
            raise RuntimeError("lost")
        return 10 * setting, (10.0**-setting, 0.0, np.nan if setting == 1 else 0.0)

    rows = peers.curve([1, 2, 3, 12, 13], run)
    assert [row[0] for row in rows] == [1, 2, 3, 12]
    assert rows[0][4] == np.inf and rows[1][2:] == (np.inf,) * 3 and np.isnan(rows[1][1])
