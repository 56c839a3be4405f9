"""Repeat one flight of a folder of results, and write it as a dump."""

from ..trials.script import DeckError
from . import flights, store
from .pair import open_pair
from .pool import facts_of


def replay(scene, out, number):
    """Write flight ``number`` of the folder ``out`` as a dump into it; returns a message.

    ``scene``: arguments of ``open_pair``, as for the flights.  Raises DeckError if the folder has no such flight, or
    flights of another deck.
    """
    settings = store.read_settings(out)
    known = {store.number_of(line): line for line in store.read_lines(out)}
    if number not in known:
        raise DeckError(f"{out} has no flight {number}: {_numbers(sorted(known))}")
    _, plan, _ = store.facts_of(settings)
    path = out / f"flight_{number}.dump"
    with open_pair(**scene) as pair:
        store.same_pair(out, settings, facts_of(pair))
        planned = plan.starts(pair, [number])[0]
        flight = flights.judge(pair, number, planned, pair.fly(planned[2], settings["most_steps"], path))
    (then,) = store.parse([known[number]])
    angle = flights.columns([then])["angle"][0]
    return (
        f"Flight {number}, {flight.fate} after {flight.steps} steps, is in {path.resolve()}\n"
        f"Its deflection is {flight.angle:.12g}, and {angle:.12g} in {store.FLIGHTS}."
    )


def _numbers(known):
    """Words about the existing numbers."""
    if not known:
        return "it has none"
    return f"it has {len(known)} flights, with numbers from {known[0]} to {known[-1]}"
