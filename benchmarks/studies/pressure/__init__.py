"""Constant pressure: the barostat of the fix compared with fix rigid/npt/small, and with fix shake and fix npt.

Water with PPPM (``in.water``) shows the drift of the conserved energy.  A crystal of
dumbbells under a different pressure along each axis (``in.crystal``) shows whether each component reaches its target.
"""

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import sem

from benchmarks.engine import Finding, Measurement, Study, Table
from benchmarks.engine.statistics import Mean, allowed, mean_of_series, slope
from gearquat_analysis.tables import with_error

OURS, RIGID, SHAKE = "gear", "rigid", "shake"
SHEARED = "sheared"
METHODS = {OURS: "`fix gear/quat`", RIGID: "`fix rigid/npt/small`", SHAKE: "`fix shake` and `fix npt`"}
WATER, CRYSTAL = (Path(__file__).parent / name for name in ("in.water", "in.crystal"))
MOLECULES, TEMPERATURE, BOLTZMANN = 216, 300.0, 0.0019872067
FREEDOMS = 6 * MOLECULES - 3
DUMBBELLS_KT, TARGETS = 0.5, (0.5, 0.5, 1.5)
#: target of xy in a crystal that shears
SHEAR = 0.3
#: kT/ns per degree of freedom
DRIFT = 0.05
COMPONENTS = ("xx", "yy", "zz", "xy", "xz", "yz")


@dataclass(frozen=True)
class Plan:
    """Sizes of all runs.  Times of water in fs."""

    dts: tuple = (1.0, 2.0)
    time: float = 5_000.0
    equilibrate: float = 500.0
    sample: float = 20.0
    seeds: tuple = tuple(range(1, 9))
    crystal: int = 20_000
    settle: int = 3_000
    blocks: int = 8


QUICK = Plan((2.0,), 500.0, 200.0, seeds=(1, 2), crystal=2_000, settle=1_000, blocks=4)


@dataclass(frozen=True)
class Results:
    """``water``: (method, step, seed) -> columns of a run; ``crystal``: method -> columns; the key SHEARED has a crystal
    that may shear."""

    plan: Plan
    water: dict
    crystal: dict

    def drift(self, method, dt):
        """Drift of the conserved energy in kT/ns/dof: mean over seeds, and its standard error from their scatter.

        The error of a slope within a run is much smaller, because the energy also changes as slowly as the run is long.
        """
        unit = 1e6 / (BOLTZMANN * TEMPERATURE * FREEDOMS)
        runs = [self.water[method, dt, seed] for seed in self.plan.seeds]
        rates = [unit * slope(run["Time"], run["v_conserved"])[0] for run in runs]
        return float(np.mean(rates)), float(sem(rates))

    def sheared(self):
        """All six components of the molecular pressure in the crystal that shears."""
        run = self.crystal[SHEARED]
        return gathered([mean_of_series([run[f"f_move[{16 + k}]"]], self.plan.blocks) for k in range(6)])

    def expected_sheared(self):
        """The exact means: a stretch along x changes three elements of the box, along y two, along z one, and the
        measure contains the volume to the power -2."""
        per_volume = DUMBBELLS_KT / self.crystal[SHEARED]["Volume"].mean()
        return np.array([*TARGETS, SHEAR, 0.0, 0.0]) - per_volume * np.array([1.0, 0.0, -1.0, 0.0, 0.0, 0.0])

    def pressures(self, method):
        """Components of the pressure in the crystal, (3,)."""
        run = self.crystal[method]
        return gathered([mean_of_series([run[name]], self.plan.blocks) for name in ("Pxx", "Pyy", "Pzz")])

    def expected(self):
        """The exact means (3,): the targets minus kT/V, because each edge moves independently."""
        return np.array(TARGETS) - DUMBBELLS_KT / self.crystal[OURS]["Volume"].mean()


def gathered(means):
    """One Mean of arrays from several Means of numbers."""
    return Mean(*(np.array([getattr(m, name) for m in means]) for name in ("value", "error")), means[0].freedoms)


def keep(finished):
    """Columns of the last run: name -> (n,)."""
    return {name: np.array(values) for name, values in finished.thermo.items()}


