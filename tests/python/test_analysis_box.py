"""Analysis in a box that changes, as at constant pressure: motion of bodies relative to the box, diffusion, volume and
density."""

import numpy as np
import pytest

from gearquat_analysis import Poses, averages, open_dump
from gearquat_analysis.box import carried, own_motion

FRAMES, BODIES = 400, 40
ARM = np.array([0.3, 0.0, 0.0])


class Walk:
    """Dumbbells that a fluctuating box carries along, and that step on their own; many are far from the box."""

    def __init__(self, seed=1):
        rng = np.random.default_rng(seed)
        self.size = 10.0 * np.exp(0.02 * rng.normal(size=(FRAMES, 3)))
        self.low = 5.0 - 0.5 * self.size
        self.steps = 0.3 * rng.normal(size=(FRAMES - 1, BODIES, 3))
        self.center = np.empty((FRAMES, BODIES, 3))
        self.center[0] = self.low[0] + self.size[0] * rng.integers(-30, 30, (BODIES, 1)) + rng.random((BODIES, 3))
        for k, step in enumerate(self.steps):
            scale = self.size[k + 1] / self.size[k]
            self.center[k + 1] = self.low[k + 1] + (self.center[k] - self.low[k]) * scale + step

    def dump(self, path, names="xu yu zu", boundary="pp pp pp"):
        """Path of a dump, with wrapped positions if the columns are x, y and z."""
        lines = []
        for k in range(FRAMES):
            sites = np.repeat(self.center[k], 2, axis=0) + np.tile([-ARM, ARM], (BODIES, 1))
            if names == "x y z":
                sites = self.low[k] + (sites - self.low[k]) % self.size[k]
            bounds = [f"{low:.17g} {low + size:.17g}" for low, size in zip(self.low[k], self.size[k])]
            lines += ["ITEM: UNITS", "real", "ITEM: TIME", f"{float(k)}", "ITEM: TIMESTEP", f"{k}"]
            lines += ["ITEM: NUMBER OF ATOMS", f"{2 * BODIES}", f"ITEM: BOX BOUNDS {boundary}", *bounds]
            lines += [f"ITEM: ATOMS id mol type mass {names}"]
            lines += [f"{n + 1} {n // 2 + 1} 1 6.0 " + " ".join(f"{x:.17g}" for x in site) for n, site in enumerate(sites)]
        path.write_text("\n".join(lines) + "\n")
        return path


@pytest.fixture(scope="module")
def walk():
    return Walk()


def displaced(walk):
    return np.concatenate([np.zeros((1, BODIES, 3)), walk.steps.cumsum(axis=0)])


@pytest.mark.parametrize("names", ["xu yu zu", "x y z"])
@pytest.mark.parametrize("backend", ["serial", "multiprocessing"])
def test_own_motion(walk, tmp_path, names, backend):
    """The box changes with the steps; wrapped positions are followed through the changing box."""
    poses = Poses(open_dump(walk.dump(tmp_path / "a.dump", names)).atoms)
    poses.run(backend=backend, **({"n_workers": 2} if backend == "multiprocessing" else {}))
    found = own_motion(poses.results)
    assert np.abs(found - found[0] - displaced(walk)).max() < 1e-9
    moved = poses.results.center - poses.results.center[0]
    assert np.abs(moved - displaced(walk)).max() > (0.1 if names == "x y z" else 1.0)


def test_a_flip_carries_nothing():
    """Edges of the same lattice, some of them with a deformation of 2 %; a large deformation is not a flip."""
    cell = np.array([[1.0, 2.0, 3.0], [10.0, 0.0, 0.0], [5.5, 9.0, 0.0], [-5.6, 4.8, 8.0]])
    x = np.random.default_rng(1).uniform(-300.0, 300.0, (20, 3))
    for k, l, m in [(-1, 0, 0), (0, 1, 0), (0, 0, -1), (-1, 1, -1)]:
        flip = np.array([[1, 0, 0], [k, 1, 0], [l, m, 1]])
        for strain in (0.0, 0.02):
            change = np.eye(3) + strain * np.array([[1.0, 0.0, 0.0], [0.7, -1.0, 0.0], [0.2, 0.5, 0.6]])
            after = np.vstack([cell[0], flip @ cell[1:] @ change])
            assert np.abs(carried(x, cell, after) - cell[0] - (x - cell[0]) @ change).max() < 1e-11
    doubled = np.vstack([cell[0], 2.0 * cell[1:]])
    assert np.allclose(carried(x, cell, doubled), cell[0] + 2.0 * (x - cell[0]))


def test_diffusion(walk, tmp_path):
    poses = Poses(open_dump(walk.dump(tmp_path / "a.dump")).atoms).run()
    (found,) = (row for row in averages.averages(poses) if row.name == "diffusion coefficient")
    assert found.value == pytest.approx(0.045, abs=3 * found.error) and found.error < 0.1 * found.value
    poses.results.cell[:] = poses.results.cell[0]
    (wrong,) = (row for row in averages.averages(poses) if row.name == "diffusion coefficient")
    assert not wrong.known or abs(wrong.value - 0.045) > 3 * found.error


def test_volume_and_density(walk, tmp_path):
    poses = Poses(open_dump(walk.dump(tmp_path / "a.dump")).atoms).run()
    found = {row.name: row for row in averages.averages(poses)}
    volume, density = found["volume"], found["density"]
    series = walk.size.prod(axis=1)
    assert volume.value == pytest.approx(series.mean(), rel=1e-12) and volume.unit == "Å³"
    assert volume.error == pytest.approx(series.std() / np.sqrt(FRAMES), rel=0.5)
    expected = np.mean(12.0 * BODIES / series) / 0.602214129
    assert density.value == pytest.approx(expected, rel=1e-9) and density.unit == "g/cm³"


def test_no_volume_of_a_slab_and_no_density_of_a_part(walk, tmp_path):
    slab = Poses(open_dump(walk.dump(tmp_path / "a.dump", boundary="pp pp ss")).atoms).run()
    assert not {"volume", "density"} & {row.name for row in averages.averages(slab)}
    moved = own_motion(slab.results)
    assert np.abs(moved[..., :2] - moved[0, :, :2] - displaced(walk)[..., :2]).max() < 1e-9
    assert np.abs(moved[..., 2] - slab.results.center[..., 2]).max() < 1e-9
    part = Poses(open_dump(walk.dump(tmp_path / "b.dump")).select_atoms("resid 1:10")).run()
    names = {row.name for row in averages.averages(part)}
    assert "volume" in names and "density" not in names
