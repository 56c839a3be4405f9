"""Files for the keyword infile: made as the manual has them, broken, and judged by rules of their own.

What is here is written from doc/src/fix_gear_quat.rst, not from the source.
"""

import re

import numpy as np

from . import tokens
from .arguments import FILES as _FILES
from .arguments import SETUP

FILES = {"molecule.two": _FILES["molecule.two"]}
SETUP = SETUP + "group three id 1 4\n"
BOX = 20.0
IMAGES = 512
#: body -> positions of its atoms; `single` and `group 2 left right` number them the same way or merge them
ATOMS = {
    "1": np.array([[0, 0, 0], [1, 0, 0], [0, 1.2, 0.1]]),
    "2": np.array([[5, 5, 5], [6, 5, 5], [5, 6.2, 5.1]]),
}
ALONE = {"1": "left", "2": "right"}
NAMED, PARDONED = "bod", ("blow-up in step", "turns with an angular velocity")
STYLES = ("molecule", "molecule formulation first", "group 2 left right")

#: what a rounded tensor may be off by, and what no body has; between them either is right
ROUNDED, REFUSED = 0.5e-3, 2e-3
UNSURE = None
POOL = "0 1 2 3 4 5 7 0.5 1.5 3.0 -1 -3 1e-3 1e3 1e10 -1e10 1e100 -1e100 1e300 -1e300 511 512 -512 20 -20".split()


# --- the rules ------------------------------------------------------------------------------------
def moments_allowed(inertia):
    """Whether a tensor (3, 3) can be that of a body: True, False, or UNSURE near the limits."""
    largest = np.abs(inertia).max()
    if largest == 0.0:
        return True
    if largest > 1e300 or largest < 1e-290:
        return UNSURE  # beyond what can be computed with
    low, middle, high = np.linalg.eigvalsh(inertia / largest)
    worst = min(low, low + middle - high)
    if low < -1e-6 * high or worst < -REFUSED * high:
        return False
    return True if low > -1e-8 * high and worst > -ROUNDED * high else UNSURE


def place_allowed(body, center):
    """Whether atoms can have their centre of mass there, in the same ternary logic."""
    arms = np.linalg.norm(ATOMS[body] - center, axis=1)
    nearest = arms.min()
    if nearest < 0.5 * BOX:
        return True
    return False if nearest > 0.5 * BOX + 4.0 else UNSURE


def tensor_of(words):
    """Inertia (3, 3) of a line of 20 words."""
    xx, yy, zz, xy, xz, yz = map(float, words[5:11])
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def body_allowed(words):
    """Whether a line of 20 words states a body, ternary."""
    numbers = [tokens.real(word) for word in words]
    whole = [tokens.integer(words[at]) for at in (0, 17, 18, 19)]
    if None in numbers or None in whole:
        return False
    if words[0].lstrip("+0") not in ATOMS or numbers[1] <= 0.0:
        return False
    if any(abs(flag) >= IMAGES for flag in whole[1:]) or min(numbers[5:8]) < 0.0:
        return False
    tensor = tensor_of(words)
    center = np.array(numbers[2:5]) + BOX * np.array(whole[1:])
    answers = [moments_allowed(tensor), place_allowed(words[0].lstrip("+0"), center)]
    if False in answers:
        return False
    with np.errstate(all="ignore"):
        spin = np.abs(numbers[14:17]).max() / np.linalg.eigvalsh(tensor).clip(1e-320)
        extreme = np.abs(numbers[1:17]).max() > 1e100 or not spin.max() < 1e100
    return UNSURE if UNSURE in answers or extreme else True


def words_of(text):
    """Words of the lines that have some, without comments."""
    lines = (re.split(r"[ \t\r\f\v]+", line.partition("#")[0]) for line in text.split("\n"))
    lines = ([word for word in words if word] for words in lines)
    return [words for words in lines if words]


