"""Boxes without periods: fixed, and shrink-wrapped; and a box that becomes triclinic."""

import numpy as np
import pytest
from support.scenes import difference, last_frame, restarted, water, water_data

STEPS = 400
SPACING = 3.3


def cluster(boundary, fix, dt, steps, dump, run="run {steps}"):
    """27 molecules of water that expand, well inside of the initial box."""
    more = "neigh_modify check no"  # the box changes in each step
    deck = water("data.water", fix, dt=dt, steps=steps, dump=dump, run=run, after=more)
    return deck.replace("atom_style", f"boundary {boundary}\natom_style", 1)


def frame(lmp, deck, dump, ranks=1):
    lmp.succeed(deck, ranks=ranks)
    return last_frame(lmp.folder / dump)


@pytest.fixture
def data(lmp_tree):
    return water_data(lmp_tree.folder / "data.water", spacing=SPACING, shift=SPACING / 2)


@pytest.mark.parametrize("boundary", ["s s s", "m s p"])
def test_boxes_that_follow_the_atoms(lmp_tree, data, boundary):
    one = frame(lmp_tree, cluster(boundary, "gear/quat molecule", 0.1, STEPS, "one"), "one")
    for ranks in (2, 4):
        deck = cluster(boundary, "gear/quat molecule", 0.1, STEPS, "many")
        assert difference(one, frame(lmp_tree, deck, "many", ranks)) < 1e-10
    deck = cluster(boundary, "rigid/nve/small molecule", 0.01, 10 * STEPS, "rigid")
    rigid = frame(lmp_tree, deck, "rigid")
    assert difference(one, rigid) < 1e-6


def test_a_restart_in_such_a_box(lmp_tree, data):
    halves = f"run {STEPS // 2}\nwrite_restart half\nrun {STEPS // 2}"
    whole = frame(
        lmp_tree, cluster("s s m", "gear/quat molecule", 0.1, STEPS, "whole", halves), "whole"
    )
    rest = cluster("s s m", "gear/quat molecule", 0.1, STEPS // 2, "rest")
    again = frame(lmp_tree, restarted(rest, "half"), "rest", ranks=2)
    assert difference(whole, again) < 1e-11


DUMP = """
dump poses all custom 20 poses.dump id xu yu zu vx vy vz
dump_modify poses sort id format float %.17g
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_box_may_become_triclinic_between_runs(lmp_tree, ranks):
    """The box and the motion are the same; all molecules are inside."""
    data = water_data(lmp_tree.folder / "data.water", spacing=4.5, shift=2.25)
    ends = []
    for change in ("", f"undump poses\nchange_box all triclinic\n{DUMP}"):
        deck = water(data, dt=1.0, steps=20, run=f"run 20\n{change}\nrun 20")
        lmp_tree.succeed(deck, ranks=ranks)
        ends.append(last_frame(lmp_tree.folder / "poses.dump")[:, 1:7])
    scale = np.abs(ends[0]).max(axis=0)
    assert (np.abs(ends[0] - ends[1]) < 1e-11 * scale).all()
