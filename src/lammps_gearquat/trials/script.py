"""What the commands of an input script say: lines, words, fix lines, runs, and what is refused.

Text in, text out; LAMMPS is not needed here.  The rules for continuation, comments and quotes are
those of LAMMPS' manual, "Parsing rules for input scripts".
"""

import re
from dataclasses import dataclass, field, replace


class DeckError(ValueError):
    """A deck that cannot be used, with the reason and what would help."""


# --- lines and words ----------------------------------------------------------------------------
def logical_lines(text):
    """Lines of a script, with those ended by & or inside triple quotes joined."""
    lines, current = [], ""
    for line in text.split("\n"):
        current += line.rstrip()
        if current.endswith("&"):
            current = current[:-1]
        elif current.count('"""') % 2:
            current += "\n"
        else:
            lines.append(current)
            current = ""
    if current.strip():
        lines.append(current)
    return lines


_QUOTED = r'""".*?"""|"[^"]*"|\'[^\']*\''


def strip_comment(line):
    """The line up to a # that is not in quotes."""
    return re.match(rf"(?:{_QUOTED}|[^#])*", line, re.DOTALL).group()


def split(line):
    """Words of a line without comment; quoted text is one word, its quotes removed."""
    words = []
    for word in re.findall(rf"{_QUOTED}|\S+", line, re.DOTALL):
        for quote in ('"""', '"', "'"):
            if word.startswith(quote) and word.endswith(quote) and len(word) >= 2 * len(quote):
                word = word[len(quote) : -len(quote)]
                break
        words.append(word)
    return words


def quote(text):
    """Text in quotes that it does not contain, as one word for LAMMPS."""
    for mark in ('"', "'"):
        if mark not in text:
            return mark + text + mark
    if '"""' not in text:
        return f'"""{text} """'  # the blank keeps a last quote apart
    raise DeckError(f"cannot be quoted: {text}")


def branches(words):
    """Branches of an if command: list of (condition, commands); the condition of else is None."""
    if len(words) < 4 or words[2] != "then":
        raise DeckError(f"not an if command: {' '.join(words)}")
    found = [(words[1], [])]
    rest = iter(words[3:])
    for word in rest:
        if word == "elif":
            found.append((next(rest, ""), []))
        elif word == "else":
            found.append((None, []))
        else:
            found[-1][1].append(word)
    return found


# --- the run ------------------------------------------------------------------------------------
def run_steps(words, now=0):
    """Number of steps of a run command at time step ``now``."""
    try:
        steps = int(float(words[1]))
    except (IndexError, ValueError):
        raise DeckError(f"not a run command: {' '.join(words)}") from None
    if "upto" in words:
        steps -= now
    if {"start", "stop"} & set(words):
        raise DeckError(
            "run ... start or stop: the trials are of runs that begin and end by themselves"
        )
    if "every" in words:
        for command in words[words.index("every") + 2 :]:
            name = (split(command) or ["NULL"])[0]
            if name not in ("NULL", "print"):
                raise DeckError(
                    f"run ... every executes '{command}' while the bodies move: the trials cannot;"
                    " give a deck whose run has no such command"
                )
    return steps


# --- the fix that moves the bodies --------------------------------------------------------------
RIGID = ("rigid", "rigid/nve", "rigid/small", "rigid/nve/small")
_SUFFIX = re.compile(r"/(omp|opt|intel|gpu|kk)$")
#: keywords of fix rigid and how many words follow each
_RIGID_KEYWORDS = {"force": 4, "torque": 4, "langevin": 4, "temp": 3, "iso": 3, "aniso": 3}
_RIGID_KEYWORDS |= {"x": 3, "y": 3, "z": 3, "couple": 1, "tparam": 3, "pchain": 1, "dilate": 1}
_RIGID_KEYWORDS |= {"infile": 1, "reinit": 1, "mol": 1, "gravity": 1}
#: keywords of fix gear/quat that say how bodies are integrated, not what they are
NUMERICAL = ("formulation", "values", "passes", "compensate", "start", "c0", "omega", "momentum")
NUMERICAL += ("project",)
_OF_ONE_FORMULATION = ("values", "c0", "omega", "momentum")
_REFUSED_KEYWORDS = {
    "langevin": "its forces are random, so there is no trajectory to compare: leave it"
    " out, or measure another run with --run N",
    "gravity": "fix gear/quat takes the forces on the atoms: leave out both this keyword and the"
    " disable of fix gravity, which is the same for point particles",
    "force": "fix gear/quat cannot switch off components of a force",
    "torque": "fix gear/quat cannot switch off components of a torque",
}


