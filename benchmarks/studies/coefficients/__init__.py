"""Coefficients of the corrector: the search for them, and their properties compared with Gear's coefficients.

search.py and spectral.py (parameters and cost functions), kernel.cpp and kernel.py (motions with the kernel of the fix
and any coefficients), properties.py (model equations and motions), prediction.py (the drift in liquids, from spectra).
The coefficients are in src/GEARQUAT/gear_quat_coefficients.cpp.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.constants import speed_of_light

from benchmarks.engine import Curve, Finding, Measurement, Panel, Study, Table
from benchmarks.engine.methods import DEFAULT_VALUES
from benchmarks.engine.page import markdown_table
from benchmarks.engine.panels import draw, floor

from . import prediction, properties, search, spectral
from .kernel import LOST, VALUES, gear, tuned
from .properties import Flights, Linear, Motions

TUNED, GEAR = "tuned", "Gear's"
#: steps in fs at which drifts are predicted
STEPS = (2.0, 2.5, 3.0, 4.0)
#: omega h, and radians per step, of the picture
RANGE = np.arange(0.06, 1.2001, 0.02)
#: number of values -> color, in the picture: those that the fix chooses, and one more
SHOWN = {DEFAULT_VALUES["momentum"]: "momentum", 7: "translation", 5: "rotation"}
#: approximate wave numbers of the librations of liquid water in 1/cm, and a large step for them
BAND, FEMTOSECONDS = (600, 850), 2.5


@dataclass(frozen=True)
class Results:
    """Dicts with keys (values, TUNED or GEAR), except ``drifts``.

    * ``linear``: Linear; ``motions``: Motions
    * ``curves``, for SHOWN only: see properties.py
    * ``drifts``: (number of values, name of liquid) -> drift at STEPS, in kT/ns/dof
    """

    linear: dict
    motions: dict
    curves: dict
    drifts: dict


def add(results, key, corrector, flights):
    """Add the properties of a Corrector, without its curves, to Results."""
    results.linear[key] = Linear.of(corrector)
    results.motions[key] = Motions.of(corrector, flights)


def measure(lab):
    """Results of all numbers of values, or with --quick of those in the picture."""
    results, flights = Results({}, {}, {}, {}), Flights()
    every = list(SHOWN) if lab.quick else VALUES
    for values in every:
        for name, corrector in ((GEAR, gear(values)), (TUNED, tuned(values))):
            add(results, (values, name), corrector, flights)
            if values in SHOWN:
                results.curves[values, name] = properties.curves(corrector, RANGE)
        if values in SHOWN:
            for liquid, own in prediction.recorded().items():
                results.drifts[values, liquid] = [own.drift(corrector, dt) for dt in STEPS]
        lab.advance(1 / len(every))
    return results


# --- tables ---------------------------------------------------------------------------------------
def cell(value, spec=".1e"):
    """A number as text, "lost" if the motion did not stay finite."""
    return "lost" if abs(value) >= LOST else format(value, spec)


def table(columns, rows):
    """Table of (values, coefficients) -> cells."""
    return Table(("values", "coefficients", *columns), [(*key, *cells) for key, cells in rows.items()])


def tables(results):
    """All tables by name."""
    linear, motions = results.linear, results.motions
    shown = [key for key in linear if key[0] in SHOWN]
    at = f"at {properties.AT:g}"
    heads = {
        "linear": ("error constant", f"damping {at}", f"phase error {at}", "largest spurious root"),
        "motions": tuple(f"libration, {h:g}" for h in properties.LIBRATIONS),
        "radii": tuple(f"ratio {ratio:g}" for ratio in properties.RATIOS),
        "responses": tuple(f"{y:g}" for y in properties.RESPONSES),
    }
    heads["linear"] += ("stable to", "noise gain")
    heads["motions"] += tuple(f"test case 1, {h:g}" for h in properties.CAGES)
    heads["motions"] += tuple(f"other starts, {h:g}" for h in properties.START_STEPS)
    rows = {
        "linear": {
            key: (
                *map(cell, (own.error, own.damping, own.phase)),
                *(format(x, ".2f") for x in (own.memory, own.limit, own.noise)),
            )
            for key, own in linear.items()
        },
        "motions": {
            key: tuple(map(cell, (*own.librations, *own.cages, *own.starts)))
            for key, own in motions.items()
        },
        "radii": {key: tuple(cell(x, ".2f") for x in linear[key].radii) for key in shown},
        "responses": {key: tuple(map(cell, linear[key].responses)) for key in shown},
    }
    every = {name: table(head, rows[name]) for name, head in heads.items()}
    every["drifts"] = Table(
        ("values", "liquid", *(f"{dt:g} fs" for dt in STEPS)),
        [(*key, *(f"{x:+.4f}" for x in row)) for key, row in results.drifts.items()],
    )
    return every | {"gains": motion_gains(motions)}


def gains(linear):
    """Number of values -> ratio of error constants, Gear's over tuned."""
    return {n: linear[n, GEAR].error / own.error for (n, name), own in linear.items() if name == TUNED}


