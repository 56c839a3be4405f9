"""One trajectory on any number of ranks, in any decomposition, in any box."""

import numpy as np
import pytest
from scenes import last_frame, water, water_data

FORMULATIONS = ["first", "second"]


def run(lmp, name, ranks, data, **settings):
    deck = water(data, dump=f"{name}.dump", **settings)
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return last_frame(lmp.folder / f"{name}.dump"), result


def assert_same(one, other, relative):
    """Positions on the scale of the box, velocities on that of the fastest atom."""
    for columns in (slice(1, 4), slice(4, 7)):
        scale = np.abs(one[:, columns]).max()
        assert np.abs(one[:, columns] - other[:, columns]).max() < relative * scale


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_1_2_and_4_ranks_over_1000_steps(lmp_tree, formulation):
    settings = dict(
        data=water_data(lmp_tree.folder / "data.water"),
        fix=f"gear/quat molecule formulation {formulation}",
        dt=0.1,
        steps=1000,
    )
    one, result = run(lmp_tree, "one", 1, **settings)
    for ranks in (2, 4):
        other, _ = run(lmp_tree, f"ranks{ranks}", ranks, **settings)
        assert_same(one, other, 1e-12)

    # bodies did meet and migrate, and a difference of 1 % would have been seen
    assert result.thermo[0]["Temp"][-1] > 2.0 * result.thermo[0]["Temp"][0]
    with pytest.raises(AssertionError):
        assert_same(one, one * 1.01, 1e-12)


@pytest.mark.parametrize("formulation", FORMULATIONS)
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
def test_decompositions(lmp_tree, formulation, settings):
    common = dict(
        data=water_data(lmp_tree.folder / "data.water"),
        fix=f"gear/quat molecule formulation {formulation}",
        dt=0.1,
        steps=200,
    )
    one, _ = run(lmp_tree, "one", 1, **common)
    other, _ = run(lmp_tree, "other", 4, **common, **settings)
    assert_same(one, other, 1e-12)


@pytest.mark.parametrize("ranks", [1, 4])
def test_triclinic_box(lmp_tree, ranks):
    """Tilted by a whole period the box is the same crystal as the orthogonal one, by half not."""
    n, spacing = 3, 3.3
    ends = {}
    for name, tilt in (("straight", 0.0), ("whole", n * spacing), ("half", n * spacing / 2)):
        data = water_data(lmp_tree.folder / f"data.{name}", n, spacing=spacing, tilt=tilt)
        ends[name], _ = run(lmp_tree, name, ranks, data=data, steps=100)
    assert_same(ends["straight"], ends["whole"], 1e-12)
    with pytest.raises(AssertionError):
        assert_same(ends["straight"], ends["half"], 1e-6)


def test_wheel_with_mpich(lmp_wheel):
    settings = dict(data=water_data(lmp_wheel.folder / "data.water"), dt=0.1, steps=200)
    one, _ = run(lmp_wheel, "one", 1, **settings)
    two, _ = run(lmp_wheel, "two", 2, **settings)
    assert_same(one, two, 1e-12)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_papers_case(lmp_tree, examples, formulation):
    ends = {}
    for ranks in (1, 2, 4):
        result = lmp_tree.run(
            examples / "case1" / "in.case1",
            dict(formulation=formulation, dt=0.02, steps=1000, every=1000),
            ranks=ranks,
        )
        assert result.returncode == 0, result.output
        row = result.thermo[-1]
        ends[ranks] = np.array([row[f"c_centre[{k}]"][-1] for k in (1, 2, 3)])
    for ranks in (2, 4):
        assert np.abs(ends[ranks] - ends[1]).max() < 1e-12 * np.abs(ends[1]).max()
