"""Real liquids: energy, temperatures and pressure against the step, and what in the forces limits them.

plan.py (what is run), runs.py (LAMMPS' runs), quantities.py (what follows from one run), and here the
measurements, tables and panels.
"""

import math
from functools import partial

import numpy as np

from benchmarks.engine.methods import GEARS, looks
from benchmarks.engine.panels import Curve, Panel, draw
from benchmarks.engine.statistics import with_error
from benchmarks.engine.study import Finding, Measurement, Study, Table

from . import quantities as of
from .plan import ALL_METHODS, FAMILIES, FLOOR_STEP, FLOORS, LIQUIDS, LONG_STEPS, MAIN, NAMES
from .plan import NVE_SMALL, SCENES, SECOND, SINGLE, power
from .runs import measure

#: as many standard errors of a difference are noise, once the errors are scaled to what does not drift
NOISE = 3.0
UNIT = "kT/ns/dof"
#: bounds of drifts in MAIN: step -> largest size; at others the noise around the drift of rigid/nve/small
MOST_DRIFT = {2.5: 0.1}
#: the drift is drawn linearly below this size
LINEAR = 0.01
#: and is a cross above this one
LARGEST = 100.0
#: the darker of a kind come last
LOOKS = looks(ALL_METHODS[::-1])


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
        for dt in scene.liquid.steps
    }


def scene_tables(results, scene):
    """Table of drifts, one step per column, and table of everything else, one run per row."""
    runs, liquid = of_scene(results, scene), scene.liquid
    drifts = [
        [NAMES[method], *(show_drift(runs[method, dt], liquid) for dt in scene.liquid.steps)]
        for method in scene.methods
    ]
    states = [
        [NAMES[method], f"{dt:g}", *show_state(run, liquid)] for (method, dt), run in runs.items()
    ]
    steps = [f"{dt:g} fs" for dt in scene.liquid.steps]
    columns = ["fluctuation, kcal/mol", "T translation, K", "T rotation, K", "rotation − translation, K"]
    return {
        f"drift_{scene.key}": Table((f"drift, {UNIT}", *steps), drifts),
        f"state_{scene.key}": Table(("method", "step, fs", *columns, "pressure, atm"), states),
    }


def show_fluctuation(run):
    """Fluctuation as text, "" without a run."""
    if run is None:
        return ""
    return lost_text(run) if run.lost else f"{of.fluctuation(run):.2g}"


def floor_table(results):
    """Fluctuation, drift and time per step for each way to compute the forces."""
    rows = []
    for forces in FLOORS:
        own, other = (results.floors.get((forces.text, m.key)) for m in (SECOND, NVE_SMALL))
        lines = "<br>".join(f"`{line}`" for line in forces.lines)
        cells = show_fluctuation(own), show_fluctuation(other), show_drift(own, MAIN.liquid)
        rows.append([lines, *cells, f"{1000 * own.seconds:.1f}"])
    names = [f"fluctuation, {NAMES[method]}" for method in (SECOND, NVE_SMALL)]
    return Table(("lines", *names, f"drift, {NAMES[SECOND]}", "ms per step"), rows)


def floors(results):
    """Fluctuations with the default that the sentences name, kcal/mol."""
    words = {"plain": "plain cut-off", "shifted": "energy shifted", "switched": "energy switched"}
    named = {
        word + suffix: next(f for f in FAMILIES[family] if f.accuracy == accuracy)
        for word, family in words.items()
        for suffix, accuracy in (("_coarse", 1e-4), ("", 1e-5), ("_fine", 1e-6))
    }
    named |= {"switched_finest": FAMILIES["energy switched"][-1]}
    named |= dict(zip(("functions", "longer", "order", "ewald", "rare"), SINGLE))
    runs = {word: results.floors[forces.text, SECOND.key] for word, forces in named.items()}
    return {word: math.inf if run.lost else of.fluctuation(run) for word, run in runs.items()}


def advice(results):
    """The cheaper of two ways to the same fine forces."""
    ways = FAMILIES["energy shifted"][-2], SINGLE[2]
    return min(ways, key=lambda forces: results.floors[forces.text, SECOND.key].seconds)


def calibration(results):
    """Root mean square of drift over its error with NO_SQUISH; 1 if errors are right, as it has none."""
    ratios = []
    for scene in SCENES:
        runs = of_scene(results, scene)
        drifts = [of.drift(runs[NVE_SMALL, dt], scene.liquid) for dt in scene.liquid.steps]
        ratios += [rate / error for rate, error in drifts]
    return Measurement(
        f"{NAMES[NVE_SMALL]}, all liquids: root mean square of drift over standard error",
        float(np.sqrt(np.mean(np.square(ratios)))),
        spec=".1f",
    )


def main_measurements(results):
    """What fix gear/quat must hold in MAIN: the default at the short steps, LONG_STEPS at the others."""
    runs, steps = of_scene(results, MAIN), MAIN.liquid.steps
    noise = NOISE * max(1.0, calibration(results).value)
    for method, bounded in ((SECOND, steps[:2]), (LONG_STEPS, steps[2:])):
        for dt in steps:
            yield from drift_measurements(method, dt, runs, noise if dt in bounded else None)