def motion_gains(motions):
    """Table of ratios of errors, Gear's over tuned, over all numbers of values and steps."""
    kinds = {"librations": "librations", "cages": "test case 1", "starts": "other starts"}
    rows = []
    for kind, words in kinds.items():
        theirs, ours = (
            np.array([getattr(own, kind) for key, own in motions.items() if key[1] == name])
            for name in (GEAR, TUNED)
        )
        kept = (abs(theirs) < LOST) & (abs(ours) < LOST)
        gain = abs(theirs[kept] / ours[kept])
        lost = [np.count_nonzero(abs(errors) >= LOST) for errors in (theirs, ours)]
        if kept.any():
            mean = np.exp(np.mean(np.log(gain)))
            rows.append((words, f"{mean:.1f}", f"{gain.min():.2f}", *lost))
    return Table(("motion", "geometric mean", "least", "Gear's lost", "tuned lost"), rows)


def mean_gain(linear, parity):
    """Geometric mean of ``gains`` over numbers of values with this ``parity``, 0 or 1."""
    logs = [np.log(gain) for values, gain in gains(linear).items() if values % 2 == parity]
    return float(np.exp(np.mean(logs))) if logs else np.nan


# --- picture --------------------------------------------------------------------------------------
def panels(results):
    """Phase, damping and largest spurious root against omega h, and the response to forces."""
    kinds = ([], [], [], [])
    for values, color in SHOWN.items():
        for name, line in ((TUNED, "-"), (GEAR, "--")):
            key = (values, name)
            damping, phase, root, of_force = results.curves[key]
            # a method is not used beyond its limit
            stable = RANGE <= results.linear[key].limit
            label, look = f"N = {values}, {name}", {"color": color, "line": line}
            for curves, x, y in zip(
                kinds,
                (RANGE[stable], RANGE[stable], RANGE, RANGE),
                (floor(phase[stable]), floor(damping[stable]), root, floor(of_force)),
            ):
                curves.append(Curve(label, x, y, **look))
    z, alone = "radians of the oscillation a step, z", {"legend": False}
    force, size = "radians of the force a step", "|phase error| / z^N"
    return (
        Panel("Phase error a step by z to the power N", z, size, kinds[0], **alone),
        Panel("Damping a step", z, "| |root| − 1 |", kinds[1], **alone),
        Panel("Largest spurious root", z, "modulus", kinds[2], "", ylim=(0.0, 1.5), **alone),
        Panel("Response to forces", force, "|Im H|", kinds[3], ylim=(1e-10, 2.0), **alone),
    )


def find(results):
    """Finding of Results."""
    measurements = [
        Measurement(f"N = {values}: gain in the error constant", gain, spec=".1f")
        for values, gain in gains(results.linear).items()
    ]
    radians = 2 * np.pi * 100 * speed_of_light * FEMTOSECONDS * 1e-15  # per step and 1/cm
    context = {
        "odd": mean_gain(results.linear, 1),
        "even": mean_gain(results.linear, 0),
        "search": search,
        "properties": properties,
        "spectral": spectral,
        "five": tuned(5).floats,
        "band": BAND,
        "femtoseconds": FEMTOSECONDS,
        "librations": [radians * wave for wave in BAND],
    }
    picture = partial(draw, panels=panels(results), columns=2)
    return Finding(measurements, tables(results), {"coefficients": picture}, context)


# --- search ---------------------------------------------------------------------------------------
def written(corrector, free_c0):
    """The line of the table of src/GEARQUAT/gear_quat_coefficients.cpp."""
    tail = ", ".join(f"{float(x):.9g}L" for x in corrector.c[3:])
    c0 = f", {float(corrector.c[0]):.9g}L" if free_c0 else ""
    return f"{{{{{tail}}}{c0}}},"


def searched(values, seed, iterations):
    """The output of --search.  Raises ValueError if there is no search for these ``values``."""
    if values not in VALUES:
        raise ValueError(f"there is no search for {values} values, only for {VALUES.start} to {VALUES.stop - 1}")
    wanted = spectral.SpectralSearch() if values == 5 else search.Search(values)
    corrector, _ = wanted.run(seed, iterations)
    results, flights = Results({}, {}, {}, {}), Flights()
    lines = [written(corrector, wanted.free_c0), ""]
    for name, own in ((TUNED, corrector), (GEAR, gear(values))):
        lines.append(f"{name}: cost {wanted.cost(own):.3f}")
        add(results, (values, name), own, flights)
    shown = tables(results)
    for name in ("linear", "motions"):
        lines += ["", markdown_table(shown[name].header, shown[name].rows)]
    return "\n".join(lines)


STUDY = Study(
    "coefficients", "Coefficients of the corrector", 35.0, measure, find, search=searched
)
