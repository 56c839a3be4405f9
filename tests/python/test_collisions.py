"""Collisions beside other solvers: forces of the scenes, true counts, and the arithmetic of the ratios."""

import sys
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.engine.lab import Lab
from benchmarks.engine.page import render
from benchmarks.engine.store import read_data, write_data
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
    """Rate of change of the energy, by differences, and what its potential part alone changes by."""
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


def test_only_adams_gets_a_jacobian_of_zeros(sundae):
    scene = Scene(0)
    for name in solvers.CVODE:
        solvers.solve(scene, scene.time, name, 1e-6)
    adams, bdf = sundae
    jacobian = np.ones((26, 26))
    adams["jacfn"](0.0, None, None, jacobian)
    assert not jacobian.any() and "jacfn" not in bdf
    assert (adams["method"], bdf["method"]) == ("Adams", "BDF")


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


def synthetic(ours=60.0):
    """Results of three scenes: the solvers need 100 or more, and LSODA 80 in the last scene."""
    points = {name: np.array([curve(ours)] * 3) for name in study.OURS}
    for work, name in zip((100.0, 120.0, 150.0), study.PEERS):
        points[name] = np.array([curve(work)] * 3)
    points["LSODA"][2] = curve(80.0)
    return study.Results(points)


def test_a_ratio_is_to_the_best_solver_of_the_scene():
    results = synthetic()
    name = next(iter(study.OURS))
    found = study.ratios(study.counted(results), name)
    assert found == pytest.approx(np.repeat([[0.6], [0.6], [0.75]], len(study.LEVELS), axis=1), rel=1e-12)
    held = {m.what: m for m in study.find(results).measurements}
    assert held[f"{name}: median ratio to the best solver"].value == pytest.approx(0.6)
    assert held[f"{name}: median ratio to the best solver"].holds
    refused = study.find(synthetic(71.0)).measurements[0]
    assert refused.value == pytest.approx(0.71) and not refused.holds


def test_what_is_lost_counts_against_it():
    results = synthetic()
    name = next(iter(study.OURS))
    results.points[name][0, :, 1] = np.nan
    results.points[name][1, 0, 1] = 1.5
    results.points["LSODA"][1:] = results.points["DOP853"][1:] = results.points["CVODE Adams"][1:] = np.nan
    found = study.ratios(study.counted(results), name)
    assert np.isinf(found[0]).all() and not found[1:].any()
    lost = study.find(results).measurements[1]
    assert lost.what == f"{name}: lost" and lost.value == 6 and not lost.holds


# --- the page ---------------------------------------------------------------------------------------
def test_a_page_without_cvode_says_so(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sksundae", None)
    for name, value in {"QUICK": 2, "EPS": (1e-3, 1e-7, 1e-11), "TOLERANCES": (1e-5, 1e-9)}.items():
        monkeypatch.setattr(study, name, value)
    monkeypatch.setattr(study, "Scene", lambda which: Scene((0, 7)[which]))
    results = study.measure(Lab(tmp_path, quick=True))
    write_data(tmp_path / "data.json", results)
    finding = study.find(read_data(tmp_path / "data.json"))
    assert finding.context["missing"] == list(solvers.CVODE)
    text = render("collisions.md.j2", study.STUDY, finding, "Somewhere.")
    assert "CVODE Adams and CVODE BDF are missing" in text
    assert not any(m.value for m in finding.measurements if m.what.endswith("lost"))
    finding.pictures["collisions"](tmp_path / "collisions.png")
    assert (tmp_path / "collisions.png").stat().st_size > 10_000
