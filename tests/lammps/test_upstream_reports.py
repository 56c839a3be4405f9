"""LAMMPS has the defects reported in doc/upstream/reports. These tests fail with a LAMMPS without the defects, so we
will notice a correction."""

from __future__ import annotations

import re

import numpy as np
import pytest

from upstream_reports import COMMAND, CONSTANT, DUMBBELLS, FOLDER, REPORTS, deck, results, run
from benchmarks.engine.publish import split_block

BOTH = pytest.mark.parametrize("style", ["rigid/npt/small", "rigid/npt"])


@BOTH
def test_the_mean_of_three_targets_is_held(lmp, style):
    found = run(lmp, "dumbbells", "targets", style=f"{style} molecule", half=1000)
    pressures, edges = found["pressures"], found["edges"]
    # targets 0.5, 0.5, 1.5: a deviator of 1, which shortens z by 4 % in a crystal of atoms
    assert pressures[2] - pressures[0] == pytest.approx(0.0, abs=0.2)
    assert sum(pressures) / 3 == pytest.approx(2.5 / 3, abs=0.2)
    assert edges[2] / edges[0] == pytest.approx(1.0, abs=0.01)


def test_the_same_targets_are_held_in_a_crystal_of_atoms(lmp):
    found = run(lmp, "atoms", "targets", style="npt nreset 1", half=1000)
    assert found["pressures"] == pytest.approx([0.5, 0.5, 1.5], abs=0.2)
    assert found["edges"][2] / found["edges"][0] < 0.98


def test_energy_drifts_and_the_barostat_is_too_cold(lmp):
    constant = run(lmp, task="barostat", **{**DUMBBELLS, **CONSTANT, "time": 40})
    assert abs(constant["drift"][0]) < 2000 and constant["kinetic"] == [0]
    found = run(lmp, task="barostat", **{**DUMBBELLS, "pressure": "aniso 1 1 0.5"})
    assert found["drift"][0] > 20000
    assert 0.4 < found["kinetic"][0] < 0.85  # 1 is the correct value


def test_the_deck_of_water(lmp):
    found = run(lmp, "water", "barostat", begin=100, time=200)
    assert len(found["drift"]) == 1 and 0 < found["kinetic"][0] < 10


@BOTH
def test_lengths_walk(lmp, style):
    found = run(lmp, "dumbbells", "lengths", style=style, runs=40)
    # rounding would be 1e-13
    assert 1e-6 < found["within"][0] < 1e-2 and 1e-5 < found["after"][0] < 0.1


@pytest.mark.parametrize(
    "task, said",
    {
        "negative": "Target pressure for fix rigid/npt/small cannot be < 0.0",
        "triclinic": "Fix rigid/npt/small does not yet allow triclinic box",
    }.items(),
)
def test_refused(lmp, task, said):
    lmp.refuse(deck("dumbbells", task), said)


def test_molecular_virial_is_the_derivative_of_the_energy(lmp):
    found = run(lmp, "dumbbells", "virial")
    assert list(found) == ["xx", "yy", "zz", "xy", "xz", "yz"]
    for atomic, molecular, difference in found.values():
        assert molecular == pytest.approx(difference, rel=1e-5, abs=1e-3)
        assert abs(atomic - difference) > 0.05 * abs(difference)


@pytest.mark.parametrize(
    "variables, factor",
    [
        # the area is 3
        ({}, 1 / 3),
        ({"density": 2}, 1 / 3),
        ({"from": "set"}, 1),
        ({"from": "set", "density": 3}, 3),
    ],
)
def test_moments_of_triangles_are_wrong_by_their_area_or_density(lmp, variables, factor):
    found = run(lmp, "", "inertia", **variables)
    assert found["energy"][0] == pytest.approx(factor * found["exact"][0], rel=1e-4)


def test_moments_of_triangles_depend_on_the_origin(lmp):
    energies = [run(lmp, "", "inertia", x=x, y=y)["energy"][0] for x, y in ((0, 0), (5, 0), (5, 7))]
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert abs(energies[one] - energies[other]) > 0.1


@pytest.mark.parametrize("style", ["rigid", "rigid/small"])
@pytest.mark.parametrize("atoms, radius", [("tri", 2 / 3**0.5), ("line", 1.0)])
def test_rigid_bodies_have_spheres_instead_of_lines_and_triangles(lmp, atoms, radius, style):
    found = run(lmp, "", "triangles", atoms=atoms, style=style)
    made, mass = found["mass"]
    assert made == pytest.approx(4 / 3 * np.pi * radius**3, rel=1e-4) and abs(made - mass) > 0.5 * mass
    # spheres have the angular velocity in omega, which only lines have
    momentum = 2 * mass * (1 + 0.4 * radius**2 * (atoms == "line"))
    moment = 2 * mass * (1 + 0.4 * radius**2)
    energy, exact = found["energy"]
    assert energy == pytest.approx(momentum**2 / moment / 2, rel=1e-4) and abs(energy - exact) > 0.04 * exact
    body, shape, _ = found["angle"]
    assert body == pytest.approx(momentum / moment / 2, abs=1e-4) and shape == pytest.approx(0.0, abs=1e-4)


def test_results_are_numbers_behind_names():
    log = 'print "result none $(1)"\nresult drift 1.5 kinetic 2e-3 -4\nresult xx 1\n'
    assert results(log) == {"drift": [1.5], "kinetic": [2e-3, -4.0], "xx": [1.0]}


@pytest.mark.parametrize("report", REPORTS, ids=lambda report: report.name)
def test_reports_hold_these_decks_and_three_releases(report):
    text = (FOLDER / f"{report.name}.md").read_text(encoding="utf-8")
    _, written, _ = split_block(text, COMMAND, report.name)
    for task in [report.task] if report.task else report.rows:
        assert f"```\n{deck(report.scene, task)}```" in written, f"run {COMMAND} {report.name}"
    assert set(re.findall(r"^\| (\d[^|]*) \|", written, re.MULTILINE)) == {
        "22 Jul 2025 - Update 4",
        "4 Feb 2025",
        "4 Jul 2026",
    }
