"""Averages of water at constant temperature against the step, with the chains of the fix and with fix rigid/nvt/small.

Long runs of two models of water with PPPM (``examples/water_nvt/in.models``) show the dependence of temperatures,
pressure and potential energy on the step, the drift of the conserved energy, and the cost.
"""

import itertools
import math
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.engine import EXAMPLES, Curve, Finding, Job, Measurement, Panel, Study, Table
from benchmarks.engine import draw, floor, statistics
from benchmarks.engine.statistics import Mean, deviation, mean_of_series, slope, with_error

MODELS = {"spce": "SPC/E", "tip4p2005": "TIP4P/2005"}
OURS, RIGID = "gear", "rigid"
METHODS = {OURS: "`fix gear/quat`", RIGID: "`fix rigid/nvt/small`"}
COLORS = {OURS: "second", RIGID: "rigid"}
DECK = EXAMPLES / "water_nvt" / "in.models"
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
DRIFT = "drift, kT/ns/dof"
#: exact value for equal temperatures
EQUIPARTITION = Mean(np.array(0.0), np.array(0.0), 0)


@dataclass(frozen=True)
class Plan:
    """Sizes of all runs; times in fs.

    ``times``: length of the runs for each of ``dts``; runs with a short step are shorter, because they cost more.
    ``start``: length of the run of a model that provides the start of all others.  ``equilibrate``: equilibration of
    the others, with new velocities.
    """

    models: tuple = tuple(MODELS)
    dts: tuple = (0.25, 0.5, 1.0, 2.0)
    times: tuple = (75_000.0, 40_000.0, 70_000.0, 150_000.0)
    start: float = 30_000.0
    equilibrate: float = 2_500.0
    sample: float = 10.0
    blocks: int = 15
    seeds: tuple = (4711,)
    timed_steps: int = 500
    rounds: int = 3

    def time(self, dt):
        """Length of the runs with a step."""
        return self.times[self.dts.index(dt)]

    @property
    def finest(self):
        """The step of the other method in the comparison of averages."""
        return self.dts[0]

    @property
    def longest(self):
        """The step of fix gear/quat in the comparison of averages."""
        return self.dts[-1]


#: a day of computing
FULL = Plan(times=(1_000_000.0,) * 4, equilibrate=10_000.0, blocks=25)
QUICK = Plan(("spce",), (1.0, 2.0), (400.0, 400.0), 200.0, 100.0, blocks=3, timed_steps=50, rounds=1)


@dataclass(frozen=True)
class Run:
    """A run: ``time`` (n,) in fs; ``difference`` (n,) of temperatures, ``pressure`` and ``potential`` (n,);
    ``conserved`` (n,) in kcal/mol."""

    time: np.ndarray
    difference: np.ndarray
    pressure: np.ndarray
    potential: np.ndarray
    conserved: np.ndarray


@dataclass(frozen=True)
class Results:
    """``runs``: (model, method, step, seed) -> Run; ``seconds``: (model, method, step) -> seconds per step, by round."""

    plan: Plan
    runs: dict
    seconds: dict

    def of(self, model, method, dt):
        """Runs of a setting, one for each seed."""
        return [self.runs[model, method, dt, seed] for seed in self.plan.seeds]

    def mean(self, model, method, dt, quantity):
        """Mean of a quantity from the blocks of all seeds."""
        series = [getattr(run, quantity) for run in self.of(model, method, dt)]
        return mean_of_series(series, self.plan.blocks)

    def drift(self, model, method, dt):
        """Drift of the conserved energy in kT/ns/dof: mean over seeds, and its standard error."""
        unit = 1e6 / (BOLTZMANN * TEMPERATURE * FREEDOMS)
        rates, errors = zip(*(slope(run.time, run.conserved) for run in self.of(model, method, dt)))
        return unit * np.mean(rates), unit * math.hypot(*errors) / len(errors)

    def seconds_per_ns(self, model, method, dt):
        """Computing time in seconds per ns: the shortest of all rounds, because other work on a machine only adds time."""
        return 1e6 / dt * min(self.seconds[model, method, dt])