def measure(lab, plan=None):
    """Results."""
    plan = plan or (QUICK if lab.quick else Plan())

    def sizes(variables):
        dt = variables["dt"]
        rounded = {"steps": plan.time, "equilibrate": plan.equilibrate, "every": plan.sample}
        return {name: round(time / dt) for name, time in rounded.items()}

    axes = {"method": tuple(METHODS), "dt": plan.dts, "seed": plan.seeds}
    water = lab.sweep("water", WATER, axes, keep, sizes)
    settings = {"steps": plan.crystal, "equilibrate": plan.settle}
    crystal = lab.sweep("crystal", CRYSTAL, {"method": (OURS, RIGID)}, keep, settings)
    crystal[SHEARED] = lab.sweep(SHEARED, CRYSTAL, {"method": (OURS,)}, keep, settings | {"pxy": SHEAR})[OURS]
    return Results(plan, water, crystal)


# --- judging ------------------------------------------------------------------------------------
def largest(mean, right):
    """Largest deviation of a Mean (n,) from the exact value, in standard errors, and its bound."""
    return float(np.abs((mean.value - right) / mean.error).max()), allowed(np.size(mean.value), mean.freedoms)


def measurements(results):
    """Measurements with their bounds."""
    plan, rows, errors = results.plan, [], {"spec": ".1f", "unit": "standard errors"}
    for dt in plan.dts:
        for method, words in METHODS.items():
            drift, error = results.drift(method, dt)
            # significant: beyond two standard errors
            most = {"most": DRIFT + 2.0 * error, "least": -DRIFT - 2.0 * error} if method == OURS else {}
            what = f"drift of the conserved energy of water at {dt:g} fs, {words}"
            rows.append(Measurement(what, drift, error, ".2g", "kT/ns/dof", **most))
    shift, most = largest(results.pressures(OURS), results.expected())
    rows.append(Measurement("crystal, largest deviation of a component of the pressure: ours", shift, most=most, **errors))
    shift, most = largest(results.pressures(RIGID), results.expected())
    rows.append(Measurement("the same: `rigid/npt/small`", shift, least=most, **errors))
    shift, most = largest(results.sheared(), results.expected_sheared())
    what = "crystal under a shear stress, largest deviation of one of six components of the pressure"
    rows.append(Measurement(what, shift, most=most, **errors))
    return rows


def water_table(results):
    """A row for each step and method."""
    rows = [
        [f"{dt:g}", METHODS[method], with_error(*results.drift(method, dt), sign="+")]
        for dt, method in itertools.product(results.plan.dts, METHODS)
    ]
    return Table(("step, fs", "method", "drift, kT/ns/dof"), rows)


def crystal_table(results):
    """A row for each component."""
    rows, expected = [], results.expected()
    ours, rigid = (results.pressures(method) for method in (OURS, RIGID))
    for k, name in enumerate(COMPONENTS[:3]):
        cells = [with_error(mean.value[k], mean.error[k]) for mean in (ours, rigid)]
        rows.append([name, f"{TARGETS[k]:g}", f"{expected[k]:.4f}", *cells])
    header = ("component", "target", "exact mean", METHODS[OURS], METHODS[RIGID])
    return Table(header, rows)


def shear_table(results):
    """A row for each of six components."""
    found, right = results.sheared(), results.expected_sheared()
    targets = (*TARGETS, SHEAR, 0.0, 0.0)
    rows = [
        [name, f"{targets[k]:g}", f"{right[k]:.4f}", with_error(found.value[k], found.error[k])]
        for k, name in enumerate(COMPONENTS)
    ]
    return Table(("component", "target", "exact mean", "molecular pressure"), rows)


def find(results):
    """Finding of Results."""
    tables = {"water": water_table(results), "crystal": crystal_table(results), "shear": shear_table(results)}
    context = {"plan": results.plan, "molecules": MOLECULES}
    # for README
    drifts = {
        words: [with_error(*results.drift(m, dt), sign="+") for dt in results.plan.dts] for m, words in METHODS.items()
    }
    context |= {"steps": results.plan.dts, "drifts": drifts, "targets": TARGETS}
    for name, method in (("ours", OURS), ("rigid", RIGID)):
        context[name] = [f"{p:.3f}" for p in results.pressures(method).value]
    return Finding(measurements(results), tables, context=context)


STUDY = Study("pressure", "Constant pressure", 600.0, measure, find, blocks={"doc/pressure.md": "pressure.md.j2", "README.md": "pressure.readme.md.j2"})
