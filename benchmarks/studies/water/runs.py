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
from benchmarks.studies.liquids import Plan as Starts
from benchmarks.studies.liquids import equilibrate, template

from .frames import read_motion
from .plan import BATCH, EXTRAPOLATED, LONG, MODELS, PRESSURE, QUICK, RIVAL, TARGETS, TEMPERATURE, Plan, Series

FOLDER = Path(__file__).parent
SAMPLES = FOLDER / "samples.csv"
BOLTZMANN = 0.0019872067  # kcal/mol/K
#: steps of the scene that distinguishes trajectories
TOLD_AFTER = 20


@dataclass(frozen=True)
class Sample:
    """Means over a part of a run.

    ``start``: number of its start; ``block``: number of the part, from 0.  ``trajectory``: see the docstring of this
    module.  ``ps``: duration.  ``rows``: number of averaged rows.  ``density`` in g/mL; ``energy``: potential energy in
    kcal/mol per molecule; ``volume`` in A^3 and ``volume2``, its square; ``measured``: pressure in atm; temperatures in
    kelvin; ``drift`` of the conserved energy in kcal/mol/ps.  The others as in Motion.
    """

    model: str
    method: str
    dt: float
    ensemble: str
    start: int
    block: int
    commit: str
    trajectory: str
    ps: float
    rows: int
    density: float
    energy: float
    volume: float
    volume2: float
    measured: float
    translation: float
    rotation: float
    drift: float
    diffusion: float
    turning: float

    @property
    def series(self):
        """The Series it belongs to."""
        return Series(*(getattr(self, field.name) for field in fields(Series)))


@dataclass(frozen=True)
class Results:
    """All samples, and method -> ``seconds`` per step at constant pressure and 2 fs on one rank, in rounds."""

    samples: list
    seconds: dict


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
        writer.writerows([f"{x:.12g}" if isinstance(x, float) else x for x in astuple(one)] for one in samples)


def job(series, data, number, plan):
    """Job of one run."""
    every = round(1000 * plan.every / series.dt)
    lengths = {"settle": plan.settle, "steps": plan.duration}
    steps = {name: every * math.ceil(1000 * length / (every * series.dt)) for name, length in lengths.items()}
    variables = {"every": every, "frame": round(1000 * plan.frame / series.dt), "seed": number, **steps}
    return Job(FOLDER / "in.water", _of_series(series, data) | variables, sum(steps.values()))


def _of_series(series, data):
    """Variables of in.water."""
    liquid = MODELS[series.model]
    variables = {"liquid": liquid.key, "data": data, "pair": liquid.pair, "kspace": liquid.kspace, "dt": series.dt}
    variables |= {"temperature": TEMPERATURE, "pressure": PRESSURE}
    return variables | {"method": series.method, "ensemble": series.ensemble}


def read(finished, series, number, origin, blocks):
    """List of the Samples of a finished run; ``origin``: commit, and the identifier of its trajectory."""
    thermo = {name: np.array(column)[1:] for name, column in finished.thermo.items()}
    length, motions = len(thermo["Time"]) // blocks, read_motion(finished.dump, blocks)
    parts = [{name: column[k * length :][:length] for name, column in thermo.items()} for k in range(blocks)]
    return [_sample(part, series, (number, k, *origin), motion) for k, (part, motion) in enumerate(zip(parts, motions))]


def _sample(thermo, series, origin, motion):
    molecules, turn, time = MODELS[series.model].molecules, thermo["c_rotation"], thermo["Time"] / 1000
    moving = 2 * thermo["KinEng"] / BOLTZMANN - 3 * molecules * turn
    volume, ps = thermo["Volume"], len(time) * float(time[1] - time[0])
    means = [thermo["Density"], thermo["PotEng"] / molecules, volume, volume**2, thermo["Press"]]
    means += [moving / (3 * molecules - 3), turn]
    numbers = [float(np.mean(values)) for values in means] + [float(np.polyfit(time, thermo["v_conserved"], 1)[0])]
    return Sample(*astuple(series), *origin, ps, len(turn), *numbers, *astuple(motion))


