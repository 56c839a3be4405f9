"""Every claim of the paper, the condition under which it counts as reproduced, and the measurement.

A verdict is computed from the readings of a claim:

reproduced        the claim is true in runs with the paper's choices (zero start, no projection), with one of the two
                  bodies, or with both if the claim requires it
explained         the claim is not true, but the readings show its origin
not reproducible  neither
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from benchmarks.reference import Cage

from . import divergence as dv
from .plan import ACCURATE, AS_PRINTED, FORMULATIONS, OMEGA_END, OMEGA_STEP, ROWS

REPRODUCED, EXPLAINED, NOT = "reproduced", "explained", "not reproducible"
THRESHOLDS = (0.1, 1.0, 3.0)
TIME_TOLERANCE = 0.2  # relative, because the paper's times are read from figures
VISIBLE = 0.02  # visible fraction of a figure's height

CAGE = Cage(float)


@dataclass(frozen=True)
class Reading:
    """One measured value as ``text``; ``label``: the run.

    ``holds``: True if the claim is true in this run, None if the run is for comparison only;
    ``explains``: True if the value shows the origin of the claim.
    """

    label: str
    text: str
    holds: bool | None = None
    explains: bool = False


@dataclass(frozen=True)
class Claim:
    """``source``: place in the paper; ``paper``: the claim; ``measure``: Results -> Readings.

    ``condition`` completes "it is reproduced if"; ``need``: any or all of the readings must be true;
    ``lead``: words before the readings; ``reason``: the explanation of an explained claim.
    """

    source: str
    paper: str
    condition: str
    measure: Callable
    need: Callable = any
    lead: str = ""
    reason: str = ""


@dataclass(frozen=True)
class Judged:
    """A claim with its readings and its verdict."""

    claim: Claim
    readings: tuple

    @property
    def verdict(self):
        """REPRODUCED, EXPLAINED or NOT."""
        if self.claim.need(reading.holds for reading in self.readings if reading.holds is not None):
            return REPRODUCED
        return EXPLAINED if any(reading.explains for reading in self.readings) else NOT

    @property
    def measured(self):
        """All readings as text."""
        texts = (f"{reading.label} {reading.text}" for reading in self.readings)
        return self.claim.lead + "; ".join(texts)

    @property
    def why(self):
        """Remark on the verdict; "" if the claim is true in all runs."""
        failing = [reading.label for reading in self.readings if reading.holds is False]
        if self.verdict == REPRODUCED and failing:
            return "but not with the " + " and ".join(failing) + " body"
        return self.claim.reason if self.verdict == EXPLAINED else ""


def show_time(time):
    """A time as text; "never" if infinite."""
    return "never" if math.isinf(time) else f"{time:.0f}"


def parting_times(results, case, row, names=FORMULATIONS):
    """Times at which two runs of a row diverge, one for each of THRESHOLDS."""
    pair = [results.get(case, row, name) for name in names]
    return tuple(dv.parting_time(*pair, threshold) for threshold in THRESHOLDS)


def show_times(times):
    """Times of divergence as text."""
    return " / ".join(map(show_time, times))


def is_near(time, low, high):
    """True if a measured time agrees with the paper's, ``low`` to ``high``."""
    return low * (1 - TIME_TOLERANCE) <= time <= high * (1 + TIME_TOLERANCE)


def is_between(times, low, high):
    """True if a time of the paper, ``low`` to ``high``, is within the range of measured times."""
    return min(times) <= high and max(times) >= low


def printed(results, case, *formulations, dt=None):
    """[(body, Series)] of the runs with the paper's choices in one formulation.

    Without ``formulations``, of both: [(body and formulation, Series)].
    """
    return [
        (ROWS[row].body + f" {name}" * (not formulations), results.get(case, row, name, dt))
        for row in AS_PRINTED
        for name in formulations or FORMULATIONS
    ]


# --- readings -----------------------------------------------------------------------------------
def initial_energy(results, case, energy, digits):
    """The total energy at the start, compared with the printed one, which has ``digits`` digits."""
    for body, values in printed(results, case, "second"):
        start = values.total[0]
        yield Reading(body, f"{start:+.8f}", bool(abs(start - energy) <= 0.5 * 10**-digits))


