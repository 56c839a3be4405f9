"""The folder of results: settings.json, the plan; flights.csv, the finished flights; and joined parts.

An interrupted run continues after the last whole line.  Lines are written in the order of the flights, so an
interruption does not change the file.
"""

import csv
import hashlib
import json
from dataclasses import asdict
from pathlib import Path

from ..trials.script import DeckError
from . import flights
from .pilots import Largest
from .pool import Facts
from .sampling import Plan

#: version of the way in which flights are drawn; settings of releases before 0.4 contain no version
SAMPLING = 2
#: the most gaps between flights that a message names
NAMED = 10
SETTINGS, FLIGHTS, RESULTS = "settings.json", "flights.csv", "results.json"


def settings(facts, plan, largest, most_steps):
    """Settings that determine every flight, ready for JSON."""
    found = {"sampling": SAMPLING, "pair": pair_of(facts), "plan": asdict(plan), "largest": asdict(largest)}
    return json.loads(json.dumps(found | {"most_steps": most_steps}))


def pair_of(facts):
    """Facts, ready for JSON; the commands of the deck as a digest."""
    known = asdict(facts)
    known["text"] = hashlib.sha256("\n".join(facts.text).encode()).hexdigest()
    return json.loads(json.dumps(known))


def facts_of(settings):
    """(Facts, Plan, Largest) of settings."""
    plan = {key: tuple(value) if isinstance(value, list) else value for key, value in settings["plan"].items()}
    return Facts(**settings["pair"]), Plan(**plan), Largest(**settings["largest"])


def read_settings(folder):
    """Settings of a folder of results.  Raises DeckError if it has none, or if they come from a release whose
    flights have another density."""
    path = Path(folder) / SETTINGS
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DeckError(f"{folder}: a folder with results of gearquat scatter is required: {error}") from error
    if not isinstance(found, dict) or found.get("sampling") != SAMPLING:
        raise DeckError(
            f"{folder} has flights of another release of gearquat scatter, which drew impact parameters and energies from"
            " another density, so they cannot be continued, joined or written as a dump; new flights in another --out are"
            " required"
        )
    return found


def write_json(path, value):
    """Write the whole file or nothing."""
    draft = path.with_suffix(".tmp")
    draft.write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    draft.replace(path)


def begin(folder, wanted):
    """Write these settings to ``folder``.  Raises DeckError if it has flights of other settings."""
    folder.mkdir(parents=True, exist_ok=True)
    if (folder / SETTINGS).exists():
        _same(folder, read_settings(folder), wanted)
    write_json(folder / SETTINGS, wanted)


#: descriptions for the user of settings that may differ, by their names in settings.json
WORDS = {
    "pair text": "the commands of the deck",
    "pair name": "the name of the deck",
    "plan seed": "--seed",
    "plan temperature": "--temperature",
    "plan energy": "--energy",
    "plan rotation": "the temperature of rotation",
    "plan largest": "the largest impact parameter",
    "most_steps": "--steps",
}
#: results of pilot flights, which differ if any other setting differs
FOUND = ("plan s0", "plan s1", "plan power")


def _differing(known, wanted):
    """Words for the differences between settings, "" for none."""
    names = [
        f"{part} {name}" if isinstance(wanted[part], dict) else part
        for part in wanted
        for name in (wanted[part] if isinstance(wanted[part], dict) else (part,))
        if _get(known, part, name) != _get(wanted, part, name) and part != "largest"
    ]
    if names and set(names) <= set(FOUND):
        return "the density of impact parameters and energies that pilot flights found"
    # other facts of the bodies differ because the decks differ
    told = [WORDS[name] for name in names if name in WORDS] or names
    return ", ".join(told)


def _same(folder, known, wanted, required="another --out is required"):
    """Raise DeckError if settings differ, and name the differences."""
    differing = _differing(known, wanted)
    if differing:
        raise DeckError(f"{folder} has flights of other settings ({differing}): {required}")


def same_pair(folder, known, facts):
    """Raise DeckError if the flights of ``folder``, with the settings ``known``, do not match the Facts."""
    _same(folder, known, {**known, "pair": pair_of(facts)}, "the same deck is required")


def _get(settings, part, name):
    value = settings.get(part)
    return value.get(name) if isinstance(value, dict) else value


def read_lines(folder):
    """Whole lines of flights.csv, without its header; an incomplete last line is cut off."""
    path = Path(folder) / FLIGHTS
    if not path.exists():
        return []
    data = path.read_bytes()
    whole = data[: data.rfind(b"\n") + 1]
    if len(whole) < len(data):
        path.write_bytes(whole)
    lines = whole.decode("utf-8").splitlines()
    if lines and lines[0] != ",".join(flights.HEADER):
        raise DeckError(f"{path}: its columns do not match gearquat scatter: another --out is required")
    return lines[1:]


def parse(lines):
    """Rows of words of lines."""
    return list(csv.reader(lines))


def number_of(line):
    """Number of the flight of a line."""
    return int(line.partition(",")[0])


class Writer:
    """Appends Flights to flights.csv; use it in a with statement."""

    def __init__(self, folder):
        self.path = folder / FLIGHTS

    def __enter__(self):
        fresh = not self.path.exists() or not self.path.stat().st_size
        self.file = self.path.open("a", newline="", encoding="utf-8")
        self.writer = csv.writer(self.file, lineterminator="\n")
        if fresh:
            self.writer.writerow(flights.HEADER)
        return self

    def __exit__(self, *_):
        self.file.close()

    def append(self, some):
        """Write a list of Flights, and return their rows of words."""
        rows = [flights.row(flight) for flight in some]
        self.writer.writerows(rows)
        self.file.flush()
        return rows


def merge(folders, out):
    """Join the flights of ``folders`` in ``out``; (settings, rows, notes).

    Notes are sentences about flights that are in several parts or in none.  Raises DeckError if parts do not fit
    together.
    """
    wanted, lines, again = read_settings(folders[0]), {}, 0
    for folder in folders:
        differing = _differing(read_settings(folder), wanted)
        if differing:
            raise DeckError(
                f"{folder} has flights of other settings than {folders[0]} ({differing}): parts have to be made with"
                " the same deck and options"
            )
        for line in read_lines(folder):
            number = number_of(line)
            again += number in lines
            if lines.setdefault(number, line) != line:
                raise DeckError(
                    f"{folder}: flight {number} differs from the same flight in another part:"
                    " parts of one run are required"
                )
    begin(out, wanted)
    ordered = [lines[number] for number in sorted(lines)]
    text = "\n".join([",".join(flights.HEADER), *ordered]) + "\n"
    (out / FLIGHTS).write_text(text, encoding="utf-8")
    return wanted, parse(ordered), _notes(sorted(lines), again)


def _notes(numbers, again):
    """Sentences about flights that occur ``again`` in another part, and about flights missing among the sorted
    ``numbers``."""
    notes = [f"Flights that are in several parts are counted once: {again}"] if again else []
    gaps = [(a + 1, b - 1) for a, b in zip([-1, *numbers], numbers) if b > a + 1]
    if gaps:
        named = ", ".join(str(a) if a == b else f"{a} to {b}" for a, b in gaps[:NAMED])
        more = "" if len(gaps) <= NAMED else " and more"
        notes.append(f"Flights that no part has: {named}{more}")
    return notes


def rewrite(folder, known):
    """Write flights.csv with ``known``, number -> row of words, in the order of the flights."""
    path = folder / FLIGHTS
    path.unlink()
    with Writer(folder) as writer:
        writer.writer.writerows(known[number] for number in sorted(known))
