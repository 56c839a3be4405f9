"""Averages of water at constant temperature against the step: chains in the histories, and fix rigid/nvt/small.

Long runs of two models of water with PPPM (``examples/water_nvt/in.models``) show how temperatures, pressure
and potential energy depend on the step, how the conserved energy drifts, and what an answer costs.
"""

import math
from dataclasses import dataclass

import numpy as np

from benchmarks.engine import EXAMPLES, Finding, Measurement, Study, Table, statistics
from benchmarks.engine.statistics import Mean, blocks_of, deviation, mean_of_blocks, slope

MODELS = {"spce": "SPC/E", "tip4p2005": "TIP4P/2005"}
OURS, RIGID = "gear", "rigid"
METHODS = {OURS: "`fix gear/quat temp`", RIGID: "`fix rigid/nvt/small`"}
MOLECULES, TEMPERATURE = 125, 300.0
BOLTZMANN = 0.0019872067
FREEDOMS = 6 * MOLECULES - 3
#: kcal/mol of all molecules in kJ/mol per mole of molecules
KILOJOULES = 4.184 / MOLECULES
QUANTITIES = {
    "difference": "T translation − T rotation, K",
    "pressure": "pressure, atm",
    "potential": "potential energy, kJ/mol",
}


@dataclass(frozen=True)
class Plan:
    """Sizes of all runs; times in fs.

    ``times``: length of the runs at each of ``dts``.  A short step costs more for the same time, so its
    runs are shorter.  ``start``: length of the run of a model that leaves the start of all others, which
    ``equilibrate`` for a while with velocities of their own.
    """

    models: tuple = tuple(MODELS)
    dts: tuple = (0.25, 0.5, 1.0, 2.0)
    times: tuple = (75_000.0, 100_000.0, 150_000.0, 240_000.0)
    start: float = 30_000.0
    equilibrate: float = 2_500.0
    sample: float = 10.0
    blocks: int = 15
    seeds: tuple = (4711,)

    def time(self, dt):
        """Length of the runs with a step."""
        return self.times[self.dts.index(dt)]

    @property
    def finest(self):
        """The step that the other method's answer is taken from."""
        return self.dts[0]

    @property
    def longest(self):
        """The step at which an answer is compared with it."""
        return self.dts[-1]


#: a day of computing
FULL = Plan(times=(1_000_000.0,) * 4, equilibrate=10_000.0, blocks=25)
QUICK = Plan(("spce",), (1.0, 2.0), (400.0, 400.0), 200.0, 100.0, blocks=3)


@dataclass(frozen=True)
class Run:
    """A run: ``time`` (n,) in fs; ``difference`` (n,) of temperatures, ``pressure`` and ``potential`` (n,);
    ``conserved`` (n,) in kcal/mol; ``seconds`` that its steps took."""

    time: np.ndarray
    difference: np.ndarray
    pressure: np.ndarray
    potential: np.ndarray
    conserved: np.ndarray
    seconds: float


@dataclass(frozen=True)
class Results:
    """``runs``: (model, method, step, seed) -> Run."""

    plan: Plan
    runs: dict

    def of(self, model, method, dt):
        """Runs of a setting, one for each seed."""
        return [self.runs[model, method, dt, seed] for seed in self.plan.seeds]

    def mean(self, model, method, dt, quantity):
        """Mean of a quantity from the blocks of all seeds."""
        series = [getattr(run, quantity) for run in self.of(model, method, dt)]
        return mean_of_blocks(np.concatenate([blocks_of(one, self.plan.blocks) for one in series]))

    def drift(self, model, method, dt):
        """Drift of the conserved energy in kT/ns/dof: mean over seeds, and its standard error."""
        unit = 1e6 / (BOLTZMANN * TEMPERATURE * FREEDOMS)
        rates, errors = zip(*(slope(run.time, run.conserved) for run in self.of(model, method, dt)))
        return unit * np.mean(rates), unit * math.hypot(*errors) / len(errors)

    def speed(self, model, method, dt):
        """Seconds of computing for a ns, the fastest of the seeds."""
        return min(run.seconds / (run.time[-1] - run.time[0]) for run in self.of(model, method, dt)) * 1e6


# --- measuring ----------------------------------------------------------------------------------
def read(finished):
    """Run of a finished run."""
    c = finished.thermo
    return Run(
        c["Time"],
        c["v_translation"] - c["v_rotation"],
        c["Press"],
        KILOJOULES * c["PotEng"],
        c["v_conserved"],
        finished.log.seconds,
    )


