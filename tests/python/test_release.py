"""A number for a release is one number."""

import re
from importlib import metadata

from lammps_gearquat import cli, keywords
from running import ROOT


def numbers():
    """Where the number of this release stands -> what it says."""
    patterns = {
        "pyproject.toml": r'^version = "(.*)"',
        "CHANGELOG.md": r"^## \[([\d.]+)\] - \d{4}-\d\d-\d\d$",
        "CITATION.cff": r"^version: (.*)",
    }
    files = {name: ROOT / name for name in patterns if (ROOT / name).exists()}
    return {
        name: re.search(patterns[name], path.read_text(), re.M)[1] for name, path in files.items()
    }


def test_one_number():
    found = numbers()
    assert {"pyproject.toml", "CHANGELOG.md"} <= set(found)
    assert set(found.values()) == {metadata.version("lammps-gearquat")}


def test_every_command_and_keyword_is_in_the_changelog():
    text = (ROOT / "CHANGELOG.md").read_text()
    first = {"formulation", "start", "project", "c0", "omega", "momentum", "infile", "reinit"}
    words = set(re.findall(r"\w+", text))
    assert set(keywords.table()) - first <= words
    assert set(cli.main.commands) <= words
