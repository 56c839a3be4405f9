"""Constant kinetic energy: its conservation, and the configurations of water.

Long runs of a few tethered bodies (``examples/isokinetic/in.tethered``) show the conservation of the kinetic energy.
Short runs of rigid water (``in.isokinetic``) compare configurations with fix rigid/nvt/small.
"""

import itertools
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.engine import EXAMPLES, Curve, Finding, Job, Measurement, Panel, Study, Table
from benchmarks.engine import statistics
from benchmarks.engine.panels import draw, floor
from benchmarks.engine.statistics import Mean, deviation, mean_of_blocks, mean_of_series, slope

CONSTRAINTS, THERMOSTAT = ("total", "separate"), "nvt"
METHODS = (*CONSTRAINTS, THERMOSTAT)
TITLES = {
    "total": "`isokinetic total`",
    "separate": "`isokinetic separate`",
    THERMOSTAT: "`fix rigid/nvt/small`",
}
COLORS = {"total": "first", "separate": "momentum", THERMOSTAT: "total"}
MOLECULES, TEMPERATURE = 216, 300.0
SAMPLES = 500
#: kcal/mol of all molecules in kJ/mol per mole of molecules
KILOJOULES = 4.184 / MOLECULES

#: largest relative change of a rescaled kinetic energy
MOST_RESCALED = 1e-13
#: the order of the drift may be smaller than the number of values by this
ORDER_SLACK = 0.5
#: bins with smaller g(r) are empty, because no pair of oxygens is so close
LEAST_DISTRIBUTION = 0.05


@dataclass(frozen=True)
class Plan:
    """Sizes of all runs; times in the units of the scenes (water: fs)."""

    drift_steps: int = 1_000_000
    dts: tuple = (0.0125, 0.025, 0.05)
    values: int = 6
    water_dt: float = 1.5
    water_steps: int = 16_000
    every: int = 20
    blocks: int = 10
    seeds: tuple = (4711, 2718)

    @property
    def block(self):
        """Steps of water in a block, and steps of equilibration."""
        return self.water_steps // self.blocks

    @property
    def rescaled_dt(self):
        """The step of the runs whose momenta are rescaled: the largest."""
        return self.dts[-1]


QUICK = Plan(drift_steps=20_000, dts=(0.05, 0.1), water_steps=400, every=10, seeds=(4711,))


@dataclass(frozen=True)
class Kept:
    """Kinetic energy of a long run: ``time`` (n,); ``error`` (n,), relative to the start.

    With ``total`` it is the error of the total kinetic energy, with ``separate`` the larger error of translation and
    rotation.  ``balance`` (n,): error of potential + kinetic energy + heat, relative to the initial kinetic energy.
    """

    time: np.ndarray
    error: np.ndarray
    balance: np.ndarray

    @property
    def drift(self):
        """Relative drift of the kinetic energy per unit of time, and its standard error."""
        return slope(self.time, self.error)

    @property
    def largest(self):
        """Largest relative change of the kinetic energy."""
        return float(np.abs(self.error).max())


@dataclass(frozen=True)
class Water:
    """A run of water: ``potential``, ``kinetic`` (n,) in kcal/mol, of all molecules.

    ``distance`` (bins,) in Angstrom; ``distribution`` (blocks, bins): g(r) of the oxygens.
    """

    potential: np.ndarray
    kinetic: np.ndarray
    distance: np.ndarray
    distribution: np.ndarray


@dataclass(frozen=True)
class Results:
    """``kept``: (constraint, True if rescaled, step) -> Kept; ``water``: (method, seed) -> Water."""

    plan: Plan
    kept: dict
    water: dict

    def order(self, constraint):
        """Observed order of the drift of the kinetic energy."""
        rates = [abs(self.kept[constraint, False, dt].drift[0]) for dt in self.plan.dts]
        return statistics.order(self.plan.dts, rates)

    def waters(self, method):
        """Runs of a method, one for each seed."""
        return [water for (of, _), water in self.water.items() if of == method]

    def energy(self, method):
        """Mean potential energy of all molecules, from the blocks of all seeds."""
        return mean_of_series([water.potential for water in self.waters(method)], self.plan.blocks)

    def kinetic(self, method):
        """Mean and standard deviation of the kinetic energy of all molecules in a configuration."""
        values = np.concatenate([water.kinetic for water in self.waters(method)])
        return float(values.mean()), float(values.std())

    def distribution(self, method):
        """g(r) with errors, from the blocks of all seeds; distances (bins,) come first."""
        waters = self.waters(method)
        return waters[0].distance, mean_of_blocks(np.concatenate([w.distribution for w in waters]))


# --- measuring ----------------------------------------------------------------------------------
def _relative(values):
    return values / values[0] - 1.0


