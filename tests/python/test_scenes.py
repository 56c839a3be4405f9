"""The scenes under examples/: files as generated, energies as printed in the paper."""

import runpy

import pytest

from lammps_gearquat import decks

MOTIONS = ("first", "second", "rigid")
ENERGY = {1: -0.72360304, 2: -0.72360304, 3: 3.99270832}


@pytest.fixture(scope="module")
def generator(examples):
    return runpy.run_path(str(examples / "common" / "make_scenes.py"))


def test_generator_writes_the_committed_files(generator, examples):
    files = generator["scene_files"]()
    assert len(files) == 6
    for name, text in files.items():
        assert (examples / name).read_text() == text, f"{name} is not what make_scenes.py writes"


def test_generator_check_can_fail(generator, examples):
    masses = list(generator["SITE_MASS"])
    masses[3] *= 1.01
    generator["scene_files"].__globals__["SITE_MASS"] = tuple(masses)
    try:
        files = generator["scene_files"]()
    finally:
        masses[3] /= 1.01
        generator["scene_files"].__globals__["SITE_MASS"] = (2.0, 2.0, 10.0, 50.0)
    assert all((examples / name).read_text() != text for name, text in files.items())


def test_package_finds_the_decks(examples):
    for case in ENERGY:
        deck = decks.deck_of_case(case)
        assert deck.read_text() == (examples / f"case{case}" / f"in.case{case}").read_text()


@pytest.mark.parametrize("body", ["consistent", "unrotated"])
@pytest.mark.parametrize("formulation", MOTIONS)
@pytest.mark.parametrize("case", ENERGY)
def test_initial_energy(run_case, case, formulation, body):
    found = run_case(case, formulation=formulation, body=body, steps=0)
    assert found.total[0] == pytest.approx(ENERGY[case], abs=5e-9)
    assert found.total[0] != pytest.approx(ENERGY[case] * 1.01, abs=5e-9)
    assert found.total == pytest.approx(found.potential + found.translation + found.rotation)


@pytest.mark.parametrize("charge", [1.01, 0.99])
def test_initial_energy_refuses_another_cage(lmp_wheel, examples, tmp_path, charge):
    """One cage charge wrong by 1 % does not go unnoticed."""
    for name in ("case1", "common"):
        (tmp_path / name).symlink_to(examples / name)
    scene = (examples / "common" / "in.scene").read_text()
    text = (examples / "case1" / "in.case1").read_text()
    scene = scene.replace(
        "group body molecule 1", f"set atom 26 charge {charge}\ngroup body molecule 1"
    )
    text = text.replace("include ../common/in.scene", scene)
    result = lmp_wheel.run(text, {"steps": 0, "formulation": "rigid"}, folder=examples / "case1")
    assert result.returncode == 0, result.output
    assert result.thermo[-1]["v_total"][0] != pytest.approx(ENERGY[1], abs=5e-9)


@pytest.mark.parametrize("formulation", MOTIONS)
def test_unrotated_is_another_body(run_case, formulation):
    """Same energy, same start, another motion: the infile is read."""
    end = [
        run_case(1, formulation=formulation, body=body, dt=0.02, steps=2500, every=2500).centre[-1]
        for body in ("consistent", "unrotated")
    ]
    assert abs(end[0] - end[1]).max() > 0.01


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_agree(lmp_wheel, examples, ranks):
    deck = examples / "case1" / "in.case1"
    variables = {"dt": 0.02, "steps": 1000, "every": 500}
    centre = []
    for n in (1, ranks):
        result = lmp_wheel.run(deck, variables, ranks=n)
        assert result.returncode == 0, result.output
        centre.append([result.thermo[-1][f"c_centre[{k}]"][-1] for k in (1, 2, 3)])
    assert centre[0] == pytest.approx(centre[1], rel=1e-10, abs=1e-10)
