"""Causes of LAMMPS' errors that end a trial, and the message for each."""

import re

from gearquat_analysis.tables import rounded

#: messages of LAMMPS and of the fix if atoms have left the box or are not where their rank expects them
_GONE = re.compile(
    r"Lost atoms|of its (\d+ )?atoms left|has lost some of its atoms|Out of range atoms|atoms? .*missing|Non-numeric (pressure|atom coords)"
)


def explained(message, deck, dt, reached=None):
    """``message`` of a trial of ``deck`` with step ``dt``, with its cause where that is known.

    ``reached``: the time up to which this trial and similar trials ran without an error, None if it is not known.
    """
    if not _GONE.search(message):
        return message
    said = message.removeprefix("ERROR: ").split("\n")[0]
    when = f"after t = {rounded(reached, 4)}, " if reached else ""
    fixed = _fixed_boundary(deck)
    if fixed:
        free = " ".join(word.replace("f", "m") for word in fixed.split())
        # LAMMPS notices an atom outside of the box only some time later
        end = f"before it with --time {rounded(0.9 * reached, 2)}" if reached else "earlier with --time"
        return (
            f"{when}molecules left the box, whose boundary is fixed: write '{free}' instead of '{fixed}', so that the"
            f" box follows them, or end {end} (LAMMPS: {said})"
        )
    if dt > deck.dt:
        remedy = f"a step of {deck.dt:g} (as in the script) or shorter is required"
    else:
        remedy = f"change the timestep or the positions until lmp -in {deck.path.name} reaches this time"
    return (
        f"{when}atoms moved so far in a step of {dt:g} that LAMMPS lost them: the step is too long for the forces, or"
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
