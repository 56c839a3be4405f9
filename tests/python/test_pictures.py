"""The camera and its pictures; pictures and film of a made-up motion; a short run."""

import numpy as np
import pytest
from PIL import Image
from scipy.spatial.transform import Rotation

from benchmarks.engine import Lab
from benchmarks.engine.page import file_of, render
from benchmarks.studies import pictures
from benchmarks.studies.pictures import film
from benchmarks.studies.pictures.view import Camera, sphere_image


def test_camera_looks_along_its_direction():
    camera = Camera((1.0, 2.0, 3.0), -90.0, 0.0, 10.0)  # from -y: x to the right, z up
    at, depth, scale = camera.project([[1, 2, 3], [2, 2, 3], [1, 2, 4], [1, -3, 3]])
    assert at == pytest.approx(np.array([[0, 0], [1, 0], [0, 1], [0, 0]]), abs=1e-14)
    assert depth == pytest.approx([0, 0, 0, 5], abs=1e-14)
    assert scale == pytest.approx([1, 1, 1, 2])  # half as far: twice as large
    assert camera.frame() @ camera.frame().T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(Camera((0, 0, 0), 33.0, 21.0, 1.0).frame()) == pytest.approx(1.0)


def test_sphere_is_round_and_lit():
    image = sphere_image("#d55e00")
    assert image[0, 0, 3] == 0.0 and image[48, 48, 3] == 1.0
    assert image[70, 30, :3].sum() > image[20, 70, :3].sum()  # light from upper left
    assert (sphere_image("#d55e00", fade=1.0)[48, 48, :3] == 1.0).all()


@pytest.fixture
def scene():
    """An even rotation along a straight line."""
    time = np.arange(0.0, 240.0, 2.0)
    turn = Rotation.from_rotvec(np.outer(time, [0.02, 0.01, 0.03]))
    axes = np.swapaxes(turn.as_matrix(), 1, 2)
    center = np.outer(time, [0.3, -0.1, 0.05]) + [70.0, 0.0, 0.0]
    shape = np.array([[3, -4, -9], [-3, -4, -9], [0, 0, -9], [0, 0, 3]])
    sites = center[:, None] + np.einsum("fij,nj->fni", turn.as_matrix(), shape)
    energy = 1.0 + 0.1 * np.sin(time)
    omega = np.tile([0.02, 0.01, 0.03], (len(time), 1))
    energies = {"potential": -energy, "rotation": energy, "total": 0 * energy}
    return pictures.Scene(time, center, sites, axes, omega, energies)


def test_pictures_are_drawn_and_shown(scene, tmp_path):
    finding = pictures.find({1: scene, 3: scene})
    drawn, text = finding.pictures, render("pictures.md.j2", pictures.STUDY, finding, "Somewhere.")
    assert all(f"(pictures/{file_of(name)})" in text for name in drawn)
    for name in ("orbit", "tumbling", "energy"):
        drawn[name](tmp_path / f"{name}.png")
        with Image.open(tmp_path / f"{name}.png") as picture:
            assert picture.size == (1536, 864)
            assert len(picture.convert("RGB").getcolors(10**6)) > 50  # something is on it


def test_film_has_a_picture_for_each_sample(scene, tmp_path):
    film.draw_film(tmp_path / "film.gif", scene, begin=200.0, every=4)
    with Image.open(tmp_path / "film.gif") as found:
        assert found.n_frames == 5 and found.size == (640, 360)
        first = np.asarray(found.convert("RGB"))
        found.seek(4)
        assert (np.asarray(found.convert("RGB")) != first).any()


def test_scenes_are_those_of_the_fix(monkeypatch, tmp_path):
    """A short run: positions, energies and angular velocity of one and the same samples."""
    monkeypatch.setattr(pictures, "RUNS", {1: (0.01, 4.0, 0.5)})
    found = pictures.measure(Lab(tmp_path))[1]
    total, translation = found.energies["total"], found.energies["translation"]
    assert found.time == pytest.approx(0.5 * np.arange(9))
    assert total == pytest.approx(np.full(9, total[0]), abs=1e-10)
    masses = np.array([2.0, 2.0, 10.0, 50.0])
    centers = np.einsum("n,fni->fi", masses, found.sites) / masses.sum()
    assert centers == pytest.approx(found.center, abs=1e-12)
    moved = (found.center[2:] - found.center[:-2]) / 1.0
    kinetic = 32.0 * (moved**2).sum(axis=1)
    assert kinetic == pytest.approx(translation[1:-1], rel=1e-2)
