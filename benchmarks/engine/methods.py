"""Methods that the studies compare: settings of fix gear/quat, and the rigid fixes of LAMMPS."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colors import to_hex

#: kind -> (colors from light to dark, marker)
_LOOKS = {
    "momentum": ("Blues", "o"),
    "second": ("Greens", "v"),
    "first": ("Oranges", "s"),
    "rigid": ("Greys", "D"),
}


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


def gear(formulation, values, compensate=False, **more):
    """Fix gear/quat with this number of ``values``; ``more``: variables of the decks, such as corrector or c0."""
    variables = {"formulation": formulation, "values": values, **more}
    words = [formulation, f"N = {values}", *(f"{name} {value}" for name, value in more.items())]
    key = "-".join(map(str, variables.values()))
    if compensate:
        key, words = f"{key}-compensated", [*words, "compensated"]
        variables["compensate"] = "yes"
    return Method(key, ", ".join(words), variables, formulation)


def rigid(style, method):
    """A rigid fix of LAMMPS; ``method`` is the variable of the decks that selects the fix."""
    return Method(style.replace("/", "-"), f"fix {style}", {"method": method}, "rigid")


#: formulation -> default number of values, of momentum for slow motion; those of the paper have Gear's coefficients
DEFAULT_VALUES = {"momentum": 9, "second": 8, "first": 6}
DEFAULTS = {formulation: gear(formulation, n) for formulation, n in DEFAULT_VALUES.items()}
#: the fix without a keyword, which chooses the number of values itself
AUTOMATIC = Method("default", "no keyword", {}, "momentum")


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