def measure(lab, plan=None):
    """Results."""
    plan = plan or (QUICK if lab.quick else FULL if lab.full else Plan())
    deck = EXAMPLES / "water_nvt" / "in.models"
    axes = {"model": plan.models, "method": tuple(METHODS), "dt": plan.dts, "seed": plan.seeds}
    sizes = {"equilibrate": 0, "dt": plan.longest, "steps": round(plan.start / plan.longest)}
    with lab.share(0.03):
        lab.sweep("start", deck, {"model": plan.models}, lambda _: None, sizes, keep=True)

    def settings(variables):
        dt = variables["dt"]
        return {
            "start": lab.dump(f"start_{variables['model']}").with_suffix(".data").resolve(),
            "steps": round(plan.time(dt) / dt),
            "equilibrate": round(plan.equilibrate / dt),
            "every": round(plan.sample / dt),
        }

    with lab.share(0.97):
        return Results(plan, lab.sweep("models", deck, axes, read, settings, keep=True))


# --- judging ------------------------------------------------------------------------------------
def farthest(results, model, method, quantity):
    """The largest deviation from the value at the shortest step, in standard errors, and what is allowed."""
    plan = results.plan
    finest = results.mean(model, method, plan.finest, quantity)
    others = [results.mean(model, method, dt, quantity) for dt in plan.dts[1:]]
    largest = max(abs(float(deviation(other, finest))) for other in others)
    return largest, statistics.largest_deviation(finest, others[0], len(others) * len(QUANTITIES))


def answer(results, model, quantity):
    """Ours at the longest step less rigid's at the shortest, in standard errors."""
    plan = results.plan
    ours = results.mean(model, OURS, plan.longest, quantity)
    return float(deviation(ours, results.mean(model, RIGID, plan.finest, quantity)))


def cost_ratio(results, model):
    """How many times longer rigid's shortest step takes for the same time than our longest."""
    plan = results.plan
    theirs, ours = results.speed(model, RIGID, plan.finest), results.speed(model, OURS, plan.longest)
    return theirs / ours


def measurements(results):
    """Measurements with their bounds."""
    rows, errors = [], {"spec": ".1f", "unit": "standard errors"}
    for model in results.plan.models:
        name = MODELS[model]
        for quantity, words in QUANTITIES.items():
            largest, most = farthest(results, model, OURS, quantity)
            what = words.partition(",")[0]
            rows.append(Measurement(f"{name}, {what}: ours, by the step", largest, most=most, **errors))
            off = abs(answer(results, model, quantity))
            rows.append(Measurement(f"{name}, {what}: ours at the longest step", off, most=2.0, **errors))
        shift, most = farthest(results, model, RIGID, "difference")
        rows.append(
            Measurement(f"{name}, temperatures: rigid, by the step", shift, least=most, **errors)
        )
        rows.append(Measurement(f"{name}: time to that answer, ratio", cost_ratio(results, model), spec=".1f"))
    return rows


def text_of(mean: Mean):
    """Value ± standard error, with two digits of the error."""
    value, error = float(mean.value), float(mean.error)
    digits = max(0, 1 - math.floor(math.log10(error))) if error > 0 else 3
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def averages_table(results, model):
    """A row for each method and step."""
    rows = []
    for method, title in METHODS.items():
        for dt in results.plan.dts:
            means = (text_of(results.mean(model, method, dt, quantity)) for quantity in QUANTITIES)
            drift, error = results.drift(model, method, dt)
            speed = f"{results.speed(model, method, dt):.0f}"
            rows.append([title, f"{dt:g}", *means, f"{drift:+.2g} ± {error:.1g}", speed])
    header = ("method", "step, fs", *QUANTITIES.values(), "drift, kT/ns/dof", "seconds per ns")
    return Table(header, rows)


def find(results):
    """Finding of Results."""
    plan = results.plan
    tables = {model: averages_table(results, model) for model in plan.models}
    context = {"plan": plan, "molecules": MOLECULES, "temperature": TEMPERATURE}
    context |= {"models": {model: MODELS[model] for model in plan.models}}
    return Finding(measurements(results), tables, {}, context)


STUDY = Study("thermostat", "Constant temperature", 4_000.0, measure, find)