def drift_measurements(method, dt, runs, noise):
    """Drift beside that of rigid/nve/small, and the time without loss.

    ``noise``: as many standard errors of a difference are noise; None for no bounds.
    """
    own, other = runs[method, dt], runs[NVE_SMALL, dt]
    what, longest = f"{MAIN.title}, {dt:g} fs, {NAMES[method]}", max(MAIN.liquid.steps)
    if own.lost or dt == longest:
        length = own.time[-1] / 1000 if len(own.time) else 0.0
        bounds = {"least": 0.999 * own.duration / 1000} if noise else {}
        yield Measurement(f"{what}: time without loss", length, spec=".1f", unit="ps", **bounds)
    if own.lost:
        return
    (rate, error), (theirs, scatter) = (of.drift(run, MAIN.liquid) for run in (own, other))
    bounds = {}
    if noise and dt < longest:
        middle, most = theirs, noise * math.hypot(error, scatter)
        if dt in MOST_DRIFT:
            middle, most = 0.0, MOST_DRIFT[dt]
        bounds = {"least": middle - most, "most": middle + most}
    remark = f"{NVE_SMALL.label}: {with_error(theirs, scatter, '+')}"
    yield Measurement(f"{what}: drift", rate, error, ".4f", UNIT, remark, **bounds)


# --- pictures -------------------------------------------------------------------------------------
def plain_name(method):
    """Name of a method in pictures."""
    return NAMES[method].replace("`", "")


def panel(results, scene, title, ylabel, read, apart=0.0, most=math.inf, **more):
    """Panel of a quantity against the step; ``read(run)``: value and error.

    ``apart``: distance of error bars at the same step, as a part of the largest step.  Runs that were
    lost, or whose value is beyond ``most``, are crosses.
    """
    runs, curves, lost = of_scene(results, scene), [], []
    for k, method in enumerate(scene.methods):
        points = [(dt, *read(runs[method, dt])) for dt in scene.liquid.steps if not runs[method, dt].lost]
        points = [point for point in points if abs(point[1]) <= most]
        x, y, error = np.array(points).reshape(-1, 3).T
        color = LOOKS[method]["color"]
        lost += [(dt, color) for dt in scene.liquid.steps if dt not in x]
        x = x + apart * max(scene.liquid.steps) * (k - (len(scene.methods) - 1) / 2)
        curves.append(Curve(plain_name(method), x, y, **LOOKS[method], error=error))
    more = {"log": "", "legend": False} | more
    return Panel(title, "step, fs", ylabel, curves, xticks=scene.liquid.steps, lost=tuple(lost), **more)


def drift_panels(results):
    """Drift against the step in every scene."""
    return tuple(
        panel(
            results,
            scene,
            scene.title,
            f"drift, {UNIT}",
            partial(of.drift, liquid=scene.liquid),
            most=LARGEST,
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
        panel(results, MAIN, MAIN.title, "T rotation − T translation, K", cooler, 0.01),
        panel(results, MAIN, MAIN.title, "pressure, atm", pressure, 0.01),
    )


def floor_panels(results):
    """Fluctuation against the accuracy of kspace, by way to cut off, and against the step, by accuracy."""
    by_accuracy, by_step, marks, words = [], [], "so^", "fluctuation of the energy, kcal/mol"
    short = {SECOND: "fix gear/quat", NVE_SMALL: NVE_SMALL.label}

    def curve(name, method, mark, runs):
        kept = [(x, of.fluctuation(run)) for x, run in runs.items() if not run.lost]
        look = LOOKS[method] | {"marker": mark}
        return Curve(f"{short[method]}, {name}", *np.array(kept).reshape(-1, 2).T, **look)

    for mark, (name, family) in zip(marks, FAMILIES.items()):
        for method in FLOORS[family[0]]:
            runs = {forces.accuracy: results.floors[forces.text, method.key] for forces in family}
            by_accuracy.append(curve(name, method, mark, runs))
    for mark, scene in zip(marks, (s for s in SCENES if s.liquid is MAIN.liquid)):
        for method in short:
            runs = {dt: results.runs[scene.key, method.key, dt] for dt in scene.liquid.steps}
            by_step.append(curve(f"pppm {power(scene.accuracy)}", method, mark, runs))
    title = f"{MAIN.liquid.title}, step {FLOOR_STEP:g} fs"
    more = {"log": "xy", "columns": 2}
    return (
        Panel(title, "accuracy of kspace_style", words, by_accuracy, **more),
        Panel(f"{MAIN.liquid.title}, energy shifted", "step, fs", words, by_step, xticks=MAIN.liquid.steps, **more),
    )


def find(results):
    """Finding of Results."""
    tables = {"floor": floor_table(results)}
    for scene in SCENES:
        tables |= scene_tables(results, scene)
    measurements = (*main_measurements(results), calibration(results))
    pictures = {
        "drift": partial(draw, panels=drift_panels(results), columns=3, note=f"crosses: lost, or a drift above {LARGEST:g}"),
        "state": state_panels(results),
        "floor": floor_panels(results),
    }
    context = {
        "floors": floors(results),
        "advice": advice(results).lines,
        "plan": results.plan,
        "scenes": SCENES,
        "main": MAIN,
        "liquids": LIQUIDS,
        "blocks": of.BLOCKS,
        "unit": UNIT,
        "floor_step": FLOOR_STEP,
        "gears": GEARS["second"].variables["values"],
    }
    return Finding(measurements, tables, pictures, context)


STUDY = Study("liquids", "Real liquids", 2400.0, measure, find)
