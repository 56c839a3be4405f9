"""Verdicts follow from the numbers: made-up results, and the same ones spoilt."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest
from synthetic import PARTS, made_up

from benchmarks.studies.cases import claims, figures
from benchmarks.studies.cases import runs as cases
from benchmarks.studies.cases import tables
from benchmarks.studies.cases.claims import EXPLAINED, NOT, REPRODUCED


def spoil(results, change, **chosen):
    """Results whose runs with the chosen attributes are changed."""
    found = cases.Results()
    for run, values in results.runs.items():
        match = all(getattr(run, name) == value for name, value in chosen.items())
        found.add(run, change(values) if match else values)
    return found


def scaled(name, factor):
    """A change that multiplies a column."""
    return lambda values: replace(values, **{name: getattr(values, name) * factor})


def drifting(values):
    """A change that lets the energy rise by 1 % of its swing per 100 units of time."""
    rise = 1e-4 * values.time * np.ptp(values.potential)
    return replace(values, total=values.total + rise)


def test_the_paper_reproduces_itself(results):
    found = claims.all_claims(results)
    wrong = [c for c in found if c.verdict != REPRODUCED and "x similar" not in c.paper]
    assert [(c.source, c.paper, c.measured) for c in wrong] == []
    assert len({(c.source, c.paper) for c in found}) == len(found) >= 20
    assert all(c.rule and c.measured for c in found)


@pytest.mark.parametrize("case, digits, printed", [(1, 4, -0.7236), (3, 3, 3.993)])
def test_energy_is_judged_by_every_printed_digit(results, case, digits, printed):
    assert claims.initial_energy(results, case, printed, digits).verdict == REPRODUCED
    for factor in (1.01, 0.99):
        wrong = spoil(results, scaled("total", factor), case=case)
        assert claims.initial_energy(wrong, case, printed, digits).verdict == NOT
    for row in cases.AS_PRINTED:  # both bodies count
        wrong = spoil(results, scaled("total", 1.01), case=case, row=row)
        assert claims.initial_energy(wrong, case, printed, digits).verdict == NOT


def test_held_energy(results):
    def judge(found):
        return claims.energy_held(found, 1, "first", "Fig. 2")

    assert judge(results).verdict == REPRODUCED
    one = judge(spoil(results, drifting, row="consistent-zero-free"))
    assert one.verdict == REPRODUCED and one.why == "not with the body: consistent"
    assert judge(spoil(results, drifting, formulation="first")).verdict == NOT


def test_late_drift(results):
    assert claims.late_drift(results).verdict == REPRODUCED
    early = spoil(results, drifting, case=2, formulation="first")
    assert claims.late_drift(early).verdict == EXPLAINED
    level = spoil(results, lambda v: replace(v, total=v.total * 0 + v.total[0]), case=2)
    assert claims.late_drift(level).verdict == NOT
    assert claims.no_late_drift(results).verdict == REPRODUCED
    assert claims.no_late_drift(spoil(results, drifting, formulation="second")).verdict == NOT


@pytest.mark.parametrize(
    "printed, others, verdict",
    [
        ([800.0, 2000.0], [], REPRODUCED),
        ([641.0], [], REPRODUCED),
        ([639.0], [], NOT),
        ([961.0], [], NOT),
        ([500.0, 1200.0], [], EXPLAINED),
        ([500.0], [math.inf], EXPLAINED),
        ([math.inf], [], NOT),
    ],
)
def test_times(printed, others, verdict):
    assert claims.judge_time(800, 800, printed, others) == verdict


def test_parting(results):
    def judge(found):
        return claims.parting(found, 3, "Table 7", "they differ after t = 800", 800, 800)

    assert judge(results).verdict == REPRODUCED
    assert "apart by 0.1" in judge(results).why
    never = spoil(results, lambda v: replace(v, centre=v.centre * 0), case=3)
    assert judge(never).verdict == NOT


def test_leaving(results):
    assert claims.leaving_direction(results).verdict == REPRODUCED
    assert claims.potential_vanishes(results).verdict == REPRODUCED
    same = spoil(results, lambda v: replace(v, centre=v.centre[:, [0, 2, 1]]), formulation="first")
    same = spoil(same, lambda v: replace(v, centre=-v.centre), formulation="first")
    assert claims.leaving_direction(same).verdict == NOT
    other = spoil(results, lambda v: replace(v, centre=-v.centre), case=3)
    assert claims.leaving_direction(other).verdict == EXPLAINED
    inside = spoil(results, lambda v: replace(v, centre=v.centre * 0), case=3)
    assert claims.potential_vanishes(inside).verdict == NOT


def test_bounded(results):
    assert claims.bounded(results).verdict == REPRODUCED
    roaming = spoil(results, lambda v: replace(v, centre=v.centre - 0.02 * v.time[:, None]), case=1)
    assert claims.bounded(roaming).verdict == NOT


def test_translation(results):
    assert claims.translation_begins(results).verdict == REPRODUCED
    slow = spoil(results, scaled("translation", 0.1), case=3)
    assert claims.translation_begins(slow).verdict == EXPLAINED
    never = spoil(results, scaled("translation", 0.0), case=3)
    assert claims.translation_begins(never).verdict == NOT


def test_omega(results):
    assert claims.omega_first(results).verdict == REPRODUCED  # 3 against 1
    shifted = spoil(results, lambda v: replace(v, centre=v.centre + 9.0), omega="corrected")
    assert claims.omega_first(shifted).verdict == NOT


def test_step_independence(results):
    def judge(found):
        return claims.step_independent(
            found, 3, lambda row, f: found.get(3, row, f, 0.001), 800, "point 3"
        ).verdict

    assert judge(results) == REPRODUCED
    moved = scaled("centre", 1.02)
    assert judge(spoil(results, moved, dt=0.001, row="unrotated-zero-free")) == EXPLAINED
    assert judge(spoil(results, moved, dt=0.001)) == NOT


def test_tables_are_written(results, tmp_path):
    found = tables.write_tables(tmp_path, results)
    with open(tmp_path / "table.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["verdict"] for row in rows] == [claim.verdict for claim in found]
    text = (tmp_path / "table.md").read_text(encoding="utf-8")
    assert "reconstructed" in text and all(claim.paper in text for claim in found)
    with open(tmp_path / "table7.csv", newline="", encoding="utf-8") as file:
        times = list(csv.DictReader(file))
    assert len(times) == (len(cases.ROWS) + 1) * 3
    assert float(times[0]["apart by 0.1"]) == PARTS[1]
    shown = tables.console_text(found, results)
    assert all(claim.verdict.upper() in shown for claim in found)


def test_figures_are_drawn(results, tmp_path):
    short = cases.Results()
    for run, values in results.runs.items():
        short.add(run, values.until(200))
    figures.draw_all(tmp_path, short)
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {f"figure{n:02d}.png" for n in range(2, 14)} | {"parting.png", "overview.png"}
    assert all(path.stat().st_size > 10000 for path in tmp_path.iterdir())


def test_planned_runs_are_those_of_the_paper():
    runs = cases.planned_runs(full=True)
    assert len({run.name for run in runs}) == len(runs)
    assert cases.planned_runs() == runs[: len(cases.planned_runs())]
    steps = {(run.case, run.dt): run.steps for run in runs if run.end == 5000}
    assert steps[1, 0.001] == 5_000_000 and steps[2, 0.125] == 40_000
    assert steps[1, 0.0001] == 50_000_000
    job = runs[0].job("logs")
    assert job.variables["choices"] == "paper" and job.variables["every"] == 1000


def test_full_adds_the_50_million_steps(results, tmp_path):
    full = cases.Results()
    for run in cases.planned_runs(full=True):
        full.add(run, made_up(run))
    assert full.has_full() and not results.has_full()
    found = claims.all_claims(full)
    extra = [c for c in found if "50 million" in c.source]
    assert len(extra) == 2 and len(found) == len(claims.all_claims(results)) + 2
    figures.draw_x(tmp_path / "fine.png", full, 1, "Fig. 4", cases.FINE_STEP)
    assert (tmp_path / "fine.png").exists()