def base_style(style):
    """A style without the suffix of an accelerator package."""
    return _SUFFIX.sub("", style)


@dataclass(frozen=True)
class FixLine:
    """A fix that moves rigid bodies: ``fix ID group style bodystyle keywords``.

    ``body`` is the bodystyle with its arguments; ``keywords`` maps a keyword to its arguments (for
    force and torque, which may be repeated, to those of all of them).
    """

    id: str
    group: str
    style: str
    body: tuple
    keywords: dict = field(default_factory=dict)

    def text(self):
        """The command."""
        words = ["fix", self.id, self.group, self.style, *self.body]
        for key, values in self.keywords.items():
            words += [key, *values]
        return " ".join(words)

    def with_numerics(self, text):
        """This line with the keywords in ``text`` instead of all those of NUMERICAL.

        Raises DeckError for text that is not pairs of a keyword and a value.
        """
        kept = {key: values for key, values in self.keywords.items() if key not in NUMERICAL}
        return replace(self, keywords=pairs(text) | kept)

    def numerics(self, text):
        """The NUMERICAL keywords of this line as text, changed by those in ``text``.

        What belongs to the other formulation only goes with a change of formulation.
        """
        own = {key: values for key, values in self.keywords.items() if key in NUMERICAL}
        new = pairs(text)
        if new.get("formulation", own.get("formulation")) != own.get("formulation"):
            own = {key: own[key] for key in own if key not in _OF_ONE_FORMULATION}
        return " ".join(f"{key} {values[0]}" for key, values in (own | new).items())


def pairs(text):
    """Keywords of fix gear/quat in ``text``: dictionary keyword -> (value,)."""
    words = text.split()
    unknown = [word for word in words[::2] if word not in NUMERICAL]
    if len(words) % 2 or unknown:
        raise DeckError(
            f"'{text}' should be pairs of a keyword ({', '.join(NUMERICAL)}) and its value"
        )
    return {key: (value,) for key, value in zip(words[::2], words[1::2])}


def moves_bodies(style):
    """Whether a fix of this style moves rigid bodies, by whatever method."""
    return style == "gear/quat" or base_style(style).split("/")[0] == "rigid"


def parse_fix(words):
    """FixLine of the words of a fix command for which ``moves_bodies`` holds."""
    id_, group, style, *rest = words[1:]
    length = {"single": 1, "molecule": 1, "custom": 2}.get(rest[0] if rest else "", 0)
    if rest and rest[0] == "group" and len(rest) > 1 and rest[1].isdigit():
        length = 2 + int(rest[1])
    if not length or len(rest) < length:
        raise DeckError(f"fix {id_} {style}: cannot make out which bodies: {' '.join(rest)}")
    keywords, rest, body = {}, rest[length:], tuple(rest[:length])
    while rest:
        key = rest[0]
        if style != "gear/quat" and key not in _RIGID_KEYWORDS:
            raise DeckError(f"fix {id_} {style}: unknown keyword {key}")
        count = 1 if style == "gear/quat" else _RIGID_KEYWORDS[key]
        if len(rest) <= count:
            raise DeckError(f"fix {id_} {style}: keyword {key} lacks its arguments")
        keywords[key] = (*keywords.get(key, ()), *rest[1 : count + 1])
        rest = rest[count + 1 :]
    return FixLine(id_, group, style, body, keywords)