def energy_error(results, case, formulation):
    """The largest error of the total energy, in parentheses relative to the range of the potential energy."""
    for body, values in printed(results, case, formulation):
        error, swing = np.abs(dv.energy_error(values)).max(), dv.energy_scale(values)
        yield Reading(
            body, f"{error:.2g} ({100 * error / swing:.2g} %)", bool(error <= VISIBLE * swing)
        )
    for name, label in (("momentum", "defaults of the fix"), ("rigid", "fix rigid/nve/small")):
        error = np.abs(dv.energy_error(results.get(case, ACCURATE, name))).max()
        yield Reading(label, f"{error:.2g}")


def late_drift(results):
    """Case 2, first formulation: the time from which the energy has drifted, and the drift at the end."""
    for body, values in printed(results, 2, "first"):
        onset, sign = dv.drift_onset(values, VISIBLE)
        drift = {1: "upward", -1: "downward", 0: "no drift"}[sign]
        drift += f" from t = {onset:.0f}" if sign else ""
        end = dv.energy_error(values)[-1]
        near = sign > 0 and abs(onset - 4000) <= TIME_TOLERANCE * 4000
        yield Reading(body, f"{drift}, error {end:+.2g} at the end", near, sign > 0)


def no_late_drift(results):
    """Case 2, second formulation: the error of the energy at the end."""
    for body, values in printed(results, 2, "second"):
        sign = dv.drift_onset(values, VISIBLE)[1]
        yield Reading(body, f"error {dv.energy_error(values)[-1]:+.2g} at the end", sign <= 0)


def parting(results, case, low, high):
    """The time at which the formulations diverge; the claim gives a time of ``low`` to ``high``."""
    times = {row: parting_times(results, case, row) for row in ROWS}
    among = is_between([time for row in times.values() for time in row], low, high)
    for row in AS_PRINTED:
        near = any(is_near(time, low, high) for time in times[row])
        yield Reading(ROWS[row].body, show_times(times[row]), near, among)


def observable(results):
    """Case 1: the largest difference of x between the formulations in two spans of time."""
    first, second = (printed(results, 1, formulation) for formulation in FORMULATIONS)
    for (body, one), (_, other) in zip(first, second):
        gap = np.abs(one.center[:, 0] - other.center[:, 0])
        spans = ((1300, 1500), (1500, 2500))
        a, b = (gap[(one.time >= begin) & (one.time <= end)].max() for begin, end in spans)
        yield Reading(body, f"{a:.2g} and {b:.2g}", bool(min(a, b) > 1.0))


def same_solution(results, case, until, other=None):
    """The time at which a run is at a distance of 1 from the run of the ``other`` case, or with another step."""
    dt = None if other else results.other_step(case)
    pairs = zip(printed(results, case), printed(results, other or case, dt=dt))
    for (label, one), (_, another) in pairs:
        time = dv.parting_time(one, another, 1.0)
        holds = time >= until * (1 - TIME_TOLERANCE)
        yield Reading(label, show_time(time), holds, holds)


def similar_curve(results):
    """Cases 1 and 2, first formulation: the time at which x differs by a quarter of its range."""
    times = {}
    for (body, one), (_, other) in zip(*(printed(results, case, "first") for case in (1, 2))):
        gap = np.abs(one.center[:, 0] - other.center[:, 0])
        times[body] = dv.first_time(one.time, gap > 0.25 * np.ptp(one.center[:, 0]))
    among = is_between(times.values(), 1000, 1000)
    for body, time in times.items():
        yield Reading(body, show_time(time), is_near(time, 1000, 1000), among)


def bounded(results):
    """Case 1: the largest distance from the sphere where the body starts."""
    for label, values in printed(results, 1):
        distance = np.linalg.norm(values.center[:, None, :] - CAGE.positions, axis=2)
        home = int(distance[0].argmin())
        stays = bool((distance.argmin(axis=1) == home).all())
        yield Reading(label, f"{distance[:, home].max():.1f}", stays)


