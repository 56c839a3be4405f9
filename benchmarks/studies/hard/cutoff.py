"""500 water molecules with a plain cut-off: no blow-up, and drift beside fix rigid/nve/small's."""

from dataclasses import dataclass

import numpy as np

from benchmarks.studies.drift.judge import slope
from benchmarks.engine.tables import Row
from .case import Case, Curve, Finding, Panel

STEP, STEPS, EVERY = 2.0, 2500, 10
RIGID = "fix rigid/nve/small"
#: method -> variables of the deck; the first is the yardstick, the last two have too many values
METHODS = {
    RIGID: {"method": "rigid"},
    "second, N = 8 (default)": {"formulation": "second"},
    "second, N = 6": {"formulation": "second", "values": 6},
    "first, N = 6 (default)": {"formulation": "first"},
    "first, N = 5": {"formulation": "first", "values": 5},
    "second, N = 9": {"formulation": "second", "values": 9},
    "first, N = 7": {"formulation": "first", "values": 7},
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
        found, error = slope(self.time[half:], self.total[half:])
        return 1e3 * found, 1e3 * error


def _drift(water):
    return "{:.0f} ± {:.0f}".format(*water.drift)


def _fate(water):
    if not water.lost:
        return f"{water.hot:.0f} K"
    return f"lost by {(water.time[-1] + EVERY * STEP) / 1000:g} ps"


def judge(results):
    """Rows; ``results``: method -> Water."""
    rigid, rows = results[RIGID], []
    for method, water in results.items():
        if method == RIGID or method in TOO_MANY:
            continue
        if water.lost:
            measured, met = _fate(water), False
        else:
            measured = f"{water.hot:.0f} K ({rigid.hot:.0f} K), drift {_drift(water)} "
            measured += f"({_drift(rigid)}) kcal/mol/ps"
            met = bool(water.hot <= HOTTER * rigid.hot)
        rows.append(
            Row(
                f"{method}: mean temperature and drift of the second half (`{RIGID}`)",
                f"no blow-up: at most {HOTTER:g} times as hot",
                measured,
                met,
            )
        )
    return tuple(rows)


def panels(results):
    """Temperature and energy over time."""
    colours = dict(zip(METHODS, ("rigid", "second", "translation", "first", "rotation")))
    hot, energy = [], []
    for method, colour in colours.items():
        water = results[method]
        hot.append(Curve(method, water.time / 1000, water.temperature, colour))
        energy.append(
            Curve(method, water.time / 1000, (water.total - water.total[0]) / 1000, colour)
        )
    return (
        Panel("step 2 fs", "time, ps", "temperature, K", tuple(hot), log=""),
        Panel("step 2 fs", "time, ps", "energy - start, 1000 kcal/mol", tuple(energy), log=""),
    )


def measure(runs, methods=tuple(METHODS), steps=STEPS, **options):
    """method -> Water."""
    variables = {
        f"run{number}": METHODS[method] | {"dt": STEP, "steps": steps, "every": EVERY} | options
        for number, method in enumerate(methods)
    }
    found = runs.many("cutoff", variables, may_fail=True)
    results = {}
    for method, finished in zip(methods, found.values()):
        table = finished.thermo
        finite = np.isfinite(table["v_total"])
        columns = (table[name][finite] for name in ("Time", "v_total", "Temp"))
        results[method] = Water(*columns, bool(finished.error) or not finite.all())
    return results


def run(runs):
    """Finding of the case."""
    results = measure(runs)
    fates = "; ".join(f"{method}: {_fate(results[method])}" for method in TOO_MANY)
    text = (
        f"{STEPS * STEP / 1000:g} ps at {STEP:g} fs from water that was equilibrated with smooth "
        "forces. The plain cut-off heats it whoever integrates: the energy jumps by kcal/mol whenever "
        "a charge crosses 8 Å. A history of too many values carries each jump on, at this step those "
        f"with one more than the default ({fates}). With forces that are smooth at the cut-off see "
        "[what accuracy costs](accuracy_cost.md)."
    )
    return Finding(judge(results), panels(results), text)


CASE = Case(
    "cutoff",
    "500 water molecules with a plain cut-off",
    "Forces jump; no method keeps its order.",
    60.0,
    run,
)