def read_kept(finished, constraint):
    """Kept of a long run."""
    c = finished.thermo
    translation, rotation = c["f_move[1]"], c["f_move[2]"]
    if constraint == "total":
        error = _relative(translation + rotation)
    else:
        parts = np.array([_relative(translation), _relative(rotation)])
        error = np.take_along_axis(parts, np.abs(parts).argmax(axis=0)[None], axis=0)[0]
    balance = (c["v_all"] - c["v_all"][0]) / (translation[0] + rotation[0])
    return Kept(c["Time"], error, balance)


def read_distribution(path):
    """Distances (bins,) and g (blocks, bins) from a file of fix ave/time in mode vector.

    Raises ValueError if the file has no blocks, or blocks of unequal length.
    """
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    bins = {int(words[1]) for words in rows if len(words) == 2}
    values = np.array([words[1:3] for words in rows if len(words) != 2], dtype=float)
    if len(bins) != 1 or not len(values) or len(values) % max(bins):
        raise ValueError(f"{path}: blocks of unequal length, or none")
    table = values.reshape(-1, max(bins), 2)
    return table[0, :, 0], table[:, :, 1]


def measure_water(lab, plan):
    """(method, seed) -> Water."""
    settings = {"values": plan.values, "dt": f"{plan.water_dt:.17g}", "temperature": TEMPERATURE}
    settings |= {"equilibrate": plan.block, "steps": plan.water_steps}
    settings |= {"every": plan.every, "block": plan.block}

    def read(finished):
        c, file = finished.thermo, finished.dump.with_suffix("")
        return Water(c["PotEng"], c["v_ketrans"] + c["v_kerot"], *read_distribution(file))

    axes = {"constraint": METHODS, "seed": plan.seeds}
    return lab.sweep("water", EXAMPLES / "isokinetic" / "in.isokinetic", axes, read, settings)