# --- measuring ----------------------------------------------------------------------------------
def read(finished):
    """Run of a finished run."""
    c = finished.thermo
    difference = c["v_translation"] - c["v_rotation"]
    return Run(c["Time"], difference, c["Press"], KILOJOULES * c["PotEng"], c["v_conserved"])


def measure_starts(lab, plan):
    """Model -> data file with the start of all its other runs."""
    sizes = {"equilibrate": 0, "dt": plan.longest, "steps": round(plan.start / plan.longest)}

    def read_place(finished):
        return finished.dump.with_suffix(".data").resolve()

    return lab.sweep("start", DECK, {"model": plan.models}, read_place, sizes, keep=True)


def measure_times(lab, plan, starts):
    """(model, method, step) -> seconds per step, by round."""
    steps, jobs = plan.timed_steps, {}
    for model, method, dt in itertools.product(plan.models, METHODS, plan.dts):
        setting = {"model": model, "method": method, "dt": dt, "start": starts[model]}
        setting |= {"equilibrate": 0, "steps": steps, "every": steps}
        jobs[model, method, dt] = Job(DECK, setting, steps)
    names = {f"timed_{model}_{method}_{dt}": (model, method, dt) for model, method, dt in jobs}
    timed = lab.in_turn({name: jobs[key] for name, key in names.items()}, plan.rounds)
    return {names[name]: [run.log.seconds / steps for run in runs] for name, runs in timed.items()}


def measure(lab, plan=None):
    """Results."""
    plan = plan or (QUICK if lab.quick else FULL if lab.full else Plan())
    with lab.share(0.03):
        starts = measure_starts(lab, plan)

    def settings(variables):
        dt = variables["dt"]
        return {
            "start": starts[variables["model"]],
            "steps": round(plan.time(dt) / dt),
            "equilibrate": round(plan.equilibrate / dt),
            "every": round(plan.sample / dt),
        }

    axes = {"model": plan.models, "method": tuple(METHODS), "dt": plan.dts, "seed": plan.seeds}
    with lab.share(0.94):
        runs = lab.sweep("models", DECK, axes, read, settings, keep=True)
    with lab.share(0.03):
        return Results(plan, runs, measure_times(lab, plan, starts))


# --- judging ------------------------------------------------------------------------------------
def farthest(results, model, method, quantity):
    """The largest deviation at any step, in standard errors, and its bound.

    It is the deviation from equal temperatures, or from the value at the shortest step.
    """
    means = [results.mean(model, method, dt, quantity) for dt in results.plan.dts]
    right = EQUIPARTITION if quantity == "difference" else means.pop(0)
    largest = max(abs(float(deviation(mean, right))) for mean in means)
    return largest, statistics.largest_deviation(means[-1], right, len(means) * len(QUANTITIES))


def answer(results, model, quantity):
    """Average of ours at the longest step minus rigid's at the shortest, in standard errors."""
    plan = results.plan
    ours = results.mean(model, OURS, plan.longest, quantity)
    return float(deviation(ours, results.mean(model, RIGID, plan.finest, quantity)))


def cost_ratio(results, model):
    """Ratio of times per ns: rigid's shortest step over our longest."""
    plan = results.plan
    theirs = results.seconds_per_ns(model, RIGID, plan.finest)
    return theirs / results.seconds_per_ns(model, OURS, plan.longest)


def measurements(results):
    """Measurements with their bounds."""
    plan, rows, errors = results.plan, [], {"spec": ".1f", "unit": "standard errors"}
    same = f"{plan.longest:g} fs of ours and {plan.finest:g} fs of `rigid/nvt/small`"
    for model in plan.models:
        name = MODELS[model]
        for quantity, title in QUANTITIES.items():
            what = f"{name}, {title.partition(',')[0]}"
            right = "0" if quantity == "difference" else f"the value at {plan.finest:g} fs"
            shift, most = farthest(results, model, RIGID, quantity)
            least = most if quantity == "difference" else None
            ours = farthest(results, model, OURS, quantity)[0]
            off = f"{what}, largest deviation from {right} at any step:"
            rows.append(Measurement(f"{off} `rigid/nvt/small`", shift, least=least, **errors))
            rows.append(Measurement(f"{off} ours", ours, most=most, **errors))
            apart = abs(answer(results, model, quantity))
            rows.append(Measurement(f"{what}, difference of {same}", apart, most=2.0, **errors))
        times = f"{plan.finest:g} fs of `rigid/nvt/small` over {plan.longest:g} fs of ours"
        ratio = cost_ratio(results, model)
        rows.append(Measurement(f"{name}, ratio of times per ns, {times}", ratio, spec=".1f"))
    return rows


