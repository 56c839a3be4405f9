"""The commands of an input script: lines, words, fix lines, runs, and refusals.

Text in, text out; from LAMMPS only the list of the fix's keywords is requested.  Continuation, comments and quotes
follow LAMMPS' manual, "Parsing rules for input scripts".
"""

import re
from dataclasses import dataclass, replace

from .. import keywords


class DeckError(ValueError):
    """A deck that cannot be used, with the reason and a remedy."""


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
    words = re.findall(rf"{_QUOTED}|\S+", line, re.DOTALL)
    return [re.sub(r"""\A("{3}|"|')(.*)\1\Z""", r"\2", word, flags=re.DOTALL) for word in words]


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
    parts = [(words[1], [])]
    rest = iter(words[3:])
    for word in rest:
        if word == "elif":
            parts.append((next(rest, ""), []))
        elif word == "else":
            parts.append((None, []))
        else:
            parts[-1][1].append(word)
    return parts


def file_name(word):
    """A file of a deck as one name without folders; * and % stay."""
    return word.replace("/", "_")


def with_file(line, path):
    """A command whose first argument is a file, with another file."""
    command = re.match(rf"(\s*\S+\s+)(?:{_QUOTED}|\S+)(.*)", line, re.DOTALL)
    return f"{command[1]}{quote(str(path))}{command[2]}"


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
        raise DeckError("run ... start or stop: only runs without these keywords can be measured")
    if "every" in words:
        for command in words[words.index("every") + 2 :]:
            name = (split(command) or ["NULL"])[0]
            if name not in ("NULL", "print"):
                raise DeckError(
                    f"run ... every executes '{command}' while the bodies move, which the trials cannot do;"
                    " use a deck whose run has no such command"
                )
    return steps


# --- the fix that moves the bodies --------------------------------------------------------------
RIGID = ("rigid", "rigid/nve", "rigid/small", "rigid/nve/small")
#: styles with a thermostat, a barostat or both
RIGID_NH = tuple(f"rigid/{ensemble}{small}" for ensemble in ("nvt", "npt", "nph") for small in ("", "/small"))
#: length of their chains if tparam or pchain does not say it
_CHAIN = "10"
#: keywords that set a pressure
PRESSURES = ("iso", "aniso", "x", "y", "z")
_SUFFIX = re.compile(r"/(omp|opt|intel|gpu|kk)$")
#: keywords that may be given many times, and how many words follow each
MASKS = ("force", "torque")
_MASK_WORDS = 4
#: keywords of the rigid fixes and how many words follow each
RIGID_KEYWORDS = dict.fromkeys(MASKS, _MASK_WORDS) | {"langevin": 4}
RIGID_KEYWORDS |= dict.fromkeys(("temp", *PRESSURES, "tparam"), 3)
RIGID_KEYWORDS |= dict.fromkeys(("couple", "pchain", "dilate", "infile", "reinit", "mol"), 1)
RIGID_KEYWORDS |= {"gravity": 1}
#: subjects of the keywords of fix gear/quat that define bodies and equations of motion
_PHYSICAL = ("bodies", "physics")
_REFUSED_KEYWORDS = {
    "gravity": "fix gear/quat takes the forces on the atoms: leave out both this keyword and the"
    " disable of fix gravity, which is the same for point particles",
}
_LEFT_OUT = {
    "mol": "no atoms are added in the trials",
    "couple": "it acts with a barostat only",
    "dilate": "it acts with a barostat only",
}


def base_style(style):
    """A style without the suffix of an accelerator package."""
    return _SUFFIX.sub("", style)


def _plain(word):
    """A word in the form of a script, in quotes if necessary."""
    return word if re.fullmatch(r"[^\s\"'#&$]+", word) else quote(word)


