"""Collisions in the gas: results of ``gearquat scatter`` compared with quadrature, experiment and other methods."""

from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from benchmarks.engine import Curve, Finding, Measurement, Panel, Study, Table, draw
from benchmarks.reference.central import CollisionIntegrals, Gromacs
from benchmarks.studies.collisions import evaluations as work_at

from . import errors, flown, rivals

PARTS = ("integrals", "molecules", "conservation", "reference", "methods", "errors")
#: reduced temperatures; diameter, well depth and ends of the cut-off in in.argon
REDUCED = (0.5, 1.0, 2.0, 5.0, 10.0)
SIGMA, WELL, CUT = 3.405, 119.8, (12.0, 30.0)
#: requested relative standard errors: of the whole study, and with --quick
ERRORS = {"argon": (0.0018, 0.03), "nitrogen": (0.01, 0.04), "helium": (0.01, 0.04), "ion": (0.03, 0.1)}
#: numbers of flights: for conservation, for the comparison with DOP853 (of each deck), and of each method
FLIGHTS = {"conservation": (100_000, 1000), "reference": (100, 3), "methods": (10, 2)}
#: seeds of the part on errors, for atoms and for molecules, and the requested errors
SEEDS = {"atoms": (errors.ATOMS, 3), "molecules": (errors.MOLECULES, 3), "asked": (errors.ASKED, errors.ASKED[:1])}
EPS, STEPS = 10.0 ** -np.arange(5.0, 13.0), (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5)
SOLVERS = dict.fromkeys(("DOP853", "LSODA"), 10.0 ** -np.arange(4.0, 14.0))
QUICK_STEPS = STEPS[:3]
#: energy errors at which methods are compared
LEVELS = 10.0 ** -np.arange(4, 11)
#: energy errors in the summary; at the last one the fix must be ten times as fast
COMPARED = (1e-7, 1e-9)
#: published: viscosity of nitrogen at 300 K without pressure (E. W. Lemmon and R. T Jacobsen, Int. J. Thermophys.
#: 25, 21 (2004), Eqs. 2 and 3, with an uncertainty of 0.5 %), and computed cross sections of choline at 301 K with
#: their standard deviations (files of the program of Campuzano et al. 2012, see examples/collisions/README)
VISCOSITY, CHOLINE = (17.877, 0.09), {"helium": (55.402, 0.510), "nitrogen": (115.92, 1.27)}
PAIRS = {"nitrogen": "two nitrogen molecules", "helium": "choline, helium", "ion": "choline, nitrogen"}
LOOKS = {
    "fix gear/quat": ("momentum", "o"),
    "fix rigid/nve/small": ("rigid", "D"),
    "DOP853": ("total", "^"),
    "LSODA": ("rotation", "v"),
}


@dataclass(frozen=True)
class Results:
    """Results; a part that was not requested is None.

    ``integrals``: reduced temperature -> Run; ``molecules``: name -> Run; ``conservation``: a Run;
    ``reference``: deck -> array (n, 4), see ``flown.beside_reference``; ``methods``: label -> array
    (settings, 3), see ``rivals.points``; ``errors``: (pair, requested error) -> rows of errors.py.
    """

    integrals: dict = None
    molecules: dict = None
    conservation: flown.Run = None
    reference: dict = None
    methods: dict = None
    errors: dict = None


# --- measuring ----------------------------------------------------------------------------------
def _integrals(lab, sized):
    found = {}
    for reduced in REDUCED:
        options = ("--temperature", reduced * WELL, "--rotation", 0, "--sigma", SIGMA)
        options += ("--error", sized(ERRORS["argon"]))
        found[reduced] = flown.command(lab, f"argon_{reduced:g}", "in.argon", *options)
        lab.advance(1 / len(REDUCED))
    return found


def _molecules(lab, sized):
    runs = {
        "nitrogen": ("in.nitrogen", 300, "nitrogen"),
        "helium": ("in.choline_helium", 301, "helium"),
        "ion": ("in.choline_nitrogen", 301, "ion"),
    }
    found = {}
    for name, (deck, temperature, error) in runs.items():
        options = ("--temperature", temperature, "--error", sized(ERRORS[error]))
        found[name] = flown.command(lab, name, deck, *options)
        lab.advance(1 / len(runs))
    return found


def _conservation(lab, sized):
    options = ("--temperature", 2, "--count", sized(FLIGHTS["conservation"]))
    return flown.command(lab, "conservation", "in.dumbbells", *options)


def _reference(lab, sized):
    count = sized(FLIGHTS["reference"])
    scenes = {"in.dumbbells": (2.0, 3.5), "in.nitrogen": (300.0, 8.0)}
    tick = partial(lab.advance, 1 / (count * len(scenes)))
    return {deck: flown.beside_reference(deck, *own, count, tick) for deck, own in scenes.items()}


