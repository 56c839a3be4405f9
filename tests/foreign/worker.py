"""Many scenes in one LAMMPS: the requests to a Worker.

A job is a list of lines for LAMMPS.  Lines that begin with @ are for this module:

    @state NAME          note IDs, unwrapped positions and velocities of all atoms
    @probe KIND ID STEPS output of every form that the fix or compute has, STEPS steps after now
    @values NAME         note what the probes have written
    @vector NAME ID SIZE note so many elements of the global vector of a fix
    @thermo NAME KEYWORD note a keyword of thermo output

An error that LAMMPS raises on all ranks ends the job, not the process.
"""

import os
import traceback
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lammps_gearquat.launch import LammpsError, open_library

PROBE, LOG = "probe", Path("log.job")
_lmp = None  # the LAMMPS of this process


@dataclass
class Answer:
    """The data that a job has noted, by name, LAMMPS' error or "", and warnings."""

    noted: dict = field(default_factory=dict)
    error: str = ""
    warnings: list = field(default_factory=list)

    @property
    def first_line(self):
        """First line of the error."""
        return self.error.strip().partition("\n")[0]


def is_abort(error):
    """Whether LAMMPS cannot continue after this error, because the other ranks are not informed of it."""
    return type(error).__name__ == "MPIAbortException"


def state(lmp):
    """Array of a row per atom, sorted by ID: ID, unwrapped position, velocity."""
    count = lmp.get_natoms()

    def gathered(name, kind, columns):
        data = np.ctypeslib.as_array(lmp.gather_concat(name, kind, columns))
        return data.reshape(count, columns).astype(float)

    low, high, xy, yz, xz, _, _ = lmp.extract_box()
    edges = np.array(
        [[high[0] - low[0], 0, 0], [xy, high[1] - low[1], 0], [xz, yz, high[2] - low[2]]]
    )
    ids, x, v = gathered("id", 0, 1), gathered("x", 1, 3), gathered("v", 1, 3)
    rows = np.hstack([ids, x + gathered("image", 0, 3) @ edges, v])
    return rows[np.argsort(rows[:, 0])]


def last_block(rows):
    """The last rows of a file that has "step n" before each n rows."""
    block = []
    while rows:
        count = int(rows[0][1])
        block, rows = rows[1 : count + 1], rows[count + 1 :]
    return block


class Probes:
    """Output commands for every form that a fix or a compute has; the forms are found by trying."""

    _TIME = 'fix {name} all ave/time {steps} 1 {steps} {value} file {name}.txt format " %.16g"'
    _HISTO = (
        "fix {name} all ave/histo {steps} 1 {steps} -1e3 1e3 1 {value} kind local mode vector"
        ' file {name}.txt format " %.16g"'
    )
    _DUMP = "dump {name} all custom {steps} {name}.txt id {value}"
    #: form -> command, text after the value
    FORMS = {
        "scalar": (_TIME, ""),
        "vector": (_TIME, "[*]"),
        "array": (_TIME, "[*] mode vector"),
        "local": (_HISTO, ""),
        "locals": (_HISTO, "[*]"),
        "atom": (_DUMP, ""),
        "atoms": (_DUMP, "[*]"),
    }

    def __init__(self, lmp):
        self.lmp, self.files = lmp, {}

    def attach(self, kind, id_, steps):
        for form, (command, behind) in self.FORMS.items():
            name = f"{PROBE}{len(self.files)}"
            value = f"{kind[0]}_{id_}{behind}"
            try:
                self.lmp.command(command.format(name=name, steps=steps, value=value))
            except Exception as error:
                if is_abort(error):
                    raise
                continue
            if command == self._DUMP:
                self.lmp.command(f"dump_modify {name} sort id format float %.16g first no")
            self.files[f"{id_} {form}"] = Path(f"{name}.txt")

    def values(self):
        """Dictionary form -> array of the last block that was written."""
        found = {}
        for form, path in self.files.items():
            if not path.exists():
                continue
            shape, rows = form.split()[1], []
            for line in path.read_text().splitlines():
                if line.startswith("ITEM: TIMESTEP"):
                    rows = []
                elif not line.startswith(("#", "ITEM")):
                    rows.append([float(word) for word in line.split()])
            if shape.startswith("atom"):
                rows = rows[5:]  # step, number of atoms, bounds
            elif shape == "array":
                rows = last_block(rows)
            elif shape.startswith("local"):
                rows = [row for row in rows if len(row) == 6]
            if not shape.startswith(("atom", "array")):
                rows = rows[-1:]
            width = max(map(len, rows), default=0)
            found[form] = np.array([row + [np.nan] * (width - len(row)) for row in rows])
        return found


def obey(lmp, job):
    """Runs the lines of a job; returns a dictionary of the noted data, and the error that ended it on all ranks.

    Raises LammpsError if only one rank has an error, because the other ranks are not informed and wait.
    """
    noted, probes = {}, Probes(lmp)
    try:
        for line in job:
            words = line.split()
            if words[:1] == ["@state"]:
                noted[words[1]] = state(lmp)
            elif words[:1] == ["@probe"]:
                probes.attach(words[1], words[2], int(words[3]))
            elif words[:1] == ["@values"]:
                noted[words[1]] = probes.values()
            elif words[:1] == ["@vector"]:
                elements = (lmp.extract_fix(words[2], 0, 1, n) for n in range(int(words[3])))
                noted[words[1]] = np.array(list(elements))
            elif words[:1] == ["@thermo"]:
                noted[words[1]] = lmp.get_thermo(words[2])
            else:
                lmp.command(line)
                if line == "clear":
                    probes = Probes(lmp)
    except Exception as raised:
        error = str(raised) or repr(raised)
        if is_abort(raised):
            raise LammpsError(error) from raised
        return noted, error if "ERROR" in error else error + traceback.format_exc()
    return noted, ""


def warnings(log):
    """Lines of a log that warn, or that fix gear/quat has written."""
    text = log.read_text(errors="replace").splitlines() if log.exists() else []
    return [line for line in text if "WARNING" in line or line.startswith("Fix gear/quat")]


def run_job(job, words, folder, tell):
    """Answer of a job in ``folder``, in a LAMMPS with these words of its command line; None on all ranks but one."""
    global _lmp
    os.chdir(folder)
    _lmp = lmp = open_library(words=words) if _lmp is None else _lmp
    for name in lmp.available_ids("variable"):  # the command clear does not remove these
        lmp.command(f"variable {name} delete")
    lmp.command("thermo_modify warn reset")  # LAMMPS would stop printing warnings after a hundred
    lmp.command(f"log {LOG}")
    noted, error = obey(lmp, job)
    lmp.command("log none")
    lmp.command("clear")
    if lmp.extract_setting("world_rank"):
        return None
    answer = Answer(noted, error, warnings(LOG))
    for path in [*Path().glob(f"{PROBE}*.txt"), LOG]:
        path.unlink(missing_ok=True)
    return answer
