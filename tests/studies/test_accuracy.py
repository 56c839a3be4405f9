"""Costs of errors, errors of poses, and a run of the study of accuracy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.engine import LammpsError
from benchmarks.engine.costs import Cost, cost_of
from benchmarks.engine.methods import AUTOMATIC
from benchmarks.engine.session import Session
from benchmarks.engine.sites import pose_errors
from benchmarks.studies import accuracy


# --- prices ---------------------------------------------------------------------------------------
POWERS = 100.0 * 2.0 ** np.arange(4)
LUCKY = [1, 2, 4, 8, 16], [1e-7, 1e-3, 1e-5, 1e-8, 1e-9]
LOST = [1, 2, 4], [np.inf, 1e-3, 1e-5]


@pytest.mark.parametrize(
    "costs, errors, target, price",
    [
        (POWERS, 1e6 * POWERS**-5.0, 1e6 * 300.0**-5.0, Cost(pytest.approx(300.0, rel=1e-12))),
        # the cost beyond which the error stays below, after a first run that is accurate by chance
        (*LUCKY, 1e-6, Cost(pytest.approx(4 * 2 ** (1 / 3), rel=1e-12))),
        (*LUCKY, 1e-2, Cost(1.0, "at most")),
        # failed runs, one of them without a known cost
        ([np.nan, 2, 4], LOST[1], 1e-2, Cost(2.0)),
        (*LOST, 1e-2, Cost(2.0)),
        ([1, 2], [1e-3, np.inf], 1e-2, None),
        ([], [], 1e-2, None),
        ([1, 2, 4], [1e-3, 1e-4, 1e-5], 1e-6, None),
    ],
)
def test_price_of_an_error(costs, errors, target, price):
    assert cost_of(costs, errors, target) == price


# --- errors of a run ------------------------------------------------------------------------------
def test_pose_errors_are_rms_over_bodies():
    masses, molecules = np.array([1.0, 2, 3, 1, 2, 3, 9]), np.array([1, 1, 1, 2, 2, 2, 0])
    before = np.random.default_rng(1).normal(size=(7, 3)) * 5

    def moved(turns, shifts):
        """The sites before with each body turned about its center of mass and shifted."""
        after = before.copy()
        for body, turn, shift in zip((1, 2), turns, shifts):
            own = molecules == body
            center = masses[own] @ before[own] / masses[own].sum()
            after[own] = Rotation.from_rotvec(turn).apply(before[own] - center) + center + shift
        return after

    reference = moved([[0.0, 0.0, 0.5], [2.0, 0.1, 0.0]], [[1, 2, 3], [0, 0, 1]])
    off = moved([[0.0, 0.0, 0.5 + 2e-7], [2.0, 0.1, 0.0]], [[1, 2, 3 + 3e-9], [0, 4e-9, 1]])
    found = pose_errors(masses, molecules, before, off, reference)
    assert found == pytest.approx((math.sqrt(12.5) * 1e-9, math.sqrt(2) * 1e-7), rel=1e-5)
    off[0, 0] = math.nan
    lost = pose_errors(masses, molecules, before, off, reference)
    assert lost == (math.inf, math.inf)


# --- real LAMMPS ----------------------------------------------------------------------------------
def test_errors_of_a_run_and_its_repetition(tmp_path):
    scene = accuracy.SCENES[0]
    reference = accuracy.Reference.of(accuracy.problem_of(scene), scene.end)
    with Session(tmp_path / "logs") as session:
        outcome, point = accuracy._errors(session, scene, reference, AUTOMATIC, 5120)
        body, masses = outcome.molecules == 1, outcome.masses
        center = masses[body] @ outcome.after[body] / masses[body].sum()
        known = np.linalg.norm(center - reference.state.double.center)
        assert point.error == pytest.approx(known, abs=2e-13) and known < 1e-10
        assert outcome.start > 0 and point.evaluations == 1 + outcome.start + 5120
        assert 0 < accuracy._timed(session, scene, AUTOMATIC, 5120, outcome) < 10
        outcome.after[0, 0] *= 1 + 1e-15
        with pytest.raises(LammpsError, match="does not repeat"):
            accuracy._timed(session, scene, AUTOMATIC, 5120, outcome)