def trajectories(lab):
    """Method -> identifier of its trajectories: a potential energy after a few steps from a lattice.

    It has as many digits as machines agree on, and does not depend on data that a machine has equilibrated.
    """
    liquid = MODELS["tip4p"]
    variables = {"liquid": liquid.key, "pair": liquid.pair, "kspace": liquid.kspace, "temperature": TEMPERATURE}
    lab.many({"lattice": Job(FOLDER / "in.lattice", variables | {"template": template(liquid), "seed": 4711}, 1)})
    data = lab.dump("lattice").with_suffix(".data").resolve()
    told = {series.method: series for series in (LONG["tip4p"], EXTRAPOLATED[1], RIVAL)}
    steps = {"settle": 0, "steps": TOLD_AFTER, "every": TOLD_AFTER, "frame": TOLD_AFTER, "seed": 0}
    jobs = {method: Job(FOLDER / "in.water", _of_series(series, data) | steps, TOLD_AFTER) for method, series in told.items()}
    found = lab.many({f"told_{method}": job for method, job in jobs.items()})
    return {method: f"{found[f'told_{method}'].thermo['PotEng'][-1]:.6f}" for method in told}


def timed(lab, data, plan):
    """Method -> seconds per step on one rank, a list with one entry for each round; the methods run in turn."""
    steps, rounds = plan.timed
    sizes = {"settle": 0, "steps": steps, "every": steps, "frame": steps, "seed": 0}
    jobs = {one.method: Job(FOLDER / "in.water", _of_series(one, data) | sizes, steps) for one in (LONG["tip4p"], EXTRAPOLATED[1])}
    return {method: [run.log.seconds / steps for run in runs] for method, runs in lab.in_turn(jobs, rounds).items()}


def next_runs(samples, number):
    """List of (Series, number of start) of the next runs: each time the series that lacks the largest part of its target."""
    ps, starts, chosen = dict.fromkeys(TARGETS, 0.0), dict.fromkeys(TARGETS, 0), []
    for sample in samples:
        ps[sample.series] += sample.ps
        starts[sample.series] = max(starts[sample.series], sample.start)
    for _ in range(number):
        series = min(TARGETS, key=lambda one: ps[one] / TARGETS[one])
        ps[series] += Plan.duration
        starts[series] += 1
        chosen.append((series, starts[series]))
    return chosen


def measure(lab, plan=None):
    """Results; samples of earlier calls come first."""
    plan = plan or (QUICK if lab.quick else Plan(hours=lab.hours))
    told, begun = trajectories(lab), time.monotonic()
    samples = [] if lab.quick else [one for one in read_samples(SAMPLES) if one.trajectory == told[one.method]]
    commit = provenance.commit("src", "benchmarks/studies/water")
    starts = Starts(equilibration=plan.equilibration, shrinking=plan.shrinking)
    seconds = timed(lab, equilibrate(lab, starts, [(MODELS["tip4p"], [1])])["tip4p", 1], plan)
    while time.monotonic() - begun < 3600 * plan.hours or {sample.series for sample in samples} < set(TARGETS):
        chosen = next_runs(samples, len(TARGETS) if lab.quick else BATCH)
        models = [model for key, model in MODELS.items() if key in {series.model for series, _ in chosen}]
        data = equilibrate(lab, starts, [(model, sorted({number for _, number in chosen})) for model in models])
        jobs = {f"{series.name}_{n}": job(series, data[series.model, n], n, plan) for series, n in chosen}
        finished = lab.many(jobs)
        for series, n in chosen:
            samples += read(finished[f"{series.name}_{n}"], series, n, (commit, told[series.method]), plan.blocks)
        if not lab.quick:
            write_samples(samples, SAMPLES)
            for run in finished.values():
                run.dump.unlink()
    return Results(samples, seconds)
