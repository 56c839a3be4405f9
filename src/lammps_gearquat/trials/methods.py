"""The methods that are tried in addition to the fix of the deck, and their names."""

from .. import keywords

#: no keyword about integration: the fix chooses by itself
DEFAULT = ""
#: formulation -> numbers of values; fewer values follow forces that change quickly, more values are better for smooth
#: forces
VALUES = {"second": (9, 7, 5, 11), "first": (8, 6, 4)}


def methods():
    """Keywords of all methods, the default of the fix first; methods equal to the default are omitted."""
    formulation, number = (keywords.table()[name].standard() for name in ("formulation", "values"))
    # "9 (second), 8 (first)"
    repeated = {f"formulation {formulation} values {words.split()[0]}" for words in number.split(", ") if formulation in words}
    stated = [f"formulation {name} values {n}" for name, numbers in VALUES.items() for n in numbers]
    return (DEFAULT, *(text for text in stated if text not in repeated))


def stated(method):
    """A method in a table: the keywords, or a description if there are none."""
    return "the deck's own" if method is None else method or "no keyword"


def named(method):
    """A method in words: keywords of fix gear/quat, or None for the deck's own fix."""
    return "your fix" if method is None else f"gear/quat {method or '(no keyword)'}"
