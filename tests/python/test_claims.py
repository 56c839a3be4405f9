"""Verdicts follow from the numbers: made-up results, and the same ones spoilt."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from synthetic import made_up_results

from benchmarks.engine.page import render
from benchmarks.studies import cases
from benchmarks.studies.cases import accuracy, claims, figures, plan
from benchmarks.studies.cases.claims import EXPLAINED, NOT, REPRODUCED


def spoil(results, change, **chosen):
    """Results whose runs with the chosen attributes are changed."""
    found = replace(results, series=dict(results.series))
    for run in plan.planned_runs(results.step):
        if all(getattr(run, name) == value for name, value in chosen.items()):
            found.series[run.name] = change(results.series[run.name])
    return found


def verdict(results, measure, **which):
    """The verdict on the claim that ``measure`` is about; ``which`` tells claims of a kind apart."""
    (claim,) = (
        claim
        for claim in claims.CLAIMS
        if (measure == claim.measure)
        or isinstance(claim.measure, partial)
        and claim.measure.func == measure
        and which.items() <= claim.measure.keywords.items()
    )
    return claims.Judged(claim, tuple(claim.measure(results)))


def scaled(name, factor):
    """A change that multiplies a column."""
    return lambda values: replace(values, **{name: getattr(values, name) * factor})


def drifting(values):
    """A change that lets the energy rise by 1 % of its swing per 100 units of time."""
    rise = 1e-4 * values.time * np.ptp(values.potential)
    return replace(values, total=values.total + rise)


def test_the_paper_reproduces_itself(results):
    found = claims.all_claims(results)
    wrong = [
        c for c in found if c.verdict != REPRODUCED and c.claim.measure != claims.similar_curve
    ]
    assert [(c.claim.source, c.claim.paper, c.measured) for c in wrong] == []
    assert len({(c.claim.source, c.claim.paper) for c in found}) == len(found) == 22


@pytest.mark.parametrize("case", [1, 3])
def test_energy_is_judged_by_every_printed_digit(results, case):
    judge = partial(verdict, measure=claims.initial_energy, case=case)
    assert judge(results).verdict == REPRODUCED
    for factor in (1.01, 0.99):
        assert judge(spoil(results, scaled("total", factor), case=case)).verdict == NOT
    for row in plan.AS_PRINTED:  # both bodies count
        assert judge(spoil(results, scaled("total", 1.01), case=case, row=row)).verdict == NOT


def test_held_energy(results):
    judge = partial(verdict, measure=claims.energy_error, case=1, formulation="first")
    assert judge(results).verdict == REPRODUCED
    one = judge(spoil(results, drifting, row="consistent-zero-free"))
    assert one.verdict == REPRODUCED and one.why == "but not with the consistent body"
    assert judge(spoil(results, drifting, formulation="first")).verdict == NOT


def test_late_drift(results):
    judge = partial(verdict, measure=claims.late_drift)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, drifting, case=2, formulation="first")).verdict == EXPLAINED
    level = spoil(results, lambda v: replace(v, total=v.total * 0 + v.total[0]), case=2)
    assert judge(level).verdict == NOT
    judge = partial(verdict, measure=claims.no_late_drift)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, drifting, formulation="second")).verdict == NOT


def test_times():
    """The paper's 800 is near 641 and 959; it lies between 500 and 1200 or never."""
    near = [claims.is_near(time, 800, 800) for time in (641.0, 639.0, 959.0, 961.0, math.inf)]
    assert near == [True, False, True, False, False]
    times = ([500.0, 1200.0], [500.0, math.inf], [639.0], [math.inf])
    assert [claims.is_between(pair, 800, 800) for pair in times] == [True, True, False, False]


def test_parting(results):
    judge = partial(verdict, measure=claims.parting, case=3)
    assert judge(results).verdict == REPRODUCED
    later = spoil(results, scaled("center", 0.0), case=3)
    assert judge(later).verdict == NOT
    early = spoil(results, scaled("center", 0.001), case=3)
    for row, factor in zip(plan.ROWS, (1e3, 1e3, 0.0, 0.0)):
        early = spoil(early, scaled("center", factor), case=3, row=row, formulation="second")
    assert judge(early).verdict == EXPLAINED


def test_leaving(results):
    judge = partial(verdict, measure=claims.leaving_direction)
    assert judge(results).verdict == REPRODUCED
    same = spoil(results, lambda v: replace(v, center=-v.center[:, [0, 2, 1]]), formulation="first")
    assert judge(same).verdict == NOT
    assert judge(spoil(results, scaled("center", -1.0), case=3)).verdict == EXPLAINED
    judge = partial(verdict, measure=claims.potential_vanishes)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, scaled("center", 0.0), case=3)).verdict == NOT
    inside = spoil(results, scaled("center", 0.0), case=3, formulation="first")
    assert judge(inside).verdict == EXPLAINED


