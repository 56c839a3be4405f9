"""GEARQUAT as one of LAMMPS' packages: way (b) of the page about installing, by CMake and by the traditional make.

These tests build LAMMPS without optimization, which takes minutes each; `tests/run installation` runs them.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from support.running import OPEN_MPI_ENVIRONMENT, OPEN_MPI_LAUNCHER, ROOT, Lammps, make_lmp_tree, tree_source
from shell import CORES, do
from support.thrown_body import DECK, assert_thrown, build_plugin

INSTALL = (ROOT / "doc" / "install.md").read_text()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """The folders of the page: this repository in ``gearquat``, a LAMMPS tree in ``lammps``."""
    (tmp_path / "gearquat").symlink_to(ROOT)
    source, tree = tree_source(), tmp_path / "lammps"
    tree.mkdir()
    for part in source.iterdir():
        if part.name in ("src", "cmake"):  # the edited file
            shutil.copytree(part, tree / part.name)
        else:
            (tree / part.name).symlink_to(part)
    return tmp_path


def way_b() -> str:
    """The lines of the page for a LAMMPS tree with one line added."""
    return re.search(r"^\*\*\(b\)[^*].*?\n\n((?:    [^\n]*\n)+)", INSTALL, re.M | re.S)[1]


def test_cmake_with_one_line_added(folder):
    lines = way_b()
    assert "-D PKG_GEARQUAT=on" in lines and "STANDARD_PACKAGES" in lines and lines.count("\n") == 4
    settings = {
        "CXXFLAGS": "-O0",
        "CMAKE_CXX_COMPILER_LAUNCHER": "ccache",
        "CMAKE_GENERATOR": "Ninja",
        "CMAKE_BUILD_PARALLEL_LEVEL": CORES,
    }
    told = do(folder, lines, **settings)
    assert re.search(r"Enabled packages:\s+GEARQUAT$", told, re.M)
    executable = folder / "build" / "lmp"
    lmp = Lammps("cmake", executable, OPEN_MPI_LAUNCHER, folder, OPEN_MPI_ENVIRONMENT)
    for ranks in (1, 2):
        assert_thrown(lmp.run(DECK.format(load=""), ranks=ranks))
    # one way at a time
    both = "cmake -S lammps/cmake -B both -D CMAKE_PROJECT_lammps_INCLUDE="
    with pytest.raises(AssertionError, match=r"tree\s+has\s+a\s+copy"):
        do(folder, f"{both}$PWD/gearquat/cmake/lammps-gearquat.cmake", **settings)


def test_traditional_make(folder):
    assert "`cd lammps/src; make yes-gearquat; make mpi`" in INSTALL
    sources = folder / "lammps" / "src"
    do(folder, "cp -r gearquat/src/GEARQUAT lammps/src/ && cd lammps/src && make yes-gearquat")
    # serial: the same Makefile with LAMMPS' own replacement of MPI
    do(sources, f"make -j {CORES} serial CC='ccache g++' CCFLAGS=-O0")
    lmp = Lammps("make", sources / "lmp_serial", [], folder)
    assert_thrown(lmp.run(DECK.format(load="")))
    do(sources, "make no-gearquat")
    assert [path for path in sources.iterdir() if "gear_quat" in path.name] == []


def test_a_plugin_for_a_tree_runs_in_the_tree(tmp_path):
    load = f"plugin load {build_plugin('tree', 'all') / 'gearquatplugin.so'}"
    lmp = make_lmp_tree(tmp_path)
    builtin, loaded = (lmp.succeed(DECK.format(load=command), ranks=2) for command in ("", load))
    assert "Overriding built-in fix style gear/quat from plugin" in loaded.output
    assert loaded.thermo == builtin.thermo


def test_a_plugin_compiles_without_mpi_and_with_big_integers():
    build_plugin("serial", "all")
