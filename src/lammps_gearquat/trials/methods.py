"""The methods that are tried in addition to the fix of the deck, and their names."""

#: no keyword about integration: the fix chooses by itself
DEFAULT = ""
#: fewer values follow forces that change quickly, more values are better for smooth forces
METHODS = (DEFAULT, *(f"values {n}" for n in (9, 7, 5, 11)))
#: of decks with a constant kinetic energy
ISOKINETIC = tuple(f"formulation first values {n}" for n in (6, 5, 4))


def methods(deck):
    """Keywords of the methods for a Deck."""
    return METHODS if deck.takes(DEFAULT) else ISOKINETIC


def stated(method):
    """A method in a table: the keywords, or a description if there are none."""
    return "the deck's own" if method is None else method or "default settings"


def named(method):
    """A method in words: keywords of fix gear/quat, or None for the deck's own fix."""
    return "your fix" if method is None else f"gear/quat {method or '(default settings)'}"