def is_valid(text):
    """Whether the fix has to accept a file in the scene SETUP, UNSURE if either is right."""
    lines = words_of(text)
    if not lines or len(lines[0]) != 1 or tokens.integer(lines[0][0]) is None:
        return False
    bodies = lines[1:]
    if tokens.integer(lines[0][0]) != len(bodies) or any(len(words) != 20 for words in bodies):
        return False
    answers = [body_allowed(words) for words in bodies]
    ids = {tokens.integer(words[0]) for words in bodies}
    if False in answers or len(ids) != len(bodies):
        return False
    return UNSURE if UNSURE in answers else True


def energies(text, others):
    """Kinetic energies (2,), of translation and rotation, that a valid file states.

    ``others``: body -> the same of bodies that are not in the file.
    """
    bodies = words_of(text)[1:]
    stated = {words[0].lstrip("+0") for words in bodies}
    translation, rotation = sum((others[body] for body in ATOMS if body not in stated), np.zeros(2))
    for words in bodies:
        velocity, momentum = np.array(words[11:14], float), np.array(words[14:17], float)
        moments, axes = np.linalg.eigh(tensor_of(words))
        turns = moments > 1e-7 * moments.max()
        translation += float(words[1]) * velocity @ velocity / 2
        rotation += ((axes.T @ momentum)[turns] ** 2 / moments[turns]).sum() / 2
    return np.array([translation, rotation])


# --- inputs ---------------------------------------------------------------------------------------
def body_line(rng, body):
    """Words that state a body in any pose, with the inertia of random masses."""
    masses = [10.0 ** rng.uniform(-1, 1) for _ in range(rng.choice((1, 2, 3, 5)))]
    arms = np.array([[rng.gauss(0, 1) for _ in range(3)] for _ in masses])
    if rng.random() < 0.2:
        arms[:, 2] = 0.0  # flat
    arms -= np.array(masses) @ arms / sum(masses)
    tensor = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms))
    tensor = np.where(np.abs(tensor) < 1e-12, 0.0, tensor)  # of a point, or flat
    center = ATOMS[body].mean(axis=0) + [rng.uniform(-0.5, 0.5) for _ in range(3)]
    image = [rng.choice((0, 0, 0, 1, -1)) for _ in range(3)]
    center = center - BOX * np.array(image)
    digits = rng.choice((4, 9, 17))
    numbers = [sum(masses), *center, *np.diag(tensor), *tensor[np.triu_indices(3, 1)]]
    numbers += [rng.gauss(0, 1) for _ in range(6)]
    return [body, *(f"{number:.{digits}g}" for number in numbers), *map(str, image)]


def make(rng):
    """A file's text, a fifth of them valid on purpose, with a few bytes that do not belong."""
    bodies = rng.choice((["1"], ["2"], ["1", "2"], ["2", "1"], []))
    lines = [[str(len(bodies))], *(body_line(rng, body) for body in bodies)]
    for _ in range(rng.choice((0, 1, 1, 2, 4))):
        if rng.random() < 0.15:
            as_words = ["\n".join(words) for words in lines]
            pool = ["\n".join(body_line(rng, "1")), "1", "2", ""]
            lines = [text.split("\n") for text in tokens.mutated(rng, as_words, pool)]
        elif lines:
            at = rng.randrange(len(lines))
            lines[at] = tokens.mutated(rng, lines[at], POOL)
    text = "\n".join(" ".join(words) for words in lines) + rng.choice(("\n", "\n", ""))
    if rng.random() < 0.1:
        text = rng.choice(("# comment\n", "\n\n", "\ufeff", "\r\n")) + text
    if rng.random() < 0.1:
        at = rng.randrange(len(text) + 1)
        alien = rng.choice((*"\0'\"\\#\n\r\t\f\v\x1b", '"""'))
        text = text[:at] + alien + text[at:]
    return text


def judge(rng):
    """An input: what LAMMPS is told, the file `bodies`, and whether it has to be accepted."""
    text = make(rng)
    return f"fix move all gear/quat {rng.choice(STYLES)} infile bodies", text, is_valid(text)
