"""The scenes under examples/: energies as printed in the paper, and decks that run."""

import re

import numpy as np
import pytest
from support.pages import unpack
from support.scene_files import read_atoms

from support.running import EXAMPLES

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


# --- the coated body ----------------------------------------------------------------------------
EPSILON = {"cage": 10.0, 4: 10.0, "coat": 0.1}  # all with sigma 10: so has every mixed pair


def coated_energy(examples, coat):
    """Total energy of the start of case 1 with epsilon ``coat`` on spheres 1 to 3."""
    atoms, velocities = read_atoms(examples / "case1" / "data.consistent")
    body, cage = atoms[:4], atoms[4:]
    epsilon = np.sqrt(EPSILON["cage"] * np.array([coat, coat, coat, EPSILON[4]]))[:, None]
    r = np.linalg.norm(body[:, None, 4:7] - cage[:, 4:7], axis=2)
    sixth = (10.0 / r) ** 6
    potential = (np.outer(body[:, 3], cage[:, 3]) / r + 4 * epsilon * (sixth**2 - sixth)).sum()
    return potential + 0.5 * np.array([2.0, 2.0, 10.0, 50.0]) @ (velocities[:4] ** 2).sum(axis=1)


@pytest.mark.parametrize("method", METHODS)
def test_energy_of_the_coated_body(run_scene, examples, method):
    """The energy is below zero, so the body stays in the cage; the sum is independent."""
    expected = coated_energy(examples, EPSILON["coat"])
    assert expected == pytest.approx(-0.82575686, abs=5e-9)
    total = run_scene("coated", method=method, steps=0)["v_total"][0]
    assert total == pytest.approx(expected, rel=1e-12)


def test_coated_body_is_repelled_by_every_sphere(examples):
    """On the way to any charge of the cage, at most 1, the repulsion wins long before r = 5."""
    scene = (examples / "common" / "in.scene").read_text()
    assert "pair_coeff 1*2 1*2 ${coat} ${thickness}" in scene
    deck = (examples / "coated" / "in.coated").read_text()
    assert f"variable coat index {EPSILON['coat']:g}\n" in deck
    epsilon, r = np.sqrt(EPSILON["coat"] * EPSILON["cage"]), np.linspace(2.0, 8.0, 100)
    force = 24 * epsilon / r * (2 * (10 / r) ** 12 - (10 / r) ** 6) - 1.0 / r**2
    assert (force > 0).all() and (np.diff(force) < 0).all()


# --- all decks ----------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """The examples of a fresh clone."""
    return unpack(tmp_path_factory.mktemp("fresh")) / "examples"


DECKS = sorted(deck.relative_to(EXAMPLES) for deck in EXAMPLES.rglob("in.*") if deck.parent.name != "common")


@pytest.mark.parametrize("deck", DECKS, ids=str)
def test_decks_run_in_a_fresh_clone(lmp_wheel, fresh, deck):
    lmp_wheel.succeed(fresh / deck, {"steps": 1} if deck.name == "in.equilibrate" else {})


# --- variables that all decks share -------------------------------------------------------------
def test_what_is_set_reaches_the_fix(lmp_wheel, examples):
    """Keywords are given to the fix only if they are set; more adds columns."""
    deck = examples / "case1" / "in.case1"
    named = {"formulation": "second", "keywords": "values 8 passes 2", "tolerance": 0, "more": "f_move[1] pe"}
    for variables, given in ((named, "formulation second values 8 passes 2"), ({"tolerance": 1e-9}, "tolerance 1e-09 length"), ({}, "")):
        log = lmp_wheel.succeed(deck, {"steps": 0, **variables}).log
        assert f"\nfix move body {f'gear/quat molecule {given}'.strip()}\n" in re.sub(" +", " ", log).replace(" \n", "\n")