def translate(line):
    """The same bodies for fix gear/quat: (FixLine without NUMERICAL keywords, notes).

    Raises DeckError for what fix gear/quat does not have.
    """
    if line.style == "gear/quat":
        return line.with_numerics(""), []
    style, who, notes = base_style(line.style), f"fix {line.id} {line.style}", []
    if style not in RIGID:
        raise DeckError(
            f"{who}: fix gear/quat has no thermostat or barostat, and no other motion to compare"
            f" with; the deck has to use one of {', '.join(RIGID)}"
        )
    kept = {}
    for key, values in line.keywords.items():
        if key in ("infile", "reinit"):
            kept[key] = values
        elif key in ("force", "torque") and not {"off"} & set(values):
            notes.append(f"{who}: keyword {key}, all on, is left out")
        elif key in _REFUSED_KEYWORDS:
            raise DeckError(f"{who}, keyword {key}: {_REFUSED_KEYWORDS[key]}")
        elif key == "mol":
            notes.append(f"{who}: keyword mol is left out; no atoms are added in the trials")
        else:
            raise DeckError(f"{who}, keyword {key}: fix gear/quat has no thermostat or barostat")
    return replace(line, style="gear/quat", keywords=kept), notes


# --- what leaves no trajectory to compare ---------------------------------------------------------
_RANDOM = "its forces are random, so there is no trajectory to compare"
_ATOMS = "it adds, removes or swaps atoms, so there is no trajectory to compare"
_STEPS = "it acts once in so many steps, so the motion changes with the time step"
_BOX = "it changes the box, which fix gear/quat does not allow"
_UNUSABLE = (
    (r"langevin.*|.*/langevin|brownian.*|bd/.*|gld|gle|temp/cs.*|srd|lb/.*|ttm.*|tfmc", _RANDOM),
    (r"shardlow|.*/dpd|dpd/.*|qtb|qbmsst|pimd.*|propel/self/.*|addtorque/random", _RANDOM),
    (r"deposit|pour|evaporate|gcmc|widom|sgcmc|.*/swap|bond/(break|create|react).*", _ATOMS),
    (r"charge/regulation|append/atoms|rigid/meso.*|wall/piston", _ATOMS),
    (r"temp/rescale.*|momentum.*|recenter|thermal/conductivity|viscosity|nve/limit", _STEPS),
    (r"dt/reset.*|heat|ehex", "it changes the time step or acts by it"),
    (r"deform.*|npt.*|nph.*|press/.*|box/relax|msst|nphug|.*/(npt|nph)|nvt/sllod", _BOX),
)
_RANDOM_PAIR = re.compile(r"^(dpd|[emt]dpd|brownian)(/|$)")


def why_not(style):
    """Why there is nothing to compare in a scene with a fix of this style; None if there is."""
    for pattern, reason in _UNUSABLE:
        if re.fullmatch(pattern, base_style(style)):
            return reason
    return None


def check_scene(fixes, pair_style):
    """Refuse what has no trajectory: ``fixes`` is a dictionary ID -> style, ``pair_style`` words."""
    faults = []
    for id_, style in fixes.items():
        reason = why_not(style)
        if reason:
            faults.append(f"fix {id_} {style}: {reason}; --without {id_} leaves it out")
    for word in pair_style:
        if _RANDOM_PAIR.match(base_style(word)):
            faults.append(f"pair_style {word}: {_RANDOM}")
    if faults:
        faults.append("(--run N measures a later run of the deck, which may be without)")
        raise DeckError("\n".join(faults))


# --- units ----------------------------------------------------------------------------------------
#: unit of time and of length by LAMMPS' units command
UNITS = {
    "lj": ("", ""),
    "real": ("fs", "Å"),
    "metal": ("ps", "Å"),
    "si": ("s", "m"),
    "cgs": ("s", "cm"),
    "electron": ("fs", "bohr"),
    "micro": ("µs", "µm"),
    "nano": ("ns", "nm"),
}
