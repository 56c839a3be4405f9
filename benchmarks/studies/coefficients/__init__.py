"""Coefficients of the corrector: the search for them, and their properties compared with Gear's coefficients.

search.py and spectral.py (parameters and cost functions), kernel.cpp and kernel.py (motions with the kernel of the fix
and any coefficients), properties.py (model equations and motions), prediction.py (the drift in liquids, from spectra).
The coefficients are in src/GEARQUAT/gear_quat_tuned.h.
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
from .kernel import LOST, NO_PROJECTION, VALUES, gear, tuned
from .properties import Flights, Linear, Motions

TUNED, GEAR, FREE = "tuned", "Gear's", "tuned, no projection"
#: least ratio of errors of free tops and librations, with a projection over without
LEAST_GAIN = 5.0
#: steps in fs at which drifts are predicted
STEPS = (2.0, 2.5, 3.0, 4.0)
#: omega h, and radians per step, of the picture
RANGE = np.arange(0.06, 1.2001, 0.02)
#: (formulation, values, color) of the picture: the defaults and another number
SHOWN = (
    ("second", DEFAULT_VALUES["second"], "second"),
    ("second", 7 if DEFAULT_VALUES["second"] == 9 else 9, "translation"),
    ("first", DEFAULT_VALUES["first"], "first"),
)
#: approximate wave numbers of the librations of liquid water in 1/cm, and a large step for them
BAND, FEMTOSECONDS = (600, 850), 2.5


@dataclass(frozen=True)
class Results:
    """Dicts with keys (formulation, values, TUNED, GEAR or FREE), except ``drifts``.

    * ``linear``: Linear; ``motions``: Motions; ``moved``: Motions.starts with another c_0
    * ``curves``, for SHOWN only: see properties.py
    * ``drifts``: (number of values, name of liquid) -> drift at STEPS, in kT/ns/dof
    """

    linear: dict
    motions: dict
    moved: dict
    curves: dict
    drifts: dict


def correctors():
    """(formulation, values, TUNED, GEAR or FREE) -> Corrector, for numbers of values with tuned and Gear's coefficients."""
    every = {}
    for formulation, numbers in VALUES.items():
        for values in numbers:
            ours = tuned(formulation, values)
            if ours:
                every[formulation, values, GEAR] = gear(formulation, values)
                every[formulation, values, TUNED] = ours
                if formulation == "second" and values in NO_PROJECTION:
                    every[formulation, values, FREE] = tuned(formulation, values, any_norm=True)
    return every


def add(results, key, corrector, flights):
    """Add the properties of a Corrector, without its curves, to Results."""
    results.linear[key] = Linear.of(corrector)
    results.motions[key] = Motions.of(corrector, flights)
    results.moved[key] = flights.others(corrector.moved(properties.MOVED))


def measure(lab):
    """Results of all sets, or with --quick of those in the picture and of those with a bound."""
    shown = [(formulation, values) for formulation, values, _ in SHOWN]
    results, every, flights = Results({}, {}, {}, {}, {}), correctors(), Flights()
    if lab.quick:
        kept = {*shown, *(("second", values) for values in spectral.VALUES)}
        every = {key: own for key, own in every.items() if key[:2] in kept}
    for key, corrector in every.items():
        add(results, key, corrector, flights)
        if key[:2] in shown:
            results.curves[key] = properties.curves(corrector, RANGE)
        if corrector.any_norm:
            for liquid, own in prediction.recorded().items():
                results.drifts[key[1], liquid] = [own.drift(corrector, dt) for dt in STEPS]
        lab.advance(1 / len(every))
    return results


# --- tables ---------------------------------------------------------------------------------------
def cell(value, spec=".1e"):
    """A number as text, "lost" if the motion did not stay finite."""
    return "lost" if abs(value) >= LOST else format(value, spec)


def with_order(errors):
    """The smaller of the errors at START_STEPS, and their observed order."""
    ratio = np.divide(*properties.START_STEPS)
    return cell(errors[1]), format(np.log(errors[0] / errors[1]) / np.log(ratio), ".1f")


