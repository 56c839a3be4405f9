"""Requirements of the study of liquids on fix gear/quat: measurements with their bounds.

Bounds that depend on statistical errors apply only if the errors are from several starts.
"""

import math

import numpy as np

from benchmarks.engine.statistics import allowed, with_error
from benchmarks.engine.study import Measurement
from benchmarks.studies.coefficients.kernel import tuned

from . import quantities as of
from .plan import DEFAULT, FORESEEN, MAIN, NAMES, NVE_SMALL, SCENES, STEPS, TEMPERED, VALUES, WATERS

UNIT = "kT/ns/dof"
#: step in fs -> largest size of the drift of water, plus WITHIN standard errors
MOST_DRIFT = {2.5: 0.02, 3.0: 0.03, 4.0: 0.25}
WITHIN = 2.0
#: a prediction may be wrong by the first number, or by this fraction of the drift, plus WITHIN standard errors
PREDICTED, PART = 0.03, 0.3


def lost(runs):
    """The lost Runs."""
    return [run for run in runs if run.lost]


def several(results):
    """True if errors are from the scatter among starts."""
    return results.plan.starts > 1


def drift_of(results, scene, method, dt):
    """Drift and its standard error, infinite if a run was lost."""
    runs = results.runs[scene.key, method.key, dt]
    return (math.inf, 0.0) if lost(runs) else of.drift(runs, scene.liquid)


def predicted(results, scene, values, dt):
    """Drift predicted from the spectrum of a liquid, for a number of values."""
    return results.spectra[scene.liquid.key].drift(tuned(values), dt)


def drifts(results):
    """The drift in water, with bounds."""
    for scene in SCENES:
        for dt in STEPS[:-1] if scene.liquid in WATERS else ():
            rate, error = drift_of(results, scene, DEFAULT, dt)
            theirs = with_error(*drift_of(results, scene, NVE_SMALL, dt), "+")
            bounds = {}
            if dt in MOST_DRIFT:
                most = MOST_DRIFT[dt] + WITHIN * error
                bounds = {"least": -most, "most": most}
            remark = f"{NVE_SMALL.label}: {theirs}"
            yield Measurement(f"{scene.title}, {dt:g} fs: drift", rate, error, ".4f", UNIT, remark, **bounds)


def survivals(results):
    """The time that all runs reached at the longest step."""
    for scene in SCENES:
        runs = results.runs[scene.key, DEFAULT.key, STEPS[-1]]
        last = min(run.time[-1] if len(run.time) else 0.0 for run in runs) / 1000
        what = f"{scene.title}, {STEPS[-1]:g} fs: time without loss"
        least = 0.999 * runs[0].duration / 1000
        yield Measurement(what, last, spec=".1f", unit="ps", least=least)


def equipartition(results):
    """Temperature of translation minus rotation: of the fix, zero within errors, and of rigid/nve/small for comparison."""
    for dt in TEMPERED:
        both = [results.runs[MAIN.key, method.key, dt] for method in (DEFAULT, NVE_SMALL)]
        if any(map(lost, both)):  # drifts() already reports these
            continue
        own, other = (of.warmer(runs, MAIN.liquid) for runs in both)
        remark, most = f"{NVE_SMALL.label}: {with_error(other.value, other.error, '+')}", WITHIN * own.error
        what = f"{MAIN.title}, {dt:g} fs: T translation − T rotation"
        bounds = {"least": -most, "most": most} if several(results) else {}
        yield Measurement(what, own.value, own.error, ".2f", "K", remark, **bounds)


def beside_the_best(results):
    """In the other liquids, the drift without keywords minus the drift with the best number of values."""
    others = [scene for scene in SCENES if scene.liquid not in WATERS]
    freedoms = 2 * results.plan.few - 2
    most = allowed(len(others) * len(FORESEEN), freedoms) if several(results) else None
    for scene in others:
        excess = []
        for dt in FORESEEN:
            rate, error = drift_of(results, scene, DEFAULT, dt)
            stated = [drift_of(results, scene, method, dt) for method in VALUES.values()]
            best, scatter = min(stated, key=lambda found: abs(found[0]))
            noise = math.hypot(error, scatter)
            excess.append(((abs(rate) - abs(best)) / noise if noise else math.inf, dt))
        worst, dt = max(excess)
        what = f"{scene.title}: size of the drift minus the size with the best number of values, in standard errors"
        yield Measurement(what, worst, spec=".1f", remark=f"at {dt:g} fs", most=most)


def predictions(results):
    """Deviation of the drift from the prediction, relative to its bound."""
    for scene in SCENES:
        ratios = []
        for dt in FORESEEN:
            rate, error = drift_of(results, scene, DEFAULT, dt)
            values = results.runs[scene.key, DEFAULT.key, dt][0].values
            wrong = abs(predicted(results, scene, values, dt) - rate)
            most = max(PREDICTED, PART * abs(rate)) + WITHIN * error
            ratios.append((wrong / most if math.isfinite(rate) else math.inf, dt))
        worst, dt = max(ratios)
        what = f"{scene.title}: error of the predicted drift relative to its bound"
        yield Measurement(what, worst, spec=".2f", remark=f"at {dt:g} fs", most=1.0 if several(results) else None)


def calibration(results):
    """Drift of NO_SQUISH relative to its error; near 1 if errors are correct, because this method does not drift.

    Root mean squares over the steps of a liquid are compared, because errors from few starts scatter.
    """
    ratios = []
    for scene in SCENES:
        found = [drift_of(results, scene, NVE_SMALL, dt) for dt in scene.methods[NVE_SMALL].steps]
        rates, errors = np.transpose([pair for pair in found if math.isfinite(pair[0])])
        ratios.append(np.sum(rates**2) / np.sum(errors**2))
    return Measurement(
        f"{NAMES[NVE_SMALL]}, all liquids: size of drift over standard error, root mean squares",
        float(np.sqrt(np.mean(ratios))),
        spec=".1f",
    )


def measurements(results):
    """All of them."""
    return (
        *drifts(results),
        *survivals(results),
        *equipartition(results),
        *beside_the_best(results),
        *predictions(results),
        calibration(results),
    )
