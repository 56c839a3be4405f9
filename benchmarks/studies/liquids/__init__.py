"""Real liquids: drift of the energy against the step.

Another liquid needs an entry in LIQUIDS, and its files ``liquid.KEY`` and ``molecule.KEY``.
"""

import itertools
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.constants import Avogadro
from scipy.stats import sem

from benchmarks.engine import EXAMPLES, Finding, Job, Measurement, Study, Table
from benchmarks.engine.methods import AUTOMATIC, rigid
from benchmarks.engine.statistics import slope
from gearquat_analysis.tables import with_error

RIGID = rigid("rigid/nve/small", "rigid")
NAMES = {AUTOMATIC: "`fix gear/quat`", RIGID: f"`{RIGID.label}`"}
#: steps in fs, and the time between samples, a multiple of all steps
STEPS, INTERVAL = (2.0, 3.0, 4.0), 60.0
BOLTZMANN, FEMTOSECONDS = 0.0019872067, 1e6  # kcal/mol/K; in a nanosecond
UNIT = "kT/ns/dof"
#: step in fs -> largest size of the drift of water, plus WITHIN standard errors
MOST_DRIFT, WITHIN = {2.0: 0.02, 3.0: 0.03, 4.0: 0.35}, 2.0
#: LAMMPS' messages if numbers are not finite or atoms move too far
LOST = ("Non-numeric", "Fix gear/quat: blow-up", "Out of range atoms", "Lost atoms", "Rigid body atoms", "Bond atoms missing")


@dataclass(frozen=True)
class Liquid:
    """A liquid of ``edge``^3 rigid molecules at a ``density`` in g/cm^3 and a ``temperature`` in K.

    ``mass`` of a molecule in g/mol; ``types``: number of atom types; ``axes``: number of axes of rotation; ``pair``,
    ``kspace``: LAMMPS' styles; ``accuracy`` of kspace.
    """

    key: str
    title: str
    edge: int
    density: float
    temperature: float
    mass: float
    types: int = 2
    axes: int = 3
    pair: str = "lj/cut/coul/long 9"
    kspace: str = "pppm"
    accuracy: str = "1e-5"

    @property
    def molecules(self):
        """Their number."""
        return self.edge**3

    @property
    def length(self):
        """Edge of the box in Angstrom."""
        return (self.molecules * self.mass / (self.density * 1e-24 * Avogadro)) ** (1 / 3)

    @property
    def freedoms(self):
        """Degrees of freedom of translation (without the total momentum) and of rotation."""
        return 3 * self.molecules - 3, self.axes * self.molecules


SPCE = Liquid("spce", "SPC/E water", 6, 0.997, 298.15, 18.0154)
WATER4 = Liquid(
    "tip4p",
    "TIP4P/2005 water",
    5,
    0.997,
    298.15,
    18.0154,
    pair="lj/cut/tip4p/long 1 2 1 1 0.1546 9",
    kspace="pppm/tip4p",
)
WATERS = (SPCE, WATER4)
LIQUIDS = (
    *WATERS,
    Liquid("co2", "TraPPE carbon dioxide", 5, 1.046, 250.0, 44.0098, axes=2),
    # small charges: with pppm 1e-5 their real-space part is so large at the cut-off that energies jump there
    Liquid("benzene", "OPLS-AA benzene", 4, 0.876, 298.15, 78.114, accuracy="1e-6"),
    Liquid("nitrogen", "TraPPE nitrogen", 5, 0.807, 77.0, 28.0134, axes=2),
    Liquid("methanol", "TraPPE-UA methanol", 5, 0.787, 298.15, 32.0419, types=3),
)


@dataclass(frozen=True)
class Plan:
    """Number of starts; durations of runs in ps of water and of the other liquids; steps of the ``equilibration`` and,
    before it, steps of ``shrinking`` until a liquid has its density."""

    starts: int = 5
    duration: float = 12.0
    short: float = 6.0
    equilibration: int = 5000
    shrinking: int = 4000


QUICK = Plan(1, 1.26, 1.26, 500, 1000)


@dataclass(frozen=True)
class Run:
    """Samples (n,) at ``time`` in fs of energies in kcal/mol: all, of translation and of rotation; ``duration``:
    requested, fs."""

    time: np.ndarray
    total: np.ndarray
    translation: np.ndarray
    rotation: np.ndarray
    duration: float

    @property
    def lost(self):
        """True if the run ended early or has numbers that are not finite."""
        return not len(self.time) or self.time[-1] < 0.999 * self.duration


@dataclass(frozen=True)
class Results:
    """``runs``: (key of liquid, key of method, step) -> list of Run, one for each start."""

    plan: Plan
    runs: dict


# --- runs -----------------------------------------------------------------------------------------
def _deck(name):
    return Path(__file__).with_name(f"in.{name}")


def template(liquid):
    """Molecule file of the liquid; the one for SPC/E is in examples/water."""
    name = f"molecule.{liquid.key}"
    own = Path(__file__).with_name(name)
    return own if own.is_file() else EXAMPLES / "water" / name