def measure_kept(lab, plan):
    """(constraint, True if rescaled, step) -> Kept: every step without rescaling, and the largest with rescaling."""
    steps = {"values": plan.values, "steps": plan.drift_steps}
    steps["every"] = max(1, plan.drift_steps // SAMPLES)
    settings = [(False, dt) for dt in plan.dts] + [(True, plan.rescaled_dt)]
    jobs, names = {}, {}
    for constraint, (rescaled, dt) in itertools.product(CONSTRAINTS, settings):
        own = {"constraint": constraint, "rescale": "yes" if rescaled else "no", "dt": f"{dt:.17g}"}
        name = f"{constraint}_{'rescaled' if rescaled else 'free'}_dt{dt:g}"
        jobs[name] = Job(EXAMPLES / "isokinetic" / "in.tethered", own | steps, plan.drift_steps)
        names[name] = constraint, rescaled, dt
    return {names[name]: read_kept(run, names[name][0]) for name, run in lab.many(jobs).items()}


def measure(lab, plan=None):
    """Results."""
    plan = plan or (QUICK if lab.quick else Plan())
    with lab.share(0.9):
        water = measure_water(lab, plan)
    with lab.share(0.1):
        return Results(plan, measure_kept(lab, plan), water)


# --- judging ------------------------------------------------------------------------------------
def energy_deviation(results, constraint):
    """Deviation of the mean energy from the thermostat, in standard errors, and its bound."""
    ours, theirs = results.energy(constraint), results.energy(THERMOSTAT)
    most = statistics.largest_deviation(ours, theirs, len(CONSTRAINTS))
    return float(deviation(ours, theirs)), most


def compare_distributions(results, constraint):
    """Deviation of g(r) from the thermostat (bins,) in bins with pairs; the same in standard errors; its bound."""
    (_, ours), (_, theirs) = (results.distribution(of) for of in (constraint, THERMOSTAT))
    there = np.minimum(ours.value, theirs.value) > LEAST_DISTRIBUTION
    ours, theirs = (Mean(m.value[there], m.error[there], m.freedoms) for m in (ours, theirs))
    most = statistics.largest_deviation(ours, theirs, int(there.sum()))
    return ours.value - theirs.value, deviation(ours, theirs), most


def measurements(results):
    """Measurements with their bounds."""
    plan, rows, errors = results.plan, [], {"spec": ".1f", "unit": "standard errors"}
    for constraint in CONSTRAINTS:
        change = results.kept[constraint, True, plan.rescaled_dt].largest
        energy, most_energy = energy_deviation(results, constraint)
        _, distribution, most = compare_distributions(results, constraint)
        rows += [
            Measurement(
                f"{constraint}: order of the drift of the kinetic energy",
                results.order(constraint),
                spec=".2f",
                least=plan.values - ORDER_SLACK,
            ),
            Measurement(
                f"{constraint}, rescaled: largest relative change of the kinetic energy",
                change,
                most=MOST_RESCALED,
            ),
            Measurement(
                f"{constraint}: mean energy of water, deviation from the thermostat",
                abs(energy),
                most=most_energy,
                **errors,
            ),
            Measurement(
                f"{constraint}: g(r) of water, largest deviation from the thermostat",
                float(np.abs(distribution).max()),
                most=most,
                **errors,
            ),
        ]
    return rows


def kinetic_table(results):
    """Drift, largest change and balance of the tethered bodies by step."""
    plan = results.plan
    keys = [(False, dt) for dt in plan.dts] + [(True, plan.rescaled_dt)]
    columns = {
        "drift of K/K(0) in the run": lambda kept, dt: kept.drift[0] * plan.drift_steps * dt,
        "largest change of K/K(0)": lambda kept, dt: kept.largest,
        "largest error of the balance of energies, in units of K": (
            lambda kept, dt: abs(kept.balance).max()
        ),
    }
    rows = []
    for words, value in columns.items():
        for constraint in CONSTRAINTS:
            numbers = [value(results.kept[constraint, *key], key[1]) for key in keys]
            rows.append([f"{TITLES[constraint]}: {words}", *(f"{x:.1e}" for x in numbers)])
    return Table(("", *(f"step {dt:g}" + ", rescaled" * fixed for fixed, dt in keys)), rows)


def water_table(results):
    """Energies of water and deviations from the thermostat."""
    rows = []
    for method in METHODS:
        mean = results.energy(method)
        value, error = KILOJOULES * float(mean.value), KILOJOULES * float(mean.error)
        kinetic, scatter = (KILOJOULES * number for number in results.kinetic(method))
        row = [TITLES[method], f"{value:.3f} ± {error:.3f}", f"{kinetic:.4f} ± {scatter:.1g}"]
        row += ["", ""]
        if method != THERMOSTAT:
            off, z, _ = compare_distributions(results, method)
            row[3] = f"{energy_deviation(results, method)[0]:+.1f}"
            row[4] = f"{abs(z).max():.1f} ({abs(off).max():.2g}), rms {np.sqrt(np.mean(z**2)):.2f}"
        rows.append(row)
    header = (
        "water",
        "potential energy, kJ/mol, ± standard error",
        "kinetic energy, kJ/mol, ± its fluctuation",
        "deviation of the energy, standard errors",
        "largest deviation of g(r), standard errors (value)",
    )
    return Table(header, rows)


# --- picture ------------------------------------------------------------------------------------
def panels(results):
    """Kinetic energy over time, its drift by step, g(r) and its differences."""
    dts = results.plan.dts
    history, drifts, distributions, differences = [], [], [], []
    _, theirs = results.distribution(THERMOSTAT)
    for method in METHODS:
        color, title = COLORS[method], TITLES[method].strip("`")
        r, g = results.distribution(method)
        seen = r >= 2.0
        distributions.append(Curve(title, r[seen], g.value[seen], color))
        if method == THERMOSTAT:
            continue
        error, off = np.hypot(g.error, theirs.error), g.value - theirs.value
        differences.append(Curve(title, r[seen], off[seen], color, "", ".", error[seen]))
        for dt, width in zip(dts, np.linspace(0.6, 1.8, len(dts))):
            kept = results.kept[method, False, dt]
            label = title if dt == dts[-1] else ""
            history.append(Curve(label, kept.time[1:], floor(kept.error[1:]), color, width=width))
        kept = results.kept[method, True, results.plan.rescaled_dt]
        history.append(Curve("", kept.time[1:], floor(kept.error[1:]), color, "", "."))
        rates = [abs(results.kept[method, False, dt].drift[0]) for dt in dts]
        label = f"{title}, order {results.order(method):.1f}"
        drifts.append(Curve(label, np.array(dts), np.array(rates), color, "-", "o"))
    title = "kinetic energy, thicker for longer steps; dots: rescaled"
    drift, pairs = "drift of K/K(0) per unit of time", "r of two oxygens, Å"
    return (
        Panel(title, "time", "|K/K(0) - 1|", tuple(history), log="xy"),
        Panel("drift by step", "step", drift, tuple(drifts), log="xy", xticks=tuple(dts)),
        Panel("pair distribution of water", pairs, "g(r)", tuple(distributions), log=""),
        Panel("minus g(r) with the thermostat", pairs, "g(r)", tuple(differences), log=""),
    )


def find(results):
    """Finding of Results."""
    plan = results.plan
    context = {
        "plan": plan,
        "molecules": MOLECULES,
        "temperature": TEMPERATURE,
        "picoseconds": plan.water_steps * plan.water_dt / 1000,
        "confidence": statistics.CONFIDENCE,
        "least": LEAST_DISTRIBUTION,
    }
    tables = {"kinetic": kinetic_table(results), "water": water_table(results)}
    picture = partial(draw, panels=panels(results), columns=2)
    return Finding(measurements(results), tables, {"isokinetic": picture}, context)


STUDY = Study("isokinetic", "Constant kinetic energy", 360.0, measure, find)
