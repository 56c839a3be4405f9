"""Decks of LAMMPS with fix gear/quat in place of a fix of the rigid family: text in, text out.

A deck is followed line by line, as LAMMPS reads it; decks of this kind have no loops around their
bodies.  Besides the fix, conversion changes only the number of steps and the output.
"""

import re
from dataclasses import dataclass, field

from lammps_gearquat.trials import script

RIGID = re.compile(r"^(rigid($|/)|poems$)")
#: fixes whose action depends on chance or on the number of steps; they are left out of comparisons of the motion
_SOME = re.compile(
    r"^(langevin|srd|deposit|pour|gcmc|evaporate|viscosity|temp/.*|momentum.*|hmc|lb/viscous|gld"
    r"|thermal/conductivity|dt/reset|adapt|langevin/drude|balance|print|ave/.*|halt|deform|press/.*)$"
)
_OUTPUT = "dump dump_modify undump restart write_data write_restart log shell".split()


@dataclass
class Line:
    """A command; ``words`` without comment; ``rigid`` if it is a fix of the rigid family."""

    text: str
    words: list
    rigid: bool = False


def lines_of(text):
    """All commands of a deck."""
    found = []
    for line in script.logical_lines(text):
        words = script.split(script.strip_comment(line))
        if words:
            rigid = words[0] == "fix" and len(words) > 3 and bool(RIGID.match(words[3]))
            found.append(Line(line, words, rigid))
    return found


def rigid_lines(text):
    return [line for line in lines_of(text) if line.rigid]


def has_random_forces(text):
    """True if a pair style draws random numbers."""
    return any(
        line.words[0] == "pair_style" and re.search(r"(^|/)\w*dpd", " ".join(line.words[1:]))
        for line in lines_of(text)
    )


def has_lines_or_triangles(text):
    """True if the atom style has lines or triangles."""
    return any(
        line.words[0] == "atom_style" and {"line", "tri"} & set(line.words[1:])
        for line in lines_of(text)
    )


def converted(line):
    """The command with gear/quat in place of the rigid style, all other words kept.

    In rigid/nvt, translation and rotation have separate chains, with ten variables by default; the first number of
    `tparam` is their length.
    """
    words = line.words[4:]
    if "nvt" in line.words[3]:
        at, length = len(words), "10"
        if "tparam" in words:
            at = words.index("tparam")
            length = words[at + 1]
        words = [*words[:at], *words[at + 4 :], "thermostat", "separate", "tchain", length]
    if line.words[3] == "poems" and words[0] == "group":
        words = ["group", str(len(words) - 1), *words[1:]]
    return " ".join(["fix", *line.words[1:3], "gear/quat", *words])


def _shortened(line, most):
    """A run of at most this number of steps, without `every` and `start`."""
    steps = line.words[1]
    steps = steps if "$" in steps else str(min(int(float(steps)), most))
    return f"run {steps}"


def whole(text, most, earlier, ours):
    """The whole deck with short runs; ``ours`` are the numbers of rigid fixes that are converted.

    The last run has ``most`` steps at most, all others ``earlier``.
    """
    found, number, lines = [], 0, lines_of(text)
    last = max((n for n, line in enumerate(lines) if line.words[0] == "run"), default=-1)
    for n, line in enumerate(lines):
        if line.words[0] in _OUTPUT:
            continue
        if line.words[0] == "run":
            found.append(_shortened(line, most if n == last else earlier))
        elif line.rigid:
            found.append(converted(line) if number in ours else line.text)
            number += 1
        else:
            found.append(line.text)
    return "\n".join([*found, ""])


@dataclass
class Segment:
    """The deck up to a run with rigid fix ``number``, and the active commands."""

    before: list = field(default_factory=list)
    run: Line = None
    fixes: dict = field(default_factory=dict)
    rigid: Line = None


def segment(text, number, earlier=200):
    """Segment of the first run after the rigid fix of that number; None if there is none."""
    found, seen = Segment(), -1
    for line in lines_of(text):
        name = line.words[0]
        if name == "fix":
            found.fixes[line.words[1]] = line.words[3]
        elif name == "unfix":
            found.fixes.pop(line.words[1], None)
        if line.rigid:
            seen += 1
            if seen == number:
                found.rigid = line
        if name == "run" and found.rigid:
            if found.rigid.words[1] not in found.fixes:
                return None
            found.run = line
            return found
        if name in _OUTPUT:
            continue
        found.before.append(_shortened(line, earlier) if name == "run" else line.text)
    return None


def trial(text, number, method, divide, steps, first, earlier):
    """The deck up to ``first`` steps of a run with its own fix, then ``steps`` with ``method``.

    ``method`` is "gear" or "rigid"; the time step of the latter run is divided by ``divide``.
    Leaves the state in the file `end`, and where it began in `begin`.
    """
    part = segment(text, number, earlier)
    state = "xu yu zu vx vy vz modify sort id format float %.16g"
    fix = part.rigid
    random = [id_ for id_, style in part.fixes.items() if _SOME.match(style)]
    return "\n".join(
        [
            *part.before,
            _shortened(part.run, first),
            "thermo_style custom step pe",
            *(f"unfix {id_}" for id_ in [*random, fix.words[1]]),
            re.sub(r"\s+langevin(\s+\S+){4}", "", converted(fix) if method == "gear" else fix.text),
            f"timestep $(dt/{divide})",
            f"write_dump all custom begin id {state}",
            "thermo_modify lost error",
            f"run {steps * divide}",
            f"write_dump all custom end id {state}",
            "",
        ]
    )


def with_map(text):
    """The deck with an atom map, made before its box."""
    line = "atom_modify map yes"
    text, count = re.subn(r"^[ \t]*atom_style\b.*", rf"\g<0>\n{line}", text, count=1, flags=re.M)
    return text if count else f"{line}\n{text}"