def _methods(lab, sized):
    steps = sized((STEPS, QUICK_STEPS))
    runs = len(EPS) + len(steps) + sum(map(len, SOLVERS.values()))
    return rivals.points(sized(FLIGHTS["methods"]), EPS, steps, SOLVERS, partial(lab.advance, 1 / runs))


def _errors(lab, sized):
    asked = sized(SEEDS["asked"])
    parts = len(errors.CENTRAL) * len(asked) + len(errors.PAIRS) * len(asked)
    tick = partial(lab.advance, 1 / parts)
    folder = flown.kept(lab) / "errors"
    found = errors.of_atoms(folder, sized(SEEDS["atoms"]), asked, tick)
    return found | errors.of_molecules(folder, sized(SEEDS["molecules"]), asked, lab.jobs, tick)


def measure(lab):
    """Results of the requested parts."""
    parts = lab.parts or PARTS
    found = {}
    for part in parts:
        with lab.share(1 / len(parts)):
            found[part] = globals()[f"_{part}"](lab, lambda pair: pair[lab.quick])
    return Results(**found)


# --- judging ------------------------------------------------------------------------------------
@cache
def _quadratures():
    """Integrals with the full potential, and with the cut-off of the deck."""
    return CollisionIntegrals(), CollisionIntegrals(Gromacs(*(end / SIGMA for end in CUT)))


def _of_integrals(runs):
    """Measurements and Table: Omega* compared with quadrature, with and without the cut-off of the deck."""
    whole, cut = _quadratures()
    rows, cells, worst, left, largest = [], [], 0.0, 0.0, 0.0
    for reduced, run in runs.items():
        for order, power in ((1, 1), (2, 2), (1, 2)):
            value, error = run.quantities[f"Omega({order},{power})*"]
            exact, with_cut = whole(order, power, reduced), cut(order, power, reduced)
            away = (value - exact) / error
            numbers = (f"{value:.4f}", f"{error:.4f}", f"{exact:.4f}", f"{away:+.1f}")
            cells.append((f"{reduced:g}", f"Ω({order},{power})*", *numbers))
            worst, left = max(worst, abs(away)), max(left, abs(with_cut / exact - 1.0))
            if power == order:
                largest = max(largest, error / exact)
    words = "Ω*: largest deviation from quadrature, in standard errors"
    rows.append(Measurement(words, worst, spec=".1f", most=3.5))
    rows.append(Measurement("Ω*(1,1), Ω*(2,2): largest standard error, relative", largest, most=0.002))
    words = "Ω*: largest relative effect of the deck's cut-off, by quadrature"
    rows.append(Measurement(words, left, most=1e-4))
    header = ("T*", "integral", "mean over flights", "standard error", "quadrature", "deviation / standard error")
    return rows, {"integrals": Table(header, cells)}


def _of_molecules(runs):
    """Measurements: viscosity and cross sections compared with published values."""
    value, error = runs["nitrogen"].quantities["viscosity"]
    rows = [
        Measurement("viscosity of nitrogen at 300 K", value, error, ".2f", "µPa s"),
        _near("its relative deviation from the measured value", value, error, VISCOSITY[0]),
    ]
    for name, gas in (("helium", "helium"), ("ion", "nitrogen")):
        value, error = runs[name].quantities["cross section"]
        rows.append(Measurement(f"cross section of choline in {gas} at 301 K", value, error, ".2f", "Å²"))
        rows.append(_near("its relative deviation from the published computed value", value, error, CHOLINE[gas][0]))
    kinds = ("flights", "orbiting", "unparted", "lost")
    counts = [(PAIRS[name], *(run.counts[kind] for kind in kinds)) for name, run in runs.items()]
    return rows, {"molecules": Table(("pair", *kinds), counts)}


def _near(what, value, error, published):
    """Measurement of the relative deviation from a published value."""
    away = value / published - 1.0
    return Measurement(what, away, error / published, ".3f", least=-0.1, most=0.1)


def _of_conservation(run):
    """Measurements: conservation in 100 000 flights, and no net transfer at equal temperatures."""
    counts = run.counts
    gone = counts["lost"] + counts["unparted"]
    rows = [
        Measurement("dumbbell flights", counts["flights"], spec=".0f"),
        Measurement("dumbbell flights that were lost or did not separate", gone, spec=".0f", most=0),
        Measurement("dumbbell flights with a repeated step", counts["repeated"], spec=".0f"),
        Measurement("dumbbell flights that orbited", counts["orbiting"], spec=".0f"),
    ]
    for name, value in run.errors.items():
        rows.append(Measurement(f"largest error of the {name} in a flight, relative", value, most=1e-9))
    value, error = run.quantities["gain"]
    words = "net transfer to rotation at equal temperatures, in standard errors"
    rows.append(Measurement(words, value / error, spec=".1f", least=-3.5, most=3.5))
    return rows, {}


