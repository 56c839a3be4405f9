"""Argument lines of the fix, made of its keywords and their values, with faults."""

import os
import re
from unittest import mock

from lammps_gearquat import keywords
from support.scenes import TWO_MOLECULES, TWO_SITES

from . import tokens

SETUP = TWO_MOLECULES.partition("{before}")[0].format(boundary="p p p") + """
thermo_modify norm no
group left id 1 2 3
group right id 4 5 6
group most id 1 2 3 4
group nobody empty
fix made all property/atom i_which i_far i_none d_real i2_two 2
set group left i_which -7
set group right i_which 4
set group left i_far -2147483647
set group right i_far 2147483647
set atom 1*6 i_none 3
variable half atom (id>3)*5-2
variable wide atom (id>3)*1.0e12
variable huge atom (id>3)*exp(1000)
variable equal equal 1.0
molecule two molecule.two
molecule heavy molecule.two
"""
FILES = {
    "molecule.two": TWO_SITES,
    "bodies": "1\n1 3.0 0.33 0.4 0.03 1 1 1 0 0 0 0.1 0 0.2 0 0.1 0.3 0 0 0\n",
    "broken": "1\n1 3.0 0.33\n",
    "empty": "",
}

#: a word of every refusal
NAMED = "ERROR"

with mock.patch.dict(os.environ):  # of the LAMMPS in the folder of this Python, for any LAMMPS of the worker
    for name in ("LD_LIBRARY_PATH", "LD_PRELOAD", "PYTHONPATH"):
        os.environ.pop(name, None)
    TABLE = keywords.table()
BODYSTYLES = ("single", "molecule", "molecule", "group 1 all", "group 2 left right", "custom i_which", "custom v_half")
POOL = (
    *TABLE,
    *("on", "off", "*", "1*", "*2", "1*2", "2*1", "3", "1e-10", "1e-3", "0.1", "0"),
    *(value for row in TABLE.values() for value in row.words),
    *(word for row in TABLE.values() for word in row.options),
    *("all", "left", "right", "most", "nobody", "i_which", "i_none", "i_far", "v_half", "v_wide", "v_huge"),
    *("i_nosuch", "d_real", "i_real", "i_two", "i2_two", "v_equal"),
    *("bodies", "broken", "empty", "nosuch", "two"),
    *("single", "molecule", "group", "custom", "1", "2", "3", "8", ""),
)


def values_of(rng, row):
    """Words that may follow a keyword."""
    if row.kind == "word":
        return [rng.choice(row.words)]
    if row.kind == "integer":
        least, most = rng.choice([*row.ranges.values()])
        return [rng.choice(("auto", *2 * [str(rng.randint(least, most))]))]
    if row.kind == "mask":
        return [rng.choice(("1", "*", "1*")), *(rng.choice(("on", "off")) for _ in range(3))]
    if row.kind == "name":
        return [{"infile": "bodies", "mol": "two", "points": "all"}[row.name]]
    number = [rng.choice(("1e-5", "0.1", "1"))] * row.arguments
    return number + (rng.choice(([], [rng.choice(row.options)])) if row.options else [])


def make(rng, faults=(0, 0, 1, 2, 4)):
    """Words after the style of the fix: a few keywords, which can often be used together, and one of these numbers of
    faults."""
    words = rng.choice(BODYSTYLES).split()
    for row in rng.sample([*TABLE.values()], rng.choice((0, 1, 1, 2, 4))):
        words += [row.name, *values_of(rng, row)]
    for _ in range(rng.choice(faults)):
        words = tokens.mutated(rng, words, POOL)
    return words


def quoted(words):
    """As LAMMPS reads them from an input script: each word as it is."""
    plain = re.compile(r"[!-~]+")  # LAMMPS takes some other characters for spaces
    return " ".join(word if plain.fullmatch(word) else f'"{word}"' for word in words)


def draw(rng):
    """An input: commands for LAMMPS, and the file `bodies`."""
    return f"fix move all gear/quat {quoted(make(rng))}", FILES["bodies"]
