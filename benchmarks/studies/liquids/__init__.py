"""Real liquids: energy, temperatures and pressure against the step, and the limits from the forces.

plan.py (scenes and sizes), runs.py (LAMMPS' runs), heavier.py (bodies with larger inertia), quantities.py (results
from runs), judging.py (measurements and bounds), and here the tables and panels.  The drift from a spectrum is computed
by coefficients/prediction.py.
"""

import math
from functools import partial

import numpy as np

from benchmarks.engine.methods import looks
from benchmarks.engine.panels import Curve, Panel, draw
from benchmarks.engine.statistics import with_error
from benchmarks.engine.study import Finding, Study, Table
from benchmarks.studies.coefficients import prediction

from . import judging
from . import quantities as of
from .judging import UNIT, lost, predicted
from .plan import DEFAULT, FAMILIES, FLOOR_STEP, FLOORS, FORESEEN, HEAVY, LIQUIDS, MAIN, METHODS, NAMES
from .plan import NVE_SMALL, SCENES, SINGLE, STEPS, VALUES, WATERS
from .runs import measure

#: the axis of drifts is linear below this size
LINEAR = 0.01
#: drifts above this size are drawn as crosses
LARGEST = 100.0
#: darker colors of a kind come last
LOOKS = looks(METHODS[::-1])


def lost_text(runs):
    """Number of lost Runs, and the time of the first loss."""
    ends = [run.time[-1] / 1000 if len(run.time) else 0.0 for run in lost(runs)]
    return f"{len(ends)} of {len(runs)} lost, after {min(ends):.1f} ps"


def show_drift(runs, liquid):
    """Drift as text."""
    return lost_text(runs) if lost(runs) else with_error(*of.drift(runs, liquid), sign="+")


def show_state(runs, liquid):
    """Fluctuation, temperatures, their difference and pressure as text."""
    if lost(runs):
        return [lost_text(runs), *[""] * 4]
    means = [of.mean(runs, lambda run, k=k: of.temperatures(run, liquid)[k]) for k in (0, 1)]
    means += [of.warmer(runs, liquid), of.mean(runs, lambda run: run.pressure)]
    fluctuation = np.mean([of.fluctuation(run) for run in runs])
    return [f"{fluctuation:.2g}", *(with_error(m.value, m.error) for m in means)]


# --- tables ---------------------------------------------------------------------------------------
def scene_tables(results, scene):
    """Table of drifts with a column per step; for water, table of other quantities with a row per method and step."""

    def cell(method, dt):
        runs = results.runs.get((scene.key, method.key, dt))
        return show_drift(runs, scene.liquid) if runs else ""

    drifts = [[NAMES[method], *(cell(method, dt) for dt in STEPS)] for method in scene.methods]
    states = [
        [NAMES[method], f"{dt:g}", *show_state(results.runs[scene.key, method.key, dt], scene.liquid)]
        for method in (DEFAULT, NVE_SMALL)
        for dt in scene.methods[method].steps
    ]
    columns = ["fluctuation, kcal/mol", "T translation, K", "T rotation, K", "translation − rotation, K"]
    tables = {f"drift_{scene.key}": Table((f"drift, {UNIT}", *(f"{dt:g} fs" for dt in STEPS)), drifts)}
    if scene.liquid in WATERS:
        tables[f"state_{scene.key}"] = Table(("method", "step, fs", *columns, "pressure, atm"), states)
    return tables


def prediction_table(results):
    """Predicted and measured drift of each liquid, number of values and step."""
    rows = []
    for scene in SCENES:
        for values, method in VALUES.items():
            cells = []
            for dt in FORESEEN:
                runs = results.runs[scene.key, method.key, dt]
                cells.append(f"{predicted(results, scene, values, dt):+.3f}; {show_drift(runs, scene.liquid)}")
            rows.append([scene.liquid.title, values, *cells])
    return Table(("liquid", "values", *(f"{dt:g} fs" for dt in FORESEEN)), rows)


def spectra_table(results):
    """Spectra of the liquids; coefficients/spectra.csv is a copy of this table."""
    spectra = {scene.liquid.title: results.spectra[scene.liquid.key] for scene in SCENES}
    return Table(*prediction.table(spectra))


def chosen_table(results):
    """Number of values that the fix chooses, for each liquid and step."""
    rows = []
    for scene in SCENES:
        chosen = [{run.values for run in results.runs[scene.key, DEFAULT.key, dt]} for dt in STEPS]
        rows.append([scene.liquid.title, *(", ".join(map(str, sorted(found))) for found in chosen)])
    return Table(("liquid", *(f"{dt:g} fs" for dt in STEPS)), rows)