def translation_begins(results, time=20.0):
    """Case 3: the translational part of the kinetic energy at ``time``, and the time at which it is visible."""
    for body, values in printed(results, 3, "second"):
        part = values.translation / values.kinetic
        at = float(part[values.at(time)])
        start = dv.first_time(values.time, part >= VISIBLE)
        text = f"{100 * at:.2g} % at t = {time:g}, {100 * VISIBLE:g} % at t = {show_time(start)}"
        yield Reading(body, text, at >= VISIBLE, bool(values.translation[1] > 0))


def potential_vanishes(results):
    """Case 3: the time at which the body has left the cage, and the energies at the end."""
    for label, values in printed(results, 3):
        left, end = dv.leaving_time(values), values.potential[-1]
        out = math.isfinite(left) and bool(abs(end / values.total[0]) < 0.05)
        text = f"outside from t = {show_time(left)}, potential {end:+.2g}, translation "
        text += f"{values.translation[-1]:.2f}, rotation {values.rotation[-1]:.2f} at the end"
        yield Reading(f"{label}:", text, out, out)


def leaving_direction(results):
    """Case 3: the axis along which the body leaves, in the first and in the second formulation."""
    ways = {
        row: [dv.leaving_axis(results.get(3, row, f)) or "not yet" for f in FORMULATIONS]
        for row in ROWS
    }
    scatter = any(first != second for first, second in ways.values())
    for row, pair in ways.items():
        holds = pair == ["-z", "+y"] if row in AS_PRINTED else None
        yield Reading(f"{ROWS[row].label}:", ", ".join(pair), holds, scatter)


def omega_first(results):
    """Case 1: errors with the corrected and with the predicted omega in Eq. 5."""
    best = results.get(1, ACCURATE, "momentum").center[int(OMEGA_END)]
    ends = [
        results.get(1, ACCURATE, "first", OMEGA_STEP, omega).center[-1]
        for omega in ("corrected", "predicted")
    ]
    corrected, predicted = (float(np.linalg.norm(end - best)) for end in ends)
    ratio = predicted / corrected
    yield Reading("corrected", f"{corrected:.2g}")
    yield Reading("predicted", f"{predicted:.2g}")
    yield Reading("ratio", f"{ratio:.2g}", ratio > 2, ratio > 1.05)


# --- the table ----------------------------------------------------------------------------------
WITHIN, PERCENT = f"{100 * TIME_TOLERANCE:g} %", f"{100 * VISIBLE:g} %"


def energy_printed(case, energy, digits):
    """The paper prints the total energy of a case."""
    return Claim(
        f"test case {case}",
        f"the total energy is {energy:+.{digits}f}",
        "the energy agrees in every printed digit, with both bodies",
        partial(initial_energy, case=case, energy=energy, digits=digits),
        all,
    )


def energy_held(case, formulation, figure):
    """A figure of the paper shows a level total energy."""
    return Claim(
        f"test case {case}, {figure}",
        f"the {formulation} formulation holds the total energy tightly",
        f"the largest error is below {PERCENT} of the range of the potential energy",
        partial(energy_error, case=case, formulation=formulation),
        lead="largest error of the energy (in parentheses, relative to the range of the potential energy): ",
    )


def formulations_part(case, source, paper, low, high):
    """A time after which the paper sees the two formulations differ."""
    return Claim(
        source,
        paper,
        f"the time is within {WITHIN} at one threshold; it is explained if times of Table 7 enclose it",
        partial(parting, case=case, low=low, high=high),
        lead="time until their difference reaches 0.1 / 1 / 3: ",
        reason="the time depends more on threshold, body, start and projection than on the formulation",
    )


def step_does_not_matter(case, source, paper, until, other=None):
    """A time until which the paper finds the same solution with two steps."""
    return Claim(
        source,
        f"{paper} the solution is the same until t = {until}",
        f"all runs agree until t = {until * (1 - TIME_TOLERANCE):g}; it is explained if some do",
        partial(same_solution, case=case, until=until, other=other),
        all,
        lead="time until the difference of the runs reaches 1: ",
        reason="the zero start leaves an error of first order, so another step changes the solution"
        " about as much as the other formulation",
    )


