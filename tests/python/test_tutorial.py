"""The notebook of the tutorial runs, its liquid obeys equipartition, and the examples of the Python interface work."""

import csv
import doctest
import importlib
import inspect
import os
import re
import sysconfig

import nbformat
import pytest
from nbclient import NotebookClient

from gearquat_analysis import averages
from support.running import MPI_ENVIRONMENT, ROOT

API = (ROOT / "doc" / "api.md").read_text()
MODULES = re.findall(r"^\.\. currentmodule:: (\S+)$", API, re.M)


@pytest.fixture(scope="module")
def tutorial(tmp_path_factory):
    """The folder in which the notebook was run."""
    folder = tmp_path_factory.mktemp("tutorial")
    notebook = nbformat.read(ROOT / "doc" / "tutorial.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs belong to the site, not to the repository"
    path = f"{sysconfig.get_path('scripts')}:{os.environ['PATH']}"
    client = NotebookClient(notebook, timeout=200, resources={"metadata": {"path": folder}})
    client.execute(env={**os.environ, **MPI_ENVIRONMENT, "PATH": path})
    return folder


def test_the_notebook_runs(tutorial):
    with open(tutorial / "gearquat-analyze" / "averages.csv", newline="") as file:
        found = {row["average"]: (float(row["value"]), float(row["standard error"])) for row in csv.DictReader(file)}
    difference, error = found[averages.DIFFERENCE]
    assert abs(difference) < 4 * error < 0.1 * found["temperature of rotation"][0]
    coefficient, error = found["diffusion coefficient"]
    assert abs(coefficient - 2.4e-4) < 1e-4 and error < 0.2 * coefficient  # Å²/fs; temperature differs from run to run
    assert found["correlation time of axis 3, order 1"][0] > found["correlation time of axis 3, order 2"][0]
    for name in ("averages.png", "correlations.png", "totals.png"):
        assert (tutorial / "gearquat-analyze" / name).is_file()


@pytest.mark.filterwarnings("ignore:::MDAnalysis")
@pytest.mark.parametrize("name", MODULES)
def test_examples_of_the_interface(tutorial, monkeypatch, name):
    monkeypatch.chdir(tutorial)
    module = importlib.import_module(name)
    failed, attempted = doctest.testmod(module)
    assert attempted and not failed


def test_every_class_has_an_example():
    """Every function and class is on the page, or is part of an item on the page."""
    listed = set(re.findall(r"^\.\. auto(?:class|function|exception):: (\w+)$", API, re.M))
    for name in MODULES:
        module = importlib.import_module(name)
        for key, thing in vars(module).items():
            if key in listed and inspect.isclass(thing) and thing.__module__ == name:
                assert ">>>" in thing.__doc__, key
                listed.remove(key)
            elif key in listed and inspect.isfunction(thing) and thing.__module__ == name:
                listed.remove(key)
    assert not listed