def first_peaks(pairs):
    """Heights of the first maxima (starts, 2) of radial distribution functions (starts, bins, 3)."""
    return np.max(np.asarray(pairs)[:, :, 1:], axis=1)


def averages(runs, pairs):
    """Averages (3, starts): potential energy per molecule, and the two first_peaks of ``pairs``."""
    energies = [run.potential.mean() / MAIN.liquid.molecules for run in runs]
    return np.vstack([energies, first_peaks(pairs).T])


def heavy_table(results):
    """Static averages of the model, and their differences, start by start, with larger inertia."""
    columns = ["inertia", "step, fs", f"drift, {UNIT}", "T translation − T rotation, K"]
    columns += ["potential energy, kcal/mol per molecule", "first maximum of g(r), O–O", "O–H"]
    rows, model = [], None
    for scene in (MAIN, HEAVY):
        for dt in scene.pairs:
            runs = results.runs[scene.key, DEFAULT.key, dt]
            cells = [f"{scene.inertia:g}", f"{dt:g}", show_drift(runs, scene.liquid)]
            if not lost(runs) and (scene is MAIN or model is not None):
                warmer = of.warmer(runs, scene.liquid)
                found = averages(runs, results.pairs[scene.key, dt])
                shown, sign = (found, "") if scene is MAIN else (found - model, "+")
                model = found if scene is MAIN else model
                cells += [with_error(warmer.value, warmer.error)]
                cells += [with_error(*of.of_starts(row), sign) for row in shown]
            rows.append(cells + [""] * (len(columns) - len(cells)))
    return Table(columns, rows)


def show_fluctuation(run):
    """Fluctuation as text, "" without a run."""
    if run is None:
        return ""
    return lost_text([run]) if run.lost else f"{of.fluctuation(run):.2g}"


def floor_table(results):
    """Fluctuation, drift and time per step for each way to compute the forces."""
    rows = []
    for forces in FLOORS:
        own, other = (results.floors.get((forces.text, m.key)) for m in (DEFAULT, NVE_SMALL))
        lines = "<br>".join(f"`{line}`" for line in forces.lines)
        cells = show_fluctuation(own), show_fluctuation(other), show_drift([own], MAIN.liquid)
        rows.append([lines, *cells, f"{1000 * own.seconds:.1f}"])
    names = [f"fluctuation, {NAMES[method]}" for method in (DEFAULT, NVE_SMALL)]
    return Table(("lines", *names, f"drift, {NAMES[DEFAULT]}", "ms per step"), rows)


def floors(results):
    """Fluctuations with the default, for the sentences of the page, kcal/mol."""
    words = {"plain": "plain cut-off", "shifted": "energy shifted", "switched": "energy switched"}
    named = {
        word + suffix: next(f for f in FAMILIES[family] if f.accuracy == accuracy)
        for word, family in words.items()
        for suffix, accuracy in (("_coarse", 1e-4), ("", 1e-5), ("_fine", 1e-6))
    }
    named |= {"switched_finest": FAMILIES["energy switched"][-1]}
    named |= dict(zip(("functions", "longer", "order", "ewald", "rare"), SINGLE))
    runs = {word: results.floors[forces.text, DEFAULT.key] for word, forces in named.items()}
    return {word: math.inf if run.lost else of.fluctuation(run) for word, run in runs.items()}


def advice(results):
    """The cheaper of two settings with equally accurate forces."""
    ways = FAMILIES["energy shifted"][-2], SINGLE[2]
    return min(ways, key=lambda forces: results.floors[forces.text, DEFAULT.key].seconds)


# --- pictures -------------------------------------------------------------------------------------
def plain_name(method):
    """Name of a method in pictures."""
    return NAMES[method].replace("`", "")


def panel(results, scene, title, ylabel, read, methods=METHODS, apart=0.0, most=math.inf, **more):
    """Panel of a quantity against the step; ``read(runs)``: value and error.

    ``apart``: distance of error bars at the same step, as a fraction of the largest step.  Lost runs, and runs with a
    value above ``most``, are crosses.
    """
    curves, crosses = [], []
    for k, method in enumerate(methods):
        runs = {dt: results.runs[scene.key, method.key, dt] for dt in scene.methods[method].steps}
        points = [(dt, *read(own)) for dt, own in runs.items() if not lost(own)]
        points = [point for point in points if abs(point[1]) <= most]
        x, y, error = np.array(points).reshape(-1, 3).T
        crosses += [(dt, LOOKS[method]["color"]) for dt in runs if dt not in x]
        x = x + apart * STEPS[-1] * (k - (len(methods) - 1) / 2)
        curves.append(Curve(plain_name(method), x, y, **LOOKS[method], error=error))
    more = {"log": "", "legend": False} | more
    return Panel(title, "step, fs", ylabel, curves, xticks=STEPS, lost=tuple(crosses), **more)