@dataclass(frozen=True)
class FixLine:
    """A fix that moves rigid bodies: ``fix ID group style bodystyle keywords``.

    ``body`` is the bodystyle with its arguments; ``keywords`` are pairs of a keyword and its
    arguments, in the order of the line, for force and torque counts.
    """

    id: str
    group: str
    style: str
    body: tuple
    keywords: tuple = ()

    def text(self):
        words = ["fix", self.id, self.group, self.style, *self.body]
        for key, values in self.keywords:
            words += [key, *values]
        return " ".join(map(_plain, words))

    def only(self, *about):
        """This line of fix gear/quat, with only its keywords about these subjects."""
        names = keywords.names(*about)
        return replace(self, keywords=tuple(pair for pair in self.keywords if pair[0] in names))

    @property
    def has_chains(self):
        """True if a thermostat or a box moves with the bodies of this line, of fix gear/quat."""
        return bool({"temp", *PRESSURES, "tri", "xy", "xz", "yz"} & set(dict(self.keywords)))

    @property
    def isokinetic(self):
        """True if the kinetic energy is held constant."""
        return dict(self.keywords).get("isokinetic", ("none",)) != ("none",)

    def takes(self, text):
        """True if the keywords in ``text`` are compatible with the keywords that define bodies and equations of
        motion."""
        (formulation,) = dict(pairs(text)).get("formulation", ("momentum",))
        return formulation == "first" if self.isokinetic else formulation == "momentum" or not self.has_chains

    def with_numerics(self, text):
        """This line with its keywords about integration replaced by ``text``.

        Raises DeckError for text that is not pairs of a keyword and a value, or that this line does not permit.
        """
        if not self.takes(text):
            raise DeckError(
                f"fix {self.id}: '{text}' cannot be tried, because isokinetic belongs to formulation first, and temp and"
                " pressures belong to formulation momentum"
            )
        kept = self.only(*_PHYSICAL)
        return replace(kept, keywords=pairs(text) + kept.keywords)

    def with_tolerance(self, eps):
        """This line with keyword tolerance, an error of ``eps`` as a length, instead of keywords about integration.

        Raises DeckError if its equations of motion do not allow steps of changing length.
        """
        if self.isokinetic or self.has_chains:
            raise DeckError(f"fix {self.id}: keyword tolerance is not tried with a thermostat")
        kept = self.only(*_PHYSICAL)
        return replace(kept, keywords=(("tolerance", (f"{eps:.2g}", "length")), *kept.keywords))


def conserved(lines, partial=False):
    """Energies while these FixLines move the bodies, as formulas of LAMMPS: (conserved, kinetic, commands before them).

    They need no temperature, which LAMMPS refuses if more degrees of freedom are subtracted than counted.  ``partial``:
    the kinetic energy of atoms differs from the kinetic energy of the bodies, and only bodies move.
    """
    own = [line for line in lines if line.style == "gear/quat"]
    heats = [f"f_{line.id}[9]" for line in own if line.isokinetic]  # which ecouple does not include
    commands = [f"fix_modify {line.id} energy yes" for line in own if not line.has_chains]
    *parts, more = kinetic_parts(lines) if partial else ("c_gearquat_ke", ["compute gearquat_ke all ke"])
    kinetic = "+".join(parts)
    return "+".join(["pe", "ecouple", kinetic, *heats]), kinetic, commands + more


def kinetic_parts(lines):
    """Kinetic energies of the bodies that these FixLines move: (formula of translation, of rotation, commands before them)."""
    parts, commands = ([], []), []
    for line in lines:
        for number, kind in enumerate(("ke", "erotate")):
            own = line.style == "gear/quat"
            parts[number].append(f"f_{line.id}[{number + 1}]" if own else f"c_{line.id}_{kind}")
            commands += [] if own else [f"compute {line.id}_{kind} all {kind}/rigid {line.id}"]
    return *map("+".join, parts), commands


def pairs(text):
    """Keywords of fix gear/quat in ``text``: pairs (keyword, (value,))."""
    words, known = text.split(), keywords.names("integration")
    unknown = [word for word in words[::2] if word not in known]
    if len(words) % 2 or unknown:
        raise DeckError(f"'{text}' should be pairs of a keyword ({', '.join(known)}) and its value")
    return tuple((key, (value,)) for key, value in zip(words[::2], words[1::2]))


def moves_bodies(style):
    """True if a fix of this style moves rigid bodies, by any method."""
    return style == "gear/quat" or base_style(style).split("/")[0] == "rigid"


def parse_fix(words):
    """FixLine of the words of a fix command for which ``moves_bodies`` is true."""
    id_, group, style, *rest = words[1:]
    who = f"fix {id_} {style}"
    length = {"single": 1, "molecule": 1, "custom": 2}.get(rest[0] if rest else "", 0)
    if rest and rest[0] == "group" and len(rest) > 1 and rest[1].isdigit():
        length = 2 + int(rest[1])
    if not length or len(rest) < length:
        raise DeckError(f"{who}: cannot determine the bodies: {' '.join(rest)}")
    known, options = RIGID_KEYWORDS, {}
    if style == "gear/quat":
        known = {key: row.arguments for key, row in keywords.table().items()}
        options = {key: row.options for key, row in keywords.table().items()}
    given, rest, body = [], rest[length:], tuple(rest[:length])
    while rest:
        key = rest[0]
        if key not in known:
            before = given[-1][0] if options and given else ""
            takes = f"; {before} takes {keywords.table()[before].values}" if before else ""
            raise DeckError(f"{who}: unknown keyword {key}{takes}")
        if len(rest) <= known[key]:
            raise DeckError(f"{who}: keyword {key} lacks its arguments")
        if key not in MASKS:  # the last keyword counts
            given = [pair for pair in given if pair[0] != key]
        end = known[key] + 1
        if rest[end : end + 1] and rest[end] in options.get(key, ()):
            end += 1
        given.append((key, tuple(rest[1:end])))
        rest = rest[end:]
    return FixLine(id_, group, style, body, tuple(given))


