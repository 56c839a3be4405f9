"""Argument lines of the fix: made by a grammar, broken, and judged by that grammar.

Names, values, defaults and what goes with what are those that the fix lists itself, which
test_documentation.py holds the manual to; how words are read and what the scene allows is written
here from doc/src/fix_gear_quat.rst, not from the source.
"""

import math
import os
import re
import sys
from unittest import mock

from lammps_gearquat import keywords

from . import tokens

SETUP = """
units lj
atom_style molecular
atom_modify map array
region box block -10 10 -10 10 -10 10
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 0.0 1.2 0.1
create_atoms 1 single 5.0 5.0 5.0
create_atoms 1 single 6.0 5.0 5.0
create_atoms 1 single 5.0 6.2 5.1
mass 1 1.0
set atom 1*3 mol 1
set atom 4*6 mol 2
velocity all create 1.0 4711 loop geom mom no
pair_style zero 2.0
pair_coeff * *
timestep 0.01
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
    "molecule.two": "two\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n",
    "bodies": "1\n1 3.0 0.33 0.4 0.03 1 1 1 0 0 0 0.1 0 0.2 0 0.1 0.3 0 0 0\n",
    "broken": "1\n1 3.0 0.33\n",
    "empty": "",
}

#: groups of bodies whose energies are measured before, a word of every refusal, errors that may follow, by words of the
#: first hundred letters, after which some releases of LAMMPS cut what Python gets
ALONE, NAMED, PARDONED = {}, "ERROR", ("turns off some components", "have no degrees of freedom", "blow-up in step", "constant pressure", "the box")

GROUPS = {"all": {1, 2, 3, 4, 5, 6}, "left": {1, 2, 3}, "right": {4, 5, 6}, "most": {1, 2, 3, 4}}
GROUPS["nobody"] = set()
APART = ("i_far", "v_wide", "v_huge")  # no integers, or too far apart to be numbered
CUSTOM = ("i_which", "i_none", "v_half")  # integers, and not too far apart
TEMPLATES = ("two", "heavy")
INFILES = ("bodies",)

with mock.patch.dict(os.environ):  # of the LAMMPS beside this Python, whichever the worker has
    for name in ("LD_LIBRARY_PATH", "LD_PRELOAD", "PYTHONPATH"):
        os.environ.pop(name, None)
    TABLE = keywords.table()
WORDS = {key: row.words for key, row in TABLE.items() if row.kind == "word"}
INTEGERS = [key for key, row in TABLE.items() if row.kind == "integer"]
NUMBERS = [key for key, row in TABLE.items() if row.kind == "number"]
SEVERAL = [key for key, row in TABLE.items() if row.kind == "numbers"]
MASKS = [key for key, row in TABLE.items() if row.kind == "mask"]  # any number of times
PRESSURES = ("iso", "aniso", "tri", "x", "y", "z", "xy", "xz", "yz")
PRESSED = (*PRESSURES, "couple", "pchain", "ptemp", "fixedpoint", "flip", "dilate")
POOL = (
    *TABLE,
    *("on", "off", "*", "1*", "*2", "1*2", "2*1", "3", "1e-10", "1e-3", "0.1", "0"),
    *(value for values in WORDS.values() for value in values),
    *(word for row in TABLE.values() for word in row.options),
    *GROUPS,
    *CUSTOM,
    *APART,
    *("i_nosuch", "d_real", "i_real", "i_two", "i2_two", "v_equal"),
    *("bodies", "broken", "empty", "nosuch", "two"),
    *("single", "molecule", "group", "custom", "1", "2", "3", "8", ""),
)


# --- the grammar ----------------------------------------------------------------------------------
def as_read(word):
    """With the sign that LAMMPS takes for what it looks like."""
    return word.replace("\u2212", "-")


def integer(word):
    """The integer that a word is for LAMMPS, or None."""
    number = tokens.integer(as_read(word))
    return None if number is None or abs(number) > 2**31 - 1 else number


def positive(word):
    """The positive number that a word is for LAMMPS, or None."""
    number = tokens.real(as_read(word))
    return None if number is None or number <= 0.0 else number


def bodystyle(words):
    """How many words say which bodies there are, and how many there are; None if they do not say."""
    style = words[0] if words else None
    if style in ("single", "molecule"):
        return 1, 1 if style == "single" else 2
    if style == "custom":
        bodies = 1 if words[1:2] == ["i_none"] else 2
        return (2, bodies) if len(words) > 1 and words[1] in CUSTOM else None
    if style == "group":
        count = integer(words[1]) if len(words) > 1 else None
        if count is None or not 0 < count <= len(words) - 2:
            return None
        names = words[2 : 2 + count]
        if any(name not in GROUPS for name in names):
            return None
        atoms = [atom for name in names for atom in GROUPS[name]]
        if not all(GROUPS[name] for name in names) or len(atoms) != len(set(atoms)):
            return None
        return 2 + count, count
    return None


def keywords_of(words):
    """Pairs of a keyword and the words behind it, or None if there is no way to read them so."""
    pairs, at = [], 0
    while at < len(words):
        row = TABLE.get(words[at])
        end = at + 1 + (row.arguments if row else 0)
        if row is None or end > len(words):
            return None
        if words[end : end + 1] and words[end] in row.options:
            end += 1
            end += bool(words[end : end + 1]) and positive(words[end]) is not None  # its unit
        pairs.append((row.name, words[at + 1 : end]))
        at = end
    return pairs


def is_mask(words, bodies):
    """Whether words say which components act on which of so many bodies."""
    found = re.fullmatch(r"([0-9]*)(\*?)([0-9]*)", words[0])
    if not found or words[0] == "" or any(flag not in ("on", "off") for flag in words[1:]):
        return False
    low, star, high = found.groups()
    first = int((low or "1")[:30])
    last = int((high or str(bodies))[:30]) if star else first
    return 1 <= first <= last <= bodies


def in_use(key, given, value=""):
    """Whether a keyword has a value, given or by default, or with an empty one any but none."""
    present = given.get(key, TABLE[key].standard("tolerance" in given) if key in WORDS else "")
    return present == value if value else present not in ("", "none")


def agrees(key, given):
    """Whether a keyword that was given may be used with all others; bodystyle is among these."""
    if not in_use(key, given):
        return True
    for other, value, own in TABLE[key].requires:
        if not in_use(key, given, own):
            continue
        if given["bodystyle"] != value if other == "bodystyle" else not in_use(other, given, value):
            return False
    return not any(
        in_use(key, given, own) and other in given and in_use(other, given)
        for other, _, own in TABLE[key].excludes
    )


def has_coefficients(given):
    """Whether there are coefficients for the number of values."""
    formulation = given.get("formulation", TABLE["formulation"].default)
    values = given.get("values", "auto")
    tuned = values == "auto" or integer(values) in TABLE["values"].tuned[formulation]
    return tuned or in_use("corrector", given, "gear")


def bounds(key, given):
    """Least and largest integer of a keyword."""
    ranges, limit = TABLE[key].ranges, re.search(r"at most (\d+) .tolerance.", TABLE[key].values)
    formulation = given.get("formulation", TABLE["formulation"].default)
    least, most = ranges.get("") or ranges[formulation]
    return least, min(most, int(limit[1])) if limit and "tolerance" in given else most


def is_count(key, given):
    """Whether an integer within its bounds follows the keyword, or auto where the fix may choose."""
    (least, most), number = bounds(key, given), integer(given[key])
    if given[key] == "auto" and TABLE[key].values.startswith("auto or "):
        return True
    return number is not None and least <= number <= most


def allowed(key, words):
    """Whether the words behind a keyword belong to it, in this scene; not of integers and masks."""
    if key in WORDS:
        return words[0] in WORDS[key]
    if key in NUMBERS:
        eps, unit = (positive(word) for word in (words[0], words[2] if len(words) == 3 else "1"))
        return None not in (eps, unit) and sys.float_info.min <= eps * unit < math.inf
    if key in SEVERAL:
        free = 3 if key == "fixedpoint" else 2 if key in PRESSURES else 0  # of any sign
        return all(tokens.real(as_read(word)) is not None for word in words[:free]) and all(
            positive(word) is not None for word in words[free:]
        )
    return words[0] in {"infile": INFILES, "mol": TEMPLATES}[key]


def is_pressed(pairs):
    """Whether the keywords of constant pressure agree with each other, in this scene: an orthogonal periodic box."""
    given = {key: behind for key, behind in pairs if key in PRESSED}
    used = [key for key in PRESSURES if key in given]
    coupled = given.get("couple", ["none"])[0]
    if not used:
        return coupled == "none" and not set(given) - {"couple"}
    whole = [key for key in used if len(key) > 2]
    if (whole and len(used) > 1) or {"tri", "xy", "xz", "yz"} & set(used):
        return False
    if coupled == "none" or whole == ["aniso"]:
        return True
    numbers = [[as_read(word) for word in given.get(axis, ())] for axis in coupled]
    return not whole and all([float(n) for n in one] == [float(n) for n in numbers[0]] for one in numbers)


def is_valid(words):
    """Whether the fix has to accept these words behind its style, in the scene SETUP."""
    found = bodystyle(words)
    if found is None:
        return False
    used, bodies = found
    pairs = keywords_of(words[used:])
    if pairs is None:
        return False
    single = [(key, behind) for key, behind in pairs if key not in MASKS]
    given = {key: behind[0] for key, behind in single}
    if len(given) != len(single):
        return False
    if given.get("formulation", "first") not in WORDS["formulation"]:
        return False
    if not all(allowed(key, behind) for key, behind in single if key not in INTEGERS):
        return False
    if not all(is_count(key, given) for key in INTEGERS if key in given) or not is_pressed(single):
        return False
    if not has_coefficients(given):
        return False
    if {"dtmin", "dtmax"} <= set(given) and positive(given["dtmin"]) > positive(given["dtmax"]):
        return False
    ramped = ("temp", *PRESSURES)
    ends = [{tokens.real(as_read(word)) for word in behind[:2]} for key, behind in single if key in ramped]
    if any(len(one) == 2 for one in ends) and "tolerance" in given:
        return False
    if not all(is_mask(behind, bodies) for key, behind in pairs if key in MASKS):
        return False
    given |= {key: "*" for key, _ in pairs if key in MASKS}
    return all(agrees(key, given | {"bodystyle": words[0]}) for key in given)


# --- inputs ---------------------------------------------------------------------------------------
def bodies_at_random(rng):
    """Words of a bodystyle, mostly right ones."""
    style = rng.choice(("single", "molecule", "molecule", "group", "custom"))
    if style == "group":
        groups = ("1 all", "2 left right", "1 most", "2 nobody left")
        return [style, *rng.choice(groups).split()]
    if style == "custom":
        return [style, rng.choice((*CUSTOM, *CUSTOM, *APART))]
    return [style]


def valid(rng):
    """Words that the fix accepts, but for a few that look so."""
    words = bodies_at_random(rng)
    choices = {key: rng.choice(values) for key, values in WORDS.items()}
    choices |= {key: rng.choice(("1e-5", "0.1", "1")) for key in NUMBERS}
    choices |= {"passes": rng.choice(("auto", "1", "2", "3")), "infile": "bodies", "mol": "two"}
    choices["tolerance"] = rng.choice(("1e-10", "1e-6", "0.01"))
    choices["dtmin"], choices["every/time"] = "1e-5", rng.choice(("0.05", "1"))
    choices["temp"], choices["tchain"] = "1.5 1.5 1.5", str(rng.randint(*bounds("tchain", {})))
    given = {key: value for key, value in choices.items() if rng.random() < 0.35}
    pressed = rng.random() < 0.15
    if not pressed:
        given = {key: value for key, value in given.items() if key not in PRESSED}
    given |= {"iso": "1 -2 1", "couple": "none"} if pressed else {}
    given["formulation"] = choices["formulation"]
    given |= {key: "*" for key in MASKS if rng.random() < 0.2}
    given["bodystyle"] = words[0]
    for key in 2 * [key for key in given if key in TABLE]:  # one may require what goes
        if key in given and not agrees(key, given):
            del given[key]
    if rng.random() < 0.35:
        given["values"] = rng.choice(("auto", *2 * [str(rng.randint(*bounds("values", given)))]))
    if not has_coefficients(given) and rng.random() < 0.9:
        given["corrector"] = "gear"
    if given["formulation"] == TABLE["formulation"].default and rng.random() < 0.65:
        del given["formulation"]
    if "tolerance" in given:
        given["tolerance"] += rng.choice(("", "", " length", " energy", " length 0.1", " energy 1e-3"))
    pairs = [
        [key, *value.split()] for key, value in given.items() if key in TABLE and key not in MASKS
    ]
    for key in (key for key in MASKS if key in given):
        for _ in range(rng.choice((1, 1, 2))):
            flags = [rng.choice(("on", "off")) for _ in range(3)]
            pairs.append([key, rng.choice(("1", "*", "1*")), *flags])
    rng.shuffle(pairs)
    return words + [word for pair in pairs for word in pair]


def make(rng):
    """Words, a fifth of them valid on purpose."""
    words = valid(rng)
    for _ in range(rng.choice((0, 1, 1, 2, 4))):
        words = tokens.mutated(rng, words, POOL)
    return words


def quoted(words):
    """As LAMMPS reads them from an input script: each word as it is."""
    plain = re.compile(r"[!-~]+")  # LAMMPS takes some other characters for spaces
    return " ".join(word if plain.fullmatch(word) else f'"{word}"' for word in words)


def judge(rng):
    """An input: what LAMMPS is told, the file `bodies`, and whether it has to accept them."""
    words = make(rng)
    return f"fix move all gear/quat {quoted(words)}", FILES["bodies"], is_valid(words)
