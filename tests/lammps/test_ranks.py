"""One trajectory on any number of ranks, in any decomposition, in any box."""

from itertools import product

import numpy as np
import pytest
from support.scenes import (
    FORMULATIONS,
    difference,
    flat_water_data,
    frames,
    last_frame,
    water,
    water_data,
)


def run(lmp, data, ranks=1, **settings):
    """The last frame, and the thermo table."""
    table = lmp.succeed(water(data, **settings), ranks=ranks).thermo[0]
    return last_frame(lmp.folder / "poses.dump"), table


def test_1_2_and_4_ranks_over_500_steps(lmp_tree, data):
    settings = dict(steps=500, dt=0.2)
    one, table = run(lmp_tree, data, **settings)
    assert table["Temp"][-1] > 2.0 * table["Temp"][0]  # bodies have collided and migrated
    for ranks in (2, 4):
        assert difference(one, run(lmp_tree, data, ranks, **settings)[0]) < 1e-12


@pytest.mark.parametrize(
    "settings",
    [
        dict(comm="tiled", after="fix balance all balance 10 1.0 rcb"),
        dict(processors="1 2 2", after="fix balance all balance 10 1.0 shift xyz 10 1.0"),
        dict(newton="off"),
        dict(processors="4 1 1", before="atom_modify sort 7 2.0"),
    ],
    ids=["tiled rcb", "brick shift", "newton off", "sorted slabs"],
)
def test_decompositions(lmp_tree, data, settings):
    one, _ = run(lmp_tree, data, steps=200)
    other, _ = run(lmp_tree, data, 4, steps=200, **settings)
    assert difference(one, other) < 1e-12


@pytest.mark.parametrize("fix, ranks", [("gear/quat molecule", 2), ("gear/quat molecule formulation first", 1)])
def test_many_bodies_follow_the_order_of_their_atoms(lmp_tree, data, fix, ranks):
    """Bodies with histories are sorted again if a rank has more than 4000 of them."""
    settings = dict(fix=fix, before=f"replicate 6 6 {5 * ranks}")
    one, _ = run(lmp_tree, data, ranks, run="run 4\nrun 4", steps=8, **settings)
    assert len(one) > 3 * 4000 * ranks
    sorted_run = "run 4\natom_modify sort 3 2.0\nrun 4"
    other, _ = run(lmp_tree, data, ranks, run=sorted_run, steps=8, **settings)
    assert difference(one, other) < 1e-12


@pytest.mark.parametrize("ranks", [1, 4])
def test_triclinic_box(lmp_tree, ranks):
    """Tilted by a whole period the box is the same crystal as the orthogonal one, by half a period it is not."""
    ends = {}
    for tilt in (0.0, 9.9, 4.95):
        data = water_data(lmp_tree.folder / "data.water", tilt=tilt)
        ends[tilt], _ = run(lmp_tree, data, ranks)
    assert difference(ends[0.0], ends[9.9]) < 1e-12
    assert difference(ends[0.0], ends[4.95]) > 1e-6


def test_wheel_with_mpich(lmp_wheel, data):
    one, two = (run(lmp_wheel, data, ranks, steps=200)[0] for ranks in (1, 2))
    assert difference(one, two) < 1e-12


# --- bodies that change their ranks all the time ----------------------------------------------

# all bodies move through a box that is divided again every ten steps; steps are short enough for the collisions that differences due to
# rounding stay small
STEPS = 500
STREAM = "velocity all set 0.1 0.06 {} sum yes units box"  # half the box in a run
CUTS = {
    "shift": dict(comm="brick", after="fix cut all balance 10 1.0 shift {axes} 10 1.0"),
    "rcb": dict(comm="tiled", after="fix cut all balance 10 1.0 rcb"),
}
# sums of forces on owned or on all atoms, and both ways to find an atom by its ID
ACCESS = list(product(("on", "off"), ("array", "hash")))
SCENES = {
    "orthogonal": water_data,
    "triclinic": lambda path: water_data(path, tilt=3.3),
    "flat": flat_water_data,
}
OWNERS = f"\ndump owners all custom {STEPS // 20} {{}}.owners id proc\ndump_modify owners sort id"


def streaming(scene, data, name, formulation, cut=None, access=ACCESS[0], dt=0.1):
    settings = CUTS.get(cut, {})
    newton, map_style = access
    after = settings.get("after", "").format(axes="xy" if scene == "flat" else "xyz")
    text = water(
        data,
        f"gear/quat molecule formulation {formulation}",
        dt=dt,
        steps=STEPS,
        dump=f"{name}.dump",
        before=STREAM.format("NULL" if scene == "flat" else 0.08),
        after=after + OWNERS.format(name),
        newton=newton,
        processors="* * 1" if scene == "flat" else "* * *",
        comm=settings.get("comm", "brick"),
    )
    text = text.replace("atom_style full", f"atom_style full\natom_modify map {map_style}")
    if scene == "flat":
        text = text.replace("newton", "dimension 2\nnewton", 1)
        text = text.replace("thermo_style", "fix flat all enforce2d\nthermo_style")
    return text


def seen_from_the_stream(frame):
    return np.hstack([frame[:, :4], frame[:, 4:7] - frame[:, 4:7].mean(axis=0)])


@pytest.mark.parametrize("scene, formulation", list(zip(SCENES, FORMULATIONS)))
def test_bodies_that_change_their_ranks_all_the_time(lmp_tree, scene, formulation):
    folder = lmp_tree.folder
    data = SCENES[scene](folder / "data.water")
    lmp_tree.succeed(streaming(scene, data, "one", formulation))
    one = seen_from_the_stream(last_frame(folder / "one.dump"))
    assert scene != "flat" or (one[:, [3, 6]] == 0).all()

    # over the scenes, each cut is combined with each number of ranks, and most with each access
    number = FORMULATIONS.index(formulation)
    for ranks, cut, access in zip((2, 4), np.roll(list(CUTS), number), np.roll(ACCESS, 2 * number, axis=0)):
        lmp_tree.succeed(streaming(scene, data, "many", formulation, cut, access), ranks=ranks)
        many = seen_from_the_stream(last_frame(folder / "many.dump"))
        assert difference(one, many) < 1e-10
        # bodies did change their ranks, and no rank was idle
        owners = np.array(list(frames(folder / "many.owners").values()))[:, :, 1]
        assert set(owners.flat) == set(range(ranks))
        assert (owners[1:] != owners[:-1]).any(axis=0).mean() > 0.5
