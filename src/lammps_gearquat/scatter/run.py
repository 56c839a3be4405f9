"""A run of the command: flights until the errors are small enough, and the results as text and in their folder."""

import json
import sys
from dataclasses import asdict

import numpy as np

from gearquat_analysis.tables import aligned, with_error, write_rows

from .. import figures
from ..trials.script import DeckError
from .flights import Flight, Pool, columns, planned
from .integrals import quantities
from .sampling import FIRST, REPLICAS

#: files of results
LEAVES = ("flights.csv", "results.json", "deflection.png")


def scatter(scene, start, error, count, steps, processes, progress):
    """(Facts, Plan, columns of flights): flights until the relative standard errors of the first two quantities are at
    most ``error``, or until twice as many would be more than ``count``; those that have ended after Ctrl-C.

    ``scene``: arguments of ``Pair``; ``start``: seed, temperature, energy and rotation; ``progress``: tqdm's bar.  Raises
    DeckError and LammpsError.
    """
    flights = []
    with Pool(scene, processes) as pool:
        facts, plan = pool.ask(planned, *start)
        try:
            for points in plan.points(facts.dimension):
                progress.reset(len(flights) + len(points))
                progress.update(len(flights))
                for some in pool.fly(plan, len(flights), points, steps):
                    flights += some
                    progress.update(len(some))
                found = columns(flights)
                first = quantities(found, plan, facts)[:2]
                said = ", ".join(f"{one.name} {one.error / abs(one.value):.2g}" for one in first)
                progress.write(f"{len(flights)} flights: relative errors {said}; {error:g} is asked for", file=sys.stderr)
                if all(one.error <= error * abs(one.value) for one in first) or 2 * len(flights) > count:
                    return facts, plan, found
        except KeyboardInterrupt:
            pool.interrupted = True
    if len(flights) < FIRST * REPLICAS:
        raise DeckError(f"interrupted after {len(flights)} flights, too few for an average")
    return facts, plan, columns(flights[: len(flights) // REPLICAS * REPLICAS])


def conclude(folder, name, facts, plan, found):
    """Write the files of a Folder; the results as text."""
    rows = quantities(found, plan, facts)
    folder.fill(lambda text: print(text, file=sys.stderr))
    write_rows(folder.path / "flights.csv", Flight._fields, zip(*found.values()))
    counts = {fate: int(np.count_nonzero(found["fate"] == fate)) for fate in ("parted", "unparted", "lost")}
    plain = {key: value for key, value in vars(plan).items() if np.isscalar(value) or value is None}
    every = {"plan": plain, "quantities": {row.name: asdict(row) for row in rows}, "flights": counts}
    (folder.path / "results.json").write_text(json.dumps(every, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    figures.draw_deflection(folder.path / "deflection.png", name, found, plan, facts.style)
    cells = [[row.name, with_error(row.value, row.error), row.unit, row.about] for row in rows]
    changes = found["error_energy"][found["fate"] == "parted"]
    lines = [
        f"{name}: {len(found['fate'])} flights, of {found['steps'].mean():.0f} steps each",
        aligned(["quantity", "value ± error", "unit", ""], cells),
        f"Change of the energy in a flight, relative: at most {changes.max():.1e}, median {np.median(changes):.1e}",
    ]
    if counts["parted"] < len(found["fate"]):
        lines.append(
            f"{counts['unparted']} flights have not parted within --steps, and LAMMPS ended {counts['lost']}; they count as"
            " isotropic scattering without transfer of energy, and errors include their whole contribution"
        )
        lines += dict.fromkeys(filter(None, found["message"]))
    return "\n".join(lines)
