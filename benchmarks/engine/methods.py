"""Methods that the studies compare: settings of fix gear/quat, and the rigid fixes of LAMMPS."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colors import to_hex

#: kind -> (colors from light to dark, marker)
_LOOKS = {"second": ("Blues", "o"), "first": ("Oranges", "s"), "rigid": ("Greys", "D")}


@dataclass(frozen=True)
class Method:
    """A method: name in files, name in texts, variables of the decks; ``kind``: formulation or "rigid"."""

    key: str
    label: str
    variables: dict
    kind: str

    def __hash__(self):
        return hash(self.key)

    @property
    def gear(self):
        """True if it is fix gear/quat."""
        return self.kind != "rigid"


#: formulation -> numbers of values for which the fix has tuned coefficients
TUNED = {"second": (4, 5, 6, 7, 8, 9, 10, 11, 12), "first": (3, 4, 5, 6, 7, 8)}


def gear(formulation, values, compensate=False, **more):
    """Fix gear/quat with this number of ``values``; ``more``: variables of the decks, such as passes or c0.

    The coefficients are Gear's if there are no tuned coefficients; with 0 passes the fix repeats passes until they
    converge.
    """
    if more.get("passes") == 0:
        del more["passes"]
    if values not in TUNED.get(formulation, ()):
        more = {"corrector": "gear"} | more
    variables = {"formulation": formulation, "values": values, **more}
    words = [formulation, f"N = {values}"]
    for name, value in more.items():
        words.append(f"{value} pass{'es' * (value > 1)}" if name == "passes" else f"{name} {value}")
    key = "-".join(map(str, variables.values()))
    if compensate:
        key, words = f"{key}-compensated", [*words, "compensated"]
        variables["compensate"] = "yes"
    return Method(key, ", ".join(words), variables, formulation)


def rigid(style, method):
    """A rigid fix of LAMMPS; ``method`` is the variable of the decks that selects the fix."""
    return Method(style.replace("/", "-"), f"fix {style}", {"method": method}, "rigid")


#: defaults of the fix for smooth motion: values of each formulation, and passes
DEFAULT_VALUES, DEFAULT_PASSES = {"second": 9, "first": 8}, 0
#: these defaults, and the defaults of version 0.2, which used Gear's coefficients
DEFAULTS = {f: gear(f, n, passes=DEFAULT_PASSES) for f, n in DEFAULT_VALUES.items()}
GEARS = {f: gear(f, n, passes=2, corrector="gear") for f, n in (("second", 8), ("first", 6))}
#: the fix without a keyword, which chooses the number of values itself
AUTOMATIC = Method("default", "no keyword", {}, "second")


def looks(methods):
    """Method -> color, marker and line: one color for each kind, one shade for each method."""
    styles = {}
    for kind, (colors, marker) in _LOOKS.items():
        members = [method for method in methods if method.kind == kind]
        for method, shade in zip(members, np.linspace(0.45, 0.95, len(members))):
            color = to_hex(matplotlib.colormaps[colors](shade))
            line = "--" if "compensate" in method.variables else "-"
            styles[method] = {"color": color, "marker": marker, "line": line}
    return styles
