"""Simulations with step control, and their output."""

import numpy as np
import pytest
from support.scenes import frames, placed

ELEMENTS = [f"f_move[{k}]" for k in range(9, 18)]
NEXT, SMALLEST, MEAN, LOADS, MEAN_LOADS, LARGEST, HELD, REPEATED, LAST = ELEMENTS


def tables(result):
    """The thermo table of each run, columns as arrays."""
    return [{key: np.array(column) for key, column in run.items()} for run in result.thermo]


def agree_on_ranks(lmp, deck):
    """Poses of water at equal times, on 1, 2 and 4 ranks; deck: of scenes.water, with 120 steps."""
    deck = deck.replace("dump poses all custom 120", "dump poses all custom 1")
    deck = deck.replace("dump_modify poses", "dump_modify poses every/time 0.5")
    found = []
    for ranks in (1, 2, 4):
        lmp.succeed(deck.replace("poses.dump", f"{ranks}.dump"), ranks=ranks)
        found.append(list(frames(lmp.folder / f"{ranks}.dump").values()))
    assert len(found[0]) > 2
    for other in found[1:]:
        for frame, same in zip(found[0], other):
            assert same == pytest.approx(frame, rel=1e-10, abs=1e-10)


def off(run, column="v_total"):
    """Largest deviation from the start."""
    return np.abs(run[column] - run[column][0]).max()


# Two molecules that collide after free flight.
TRIANGLE = np.array([(0, 0, 0), (1, 0, 0), (0, 1.2, 0.1)])
TWO = [TRIANGLE - [15, 0, 0], TRIANGLE + [15, 0.3, 0.2]]
TOWARDS = [(2, 0, 0)] * 3 + [(-2, 0, 0)] * 3


def meeting(eps, pair, run, bodies=TWO, velocities=TOWARDS, before="", words=""):
    settings = dict(style="full", boundary="p p p", box="-30 30 -10 10 -10 10")
    settings |= dict(dt=0.005, thermo=1, columns=f"{NEXT} {LOADS} {LARGEST}", run=run)
    settings["before"] = f"{before}\npair_style {pair}\npair_coeff * * 1.0 1.0"
    fix = f"gear/quat molecule tolerance {eps} {words}"
    return placed(bodies, velocities, fix=fix, **settings)


INSERTED = """
run 100
region in block -5 5 -5 5 -5 5
fix in all deposit 3 0 200 4711 region in near 2.5 mol two rigid move vx 1 1
run 700
"""