def drift_panels(results):
    """Drift against the step in every scene."""
    words = f"drift, {UNIT}"
    return tuple(
        panel(
            results,
            scene,
            scene.title,
            words,
            partial(of.drift, liquid=scene.liquid),
            most=LARGEST,
            linear=LINEAR,
        )
        for scene in SCENES
    )


def state_panels(results):
    """Fluctuation, difference of the temperatures and pressure against the step in MAIN."""

    def value_and_error(mean):
        return mean.value, mean.error

    def fluctuation(runs):
        return float(np.mean([of.fluctuation(run) for run in runs])), 0.0

    def warmer(runs):
        return value_and_error(of.warmer(runs, MAIN.liquid))

    def pressure(runs):
        return value_and_error(of.mean(runs, lambda run: run.pressure))

    shown = partial(panel, results, MAIN, MAIN.title, methods=(DEFAULT, NVE_SMALL))
    return (
        shown("fluctuation of the energy, kcal/mol", fluctuation, log="y"),
        shown("T translation − T rotation, K", warmer, apart=0.01),
        shown("pressure, atm", pressure, apart=0.01),
    )


def floor_panels(results):
    """Fluctuation against the accuracy of kspace, for each treatment of the cut-off."""
    curves = []
    for mark, (name, family) in zip("so^", FAMILIES.items()):
        for method in FLOORS[family[0]]:
            runs = {forces.accuracy: results.floors[forces.text, method.key] for forces in family}
            kept = [(x, of.fluctuation(run)) for x, run in runs.items() if not run.lost]
            look, points = LOOKS[method] | {"marker": mark}, np.array(kept).reshape(-1, 2).T
            curves.append(Curve(f"{plain_name(method)}, {name}", *points, **look))
    title = f"{MAIN.liquid.title}, step {FLOOR_STEP:g} fs"
    words = "fluctuation of the energy, kcal/mol"
    return (Panel(title, "accuracy of kspace_style", words, curves, log="xy", columns=2),)


def heavy_panels(results):
    """Radial distribution functions with larger inertia and with the inertia of the model."""
    panels = []
    for column, name in ((1, "O–O"), (2, "O–H")):
        curves = []
        for color, ((key, dt), pairs) in zip(("black", "C0", "C1", "C2"), results.pairs.items()):
            mean, factor = np.mean(pairs, axis=0), HEAVY.inertia if key == HEAVY.key else 1.0
            label = f"inertia × {factor:g}, {dt:g} fs"
            curves.append(Curve(label, mean[:, 0], mean[:, column], color))
        panels.append(Panel(MAIN.liquid.title, "r, Å", f"g(r), {name}", curves, log="", columns=2))
    return tuple(panels)


def find(results):
    """Finding of Results."""
    tables = {
        "floor": floor_table(results),
        "prediction": prediction_table(results),
        "chosen": chosen_table(results),
        "heavy": heavy_table(results),
        "spectra": spectra_table(results),
    }
    for scene in SCENES:
        tables |= scene_tables(results, scene)
    note = f"crosses: lost, or a drift above {LARGEST:g}"
    pictures = {
        "drift": partial(draw, panels=drift_panels(results), columns=3, note=note),
        "state": state_panels(results),
        "floor": floor_panels(results),
        "heavy": heavy_panels(results),
    }
    context = {
        "floors": floors(results),
        "advice": advice(results).lines,
        "plan": results.plan,
        "scenes": SCENES,
        "waters": [scene for scene in SCENES if scene.liquid in WATERS],
        "main": MAIN,
        "heavy": HEAVY,
        "names": {"default": NAMES[DEFAULT]},
        "liquids": LIQUIDS,
        "blocks": of.BLOCKS,
        "unit": UNIT,
        "floor_step": FLOOR_STEP,
    }
    return Finding(judging.measurements(results), tables, pictures, context)


STUDY = Study("liquids", "Real liquids", 4200.0, measure, find)
