"""Mixtures: kinds of bodies are distinguished, and each kind has separate averages and functions."""

from support import dumps
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gearquat_analysis import Poses, averages, correlations, open_dump
from gearquat_analysis.kinds import kinds, too_many
from gearquat_analysis.pictures import draw_correlations

WATER = np.array([[0.0, 0, 0], [0.8, 0.6, 0], [-0.8, 0.6, 0]])
METHANE = np.array([[0.0, 0, 0], [1, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]]) * 0.63
SITES = {"H2O": (WATER, [1, 2, 2], [15.9994, 1.008, 1.008]), "CH4": (METHANE, [3, 2, 2, 2, 2], [12.011, *[1.008] * 4])}
#: standard deviations of steps, and numbers of bodies
STEPS, NUMBERS, FRAMES = {"H2O": 0.2, "CH4": 0.5}, {"H2O": 24, "CH4": 12}, 240


def mixture(path, scale=1.0, shape=1.0):
    """Dump of random walks and small random turns; bodies of the two kinds take turns, two and one."""
    rng, order = np.random.default_rng(3), ["H2O", "H2O", "CH4"] * 12
    turn, center = Rotation.random(36, rng), rng.uniform(-20.0, 20.0, (36, 3))
    step = np.array([STEPS[name] for name in order])[:, None]
    text = []
    for frame in range(FRAMES):
        rows = []
        for body, name in enumerate(order):
            sites, types, masses = SITES[name]
            own = turn[body].apply(sites * (shape if body % 2 else 1.0)) + center[body]
            ids = len(rows) + 1 + np.arange(len(own))
            keys = [ids, np.full(len(own), body + 1), types, np.array(masses) * scale]
            rows += np.column_stack([*keys, own, np.zeros((len(own), 3))]).tolist()
        text.append(dumps.frame(frame, rows))
        center = center + rng.normal(size=(36, 3)) * step
        turn = turn * Rotation.from_rotvec(0.2 * rng.normal(size=(36, 3)))
    path.write_text("".join(text))
    return path


@pytest.fixture(scope="module")
def mixed(tmp_path_factory):
    return mixture(tmp_path_factory.mktemp("mixed") / "mixed.dump")


def test_diffusion_of_each_kind(mixed, tmp_path):
    poses = Poses(open_dump(mixed).atoms, reference="principal").run()
    assert [(kind.name, len(kind.bodies)) for kind in kinds(poses)] == [("H2O", 24), ("CH4", 12)]
    found = {one.name: one for one in averages.averages(poses)}
    assert "diffusion coefficient" not in found
    for name, step in STEPS.items():
        one, expected = found[f"diffusion coefficient of {name}"], step**2 / 2.0
        assert abs(one.value - expected) < 4.0 * one.error < 0.4 * expected, name
    assert {"correlation time of H2O, axis 1, order 1", "correlation time of CH4, axes 1, 2 and 3, order 2"} <= set(found)
    functions = correlations.all_correlations(poses)
    for kind in kinds(poses):
        alone = Poses(open_dump(mixed).atoms.residues[kind.bodies].atoms, reference="principal").run()
        for name, expected in correlations.all_correlations(alone).functions.items():
            if name != "lag":
                ending = functions.of_kind(kind.name)[name]
                assert ending == pytest.approx(expected, rel=1e-9, abs=1e-12), name
    assert len(draw_correlations(functions, found.values()).axes) >= 4


def test_the_command_tells_kinds(mixed, tmp_path):
    result = dumps.analyze(mixed, tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert "The diffusion coefficient of H2O is " in result.output
    assert "The diffusion coefficient of CH4 is " in result.output
    rows = (tmp_path / "out" / "bodies.csv").read_text().splitlines()
    assert rows[0].endswith(",species") and [row.split(",")[-1] for row in rows[1:4]] == ["H2O", "H2O", "CH4"]
    assert "mean_square_displacement_CH4" in (tmp_path / "out" / "correlations.csv").read_text().splitlines()[0]


def names(path):
    poses = Poses(open_dump(path).atoms)
    poses.results.center = np.zeros((1, len(poses.ids), 3))
    return [kind.name for kind in kinds(poses)], too_many(poses)


def test_names(tmp_path):
    """Names consist of types if masses are not of elements; isomers (one is 5 % larger here) are numbered."""
    assert names(mixture(tmp_path / "a.dump", scale=1.1))[0] == ["T1(T2)2", "(T2)4T3"]
    assert names(mixture(tmp_path / "b.dump", shape=1.05))[0] == ["H2O-1", "H2O-2", "CH4-1", "CH4-2"]
    assert names(mixture(tmp_path / "c.dump", shape=1.005))[0] == ["H2O", "CH4"]


def test_bodies_that_are_all_different(tmp_path):
    path = dumps.write(tmp_path / "many.dump", dumps.Motion([4] * 12), np.arange(120.0))
    assert names(path) == ([""], True)
    with pytest.warns(UserWarning, match="too many kinds of bodies: diffusion and correlation times are averages over all"):
        averages.averages(Poses(open_dump(path).atoms).run())