def table(columns, rows):
    """Table of (formulation, values, coefficients) -> cells."""
    return Table(
        ("formulation", "values", "coefficients", *columns),
        [(*key, *cells) for key, cells in rows.items()],
    )


def tables(results):
    """All tables by name."""
    linear, motions = results.linear, results.motions
    # seven and nine values have the same coefficients with and without a projection
    linear = {key: own for key, own in linear.items() if key[2] != FREE or key[1] in spectral.VALUES}
    shown = [key for key in linear if key[:2] in [place[:2] for place in SHOWN]]
    at = f"at {properties.AT:g}"
    heads = {
        "linear": ("error constant", f"damping {at}", f"phase error {at}", "largest spurious root"),
        "motions": tuple(f"libration, {h:g}" for h in properties.LIBRATIONS),
        "models": ("damped", "driven", "gyroscopic"),
        "radii": tuple(f"ratio {ratio:g}" for ratio in properties.RATIOS),
        "responses": tuple(f"{y:g}" for y in properties.RESPONSES),
        "moved": ("c_0 as it is", "order", "c_0 moved", "order"),
    }
    heads["linear"] += ("stable to", "noise gain")
    heads["motions"] += tuple(f"free top, {h:g}" for h in properties.TOPS)
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
            key: tuple(map(cell, (*own.librations, *own.tops, *own.cages, *own.starts)))
            for key, own in motions.items()
        },
        "models": {key: tuple(map(cell, linear[key].models)) for key in shown},
        "radii": {key: tuple(cell(x, ".2f") for x in linear[key].radii) for key in shown},
        "responses": {key: tuple(map(cell, linear[key].responses)) for key in shown},
        "moved": {
            key: (*with_order(motions[key].starts), *with_order(results.moved[key]))
            for key in shown
        },
    }
    every = {name: table(head, rows[name]) for name, head in heads.items()}
    every["drifts"] = Table(
        ("values", "liquid", *(f"{dt:g} fs" for dt in STEPS)),
        [(*key, *(f"{x:+.4f}" for x in row)) for key, row in results.drifts.items()],
    )
    words = [f"free top, {h:g}" for h in properties.TOPS]
    words += [f"libration, {h:g}" for h in properties.LIBRATIONS]
    every["free"] = Table(
        ("values", *words),
        [(n, *(f"{x:.2g}" for x in row)) for n, row in free_gains(motions).items()],
    )
    return every | {"gains": motion_gains(motions)}


def free_gains(motions):
    """Number of values -> ratios of errors, with a projection over without, at TOPS and LIBRATIONS."""
    found = {}
    for key, own in motions.items():
        if key[2] == FREE:
            before = motions[(*key[:2], TUNED)]
            pairs = zip((*before.tops, *before.librations), (*own.tops, *own.librations))
            found[key[1]] = [abs(theirs / ours) for theirs, ours in pairs]
    return found


def gains(linear):
    """(formulation, values) -> ratio of error constants, Gear's over tuned."""
    return {
        key[:2]: linear[(*key[:2], GEAR)].error / own.error
        for key, own in linear.items()
        if key[2] == TUNED
    }


def motion_gains(motions):
    """Table of ratios of errors, Gear's over tuned, over all numbers of values and steps."""
    kinds = {
        "librations": "librations",
        "tops": "free tops",
        "cages": "test case 1",
        "starts": "other starts",
    }
    rows = []
    for formulation in dict.fromkeys(key[0] for key in motions):
        for kind, words in kinds.items():
            theirs, ours = (
                np.array([getattr(own, kind) for key, own in motions.items() if key[::2] == of])
                for of in ((formulation, GEAR), (formulation, TUNED))
            )
            kept = (abs(theirs) < LOST) & (abs(ours) < LOST)
            gain = abs(theirs[kept] / ours[kept])
            lost = [np.count_nonzero(abs(errors) >= LOST) for errors in (theirs, ours)]
            if not kept.any():
                continue
            mean = np.exp(np.mean(np.log(gain)))
            rows.append((formulation, words, f"{mean:.1f}", f"{gain.min():.2f}", *lost))
    header = ("formulation", "motion", "geometric mean", "least", "Gear's lost", "tuned lost")
    return Table(header, rows)


