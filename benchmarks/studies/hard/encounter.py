"""A charge passes a bare charge of the other sign: the step has to follow the error."""

import numpy as np

from benchmarks.engine import FORMULATIONS, Curve, Finding, Measurement, Panel, deck, floor

TITLE, SECONDS = "Near-singular encounter", 8.0
#: error with a tolerance is at most this, with a fixed step more
BOUND = 1e-8
DISTANCES = ("0.02", "0.002")
TOLERANCE, STEP, END = 1e-15, 0.001, 8.0
#: method -> variables of the deck
METHODS = {f"tolerance, {f}": {"formulation": f, "tolerance": TOLERANCE} for f in FORMULATIONS}
METHODS |= {f"step {STEP:g}, {f}": {"formulation": f, "tolerance": 0} for f in FORMULATIONS}
RIGID = "fix rigid/nve/small"
METHODS[RIGID] = {"method": "rigid", "tolerance": 0}


def depth(results, distance):
    """Depth of the potential that was met: the smaller one of both runs with a tolerance."""
    runs = (results[distance, f"tolerance, {f}"]["c_potential"] for f in FORMULATIONS)
    return min(-float(potential.min()) for potential in runs)


def relative_error(results, distance, method):
    """|E(t) - E(0)| over the depth, (n,); infinite where the energy is no number."""
    total = results[distance, method]["v_total"]
    return np.abs(total - total[0]) / depth(results, distance)


def measure(lab, distances=DISTANCES, **options):
    """(distance, method) -> thermo output, energy at every step."""
    numbers = {str(number): method for number, method in enumerate(METHODS)}

    def settings(run):
        own = METHODS[numbers[run["method_number"]]]
        fixed = {"dt": STEP, "steps": round(END / STEP), "more": "", "until": 0}
        free = {"steps": 1_000_000, "until": END}
        return (free if own["tolerance"] else fixed) | own | options

    axes = {"distance": distances, "method_number": tuple(numbers)}
    runs = lab.sweep(
        "encounter", deck("hard/encounter"), axes, lambda run: run.thermo, settings, may_fail=True
    )
    return {(distance, numbers[number]): table for (distance, number), table in runs.items()}


def find(results):
    """Finding of what ``measure`` returns."""
    measurements = []
    for (distance, method), table in results.items():
        error = relative_error(results, distance, method).max()
        steps, bounds = round(END / STEP), {"least": BOUND}
        name = method
        if METHODS[method]["tolerance"]:
            steps, bounds = len(table["Step"]) - 1, {"most": BOUND}
            name = f"`tolerance`, {method.split(', ')[1]} formulation"
        elif method == RIGID:
            name, bounds = f"step {STEP:g}, `{RIGID}`", {}
        what = f"distance {distance}, {name}: largest error of the energy over the depth"
        measurements.append(Measurement(what, error, remark=f"{steps} steps", **bounds))
    distances = tuple(dict.fromkeys(distance for distance, _ in results))
    panels = tuple(_panel(results, distance) for distance in distances)
    depths = [depth(results, distance) for distance in distances]
    context = {"depths": depths, "tolerance": TOLERANCE}
    return Finding(measurements, pictures={"encounter": panels}, context=context)


def _panel(results, distance):
    """Errors over time."""
    looks = {m: (m.split(", ")[-1], "-" if "tol" in m else ":") for m in METHODS}
    looks[RIGID] = ("rigid", ":")
    curves = []
    for method, (color, line) in looks.items():
        time, off = results[distance, method]["Time"], relative_error(results, distance, method)
        worst = np.maximum.accumulate(floor(off))[1:]
        kept = np.isfinite(worst)
        curves.append(Curve(method, time[1:][kept], worst[kept], color, line))
    title = f"distance {distance}: largest error so far"
    return Panel(title, "time", "energy / depth", tuple(curves))
