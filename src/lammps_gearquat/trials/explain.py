"""Causes of LAMMPS' errors that end a trial, and the message for each."""

import re

#: messages of LAMMPS and of the fix if atoms have left the box or are not where their rank expects them
_GONE = re.compile(
    r"Lost atoms|of its (\d+ )?atoms left|has lost some of its atoms|Out of range atoms|atoms? .*missing|Non-numeric (pressure|atom coords)"
)


def explained(message, deck, dt):
    """``message`` of a trial of ``deck`` with step ``dt``, with its cause where that is known."""
    if not _GONE.search(message):
        return message
    said = message.removeprefix("ERROR: ").split("\n")[0]
    fixed = _fixed_boundary(deck)
    if fixed:
        free = " ".join(word.replace("f", "m") for word in fixed.split())
        return (
            f"molecules left the box, whose boundary is fixed: write '{free}' instead of '{fixed}', so that the"
            f" box follows them, or end earlier with --time (LAMMPS: {said})"
        )
    if dt > deck.dt:
        remedy = f"a step of {deck.dt:g} (as in the script) or shorter is required"
    else:
        remedy = f"change the timestep or the positions until lmp -in {deck.path.name} reaches this time"
    return (
        f"atoms moved so far in a step of {dt:g} that LAMMPS lost them: the step is too long for the forces, or"
        f" atoms overlap; {remedy} (LAMMPS: {said})"
    )


def left_the_box(message, deck):
    """True if an error means that bodies left a box with fixed boundaries, so that no step would help."""
    return bool(_GONE.search(message) and _fixed_boundary(deck))


def _fixed_boundary(deck):
    """The command of the deck that makes a boundary fixed, or ""."""
    commands = [command.text.split() for command in deck.start.commands]
    last = next((words for words in reversed(commands) if words[:1] == ["boundary"]), [])
    return " ".join(last) if any("f" in word for word in last[1:]) else ""