def mean_gain(linear, formulation, parity=None):
    """Geometric mean of ``gains`` over numbers of values with this ``parity`` (0 or 1), or over all."""
    logs = [
        np.log(gain)
        for (of, values), gain in gains(linear).items()
        if of == formulation and parity in (None, values % 2)
    ]
    return float(np.exp(np.mean(logs))) if logs else np.nan


# --- picture --------------------------------------------------------------------------------------
def panels(results):
    """Phase, damping and largest spurious root against omega h, and the response to forces."""
    kinds = ([], [], [], [])
    for formulation, values, color in SHOWN:
        for name, line in ((TUNED, "-"), (GEAR, "--")):
            key = (formulation, values, name)
            if key not in results.curves:
                continue
            damping, phase, root, of_force = results.curves[key]
            # a method is not used beyond its limit
            stable = RANGE <= results.linear[key].limit
            label, look = f"{formulation}, N = {values}, {name}", {"color": color, "line": line}
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
        Measurement(f"{formulation}, N = {values}: gain in the error constant", gain, spec=".1f")
        for (formulation, values), gain in gains(results.linear).items()
    ]
    measurements += [
        Measurement(
            f"second, N = {n}: least gain in free tops and librations without a projection",
            min(row),
            spec=".1f",
            least=LEAST_GAIN if n in spectral.VALUES else None,
        )
        for n, row in free_gains(results.motions).items()
    ]
    radians = 2 * np.pi * 100 * speed_of_light * FEMTOSECONDS * 1e-15  # per step and 1/cm
    context = {
        "odd": mean_gain(results.linear, "second", 1),
        "even": mean_gain(results.linear, "second", 0),
        "first": mean_gain(results.linear, "first"),
        "search": search,
        "properties": properties,
        "spectral": spectral,
        "sets": {n: tuned("second", n, any_norm=True).floats[0] for n in spectral.VALUES},
        "band": BAND,
        "femtoseconds": FEMTOSECONDS,
        "librations": [radians * wave for wave in BAND],
    }
    picture = partial(draw, panels=panels(results), columns=2)
    return Finding(measurements, tables(results), {"coefficients": picture}, context)


# --- search ---------------------------------------------------------------------------------------
def written(corrector, free_c0):
    """Lines of the table of src/GEARQUAT/gear_quat_tuned.h."""
    more = ", true" if corrector.any_norm else ""
    order = corrector.order
    for columns, own in zip(("DRIVEN", "INTEGRATED")[: 3 - order], corrector.sets):
        tail = ", ".join(f"{float(x):.9g}L" for x in own[order + 1 :])
        c0 = f", {float(own[0]):.9g}L" if free_c0 else ""
        yield f"{{{corrector.formulation.upper()}, {columns}, {{{tail}}}{c0}{more}}},"


def searched(formulation, values, seed, iterations):
    """The output of --search.  Raises ValueError if there is no search for these ``values``.

    ``formulation``: first, second, or "spectral" for the coefficients of the second without a projection.
    """
    if formulation == "spectral" and values in spectral.VALUES:
        wanted = spectral.SpectralSearch(values=values)
    elif values in VALUES.get(formulation, ()):
        wanted = search.Search(formulation, values)
    else:
        known = [f"{n.start} to {n.stop - 1} of {f}" for f, n in VALUES.items()]
        known += [f"{n} of spectral" for n in spectral.VALUES]
        raise ValueError(f"there are no {values} values of {formulation}; there are {', '.join(known)}")
    corrector, _ = wanted.run(seed, iterations)
    results, flights = Results({}, {}, {}, {}, {}), Flights()
    lines = [*written(corrector, wanted.free_c0), ""]
    for name, own in ((TUNED, corrector), (GEAR, gear(wanted.formulation, values))):
        lines.append(f"{name}: cost {wanted.cost(own):.3f}")
        add(results, (wanted.formulation, values, name), own, flights)
    shown = tables(results)
    for name in ("linear", "motions"):
        lines += ["", markdown_table(shown[name].header, shown[name].rows)]
    return "\n".join(lines)


STUDY = Study(
    "coefficients", "Coefficients of the corrector", 35.0, measure, find, search=searched
)
