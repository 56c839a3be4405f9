"""Real liquids: energy, temperatures and pressure against the step, and what in the forces limits them.

plan.py (what is run), runs.py (LAMMPS' runs), quantities.py (what follows from one run), and here the
measurements, tables and panels.
"""

import math
from functools import partial

import numpy as np

from benchmarks.engine.methods import GEARS, looks
from benchmarks.engine.panels import Curve, Panel, draw
from benchmarks.engine.study import Finding, Measurement, Study, Table

from . import quantities as of
from .plan import ACCURACIES, ALL_METHODS, FAMILIES, FLOOR_METHODS, FLOORS, LIQUIDS
from .plan import MAIN, NAMES, NVE_SMALL, SCENES, SECOND, replace
from .runs import measure

#: as many standard errors of a difference are noise
NOISE = 3.0
UNIT = "kT/ns/dof"
#: bounds of the drift of the default in MAIN: step -> largest size; those not named: noise
MOST_DRIFT = {2.5: 0.1}
#: the drift is drawn linearly below this size
LINEAR = 0.01
LOOKS = looks(ALL_METHODS)


def with_error(value, error, sign=""):
    """Value ± error with two digits of the error."""
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0 else 3
    return f"{value:{sign}.{digits}f} ± {error:.{digits}f}"


def lost_text(run):
    """How long a run lasted that was lost."""
    return f"lost after {run.time[-1] / 1000 if len(run.time) else 0:.1f} ps"


def show_drift(run, liquid):
    """Drift as text."""
    return lost_text(run) if run.lost else with_error(*of.drift(run, liquid), sign="+")


def show_state(run, liquid):
    """Fluctuation, temperatures, their difference and pressure as texts."""
    if run.lost:
        return [lost_text(run), *[""] * 4]
    translation, rotation = map(of.block_mean, of.temperatures(run, liquid))
    means = translation, rotation, of.cooler(run, liquid), of.block_mean(run.pressure)
    return [f"{of.fluctuation(run):.2g}", *(with_error(m.value, m.error) for m in means)]


# --- tables and measurements ----------------------------------------------------------------------
def of_scene(results, scene):
    """(Method, step) -> Run of a scene."""
    return {
        (method, dt): results.runs[scene.key, method.key, dt]
        for method in scene.methods
        for dt in scene.steps
    }


def scene_tables(results, scene):
    """Table of drifts, one step per column, and table of everything else, one run per row."""
    runs, liquid = of_scene(results, scene), scene.liquid
    drifts = [
        [NAMES[method], *(show_drift(runs[method, dt], liquid) for dt in scene.steps)]
        for method in scene.methods
    ]
    states = [
        [NAMES[method], f"{dt:g}", *show_state(run, liquid)] for (method, dt), run in runs.items()
    ]
    steps = [f"{dt:g} fs" for dt in scene.steps]
    columns = ["fluctuation, kcal/mol", "T translation, K", "T rotation, K", "rotation − translation, K"]
    return {
        f"drift_{scene.key}": Table((f"drift, {UNIT}", *steps), drifts),
        f"state_{scene.key}": Table(("method", "step, fs", *columns, "pressure, atm"), states),
    }


def floor_table(results):
    """Fluctuation, drift and time per step for each way to compute the forces."""
    rows = []
    for forces in FLOORS:
        runs = [results.floors[forces.text, method.key] for method in FLOOR_METHODS]
        cells = []
        for run in runs:
            there = not run.lost
            cells.append(f"{of.fluctuation(run):.2g}" if there else lost_text(run))
            cells.append(show_drift(run, MAIN.liquid))
        lines = "<br>".join(f"`{line}`" for line in forces.lines)
        rows.append([lines, *cells, f"{1000 * min(run.seconds for run in runs):.1f}"])
    names = [f"{word}, {NAMES[m]}" for m in FLOOR_METHODS for word in ("fluctuation", "drift")]
    return Table(("lines", *names, "ms per step"), rows)


def floors(results):
    """Fluctuations with the default that the sentences name, kcal/mol."""
    words = {"plain": "plain cut-off", "shifted": "energy shifted", "switched": "energy switched"}
    shown = {}
    for word, family in words.items():
        for suffix, accuracy in (("_coarse", 1e-4), ("", 1e-5), ("_fine", 1e-6)):
            forces = replace(FAMILIES[family], accuracy=accuracy)
            run = results.floors[forces.text, SECOND.key]
            shown[word + suffix] = math.inf if run.lost else of.fluctuation(run)
    return shown


def calibration(results):
    """Root mean square of drift over its error with NO_SQUISH; 1 if errors are right, as it has none."""
    ratios = []
    for scene in SCENES:
        runs = of_scene(results, scene)
        drifts = [of.drift(runs[NVE_SMALL, dt], scene.liquid) for dt in scene.steps]
        ratios += [rate / error for rate, error in drifts]
    return Measurement(
        f"{NAMES[NVE_SMALL]}, all liquids: root mean square of drift over standard error",
        float(np.sqrt(np.mean(np.square(ratios)))),
        spec=".1f",
    )


