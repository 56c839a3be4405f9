"""The methods that are tried beside the deck's own fix, and their names."""

from .. import keywords

#: no keyword about integration: whatever the fix chooses by itself
DEFAULT = ""
#: formulation -> numbers of values; fewer follow forces that change quickly, more are better where all is smooth
VALUES = {"second": (9, 7, 5, 11), "first": (8, 6, 4)}


def methods():
    """Keywords of all methods, the default of the fix first; methods equal to the default are omitted."""
    formulation, number = (keywords.table()[name].standard() for name in ("formulation", "values"))
    # "9 (second), 8 (first)"
    repeated = {f"formulation {formulation} values {words.split()[0]}" for words in number.split(", ") if formulation in words}
    stated = [f"formulation {name} values {n}" for name, numbers in VALUES.items() for n in numbers]
    return (DEFAULT, *(text for text in stated if text not in repeated))


def stated(method):
    """A method in a table: the keywords, or words where there are none."""
    return "the deck's own" if method is None else method or "no keyword"


def named(method):
    """A method in words: keywords of fix gear/quat, or None for the deck's own fix."""
    return "your fix" if method is None else f"gear/quat {method or '(no keyword)'}"
