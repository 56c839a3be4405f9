"""cmake/packaging: what the packages leave in an environment."""

import os
import shutil
import subprocess

import pytest
import yaml
from support.running import ROOT

FOLDER = ROOT / "cmake" / "packaging" / "conda"


@pytest.fixture
def prefix(tmp_path):
    """A conda environment in which the recipe has put its scripts."""
    recipe = yaml.safe_load((FOLDER / "recipe.yaml").read_text())
    (plugin,) = [output for output in recipe["outputs"] if output["package"]["name"] == "lammps-gearquat"]
    (scripts,) = [line for line in plugin["build"]["script"] if "activate" in line]
    folders = {"PREFIX": tmp_path, "SP_DIR": tmp_path / "site-packages", "RECIPE_DIR": FOLDER}
    subprocess.run(["bash", "-ec", scripts], env={**os.environ, **folders}, check=True)
    return tmp_path


@pytest.mark.parametrize("shell", ["bash", "sh"])
@pytest.mark.parametrize("before", [None, "/a", "/a:/b c"])
def test_a_conda_environment_that_is_left_leaves_nothing_behind(prefix, shell, before):
    """Activated and left twice; in the second round another package has put its folder before ours."""
    ours = f"{prefix}/site-packages/lammps_gearquat"
    code = """
    set -eu
    show() { echo "${LAMMPS_PLUGIN_PATH-unset}"; }
    for other in "" /other:; do
      . "$1/etc/conda/activate.d/lammps-gearquat.sh"
      LAMMPS_PLUGIN_PATH="$other$LAMMPS_PLUGIN_PATH"
      show
      . "$1/etc/conda/deactivate.d/lammps-gearquat.sh"
      show
    done
    . "$1/etc/conda/deactivate.d/lammps-gearquat.sh"
    show
    """
    environment = {name: value for name, value in os.environ.items() if name != "LAMMPS_PLUGIN_PATH"}
    if before:
        environment["LAMMPS_PLUGIN_PATH"] = before
    done = subprocess.run([shutil.which(shell), "-c", code, shell, prefix], env=environment, capture_output=True, text=True, check=True)
    rest = f":{before}" if before else ""
    left = f"/other{rest}"
    assert done.stdout.splitlines() == [f"{ours}{rest}", before or "unset", f"/other:{ours}{rest}", left, left]
    assert done.stderr == ""
