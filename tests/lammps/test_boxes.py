"""Boxes without periods: fixed, and following the atoms."""

import numpy as np
import pytest
from scenes import last_frame, restarted, water, water_data

STEPS = 400
SPACING = 3.3


def cluster(boundary, fix, dt, steps, dump, run="run {steps}"):
    """27 molecules of water that fly apart, well inside of what the box is at the beginning."""
    more = "neigh_modify check no"  # the box follows at each step
    deck = water("data.water", fix, dt=dt, steps=steps, dump=dump, run=run, after=more)
    return deck.replace("atom_style", f"boundary {boundary}\natom_style", 1)


def frame(lmp, deck, dump, ranks=1):
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return last_frame(lmp.folder / dump)[:, 1:]


def difference(one, other):
    """Of positions and of velocities, each relative to the largest."""
    parts = (slice(0, 3), slice(3, 6))
    return max(np.abs((one - other)[:, k]).max() / np.abs(one[:, k]).max() for k in parts)


@pytest.fixture
def data(lmp_tree):
    return water_data(lmp_tree.folder / "data.water", spacing=SPACING, shift=SPACING / 2)


@pytest.mark.parametrize("boundary", ["s s s", "m m m", "p p s", "m s p"])
def test_boxes_that_follow_the_atoms(lmp_tree, data, boundary):
    one = frame(lmp_tree, cluster(boundary, "gear/quat molecule", 0.1, STEPS, "one"), "one")
    for ranks in (2, 4):
        deck = cluster(boundary, "gear/quat molecule", 0.1, STEPS, "many")
        assert difference(one, frame(lmp_tree, deck, "many", ranks)) < 1e-10
    deck = cluster(boundary, "rigid/nve/small molecule", 0.01, 10 * STEPS, "rigid")
    rigid = frame(lmp_tree, deck, "rigid")
    assert difference(one, rigid) < 1e-6
    assert difference(1.01 * one, rigid) > 1e-3


def test_a_restart_in_such_a_box(lmp_tree, data):
    halves = f"run {STEPS // 2}\nwrite_restart half\nrun {STEPS // 2}"
    whole = frame(
        lmp_tree, cluster("s s m", "gear/quat molecule", 0.1, STEPS, "whole", halves), "whole"
    )
    rest = cluster("s s m", "gear/quat molecule", 0.1, STEPS // 2, "rest")
    again = frame(lmp_tree, restarted(rest, "half"), "rest", ranks=2)
    assert difference(whole, again) < 1e-11
