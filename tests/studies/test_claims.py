"""Verdicts follow from the numbers: made-up results, and the same results with errors."""

from dataclasses import replace

import numpy as np
import pytest
from support.synthetic import made_up_results

from benchmarks.studies.cases import claims, plan
from benchmarks.studies.cases.claims import EXPLAINED, NOT, REPRODUCED


@pytest.fixture
def results():
    return made_up_results()


def spoil(results, change, **chosen):
    """Results whose runs with the chosen attributes are changed."""
    spoilt = replace(results, series=dict(results.series))
    for run in plan.planned_runs(results.step):
        if all(getattr(run, name) == value for name, value in chosen.items()):
            spoilt.series[run.name] = change(results.series[run.name])
    return spoilt


def judge(results, measure, which=None):
    """The verdict on the claim of ``measure``; ``which`` distinguishes claims of the same kind."""
    (claim,) = (
        claim
        for claim in claims.CLAIMS
        if claim.measure == measure
        or getattr(claim.measure, "func", None) == measure
        and (which or {}).items() <= claim.measure.keywords.items()
    )
    return claims.Judged(claim, tuple(claim.measure(results)))


# --- changes of a run ---------------------------------------------------------------------------
def scaled(name, factor):
    """Multiplies a column."""
    return lambda run: replace(run, **{name: getattr(run, name) * factor})


def drifting(run):
    """The energy rises by 1 % of its swing per 100 units of time."""
    return replace(run, total=run.total + 1e-4 * run.time * np.ptp(run.potential))


def level(run):
    """The energy stays at its start."""
    return replace(run, total=np.full_like(run.total, run.total[0]))


def mirrored(run):
    """The body leaves in the opposite direction along another axis."""
    return replace(run, center=-run.center[:, [0, 2, 1]])


def roaming(run):
    """The body goes away along the diagonal."""
    return replace(run, center=run.center - 0.02 * run.time[:, None])


def shifted(run):
    """The body is elsewhere."""
    return replace(run, center=run.center + 9.0)


def test_the_paper_reproduces_itself(results):
    judged = claims.all_claims(results)
    wrong = [c for c in judged if c.verdict != REPRODUCED]
    assert [c.claim.measure for c in wrong] == [claims.similar_curve]
    assert len({(c.claim.source, c.claim.paper) for c in judged}) == len(judged) == 22


FIRST, SECOND = {"formulation": "first"}, {"formulation": "second"}
CASE_1, CASE_2, CASE_3 = {"case": 1}, {"case": 2}, {"case": 3}
LOST, MOVED = scaled("center", 0.0), scaled("center", 1.02)


@pytest.mark.parametrize(
    "measure, which, change, chosen, verdict",
    [
        (claims.energy_error, CASE_1 | FIRST, drifting, FIRST, NOT),
        (claims.late_drift, None, drifting, CASE_2 | FIRST, EXPLAINED),
        (claims.late_drift, None, level, CASE_2, NOT),
        (claims.no_late_drift, None, drifting, SECOND, NOT),
        (claims.parting, CASE_3, LOST, CASE_3, NOT),
        (claims.leaving_direction, None, mirrored, FIRST, NOT),
        (claims.leaving_direction, None, scaled("center", -1.0), CASE_3, EXPLAINED),
        (claims.potential_vanishes, None, LOST, CASE_3, NOT),
        (claims.potential_vanishes, None, LOST, CASE_3 | FIRST, EXPLAINED),
        (claims.bounded, None, roaming, CASE_1, NOT),
        (claims.observable, None, LOST, CASE_1, NOT),
        (claims.translation_begins, None, scaled("translation", 0.1), CASE_3, EXPLAINED),
        (claims.translation_begins, None, scaled("translation", 0.0), CASE_3, NOT),
        (claims.omega_first, None, shifted, {"omega": "corrected"}, NOT),
        (claims.same_solution, CASE_3, MOVED, {"dt": 0.001, "row": plan.AS_PRINTED[1]}, EXPLAINED),
        (claims.same_solution, CASE_3, MOVED, {"dt": 0.001}, NOT),
        (claims.same_solution, {"other": 2}, MOVED, CASE_2, NOT),
    ],
)
def test_verdict_on_spoilt_runs(results, measure, which, change, chosen, verdict):
    assert judge(spoil(results, change, **chosen), measure, which).verdict == verdict
