"""Collisions beside other solvers: forces of the scenes, true counts, and the arithmetic of the ratios."""

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.reference import solvers
from benchmarks.reference.equations import PARTS, State
from benchmarks.studies import collisions as study
from benchmarks.studies.collisions.scene import Scene


# --- the scenes -------------------------------------------------------------------------------------
def near(scene, random):
    """A packed state with the bodies at a distance of 3, at random velocities and unit quaternions."""
    y = random.normal(size=(2, 13))
    y[:, PARTS["q"]] /= np.linalg.norm(y[:, PARTS["q"]], axis=1, keepdims=True)
    y[:, PARTS["center"]] = [[1.5, 0.3, 0.0], [-1.5, 0.0, 0.2]]
    return y


def power(scene, y, rates, d=1e-5):
    """Rate of change of the energy by differences, and of its potential part alone."""
    there, back = (scene.energies(State.of(y + s * d * rates)) for s in (1, -1))
    change = (there - back) / (2 * d)
    return change.sum(), abs(change[0])


@pytest.mark.parametrize("which", [0, 1, 4, 7])
def test_forces_are_those_of_the_energy_and_one_percent_is_refused(which):
    scene, random = Scene(which), np.random.default_rng(which)
    worst, wrong = 0.0, {"velocity": 0.0, "omega_body": 0.0}
    for _ in range(6):
        y = near(scene, random)
        rates = scene.rates(0.0, y)
        change, size = power(scene, y, rates)
        worst = max(worst, abs(change) / size)
        for part in wrong:
            off = rates.copy()
            off[0, PARTS[part]] *= 1.01
            change, _ = power(scene, y, off)
            wrong[part] = max(wrong[part], abs(change) / size)
    assert worst < 1e-6
    assert min(wrong.values()) > 1e-4


def test_forces_are_opposite_and_quaternions_turn_with_the_body():
    scene, random = Scene(3), np.random.default_rng(3)
    y = near(scene, random)
    rates = scene.rates(0.0, y)
    masses = [2 * scene.energies(State.of(moving))[1] for moving in moving_one_by_one(y)]
    momentum = np.array(masses) @ rates[:, PARTS["velocity"]]
    assert abs(momentum).max() < 1e-12 * abs(rates[:, PARTS["velocity"]]).max() * max(masses)
    assert np.sum(y[:, PARTS["q"]] * rates[:, PARTS["q"]], axis=1) == pytest.approx(0, abs=1e-14)
    speed = np.linalg.norm(y[:, PARTS["omega_body"]], axis=1)
    assert 2 * np.linalg.norm(rates[:, PARTS["q"]], axis=1) == pytest.approx(speed, rel=1e-13)


def moving_one_by_one(y):
    """States in which one body alone moves, with a velocity of 1."""
    for k in range(2):
        own = y.copy()
        own[:, PARTS["velocity"]] = own[:, PARTS["omega_body"]] = 0.0
        own[k, PARTS["velocity"]] = [0.6, 0.0, 0.8]
        yield own


# --- counts -----------------------------------------------------------------------------------------
@pytest.mark.parametrize("formulation, energy", study.OURS.values())
def test_every_evaluation_under_a_tolerance_is_counted(formulation, energy):
    scene = Scene(6)
    met = scene.follow(formulation, 1e-6, energy)
    assert met.evaluations == 1 + met.steps + met.repeated
    # the energy after a step is the other call of the forces, which no run needs
    assert scene.calls == met.evaluations + met.steps
    assert met.repeated > 0
    finer = scene.follow(formulation, 1e-8, energy)
    assert finer.error < met.error / 5 and finer.evaluations > met.evaluations


@pytest.fixture
def sundae(monkeypatch):
    """A stand-in for scikit-sundae; returns the options that its solvers were given."""
    given = []

    class Solver:
        def __init__(self, fill, **options):
            self.fill = fill
            given.append(options)

        def solve(self, span, start):
            def rates(t, y):
                found = np.empty_like(y)
                self.fill(t, y, found)
                return found

            own = solve_ivp(rates, span, start, "DOP853", rtol=given[-1]["rtol"], atol=given[-1]["atol"])
            success = given[-1]["rtol"] > 1e-9
            return SimpleNamespace(success=success, message="gave up", y=own.y.T)

    for name in ("sksundae", "sksundae.cvode"):
        module = ModuleType(name)
        module.__spec__, module.CVODE = ModuleSpec(name, None), Solver
        monkeypatch.setitem(sys.modules, name, module)
    return given


def test_every_evaluation_of_the_solvers_is_counted(sundae):
    assert solvers.available() == study.PEERS
    for name in study.PEERS:
        scene = Scene(0)
        _, evaluations = solvers.solve(scene, scene.time, name, 1e-6)
        assert scene.calls == evaluations > 50
        again, error = study.of_peer(scene, name, 1e-6)
        assert again == evaluations and 0 < error < 1e-3
    assert np.isnan(study.of_peer(scene, "CVODE BDF", 1e-10)).all()


# --- ratios -----------------------------------------------------------------------------------------
def curve(work, order=8, errors=10.0 ** np.arange(-3, -13, -2.0)):
    """Points of a method of an ``order`` that needs ``work`` evaluations for an error of 1."""
    return np.stack([work * errors ** (-1 / order), errors], axis=-1)


def test_evaluations_are_interpolated_between_the_best_points():
    exact = 100 * study.LEVELS ** (-1 / 8)
    points = curve(100.0)
    assert study.evaluations(points) == pytest.approx(exact, rel=1e-12)
    worse = [[1e6, 1e-5], [5e3, np.nan], [3e2, 4.0]]
    assert study.evaluations(np.concatenate([worse, points[::-1]])) == pytest.approx(exact, rel=1e-12)
    assert study.evaluations(curve(101.0)) == pytest.approx(1.01 * exact, rel=1e-12)
    short = study.evaluations(points[:3])  # to 1e-7 only
    assert np.isfinite(short[:2]).all() and np.isinf(short[2:]).all()
    assert study.evaluations(points, np.array([1.0])) == pytest.approx(points[0, 0])
    assert np.isinf(study.evaluations(np.full((4, 2), np.nan))).all()


# --- the page ---------------------------------------------------------------------------------------
