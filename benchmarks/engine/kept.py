"""Runs that need not be repeated, because their output exists and their input is unchanged.

The input of a run is its deck with the other files of the deck's folder and of ``examples/common``, its
variables, the files named by the variables, the LAMMPS program, and the plugin if the run uses it.
"""

import hashlib
import json
import os
import shutil
from pathlib import Path

import lammps_gearquat

from .decks import EXAMPLES


def fingerprint(job, lmp):
    """Hash of the input of a Job that is run with the LAMMPS program ``lmp``."""
    shared = [*job.deck.parent.iterdir(), *(EXAMPLES / "common").iterdir()]
    files = [file for file in shared if file.is_file() and file.suffix not in (".py", ".pyc")]
    files += [Path(str(value)) for value in job.variables.values()]
    if job.plugin:
        files += [Path(lammps_gearquat.plugin_folder()) / "gearquat.so"]
    digest = hashlib.sha256(repr((job.deck.name, job.variables, job.ranks)).encode())
    for file in sorted(files):
        if os.path.isabs(file) and file.is_file():
            digest.update(file.read_bytes())
    program = os.stat(shutil.which(lmp))
    digest.update(repr((lmp, program.st_size, program.st_mtime_ns)).encode())
    return digest.hexdigest()


class Kept:
    """The record of a run ``name`` with its ``log``, and with its dumps and data in the folder ``dumps``."""

    def __init__(self, log, dumps, name, job, lmp):
        self._log, self._dumps, self._name = log, dumps, name
        self._record = log.with_name(f"kept.{name}.json")
        self._input = fingerprint(job, lmp)

    def error(self):
        """LAMMPS' error in the kept run, "" for none; None if no such run is kept."""
        if not self._record.is_file() or not self._log.is_file():
            return None
        record = json.loads(self._record.read_text(encoding="utf-8"))
        there = all((self._dumps / file).is_file() for file in record["files"])
        return record["error"] if there and record["input"] == self._input else None

    def forget(self):
        """Called before a run: discards the record of an earlier run."""
        self._record.unlink(missing_ok=True)

    def write(self, error):
        """Called after a run that ended by itself, with LAMMPS' ``error`` or "" for none."""
        files = sorted(path.name for path in self._dumps.glob(f"{self._name}.*"))
        record = {"input": self._input, "error": error, "files": files}
        self._record.write_text(json.dumps(record, indent=1), encoding="utf-8")