def main_measurements(results):
    """What the default of fix gear/quat must hold in MAIN."""
    runs = of_scene(results, MAIN)
    for dt in MAIN.liquid.steps:
        own, other = runs[SECOND, dt], runs[NVE_SMALL, dt]
        what = f"{MAIN.title}, {dt:g} fs, {NAMES[SECOND]}"
        length = own.time[-1] / 1000 if len(own.time) else 0.0
        least = 0.999 * own.duration / 1000
        yield Measurement(f"{what}: time without loss", length, spec=".1f", unit="ps", least=least)
        if own.lost:
            continue
        (rate, error), (theirs, scatter) = (of.drift(run, MAIN.liquid) for run in (own, other))
        most = MOST_DRIFT.get(dt, NOISE * math.hypot(error, scatter))
        bounds = {"least": -most, "most": most} if dt < max(MAIN.steps) else {}
        remark = f"{NVE_SMALL.label}: {with_error(theirs, scatter, '+')}"
        yield Measurement(f"{what}: drift", rate, error, "+.3f", UNIT, remark, **bounds)


# --- pictures -------------------------------------------------------------------------------------
def _curves(scene, runs, read):
    """A Curve for each method of a scene; ``read(run)``: value and error."""
    for method in scene.methods:
        points = [(dt, *read(runs[method, dt])) for dt in scene.steps if not runs[method, dt].lost]
        x, y, error = np.array(points).reshape(-1, 3).T
        yield Curve(NAMES[method].replace("`", ""), x, y, **LOOKS[method], error=error)


def _lost(scene, runs):
    return tuple((dt, LOOKS[method]["color"]) for (method, dt), run in runs.items() if run.lost)


def panel(results, scene, title, ylabel, read, **more):
    """Panel of a quantity against the step."""
    runs = of_scene(results, scene)
    more = {"log": "", "legend": False} | more
    curves = tuple(_curves(scene, runs, read))
    return Panel(title, "step, fs", ylabel, curves, xticks=scene.steps, lost=_lost(scene, runs), **more)


def drift_panels(results):
    """Drift against the step in every scene."""
    return tuple(
        panel(
            results,
            scene,
            scene.title,
            f"drift, {UNIT}",
            partial(of.drift, liquid=scene.liquid),
            linear=LINEAR,
        )
        for scene in SCENES
    )


def state_panels(results):
    """Fluctuation, difference of the temperatures and pressure against the step in MAIN."""

    def mean_and_error(function, run):
        mean = function(run)
        return mean.value, mean.error

    cooler = partial(mean_and_error, partial(of.cooler, liquid=MAIN.liquid))
    pressure = partial(mean_and_error, lambda run: of.block_mean(run.pressure))
    words = "fluctuation of the energy, kcal/mol"
    return (
        panel(results, MAIN, MAIN.title, words, lambda run: (of.fluctuation(run), 0.0), log="y"),
        panel(results, MAIN, MAIN.title, "T rotation − T translation, K", cooler),
        panel(results, MAIN, MAIN.title, "pressure, atm", pressure),
    )


def floor_panel(results):
    """Fluctuation against the accuracy of kspace, for each way to cut off."""
    curves, marks = [], dict(zip(FAMILIES, "so^"))
    for method in FLOOR_METHODS:
        for name, forces in FAMILIES.items():
            runs = [results.floors[replace(forces, accuracy=a).text, method.key] for a in ACCURACIES]
            y = np.array([math.nan if run.lost else of.fluctuation(run) for run in runs])
            look = {"color": LOOKS[method]["color"], "marker": marks[name]}
            label = f"{NAMES[method].replace('`', '')}, {name}"
            curves.append(Curve(label, np.array(ACCURACIES), y, **look))
    words = "fluctuation of the energy, kcal/mol"
    title = f"{MAIN.liquid.title}, step {results.plan.floor_step:g} fs"
    return Panel(title, "accuracy of kspace_style", words, tuple(curves), log="xy")


def find(results):
    """Finding of Results."""
    tables = {"floor": floor_table(results)}
    for scene in SCENES:
        tables |= scene_tables(results, scene)
    measurements = (*main_measurements(results), calibration(results))
    pictures = {
        "drift": partial(draw, panels=drift_panels(results), columns=3, note="crosses: lost"),
        "state": state_panels(results),
        "floor": (floor_panel(results),),
    }
    context = {
        "floors": floors(results),
        "advice": replace(FAMILIES["energy shifted"], accuracy=1e-6).lines,
        "plan": results.plan,
        "scenes": SCENES,
        "main": MAIN,
        "liquids": LIQUIDS,
        "blocks": of.BLOCKS,
        "unit": UNIT,
        "gears": [GEARS[f].variables["values"] for f in ("second", "first")],
    }
    return Finding(measurements, tables, pictures, context)


STUDY = Study("liquids", "Real liquids", 2100.0, measure, find)
