"""Valid and invalid files for the keyword infile."""

import numpy as np

from . import tokens
from .arguments import FILES as _FILES
from .arguments import SETUP

FILES = {"molecule.two": _FILES["molecule.two"]}
SETUP = SETUP + "group three id 1 4\n"
BOX = 20.0
#: body -> positions of its atoms; `single` and `group 2 left right` number them the same way or merge them
ATOMS = {
    "1": np.array([[0, 0, 0], [1, 0, 0], [0, 1.2, 0.1]]),
    "2": np.array([[5, 5, 5], [6, 5, 5], [5, 6.2, 5.1]]),
}
NAMED = "bod"
STYLES = ("molecule", "molecule formulation first", "group 2 left right")

POOL = "0 1 2 3 4 5 7 0.5 1.5 3.0 -1 -3 1e-3 1e3 1e10 -1e10 1e100 -1e100 1e300 -1e300 511 512 -512 20 -20".split()


def body_line(rng, body):
    """Words that state a body in any pose, with the inertia of random masses."""
    masses = [10.0 ** rng.uniform(-1, 1) for _ in range(rng.choice((1, 2, 3, 5)))]
    arms = np.array([[rng.gauss(0, 1) for _ in range(3)] for _ in masses])
    if rng.random() < 0.2:
        arms[:, 2] = 0.0  # flat
    arms -= np.array(masses) @ arms / sum(masses)
    tensor = sum(m * (a @ a * np.eye(3) - np.outer(a, a)) for m, a in zip(masses, arms))
    tensor = np.where(np.abs(tensor) < 1e-12, 0.0, tensor)  # for a point, or for a flat body
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


def draw(rng):
    """An input: commands for LAMMPS, and the file `bodies`."""
    return f"fix move all gear/quat {rng.choice(STYLES)} infile bodies", make(rng)
