"""Methods that the studies compare: fix gear/quat, and the rigid fixes of LAMMPS."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Method:
    """A method: name in files, name in texts, variables of the decks; ``gear``: whether it is fix gear/quat."""

    key: str
    label: str
    variables: dict
    gear: bool = False

    def __hash__(self):
        return hash(self.key)


def rigid(style, method):
    """A rigid fix of LAMMPS; ``method`` is the variable of the decks that selects the fix."""
    return Method(style.replace("/", "-"), f"fix {style}", {"method": method})


#: the fix without a keyword, which chooses the number of values itself
AUTOMATIC = Method("default", "fix gear/quat", {}, True)
