"""The scenes of the paper and the examples: energies as printed in the paper, and decks that run."""

import re

import numpy as np
import pytest
from support.pages import unpack
from support.scene_files import read_atoms

from support.running import EXAMPLES, SCENES

MOTIONS = ("momentum", "second", "first", "rigid")
METHODS = ("gear", "rigid")
ENERGY = {1: -0.72360304, 2: -0.72360304, 3: 3.99270832}


@pytest.mark.parametrize("body", ["consistent", "unrotated"])
@pytest.mark.parametrize("formulation", MOTIONS)
@pytest.mark.parametrize("case", ENERGY)
def test_initial_energy(run_case, case, formulation, body):
    found = run_case(case, formulation=formulation, body=body, steps=0)
    assert found.total[0] == pytest.approx(ENERGY[case], abs=5e-9)
    assert found.total == pytest.approx(found.potential + found.translation + found.rotation)


@pytest.mark.parametrize("formulation", MOTIONS)
def test_unrotated_is_another_body(run_case, formulation):
    """Energy and start are the same but the motion differs, so the infile is read."""
    end = [
        run_case(1, formulation=formulation, body=body, dt=0.02, steps=2500, every=2500).center[-1]
        for body in ("consistent", "unrotated")
    ]
    assert abs(end[0] - end[1]).max() > 0.01


# --- the free top -------------------------------------------------------------------------------
MOMENTS, OMEGA_BODY = np.array([19.5, 15.0, 7.5]), np.array([0.02, 1.0, 0.01])


@pytest.fixture(scope="module")
def top(examples):
    """Masses (6,), positions and velocities (6, 3) of data.top."""
    atoms, velocities = read_atoms(examples / "top" / "data.top")
    return atoms[:, 2], atoms[:, 4:7], velocities


def test_top_is_a_rigid_body_at_rest(top):
    """Moments follow from the sites, the momentum is zero, and all velocities belong to one angular velocity."""
    mass, x, v = top
    assert mass @ x == pytest.approx(0.0, abs=1e-14)
    assert mass @ v == pytest.approx(0.0, abs=1e-14)
    tensor = np.einsum("a,ai,ai->", mass, x, x) * np.eye(3) - np.einsum("a,ai,aj->ij", mass, x, x)
    moments, axes = np.linalg.eigh(tensor)
    assert moments[::-1] == pytest.approx(MOMENTS, rel=1e-13)
    omega_space = np.linalg.solve(tensor, (mass[:, None] * np.cross(x, v)).sum(axis=0))
    assert np.cross(omega_space, x) == pytest.approx(v, abs=1e-13)
    assert abs(axes.T @ omega_space)[::-1] == pytest.approx(OMEGA_BODY, rel=1e-12)


@pytest.mark.parametrize("method", METHODS)
def test_energy_of_the_top(run_scene, method):
    total = run_scene("top", method=method, steps=100, every=100)["v_total"]
    expected = (MOMENTS * OMEGA_BODY**2).sum() / 2
    assert total[0] == pytest.approx(expected, rel=1e-13)
    assert total[1] == pytest.approx(expected, rel=1e-4)


# --- all decks ----------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """The examples of a fresh clone."""
    return unpack(tmp_path_factory.mktemp("fresh")) / "examples"


DECKS = sorted(deck.relative_to(EXAMPLES) for deck in EXAMPLES.rglob("in.*"))


@pytest.mark.parametrize("deck", DECKS, ids=str)
def test_decks_run_in_a_fresh_clone(lmp_wheel, fresh, deck):
    lmp_wheel.succeed(fresh / deck, {"steps": 1} if deck.name == "in.equilibrate" else {})


@pytest.mark.parametrize("name", ["case1", "case2", "case3", "top"])
def test_examples_are_the_measured_scenes(lmp_wheel, name):
    """The same centers of mass and energies."""
    measured, example = (lmp_wheel.succeed(folder / f"in.{name}").thermo[-1] for folder in (SCENES, EXAMPLES / name))
    for ours, scenes in {"c_center[1]": "c_centre[1]", "f_move[2]": "v_kerot", "v_total": "v_total"}.items():
        assert example[ours] == pytest.approx(measured[scenes], abs=1e-12)


@pytest.mark.parametrize("case", [1, 3])
def test_the_unrotated_body_in_an_example(lmp_wheel, case):
    """Its energy belongs to the moments of the infile, not to the sites."""
    words = {"data": "data.unrotated", "words": "infile infile.unrotated preset paper", "steps": 0}
    result = lmp_wheel.succeed(EXAMPLES / f"case{case}" / f"in.case{case}", words)
    assert result.thermo[-1]["v_total"][0] == pytest.approx(ENERGY[case], abs=5e-9)


# --- variables that all scenes share -------------------------------------------------------------
def test_what_is_set_reaches_the_fix(lmp_wheel):
    """Keywords are given to the fix only if they are set; more adds columns."""
    deck = SCENES / "in.case1"
    named = {"formulation": "second", "keywords": "values 8 passes 2", "tolerance": 0, "more": "f_move[1] pe"}
    for variables, given in ((named, "formulation second values 8 passes 2"), ({"tolerance": 1e-9}, "tolerance 1e-09 length"), ({}, "")):
        log = lmp_wheel.succeed(deck, {"steps": 0, **variables}).log
        assert f"\nfix move body {f'gear/quat molecule {given}'.strip()}\n" in re.sub(" +", " ", log).replace(" \n", "\n")
