"""500 water molecules with a plain cut-off: no blow-up, and drift beside fix rigid/nve/small's."""

from dataclasses import dataclass

import numpy as np

from benchmarks.engine import Curve, Finding, Measurement, Panel, deck
from benchmarks.engine.statistics import slope

TITLE, SECONDS = "500 water molecules with a plain cut-off", 60.0
STEP, STEPS, EVERY = 2.0, 2500, 10
RIGID = "fix rigid/nve/small"
#: method -> variables of the deck; the first is the yardstick, the last two have too many values
METHODS = {
    RIGID: {"method": "rigid"},
    "second, N = 9 (default)": {"formulation": "second"},
    "second, N = 7": {"formulation": "second", "values": 7},
    "first, N = 8 (default)": {"formulation": "first"},
    "first, N = 6": {"formulation": "first", "values": 6},
    "second, N = 9, Gear's": {"formulation": "second", "values": 9, "corrector": "gear"},
    "first, N = 8, Gear's": {"formulation": "first", "values": 8, "corrector": "gear"},
}
TOO_MANY = tuple(METHODS)[-2:]
#: temperature, by the end, over that of fix rigid/nve/small: no blow-up
HOTTER = 1.25


@dataclass(frozen=True)
class Water:
    """One run: ``time`` (fs), ``total`` energy (kcal/mol), ``temperature`` (K), each (n,).

    ``lost``: whether LAMMPS ended it.
    """

    time: np.ndarray
    total: np.ndarray
    temperature: np.ndarray
    lost: bool

    @property
    def hot(self):
        """Mean temperature of the second half."""
        return float(self.temperature[len(self.temperature) // 2 :].mean())

    @property
    def drift(self):
        """Slope of the energy over the second half, kcal/mol/ps, and its standard error."""
        half = len(self.time) // 2
        rate, error = slope(self.time[half:], self.total[half:])
        return 1e3 * rate, 1e3 * error

    @property
    def end(self):
        """Time in ps by which a run was lost."""
        return (self.time[-1] + EVERY * STEP) / 1000


def read(finished):
    """Water of a run."""
    table = finished.thermo
    finite = np.isfinite(table["v_total"])
    columns = (table[name][finite] for name in ("Time", "v_total", "Temp"))
    return Water(*columns, bool(finished.error) or not finite.all())


def measure(lab, methods=tuple(METHODS), steps=STEPS, **options):
    """method -> Water."""
    names = tuple(METHODS)
    settings = {"dt": STEP, "steps": steps, "every": EVERY} | options

    def of_method(run):
        return METHODS[names[run["method_number"]]] | settings

    axes = {"method_number": [names.index(method) for method in methods]}
    runs = lab.sweep("cutoff", deck("hard/cutoff"), axes, read, of_method, may_fail=True)
    return {names[number]: water for number, water in runs.items()}


def find(results):
    """Finding of what ``measure`` returns."""
    measurements, hottest = [], HOTTER * results[RIGID].hot
    colors = dict(zip(METHODS, ("rigid", "second", "translation", "first", "rotation")))
    hot, energy = [], []
    for method, color in colors.items():
        if method not in results:
            continue
        water = results[method]
        what = f"{method}: mean temperature of the second half"
        if water.lost:
            lost = f"lost by {water.end:g} ps"
            measurements.append(Measurement(what, np.inf, remark=lost, most=0))
        else:
            most = None if method == RIGID else hottest
            measurements.append(Measurement(what, water.hot, spec=".0f", unit="K", most=most))
            what = f"{method}: drift of the energy in the second half"
            measurements.append(Measurement(what, *water.drift, spec=".0f", unit="kcal/mol/ps"))
        time = water.time / 1000
        hot.append(Curve(method, time, water.temperature, color))
        energy.append(Curve(method, time, (water.total - water.total[0]) / 1000, color))
    panels = (
        Panel("step 2 fs", "time, ps", "temperature, K", tuple(hot), log=""),
        Panel("step 2 fs", "time, ps", "energy - start, 1000 kcal/mol", tuple(energy), log=""),
    )
    many = {method: results[method] for method in TOO_MANY if method in results}
    context = {"many": many, "picoseconds": STEPS * STEP / 1000, "step": STEP}
    return Finding(measurements, pictures={"cutoff": panels}, context=context)