CLAIMS = (
    energy_printed(1, -0.7236, 4),
    energy_printed(3, 3.993, 3),
    energy_held(1, "first", "Fig. 2"),
    energy_held(1, "second", "Fig. 3"),
    formulations_part(1, "test case 1", "the formulations differ after t = 1000", 1000, 1000),
    formulations_part(1, "Fig. 4, Table 7", "they coincide until t = 1300", 1300, 1300),
    Claim(
        "test case 1, Fig. 4",
        "x differs observably by t = 1500 and follows another trajectory by t = 2500",
        "both differences are above 1",
        observable,
        lead="largest difference of x for t = 1300 to 1500 and 1500 to 2500: ",
    ),
    Claim(
        "test case 1",
        "as its energy is below zero, the body orbits one of the fixed spheres",
        "that sphere is the nearest one to the end, in every run",
        bounded,
        all,
        lead="largest distance from the sphere where it starts: ",
    ),
    Claim(
        "test case 2, Fig. 5",
        "the energy of the first formulation drifts upward at about t = 4000",
        f"the energy stays {PERCENT} of the range of the potential energy above its start from t = 4000 ± {WITHIN} on;"
        " it is explained if it does from another time on",
        late_drift,
        reason="the time at which the body comes close to a sphere, where the step is too large, is chaotic",
    ),
    Claim(
        "test case 2, Fig. 6",
        "the energy of the second formulation does not drift",
        f"the energy at the end is at most {PERCENT} of the range of the potential energy above its start",
        no_late_drift,
    ),
    formulations_part(2, "Fig. 7, Table 7", "they coincide until t = 250 to 300", 250, 300),
    step_does_not_matter(1, "test case 2", "with the steps of cases 1 and 2", 250, other=2),
    Claim(
        "test case 2, Fig. 7",
        "x of the first formulation is similar to x of test case 1 until about t = 1000",
        f"the time is within {WITHIN} with one body; it is explained if the times of the two bodies enclose it",
        similar_curve,
        lead="time until x differs by a quarter of its range: ",
    ),
    Claim(
        "test case 3, Figs. 8, 9",
        "all kinetic energy is rotational at first; by t = 20 the cage has induced translation",
        f"translation has {PERCENT} of the kinetic energy at t = 20; it is explained if it has begun",
        translation_begins,
        lead="translational part of the kinetic energy: ",
        reason="translation has begun, but is far too small to be seen in a figure",
    ),
    Claim(
        "test case 3, Figs. 10, 11",
        "the body leaves, its potential energy vanishes, and both kinds of kinetic energy remain",
        "the body stays outside and its potential energy falls below 5 % of the total energy in every"
        " run; it is explained if it does in some",
        potential_vanishes,
        all,
        reason="some bodies are still inside at the end, because the time at which they leave is chaotic",
    ),
    formulations_part(3, "test case 3, Table 7", "they differ after t = 800", 800, 800),
    Claim(
        "test case 3, Figs. 12, 13",
        "the body leaves toward -z in the first formulation and toward +y in the second",
        "it does so in a run with the choices of the paper; it is explained if the formulations differ",
        leaving_direction,
        lead="first and second formulation: ",
        reason="if the formulations diverge before the body leaves, its direction is chaotic",
    ),
    step_does_not_matter(1, "discussion, point 3", "in case 1 with half the step", 1300),
    step_does_not_matter(3, "discussion, point 3", "in case 3 with a fifth of the step", 800),
    energy_held(3, "first", "Fig. 10"),
    energy_held(3, "second", "Fig. 11"),
    Claim(
        "Eq. 5 and discussion",
        "quaternion rates from the predicted omega (Allen and Tildesley) are an error",
        "the ratio of the two errors is above 2; it is explained if above 1.05",
        omega_first,
        lead=f"error at t = {OMEGA_END:g} with a step of {OMEGA_STEP:g}: ",
        reason="the corrected omega is better, but both converge: the predicted omega is not an error",
    ),
)


def all_claims(results):
    """Every claim of the paper with its verdict: list of Judged."""
    return [Judged(claim, tuple(claim.measure(results))) for claim in CLAIMS]