def deviations_table(results):
    """A row for each model and quantity, all in standard errors."""
    rows, plan = [], results.plan
    for model, (quantity, title) in itertools.product(plan.models, QUANTITIES.items()):
        largest = [farthest(results, model, method, quantity)[0] for method in (RIGID, OURS)]
        numbers = [f"{number:.1f}" for number in (*largest, answer(results, model, quantity))]
        rows.append([f"{MODELS[model]}: {title.partition(',')[0]}", *numbers])
    both = f"{plan.longest:g} fs of {METHODS[OURS]} minus {plan.finest:g} fs of {METHODS[RIGID]}"
    header = ("deviation in standard errors", f"{METHODS[RIGID]}, largest", f"{METHODS[OURS]}, largest", both)
    return Table(header, rows)


def averages_table(results, model):
    """A row for each method and step."""
    rows, plan = [], results.plan
    for method, dt in itertools.product(METHODS, plan.dts):
        means = [results.mean(model, method, dt, quantity) for quantity in QUANTITIES]
        cells = [with_error(float(mean.value), float(mean.error)) for mean in means]
        cells.append(with_error(*results.drift(model, method, dt), sign="+"))
        cells.append(f"{results.seconds_per_ns(model, method, dt):.0f}")
        rows.append([METHODS[method], f"{dt:g}", f"{plan.time(dt) / 1000:g}", *cells])
    header = ("method", "step, fs", "run, ps", *QUANTITIES.values(), DRIFT, "seconds per ns")
    return Table(header, rows)


# --- picture ------------------------------------------------------------------------------------
def panels(results, model):
    """Averages and the drift against the step."""
    dts, found = results.plan.dts, []
    for quantity, title in QUANTITIES.items():
        curves = []
        if quantity == "difference":
            curves.append(Curve("", np.array(dts), np.zeros(len(dts)), "#666666", width=0.6))
        for method, words in METHODS.items():
            means = [results.mean(model, method, dt, quantity) for dt in dts]
            value, error = (np.array([getattr(m, name) for m in means], float) for name in ("value", "error"))
            look = {"color": COLORS[method], "marker": "o", "error": error}
            curves.append(Curve(words.strip("`"), np.array(dts), value, **look))
        found.append(Panel(title.partition(",")[0], "step, fs", title, curves, log="x", xticks=dts, legend=False))
    curves = []
    for method, words in METHODS.items():
        rates, errors = np.array([results.drift(model, method, dt) for dt in dts]).T
        curves.append(Curve("", np.array(dts), floor(rates), COLORS[method], "-", "o", errors))
    drift = "drift of the conserved energy"
    found.append(Panel(drift, "step, fs", f"size of the {DRIFT}", curves, log="xy", xticks=dts, legend=False))
    return found


def find(results):
    """Finding of Results."""
    plan = results.plan
    tables = {model: averages_table(results, model) for model in plan.models}
    tables["deviations"] = deviations_table(results)
    pictures = {model: partial(draw, panels=panels(results, model), columns=2) for model in plan.models}
    context = {"plan": plan, "molecules": MOLECULES, "temperature": TEMPERATURE}
    context["ratios"] = {MODELS[model]: cost_ratio(results, model) for model in plan.models}
    context["confidence"] = statistics.CONFIDENCE
    context["beyond"] = [
        f"the {QUANTITIES[quantity].partition(',')[0]} of {MODELS[model]}"
        for model, quantity in itertools.product(plan.models, QUANTITIES)
        for largest, most in [farthest(results, model, OURS, quantity)]
        if largest > most
    ]
    context |= {"models": {model: MODELS[model] for model in plan.models}}
    return Finding(measurements(results), tables, pictures, context)


STUDY = Study("thermostat", "Constant temperature", 1_000.0, measure, find)
