"""Instructions of the steps of many scenes, counted by callgrind in one run of LAMMPS.

Instructions are counted only inside ``Verlet::run``, and every set-up of a run begins a new part of the profile, so
the second run of a scene contains only its steps.
"""

import re
import shutil
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from benchmarks.engine.runner import LammpsError, run
from .scenes import write_molecules

INSTALL = "install it by\n  sudo apt-get update && sudo apt-get install -y --no-install-recommends valgrind"
HOOKS = re.compile(r"LAMMPS_NS::FixGearQuat::(initial_integrate|final_integrate|end_of_step)\(")
#: work of the fix for output, before the first step, and once per step for any number of bodies
FIX = re.compile(r"LAMMPS_NS::(FixGearQuat|GearQuat::Step)::")
ASIDE = re.compile(
    r"FixGearQuat::show_bodies\(|GearQuat::Step::start\(|GearQuat::Start::|Comm\w+::forward_comm\(int\)"
    r"|GearQuat::OtherFixes::(watch|take)_\w+\("
)
ADDRESS = re.compile("0x[0-9a-f]+")
FORCES = re.compile(r"LAMMPS_NS::Pair\w+::compute\(int, int\)")


@dataclass(frozen=True)
class Profile:
    """Instructions of one part: ``own`` by function; ``called`` by caller and function, including all nested calls."""

    own: Counter
    called: Counter

    @property
    def fix(self):
        """Instructions in the fix for the bodies in a step."""
        return self.inclusive(HOOKS) - self.inclusive(ASIDE, FIX)

    @property
    def forces(self):
        """Instructions in the pair style."""
        return self.inclusive(FORCES)

    def inclusive(self, pattern, by=re.compile("")):
        """Instructions, including nested calls, of functions that match and whose caller matches ``by``."""
        called = self.called.items()
        return sum(n for (caller, name), n in called if pattern.search(name) and by.search(caller))

    def of(self, pattern):
        """Own instructions of functions whose names match a pattern."""
        return sum(count for name, count in self.own.items() if re.search(pattern, name))


def parse(text):
    """Profile of one part, from callgrind's output without compression of names."""
    own, called = Counter(), Counter()
    function = callee = None
    for line in text.splitlines():
        if line.startswith("fn="):
            function = line[3:]
        elif line.startswith("cfn="):
            callee = line[4:]
        elif callee and re.match(r"[+\-*\d]", line):
            called[function, callee] += int(line.split()[-1])
            callee = None
        elif function and re.match(r"[+\-*\d]", line):
            own[function] += int(line.split()[-1])
    return Profile(own, _without_stubs(called))


def _without_stubs(called):
    """``called`` without the linker's stubs, whose names are addresses, so that functions call each other directly."""
    callees = Counter(caller for caller, _ in called)
    behind = {stub: name for stub, name in called if ADDRESS.fullmatch(stub) and callees[stub] == 1}
    direct = Counter()
    for (caller, name), instructions in called.items():
        if caller not in behind:
            direct[caller, behind.get(name, name)] += instructions
    return direct


def find_valgrind():
    """The program; raises an error with the command to install it if it is missing."""
    program = shutil.which("valgrind")
    if not program:
        raise LammpsError(f"valgrind, which counts instructions, is missing; {INSTALL}")
    return program


def profiled(lmp, deck, folder, variables=None, parts=True):
    """Run a deck under callgrind; ``folder`` then contains its log and profile files.

    ``parts``: a part for each set-up of fix gear/quat.  Raises LammpsError if the run fails.
    """
    folder = folder.resolve()
    for old in folder.glob("callgrind.*"):
        old.unlink()
    command = [
        find_valgrind(),
        "--tool=callgrind",
        "--trace-children=yes",
        "--toggle-collect=LAMMPS_NS::Verlet::run(int)",
        *(["--dump-before=LAMMPS_NS::FixGearQuat::setup(int)"] if parts else []),
        "--compress-strings=no",
        "--compress-pos=no",
        f"--callgrind-out-file={folder}/callgrind.%p",
    ]
    run(deck, folder / "log.count", variables or {}, lmp, before=command)


def whole(folder, deck, variables, lmp):
    """Profile of all steps of a deck, with any fix.  ``folder`` is created for log and profile."""
    folder = Path(folder)
    profiled(lmp, deck, folder, variables, parts=False)
    profiles = [parse(file.read_text(encoding="utf-8")) for file in folder.glob("callgrind.*")]
    return max(profiles, key=lambda profile: profile.own.total())


def _parts(folder):
    """Files of the process that ran the steps, in the order of the parts."""
    files = list(folder.glob("callgrind.*"))
    number = {file: [int(n) for n in file.name.split(".")[1:]] for file in files}
    several = {n[0] for n in number.values() if len(n) > 1}
    if len(several) != 1:
        raise LammpsError(
            "callgrind saw no FixGearQuat::setup(int): the LAMMPS program has no names of functions "
            f"(it was stripped), or no fix gear/quat; see {folder}"
        )
    of_it = [file for file in files if number[file][0] in several]
    return sorted(of_it, key=lambda file: (len(number[file]) == 1, number[file]))


def count(folder, scenes, sides, steps, lmp):
    """Profiles of ``steps`` steps: (scene, side) -> Profile.  Deck, log and profiles are written to ``folder``."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    write_molecules(folder)
    keys = [(scene, side) for scene in scenes for side in sides]
    deck = folder / "in.count"
    text = "clear\n".join(scene.deck(side, steps) for scene, side in keys)
    deck.write_text(text, encoding="utf-8")
    profiled(lmp, deck, folder)
    parts = _parts(folder)
    if len(parts) != 2 * len(keys) + 1:
        raise LammpsError(f"{len(parts)} parts of the profile for {len(keys)} scenes; see {folder}")
    profiles = [parse(file.read_text(encoding="utf-8")) for file in parts[2::2]]
    return dict(zip(keys, profiles))
