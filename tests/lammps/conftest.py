"""Fixtures of most tests of the fix: either formulation, and a box of rigid water."""

from __future__ import annotations

from pathlib import Path

import pytest

from support.scenes import FORMULATIONS, water_data


@pytest.fixture(params=FORMULATIONS)
def formulation(request: pytest.FixtureRequest) -> str:
    return request.param


@pytest.fixture
def fix(formulation: str) -> str:
    """The words of a fix for molecules in each of the formulations."""
    return f"gear/quat molecule formulation {formulation}"


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """27 molecules across all boundaries, in the folder where the test's LAMMPS runs."""
    return water_data(tmp_path / "data.water")
