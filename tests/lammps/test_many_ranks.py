"""One trajectory on any number of ranks while bodies change their ranks all the time.

Every ten steps the box is cut anew, on 2 and 4 ranks, in slabs (brick) and by recursive bisection
(tiled), and everything streams through it: 1000 steps of 0.1 fs, short enough against the collisions
that differences of rounding stay what they are.  What test_ranks.py shows without rebalancing is not
repeated.
"""

from itertools import product

import numpy as np
import pytest
from running import make_lmp_tree
from scenes import flat_water_data, last_frame, one_after_the_other, water, water_data

pytestmark = pytest.mark.tree  # made in a fixture of the module

STEPS, RANKS = 1000, (2, 4)
FORMULATIONS = ["first", "second"]
CUTS = {
    "shift": dict(comm="brick", after="fix cut all balance 10 1.0 shift {axes} 10 1.0"),
    "rcb": dict(comm="tiled", after="fix cut all balance 10 1.0 rcb"),
}
# sums of forces on owned or on all atoms, and both ways to find an atom by its ID
ACCESS = list(product(("on", "off"), ("array", "hash")))

STREAM = "velocity all set 0.05 0.03 {} sum yes units box"  # half the box in a run

SCENES = {
    "orthogonal": lambda path: water_data(path),
    "triclinic": lambda path: water_data(path, tilt=3.3),
    "flat": lambda path: flat_water_data(path),
}


def deck(scene, data, name, formulation, cut=None, newton="on", access="array", dt=0.1):
    settings = dict(CUTS[cut]) if cut else dict(after="")
    axes = "xy" if scene == "flat" else "xyz"
    settings["after"] = settings["after"].format(axes=axes) + (
        "\nfix flat all enforce2d" if scene == "flat" else ""
    )
    settings[
        "after"
    ] += f"\ndump owners all custom {STEPS // 20} {name}.owners id proc\ndump_modify owners sort id"
    text = water(
        data,
        f"gear/quat molecule formulation {formulation}",
        dt=dt,
        steps=STEPS,
        dump=f"{name}.dump",
        before=STREAM.format("NULL" if scene == "flat" else 0.04),
        newton=newton,
        processors="* * 1" if scene == "flat" else "* * *",
        **settings,
    )
    text = text.replace("atom_style full", f"atom_style full\natom_modify map {access}")
    return text.replace("newton", "dimension 2\nnewton", 1) if scene == "flat" else text


def name_of(formulation, ranks, cut):
    return f"{formulation}-{ranks}-{cut}"


@pytest.fixture(scope="module", params=SCENES)
def ends(request, tmp_path_factory):
    """All runs of a scene: name -> its last frame; name + '.owners' -> ranks of atoms (time, atom)."""
    scene = request.param
    lmp = make_lmp_tree(tmp_path_factory.mktemp(scene))
    data = SCENES[scene](lmp.folder / "data.water")
    access = {
        combination: ACCESS[(k + k // 4) % 4]  # either cut meets all four
        for k, combination in enumerate(product(FORMULATIONS, RANKS, CUTS))
    }
    decks = {1: [], 2: [], 4: []}
    for formulation in FORMULATIONS:
        decks[1].append(deck(scene, data, formulation, formulation))
        decks[1].append(deck(scene, data, f"{formulation}-other", formulation, dt=0.1001))
        for ranks, cut in product(RANKS, CUTS):
            name = name_of(formulation, ranks, cut)
            newton, map_style = access[formulation, ranks, cut]
            decks[ranks].append(deck(scene, data, name, formulation, cut, newton, map_style))
    for ranks, some in decks.items():
        result = lmp.run(one_after_the_other(some), ranks=ranks)
        assert result.returncode == 0, result.output
    found = {path.stem: last_frame(path) for path in lmp.folder.glob("*.dump")}
    for path in lmp.folder.glob("*.owners"):
        frames = path.read_text().split("ITEM: ATOMS")[1:]
        table = [np.loadtxt(f.split("ITEM: TIMESTEP")[0].splitlines()[1:]) for f in frames]
        found[path.name] = np.array(table)[:, :, 1]
    found["scene"] = scene
    return found


def difference(one, other):
    """Largest difference of positions and of velocities, relative to the largest of each.

    Velocities count as they are seen from the stream.
    """
    x, v = one[:, 1:4], one[:, 4:7] - one[:, 4:7].mean(axis=0)
    moved = np.abs(one - other)
    return max(moved[:, 1:4].max() / np.abs(x).max(), moved[:, 4:7].max() / np.abs(v).max())


@pytest.mark.parametrize("cut", CUTS)
@pytest.mark.parametrize("ranks", RANKS)
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_trajectory_is_that_of_one_rank(ends, formulation, ranks, cut):
    one, many = ends[formulation], ends[name_of(formulation, ranks, cut)]
    assert difference(one, many) < 1e-10
    assert difference(one, 1.01 * many) > 5e-3

    # bodies did change their ranks, and no rank was idle
    owners = ends[name_of(formulation, ranks, cut) + ".owners"]
    assert set(owners.flat) == set(range(ranks))
    assert (owners[1:] != owners[:-1]).any(axis=0).mean() > 0.5


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_scenes_move_enough_to_tell(ends, formulation):
    """Forces act: a step 0.1 % longer shows, and velocities are not those of the start."""
    one, other = ends[formulation], ends[f"{formulation}-other"]
    assert difference(one, other) > 1e-5
    if ends["scene"] == "flat":
        assert (one[:, [3, 6]] == 0).all()
