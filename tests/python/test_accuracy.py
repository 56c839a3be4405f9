"""The study accuracy: orders, prices and errors of made-up numbers; real runs of one scene."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.engine import LammpsError, session
from benchmarks.engine.methods import DEFAULTS, gear
from benchmarks.engine.sites import pose_errors
from benchmarks.studies.accuracy import evaluate, plan, runs
from benchmarks.studies.accuracy.evaluate import Cost, cost_of, fitted_order
from benchmarks.studies.cases.accuracy import reference

STEPS = 0.5 / 2.0 ** np.arange(0, 8, 0.5)


# --- fitted orders --------------------------------------------------------------------------------
def test_rounding_and_coarse_steps_do_not_count():
    noise = 1e-9 * np.resize([2.0, 1.0, 3.0], len(STEPS))
    errors = np.maximum(STEPS**5, noise)
    errors[:3] = (1e-4, np.inf, 1.0)
    fit = fitted_order(STEPS, errors, limit=STEPS[2])
    assert fit.order == pytest.approx(5.0, rel=1e-9)
    assert errors[fit.used].min() > evaluate.ABOVE_FLOOR * noise.max()
    assert STEPS[fit.used].max() < STEPS[2] / 1.25
    assert np.polyfit(np.log(STEPS[3:]), np.log(errors[3:]), 1)[0] < 4.9  # the rule matters


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
SCENE = plan.scenes(True)["case1"]


@pytest.fixture
def lammps(tmp_path):
    with session.Session(tmp_path / "logs") as running:
        yield running


def test_errors_of_a_run_and_its_repetition(lammps, tmp_path):
    run = plan.Run(SCENE, gear("second", 6), 10240)
    outcome, errors = runs.judged(lammps, run, runs.reference_of(SCENE, tmp_path, lammps))
    body, masses = outcome.molecules == 1, outcome.masses
    center = masses[body] @ outcome.after[body] / masses[body].sum()
    known = np.linalg.norm(center - reference())
    assert errors.position == pytest.approx(known, abs=2e-13) and known < 1e-10
    assert errors.orientation < 1e-10 and errors.energy < 1e-8
    assert errors.norm < 1e-14 and errors.tangency < 1e-14
    assert outcome.start > 0 and len(outcome.thermo["Time"]) == SCENE.samples + 1
    assert 0 < runs.timed(lammps, run, outcome) < 10
    outcome.after[0, 0] *= 1 + 1e-15
    with pytest.raises(LammpsError, match="does not repeat"):
        runs.timed(lammps, run, outcome)
    timed = run.perform(lammps, timers=True)
    assert 0 < timed.modify < timed.seconds


def test_defaults_are_those_of_the_fix(lammps):
    """Stating the keywords that plan.py assumes as defaults does not change the last bit."""
    for formulation, method in DEFAULTS.items():
        given = {} if formulation == "momentum" else {"formulation": formulation}
        bare = plan.Run(SCENE, method, 320).variables(False)
        bare = {k: v for k, v in bare.items() if k not in method.variables} | given
        told = plan.Run(SCENE, method, 320).perform(lammps)
        untold = lammps.run(SCENE.deck, bare, "bare")
        assert np.array_equal(told.after, untold.after), f"{method.label}: not the defaults"