def for_trials(line):
    """The line of a deck in the form used by its trials: (FixLine, notes)."""
    if line.style != "gear/quat":
        return line, []
    kept = line.only("integration", *_PHYSICAL, "output")
    left_out = [key for key, _ in line.keywords if key not in dict(kept.keywords)]
    if not left_out:
        return line, []
    return kept, [
        f"fix {line.id} {line.style}: {', '.join(left_out)} left out, because trials have steps of equal"
        " length"
    ]


def closest(line):
    """The line of fix gear/quat that comes closest to one of RIGID_NH: the same bodies, targets and chains."""
    held = {key: values for key, values in line.keywords if key in ("temp", "tparam", *PRESSURES, "couple", "pchain")}
    rest = tuple((key, values) for key, values in line.keywords if key not in held)
    chain, *_ = held.pop("tparam", (_CHAIN,))
    if "temp" in held:
        held |= {"tchain": (chain,), "thermostat": ("separate",)}
    if set(PRESSURES) & set(held):
        held.setdefault("pchain", (_CHAIN,))
    moved, _ = translate(replace(line, style="rigid", keywords=rest))
    return replace(moved, keywords=moved.keywords + tuple(held.items()))


def translate(line):
    """The same bodies for fix gear/quat: (FixLine with keywords about bodies and physics, notes).

    Raises DeckError for keywords that fix gear/quat does not have.
    """
    if "langevin" in dict(line.keywords):
        raise DeckError(
            f"fix {line.id} {line.style}, keyword langevin: its forces are random, so there is no trajectory to compare:"
            " leave it out, or measure another run with --run N"
        )
    if line.style == "gear/quat":
        return line.only(*_PHYSICAL), []
    style, who, notes = base_style(line.style), f"fix {line.id} {line.style}", []
    if style in RIGID_NH:
        of_box = set(PRESSURES) & set(dict(line.keywords))
        why = "its barostat has other equations" if of_box else "its thermostat counts other degrees of freedom"
        raise DeckError(
            f"{who}: {why} than keyword {min(of_box, default='temp')} of fix gear/quat, so"
            " the two fixes move the bodies differently, and the difference is not an error. Steps and orders at"
            f" constant {'pressure' if of_box else 'temperature'} can be compared in a deck with\n  {closest(line).text()}"
        )
    if style not in RIGID:
        raise DeckError(
            f"{who}: fix gear/quat has no such motion to compare with; the deck has to"
            f" use fix gear/quat or one of {', '.join(RIGID)}"
        )
    kept, stated = [], "infile" in dict(line.keywords)
    for key, values in line.keywords:
        if key in _REFUSED_KEYWORDS:
            raise DeckError(f"{who}, keyword {key}: {_REFUSED_KEYWORDS[key]}")
        if key in ("infile", *MASKS):
            kept.append((key, values))
        elif key == "reinit":
            no = values[0].lower() in ("no", "off", "false", "0")
            if not stated:
                kept.append((key, ("no" if no else "yes",)))
            elif not no:
                notes.append(f"{who}: keyword reinit is left out; bodies of an infile stay as stated")
        elif key in _LEFT_OUT:
            notes.append(f"{who}: keyword {key} is left out; {_LEFT_OUT[key]}")
        else:
            raise DeckError(f"{who}, keyword {key}: this fix has no thermostat or barostat")
    return replace(line, style="gear/quat", keywords=tuple(kept)), notes


# --- what leaves no trajectory to compare ---------------------------------------------------------
_RANDOM = "its forces are random, so the motion has no exact solution"
_ATOMS = "it adds, removes or swaps atoms, so the motion has no exact solution"
_STEPS = "it acts only every few steps, so the motion depends on the time step"
_BOX = "it changes the box, and fix gear/quat does not allow other fixes to do so"
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


def check_scene(fixes, pair_style):
    """Refuse decks without a deterministic trajectory: ``fixes`` is a dictionary ID -> style, ``pair_style`` words."""
    faults = []
    for id_, style in fixes.items():
        reasons = [why for pattern, why in _UNUSABLE if re.fullmatch(pattern, base_style(style))]
        faults += [f"fix {id_} {style}: {why}; --without {id_} leaves it out" for why in reasons[:1]]
    for word in pair_style:
        if _RANDOM_PAIR.match(base_style(word)):
            faults.append(f"pair_style {word}: {_RANDOM}")
    if faults:
        faults.append("(--run N measures a later run of the deck, which may be without)")
        raise DeckError("\n".join(faults))