def test_bounded(results):
    judge = partial(verdict, measure=claims.bounded)
    assert judge(results).verdict == REPRODUCED
    roaming = spoil(results, lambda v: replace(v, center=v.center - 0.02 * v.time[:, None]), case=1)
    assert judge(roaming).verdict == NOT


def test_observable(results):
    judge = partial(verdict, measure=claims.observable)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, scaled("center", 0.0), case=1)).verdict == NOT


def test_translation(results):
    judge = partial(verdict, measure=claims.translation_begins)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, scaled("translation", 0.1), case=3)).verdict == EXPLAINED
    assert judge(spoil(results, scaled("translation", 0.0), case=3)).verdict == NOT


def test_omega(results):
    judge = partial(verdict, measure=claims.omega_first)
    assert judge(results).verdict == REPRODUCED  # 3 against 1
    shifted = spoil(results, lambda v: replace(v, center=v.center + 9.0), omega="corrected")
    assert judge(shifted).verdict == NOT


def test_step_independence(results):
    judge = partial(verdict, measure=claims.same_solution, case=3)
    assert judge(results).verdict == REPRODUCED
    moved = scaled("center", 1.02)
    assert judge(spoil(results, moved, dt=0.001, row="unrotated-zero-free")).verdict == EXPLAINED
    assert judge(spoil(results, moved, dt=0.001)).verdict == NOT
    judge = partial(verdict, measure=claims.same_solution, other=2)
    assert judge(results).verdict == REPRODUCED
    assert judge(spoil(results, moved, case=2)).verdict == NOT


def exact(results):
    """The same with the short runs at the reference."""
    for run in plan.planned_runs(results.step):
        values = results.series[run.name]
        if run.dt in plan.ACCURACY_STEPS and not run.omega:
            values.center[values.at(plan.ACCURACY_END)] = accuracy.reference()
    return results


def test_errors_are_measured_against_the_reference(results):
    found = exact(results)
    assert set(map(tuple, accuracy.position_errors(found).values())) == {(0.0,) * 4}
    for values in found.series.values():
        values.center[values.at(plan.ACCURACY_END)] *= 1.01
    assert min(min(row) for row in accuracy.position_errors(found).values()) > 0.5


def test_bounds_refuse_what_is_not_reproduced(results):
    broken = [m.what for m in cases.find(exact(results)).measurements if not m.holds]
    assert broken == []
    wrong = spoil(results, drifting)
    wrong = spoil(wrong, scaled("center", 1.01), dt=cases.CHECKED_STEP)
    broken = " ".join(m.what for m in cases.find(wrong).measurements if not m.holds)
    for words in (
        "not reproducible",
        "step 0.02: error of the center",
        "step 0.001: largest error",
    ):
        assert words in broken


def test_the_page_shows_every_claim(results):
    finding = cases.find(results)
    text = render("results.md.j2", cases.STUDY, finding, "Somewhere.")
    assert text.count("| reproduced") >= finding.context["count"][REPRODUCED] == 21
    assert all(judged.measured in text for judged in claims.all_claims(results))


def test_table_7_shows_the_times(results):
    table = cases.table7(results)
    assert [len(row) for row in table.rows] == [4] * (len(plan.ROWS) + 2)
    assert table.rows[1][1].startswith("1000 / ") and table.rows[1][3].startswith("800 / ")


def test_figures_are_drawn(results, tmp_path):
    short = replace(results, series={k: v.until(200) for k, v in results.series.items()})
    drawn = figures.pictures(short)
    assert len(drawn) == 14
    for name in ("figure04", "figure08", "figure12", "parting", "overview"):
        drawn[name](tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 10000


def test_planned_runs_are_those_of_the_paper():
    runs = plan.planned_runs(plan.STEP, full=True)
    assert len({run.name for run in runs}) == len(runs) == 71
    steps = {(run.case, run.dt): run.job.steps for run in runs if run.end == plan.END}
    assert steps[1, 0.001] == 5_000_000 and steps[2, 0.125] == 40_000
    assert steps[1, 0.0001] == 50_000_000
    assert runs[0].job.variables["choices"] == "paper" and runs[0].job.variables["every"] == 1000
    quick = plan.planned_runs(plan.QUICK_STEP)
    assert len({run.name for run in quick}) == len(quick) == 67
    assert sum(run.job.steps for run in quick) < 0.25 * sum(run.job.steps for run in runs[:67])


def test_full_adds_the_50_million_steps(results):
    full = made_up_results(full=True)
    assert full.fine == 0.0001 and results.fine is None
    added = claims.all_claims(full)[len(claims.all_claims(results)) :]
    assert ["50 million" in judged.claim.source for judged in added] == [True, True]
    panels = figures.paper_figure(full, 4).keywords["panels"]
    assert len(panels[0].curves[0].x) == 5001