def equilibrate(lab, plan, liquids_and_numbers):
    """(key of liquid, number of start) -> path of its data file, from pairs of a Liquid and numbers of starts."""
    jobs, data = {}, {}
    names = "types", "edge", "density", "mass", "temperature", "pair", "kspace"
    for liquid, numbers in liquids_and_numbers:
        own = {"liquid": liquid.key} | {name: getattr(liquid, name) for name in names}
        own |= {"template": template(liquid), "steps": plan.equilibration, "shrinking": plan.shrinking}
        for start in numbers:
            name = f"equilibrate_{liquid.key}_{start}"
            jobs[name] = Job(_deck("equilibrate"), own | {"seed": 4711 + start}, plan.equilibration)
            data[liquid.key, start] = lab.dump(name).with_suffix(".data").resolve()
    lab.many(jobs)
    return data


def job(liquid, data, method, dt, duration, interval=INTERVAL):
    """Job of in.liquid; ``data``: path, ``dt``, ``duration`` and ``interval`` in fs."""
    every = round(interval / dt)
    steps = every * math.ceil(duration / (every * dt) - 1e-9)
    variables = {"liquid": liquid.key, "data": data, "pair": liquid.pair, "kspace": f"{liquid.kspace} {liquid.accuracy}"}
    variables |= {"dt": f"{dt:.17g}", "every": every, "steps": steps, **method.variables}
    return Job(_deck("liquid"), variables, steps)


def read(finished, duration):
    """Run of a log; it may have been refused before its first sample."""
    if not finished.log.tables or not len(finished.thermo["Step"]):
        return Run(*np.zeros((4, 0)), duration)
    columns = np.array([finished.thermo[name] for name in ("Time", "v_total", "v_ketrans", "v_kerot")])
    return Run(*columns[:, np.isfinite(columns).all(axis=0)], duration)


def measure(lab):
    """Results; finished runs of an earlier call with the same input are not repeated."""
    plan, jobs = QUICK if lab.quick else Plan(), {}
    data = equilibrate(lab, plan, [(liquid, range(plan.starts)) for liquid in LIQUIDS])
    for liquid, method, dt in itertools.product(LIQUIDS, NAMES, STEPS):
        for start in range(plan.starts):
            duration = 1000 * (plan.duration if liquid in WATERS else plan.short)
            made = job(liquid, data[liquid.key, start], method, dt, duration)
            jobs[f"{liquid.key}_{method.key}_dt{dt:g}_{start}"] = made, (liquid.key, method.key, dt)
    made = {name: made for name, (made, _) in jobs.items()}
    finished = lab.many(made, may_fail=lambda text: any(words in text for words in LOST))
    results = Results(plan, {})
    for name, (made, key) in jobs.items():
        results.runs.setdefault(key, []).append(read(finished[name], made.steps * key[-1]))
    return results


# --- quantities -----------------------------------------------------------------------------------
def drift(runs, liquid):
    """Mean slope of the total energy of some Runs and its standard error, kT per ns and degree of freedom.

    The error is from the scatter of the slopes; of a single run, from the scatter of its samples about the line.  kT is
    for the nominal temperature of the liquid.
    """
    unit = BOLTZMANN * liquid.temperature * sum(liquid.freedoms) / FEMTOSECONDS
    rates, errors = np.transpose([slope(run.time, run.total) for run in runs]) / unit
    if len(runs) == 1:
        return float(rates[0]), float(errors[0])
    return float(rates.mean()), float(sem(rates))


# --- what is found --------------------------------------------------------------------------------
def _ends(runs):
    """Times in ps at which lost runs ended."""
    return [run.time[-1] / 1000 if len(run.time) else 0.0 for run in runs if run.lost]


def drifts(results):
    """A row for each liquid and method with the drift at each step."""
    rows = []
    for liquid, (method, name) in itertools.product(LIQUIDS, NAMES.items()):
        cells = []
        for dt in STEPS:
            runs = results.runs[liquid.key, method.key, dt]
            ends = _ends(runs)
            lost = f"{len(ends)} of {len(runs)} lost, after {min(ends, default=0.0):.1f} ps"
            cells.append(lost if ends else with_error(*drift(runs, liquid), sign="+"))
        rows.append([liquid.title, name, *cells])
    return Table((f"drift, {UNIT}", "method", *(f"{dt:g} fs" for dt in STEPS)), rows)


def measurements(results):
    """Bounds for water."""
    for liquid, dt in itertools.product(WATERS, MOST_DRIFT):
        runs = results.runs[liquid.key, AUTOMATIC.key, dt]
        rate, error = (math.inf, 0.0) if _ends(runs) else drift(runs, liquid)
        most = MOST_DRIFT[dt] + WITHIN * error
        what = f"{liquid.title}, {dt:g} fs: drift"
        yield Measurement(what, rate, error, ".4f", UNIT, least=-most, most=most)


def find(results):
    """Finding of Results."""
    rows = [
        [liquid.title, liquid.molecules, liquid.density, liquid.temperature, f"`{liquid.pair}`", f"`{liquid.kspace} {liquid.accuracy}`"]
        for liquid in LIQUIDS
    ]
    header = ("liquid", "molecules", "density, g/cm³", "temperature, K", "pair style", "kspace style")
    tables = {"drift": drifts(results), "liquids": Table(header, rows)}
    return Finding(tuple(measurements(results)), tables, context={"plan": results.plan})


STUDY = Study("liquids", "Energy of liquids", 1500.0, measure, find, blocks={"doc/accuracy.md": "liquids.md.j2"})