def _of_reference(arrays):
    """Measurements: deviations from DOP853 with its own forces, and from the start after reversed flights."""
    every = np.concatenate(list(arrays.values()))
    simple = every[every[:, 2] <= 1]
    rows = [
        Measurement("flights compared with DOP853", len(every), spec=".0f"),
        Measurement("flights compared with DOP853 that orbited", len(every) - len(simple), spec=".0f"),
        Measurement("largest deviation of a velocity (not orbiting)", simple[:, 0].max(), most=1e-8),
        Measurement("largest deviation of an angular momentum (not orbiting)", simple[:, 1].max(), most=1e-8),
        Measurement("largest deviation of a velocity after the reversed flight (not orbiting)", simple[:, 3].max(), most=1e-7),
    ]
    header = ("deck", "flight", "turnings", "velocity", "angular momentum", "velocity, reversed flight")
    orbiting = [
        (deck, number, f"{own[2]:.0f}", *(f"{own[k]:.0e}" for k in (0, 1, 3)))
        for deck, values in arrays.items()
        for number, own in enumerate(values)
        if own[2] > 1
    ]
    return rows, {"orbiting": Table(header, orbiting)}


def _of_methods(points):
    """Measurements, tables: flights per second and evaluations at equal energy errors."""
    seconds = {label: work_at(own[:, [0, 2]], LEVELS) for label, own in points.items()}
    calls = {label: work_at(own[:, [1, 2]], LEVELS) for label, own in points.items()}
    header = ("method", *(f"{level:.0e}" for level in LEVELS))
    tables = {
        "rates": Table(header, [(label, *(f"{1 / x:.3g}" for x in own)) for label, own in seconds.items()]),
        "evaluations": Table(header, [(label, *(f"{x:.0f}" for x in own)) for label, own in calls.items()]),
    }
    rows = []
    for level in COMPARED:
        at = int(np.argmin(np.abs(np.log(LEVELS / level))))
        ours = seconds["fix gear/quat"][at]
        words = f"fix gear/quat: flights per second and core at an error of {level:.0e}"
        rows.append(Measurement(words, 1 / ours, spec=".0f"))
        for label in points:
            if label != "fix gear/quat":
                words = f"time of {label} relative to the fix at {level:.0e}"
                least = 10.0 if level == COMPARED[-1] else None
                rows.append(Measurement(words, seconds[label][at] / ours, spec=".1f", least=least))
    return rows, tables


def _of_errors(found):
    """Measurements, table: deviations divided by stated errors, over all seeds."""
    cells, squares, outside = [], [], 0
    for (name, asked), values in found.items():
        exact = errors.reference(name, values)
        for k, label in enumerate(("Ω(1,1)", "Ω(2,2)")):
            value, error = values[:, 2 + 2 * k], values[:, 3 + 2 * k]
            square = errors.squares(value, error, exact[k], name in errors.PAIRS)
            within = errors.interval(len(square))
            rms = np.sqrt(square.mean())
            outside += not within[0] < rms < within[1]
            squares.append(square)
            numbers = (f"{values[:, 1].mean():.0f}", f"{value.std(ddof=1) / value.mean():.4f}")
            stated = f"{np.sqrt((error**2).mean()) / value.mean():.4f}"
            bounds = f"{within[0]:.2f} to {within[1]:.2f}"
            cells.append((name, label, f"{asked:g}", str(len(square)), *numbers, stated, f"{rms:.2f}", bounds))
    pooled = np.sqrt(np.concatenate(squares).mean())
    header = ("pair", "integral", "--error", "seeds", "flights", "scatter", "stated", "rms z", "99.9 % of rms z")
    rows = [
        Measurement("rms deviation by the error that is stated, over all seeds", pooled, spec=".3f", least=0.9, most=1.1),
        Measurement("pairs and errors whose rms deviation is outside of its interval", outside, spec=".0f", most=0),
    ]
    return rows, {"errors": Table(header, cells)}


def find(results):
    """Finding of Results."""
    rows, tables, pictures = [], {}, {}
    for part in PARTS:
        data = getattr(results, part)
        if data is not None:
            more, own = globals()[f"_of_{part}"](data)
            rows, tables = rows + more, tables | own
    context = {}
    if results.methods is not None:
        pictures["scatter"] = partial(draw, panels=panels(results.methods))
        seconds, calls, _ = results.methods["DOP853"].sum(axis=0)
        context["microseconds"] = 1e6 * seconds / calls
    context |= {"viscosity": VISCOSITY, "choline": CHOLINE}
    return Finding(rows, tables, pictures, context)


def panels(points):
    """Time and evaluations of a flight against the energy error."""
    found = []
    for column, title, words in ((0, "Time of a flight", "seconds"), (1, "Evaluations in a flight", "evaluations")):
        curves = [
            Curve(label, own[:, 2], own[:, column], LOOKS[label][0], "-", LOOKS[label][1])
            for label, own in points.items()
        ]
        found.append(Panel(title, "largest error of the energy on the way", words, curves, "xy", columns=1))
    return tuple(found)


STUDY = Study("scatter", "Collisions in the gas", 1800.0, measure, find, parts=PARTS)
