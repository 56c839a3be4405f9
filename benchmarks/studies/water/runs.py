"""Runs of water, and their samples.

A sample is a part of a run with its own start, much longer than correlation times of water.  Samples are stored in
``samples.csv`` of this folder, and later calls add to them.  Samples of other versions of the fix are not mixed: each has
the energy after a few steps of a fixed scene, which changes if the trajectory does.
"""

import csv
import math
import time
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np

from benchmarks.engine import Job, provenance
from benchmarks.studies.liquids.runs import equilibrate, template
from benchmarks.studies.liquids.plan import Plan as Starts

from .plan import METHODS, MODELS, OURS, QUICK, ROUND, TEMPERATURE, Plan, Series

FOLDER = Path(__file__).parent
SAMPLES = FOLDER / "samples.csv"
BOLTZMANN = 0.0019872067  # kcal/mol/K
#: 1 atm A^3 in kcal/mol
PRESSURE_VOLUME = 1.0 / 68568.415
#: steps of the scene that distinguishes trajectories
TOLD_AFTER = 20


@dataclass(frozen=True)
class Sample:
    """Means over a part of a run.

    ``start``: number of its start; ``block``: number of the part, from 0.  ``trajectory``: see the docstring of this
    module.  ``ps``: duration.  ``rows``: number of averaged rows.  ``density`` in g/mL, ``volume`` in A^3 and ``volume2``,
    its square; ``energy``: potential energy in kcal/mol per molecule; temperatures in kelvin; ``drift`` of the
    conserved energy in kcal/mol/ps.
    """

    model: str
    method: str
    dt: float
    pressure: float
    start: int
    block: int
    commit: str
    trajectory: str
    ps: float
    rows: int
    density: float
    volume: float
    volume2: float
    energy: float
    translation: float
    rotation: float
    drift: float

    @property
    def series(self):
        """The Series it belongs to."""
        return Series(self.model, self.method, self.dt, self.pressure)


def read_samples(path):
    """List of Sample in a file; empty if there is none."""
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    types = [field.type for field in fields(Sample)]
    return [Sample(*(kind(cell) for kind, cell in zip(types, row))) for row in rows]


def write_samples(samples, path):
    """Write a list of Sample to a file."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([field.name for field in fields(Sample)])
        writer.writerows([f"{x:.10g}" if isinstance(x, float) else x for x in astuple(one)] for one in samples)


def job(series, data, number, plan):
    """Job of one sample."""
    liquid, every = MODELS[series.model], round(1000 * plan.every / series.dt)
    steps = {name: every * math.ceil(1000 * length / (every * series.dt)) for name, length in plan.lengths.items()}
    variables = {"liquid": liquid.key, "data": data, "pair": liquid.pair, "kspace": liquid.kspace}
    variables |= {"temperature": TEMPERATURE, "pressure": series.pressure, "method": series.method}
    variables |= {"dt": series.dt, "every": every, "seed": number, **steps}
    return Job(FOLDER / "in.water", variables, sum(steps.values()), plugin=series.method == OURS)


def read(finished, series, number, origin, blocks):
    """List of the Samples of a finished run; ``origin``: commit, and the identifier of its trajectory."""
    thermo = {name: np.array(column)[1:] for name, column in finished.thermo.items()}
    length = len(thermo["Time"]) // blocks
    parts = [{name: column[k * length :][:length] for name, column in thermo.items()} for k in range(blocks)]
    return [_sample(part, series, (number, k, *origin)) for k, part in enumerate(parts)]


def _sample(thermo, series, origin):
    molecules, turn, time = MODELS[series.model].molecules, thermo["c_rotation"], thermo["Time"] / 1000
    moving = 2 * thermo["KinEng"] / BOLTZMANN - 3 * molecules * turn
    means = [thermo["Density"], thermo["Volume"], thermo["Volume"] ** 2, thermo["PotEng"] / molecules]
    means += [moving / (3 * molecules - 3), turn]
    numbers = [float(np.mean(values)) for values in means]
    ps = len(time) * float(time[1] - time[0])
    return Sample(*astuple(series), *origin, ps, len(turn), *numbers, float(np.polyfit(time, thermo["Econserve"], 1)[0]))


def trajectories(lab):
    """Method -> identifier of its trajectories: a potential energy after a few steps from a lattice.

    It has as many digits as machines agree on, and does not depend on data that a machine has equilibrated.
    """
    liquid = MODELS["tip4p"]
    variables = {"liquid": liquid.key, "pair": liquid.pair, "kspace": liquid.kspace, "temperature": TEMPERATURE}
    lab.many({"lattice": Job(FOLDER / "in.lattice", variables | {"template": template(liquid), "seed": 4711}, 1, plugin=False)})
    data = lab.dump("lattice").with_suffix(".data").resolve()
    variables |= {"data": data, "pressure": 1.0, "dt": 2.0, "settle": 0, "steps": TOLD_AFTER, "every": TOLD_AFTER, "seed": 0}
    jobs = {method: Job(FOLDER / "in.water", variables | {"method": method}, TOLD_AFTER) for method in METHODS}
    found = lab.many({f"told_{method}": job for method, job in jobs.items()})
    return {method: f"{found[f'told_{method}'].thermo['PotEng'][-1]:.6f}" for method in METHODS}


def measure(lab, plan=None):
    """List of all samples with the same trajectory, samples of earlier calls first."""
    plan = plan or (QUICK if lab.quick else Plan(hours=lab.hours))
    kept = [] if lab.quick else read_samples(SAMPLES)
    told = trajectories(lab)
    samples = [sample for sample in kept if sample.trajectory == told[sample.method]]
    commit, begun = provenance.commit("src", "benchmarks/studies/water"), time.monotonic()
    first = 1 + max((sample.start for sample in samples), default=0)
    while True:
        numbers, data = range(first, first + max(ROUND.values())), {}
        for series, count in ROUND.items():
            enough = time.monotonic() - begun > 3600 * plan.hours
            if enough and {sample.series for sample in samples} == set(ROUND):
                return samples
            if not data:
                data = equilibrate(lab, Starts(equilibration=plan.equilibration), MODELS.values(), numbers)
            jobs = {n: job(series, data[series.model, n], n, plan) for n in numbers[:count]}
            named = {f"{series.name}_{n}": made for n, made in jobs.items()}
            finished = lab.many(named, keep=True)
            origin = commit, told[series.method]
            for n in jobs:
                samples += read(finished[f"{series.name}_{n}"], series, n, origin, plan.blocks)
            if not lab.quick:
                write_samples(samples, SAMPLES)
        first = numbers[-1] + 1
