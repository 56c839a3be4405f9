"""The study accuracy: fitted orders, prices, errors and bounds from made-up numbers."""

import math
from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.engine import session
from benchmarks.engine.page import render
from benchmarks.engine.sites import pose_errors
from benchmarks.engine.store import read_data, write_data
from benchmarks.reference import stability
from benchmarks.reference.solvers import METHODS as SOLVERS
from benchmarks.studies import accuracy as study
from benchmarks.studies.accuracy import evaluate, plan, runs, tables
from benchmarks.studies.accuracy.evaluate import Cost, cost_of, fitted_order

STEPS = 0.5 / 2.0 ** np.arange(0, 8, 0.5)


# --- fitted orders --------------------------------------------------------------------------------
def test_order_of_a_power_law():
    fit = fitted_order(STEPS, 3.0 * STEPS**7)
    assert fit.order == pytest.approx(7.0, rel=1e-9)
    assert fit.coefficient == pytest.approx(3.0, rel=1e-9)
    assert fit.order != pytest.approx(7.0 * 1.01, rel=1e-3)


def test_rounding_and_coarse_steps_do_not_count():
    noise = 1e-9 * np.resize([2.0, 1.0, 3.0], len(STEPS))
    errors = np.maximum(STEPS**5, noise)
    errors[:3] = (1e-4, np.inf, 1.0)
    fit = fitted_order(STEPS, errors, limit=STEPS[2])
    assert fit.order == pytest.approx(5.0, rel=1e-9)
    assert (
        errors[fit.used].min() > evaluate.ABOVE_FLOOR * noise.max()
        and STEPS[fit.used].max() < STEPS[2] / 1.25
    )
    assert np.polyfit(np.log(STEPS[3:]), np.log(errors[3:]), 1)[0] < 4.9  # the rule matters


def test_an_order_off_by_one_percent_shows():
    assert fitted_order(STEPS, STEPS**7.07).order != pytest.approx(7.0, rel=5e-3)


def test_one_lucky_error_does_not_bend_the_order():
    errors = STEPS**5
    errors[-8] *= 1e-2
    assert fitted_order(STEPS, errors).order == pytest.approx(5.0, rel=0.01)
    assert evaluate.sign_change(STEPS, errors) == STEPS[-8]
    assert evaluate.sign_change(STEPS, STEPS**5) is None


def test_too_few_points_have_no_order():
    assert fitted_order(STEPS[:2], STEPS[:2] ** 3) is None
    assert fitted_order(STEPS, np.full(len(STEPS), 1e-12)) is None


@pytest.mark.parametrize(
    ("formulation", "values", "order"),
    [("first", 3, 3), ("first", 4, 5), ("first", 5, 5), ("first", 6, 7), ("first", 8, 9)]
    + [("second", 4, 3), ("second", 5, 5), ("second", 6, 7), ("second", 7, 7), ("second", 8, 9)],
)
def test_expected_orders_are_those_of_gear(formulation, values, order):
    assert evaluate.expected_order(formulation, values) == order


# --- prices ---------------------------------------------------------------------------------------
def test_price_is_interpolated_log_log():
    costs = np.array([100.0, 200.0, 400.0, 800.0])
    errors = 1e6 * costs**-5.0
    found = cost_of(costs, errors, 1e6 * 300.0**-5.0)
    assert found.value == pytest.approx(300.0, rel=1e-12) and found.kind == "measured"
    assert found.value != pytest.approx(303.0, rel=5e-3)


def test_price_counts_from_where_the_error_stays_below():
    costs, errors = [1, 2, 4, 8, 16], [1e-7, 1e-3, 1e-5, 1e-8, 1e-9]  # a lucky first run
    assert 4 < cost_of(costs, errors, 1e-6).value < 8
    assert cost_of(costs, errors, 1e-2) == Cost(1.0, "at most")


def test_price_of_runs_that_went_astray():
    assert cost_of([np.nan, 2, 4], [np.inf, 1e-3, 1e-5], 1e-2) == Cost(2.0)
    assert cost_of([1, 2, 4], [np.inf, 1e-3, 1e-5], 1e-2) == Cost(2.0)
    assert cost_of([1, 2], [1e-3, np.inf], 1e-2) is None
    assert cost_of([], [], 1e-2) is None


def test_an_error_that_is_not_reached_has_no_price():
    assert cost_of([1, 2, 4], [1e-3, 1e-4, 1e-5], 1e-6) is None


def test_extrapolated_price():
    costs = 100 * 2.0 ** np.arange(10)
    errors = 4.0 * costs**-2.0
    found = evaluate.extrapolated_cost(costs, errors, 4.0 * 1e7**-2.0)
    assert found.value == pytest.approx(1e7, rel=1e-9) and found.kind == "extrapolated"


def test_the_cheapest_is_found():
    found = evaluate.cheapest({"a": None, "b": Cost(2.0), "c": Cost(1.5)})
    assert found == ("c", Cost(1.5))
    assert evaluate.cheapest({"a": None}) == (None, None)


def test_a_ratio_of_prices_keeps_what_is_known_of_them():
    measured, any_run = Cost(6.0, error=0.03), Cost(2.0, "at most", 0.04)
    assert measured.over(any_run) == Cost(3.0, "at least", pytest.approx(0.05))
    assert any_run.over(measured).kind == "at most"
    assert Cost(6.0, "extrapolated").over(Cost(2.0)).kind == "extrapolated"


# --- errors of a run ------------------------------------------------------------------------------
MASSES = np.array([1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 9.0])
MOLECULES = np.array([1, 1, 1, 2, 2, 2, 0])
BEFORE = np.random.default_rng(1).normal(size=(7, 3)) * 5


def moved(turns, shifts):
    """BEFORE with each body turned about its center of mass and shifted."""
    after = BEFORE.copy()
    for body, turn, shift in zip((1, 2), turns, shifts):
        own = MOLECULES == body
        center = MASSES[own] @ BEFORE[own] / MASSES[own].sum()
        after[own] = Rotation.from_rotvec(turn).apply(BEFORE[own] - center) + center + shift
    return after


def test_pose_errors_are_rms_over_bodies():
    reference = moved([[0.3, 1.0, 0.2], [2.0, 0.1, 0.0]], [[1, 2, 3], [0, 0, 1]])
    off = moved([[0.3, 1.0, 0.2], [2.0, 0.1, 0.0]], [[1, 2, 3 + 3e-9], [0, 4e-9, 1]])
    found = pose_errors(MASSES, MOLECULES, BEFORE, off, reference)
    assert found[0] == pytest.approx(math.sqrt((9 + 16) / 2) * 1e-9, rel=1e-5)
    assert found[0] != pytest.approx(1.01 * math.sqrt(12.5) * 1e-9, rel=5e-3)
    assert found[1] < 1e-14


def test_orientation_error_is_an_angle():
    reference = moved([[0, 0, 0.5], [0, 0, 0]], np.zeros((2, 3)))
    off = moved([[0, 0, 0.5 + 2e-7], [0, 0, 0]], np.zeros((2, 3)))
    found = pose_errors(MASSES, MOLECULES, BEFORE, off, reference)
    assert found[1] == pytest.approx(2e-7 / math.sqrt(2), rel=1e-6) and found[0] < 1e-14


def test_a_body_that_is_lost_is_infinitely_far():
    off = BEFORE.copy()
    off[0, 0] = math.nan
    assert pose_errors(MASSES, MOLECULES, BEFORE, off, BEFORE) == (math.inf, math.inf)


def test_energy_error_and_drift():
    time = np.arange(0.0, 41.0)
    energy, drift = runs.energy_errors(time, -0.7 + 1e-6 * time)
    assert (energy, drift) == pytest.approx((4e-5, 1e-6), rel=1e-6)
    assert drift != pytest.approx(1.01e-6, rel=5e-3)
    assert runs.energy_errors(time, np.full(41, math.nan)) == (math.inf, math.inf)


# --- stability ------------------------------------------------------------------------------------
def test_coefficients():
    assert stability.first_order_coefficients(5) == [
        Fraction(*pair) for pair in ((251, 720), (1, 1), (11, 12), (1, 3), (1, 24))
    ]
    second = [Fraction(*pair) for pair in ((3, 20), (251, 360), (1, 1), (11, 18), (1, 6), (1, 60))]
    assert stability.second_order_coefficients(6) == second
    assert stability.second_order_coefficients(6, "velocity")[0] == Fraction(3, 16)


# Gear's limits as the notes on the method give them, two digits
LIMITS = {
    "second": {4: 1.42, 5: 1.11, 6: 0.84, 7: 0.63, 8: 0.46},
    "first": {3: 1.01, 4: 0.94, 5: 0.66, 6: 0.42, 7: 0.25, 8: 0.14},
}


@pytest.mark.parametrize("formulation", LIMITS)
def test_linear_limits(formulation):
    found = {n: tables.limit_of(formulation, n) for n in LIMITS[formulation]}
    assert found == pytest.approx(LIMITS[formulation], abs=0.0085)


def test_a_wrong_coefficient_moves_the_limit(monkeypatch):
    right, limit = stability.second_order_coefficients, tables.limit_of("second", 8)

    def wrong(values, c0):
        return [1.01 * float(c) if row == 3 else c for row, c in enumerate(right(values, c0))]

    monkeypatch.setattr(stability, "second_order_coefficients", wrong)
    assert abs(tables.limit_of("second", 8) - limit) > 2e-3 * limit


@pytest.mark.parametrize("least", [3, 50, 99, 100, 101, 777])
def test_bisection_finds_the_fewest_steps(least):
    asked = []
    found = runs.fewest_steps(lambda n: asked.append(n) or n >= least, 100, 10_000)
    assert least <= found <= max(1.02 * least, least + 1) and len(asked) < 25


def test_bisection_gives_up():
    assert runs.fewest_steps(lambda n: False, 100, 1000) is None


# --- timings --------------------------------------------------------------------------------------
def test_competitors_take_turns():
    order = []
    found = session.time_in_turn("ab", 5, lambda name: order.append(name) or 1.0, 20)
    assert "".join(order) == "ab" * 5 and found["a"] == session.Timing(5, 1.0, 1.0, 1.0)


def test_unsteady_runs_go_on():
    noise = iter(np.tile([0.01, 0.02], 100))
    calls = {"steady": 0, "noisy": 0}

    def once(name):
        calls[name] += 1
        return 0.01 if name == "steady" else next(noise)

    session.time_in_turn(calls, 5, once, session.MOST_ROUNDS)
    assert calls == {"steady": 5, "noisy": session.MOST_ROUNDS}


def test_quartiles():
    found = session.Timing.of([5.0, 1.0, 2.0, 3.0, 4.0])
    assert found == session.Timing(5, 2.0, 3.0, 4.0)


# --- bounds and page --------------------------------------------------------------------------------
def points(scene, method, order, rounding=0.0):
    """Points of a method whose errors are a power of the step."""
    p, factor = (order, 0.03) if method.gear else (2.0, 0.1)
    made = []
    for steps in 400 * 2 ** np.arange(0, 7 if method.gear else 12):
        dt = 200.0 / steps
        errors = runs.Errors(*[max(factor * dt**p, rounding)] * 4, 1e-16, 1e-9)
        timing, run = session.Timing(5, 0.99e-6 * steps, 1e-6 * steps, 1.01e-6 * steps), None
        run = plan.Run(plan.scenes(False)[scene], method, int(steps))
        made.append(runs.point_of(run, START, errors, timing))
    return made


START = session.Outcome(0.0, 0.0, 0, *[np.zeros(0)] * 5, {})


def made_up(order=7.0, scenes=("case1",), slope=1.0, rounding=1e-12, modify=3e-7):
    """Results in which every error is a power of the step."""
    results = runs.Results(False)
    for scene in scenes:
        for method in plan.scenes(False)[scene].methods:
            results.runs += points(scene, method, order)
            results.limits[scene, method.key] = 0.8
        for solver in SOLVERS:
            rows = [(1e-3, n, n**-3.0, n**-3.0) for n in (1000, 2000, 4000, 64000)]
            results.solvers[scene, solver] = rows
    steps = 0.2 / 1.1 ** np.arange(20)
    for name, numbers in plan.VALUES.items():
        for n in numbers:
            p = slope * evaluate.expected_order(name, n)
            results.orders[name, n] = [(dt, 0.1 * dt**p) for dt in steps]
        for compensate, error in ((False, 2e-11), (True, rounding)):
            results.rounding[name, compensate] = [(dt, error) for dt in (0.01, 0.001)]
    times = {plan.RIGID_NVE: 4e-7, plan.RIGID_SMALL: 4e-7}
    for method in plan.MODIFY:
        time = times.get(method, modify)
        results.modify[method.key] = session.Timing(5, time, time, time)
    return results


def broken(results):
    """Words of the measurements that are out of bounds."""
    return [m.what for m in study.find(results).measurements if not m.holds]


def test_speedup_is_that_of_the_numbers():
    table = study.find(made_up()).tables["speedup"]
    # error 1e-6: our step (1e-6/0.03)^(1/7), theirs (1e-6/0.1)^(1/2)
    expected = (1e-6 / 0.03) ** (1 / 7) / (1e-6 / 0.1) ** 0.5
    assert table.rows[1][1].startswith(f"{tables.significant(expected)}× ± ")
    assert "extrapolated" not in table.rows[2][1] and "extrapolated" in table.rows[3][1]


def test_a_low_order_is_not_fast():
    wrong = broken(made_up(order=2.0))
    assert len([what for what in wrong if "fix rigid/nve/small` relative" in what]) == 6


def test_evaluations_beside_scipy():
    rows = study.find(made_up()).tables["evaluations"].rows
    assert rows[0][4] == "≤ 1 000" and rows[3][4] == "2 154"
    # error 1e-8 needs 200 (1e-8/0.03)^(-1/7) steps, more than SciPy's 1 000
    assert [what.split(":")[0] for what in broken(made_up()) if "evaluations" in what] == [
        f"test case 1, error {error}" for error in ("1e-8", "1e-10")
    ]


def test_slopes_floors_and_times_are_bounded():
    good = set(broken(made_up()))
    assert not [what for what in good if "order" in what or "sums" in what or "inside" in what]
    flat = [what for what in broken(made_up(slope=0.9)) if "order" in what]
    assert len(flat) > 6
    assert len([what for what in broken(made_up(rounding=1.01e-12)) if "sums" in what]) == 2
    assert len([what for what in broken(made_up(modify=4.04e-7)) if "inside" in what]) == 1


def test_results_survive_their_file(tmp_path):
    write_data(tmp_path / "data.json", made_up())
    assert read_data(tmp_path / "data.json") == made_up()


def test_page_and_readme():
    finding = study.find(made_up(scenes=tuple(plan.scenes(False))))
    text = render("accuracy_cost.md.j2", study.STUDY, finding, "Somewhere.")
    assert "(accuracy_cost/main.png)" in text and "costs 0.87 ms with" in text
    block = render("accuracy_cost.readme.md.j2", study.STUDY, finding, "Somewhere.")
    assert "(doc/accuracy_cost/main.png)" in block and block.count("×") == 6


def test_one_scene_alone_is_enough(tmp_path):
    finding = study.find(made_up(scenes=("top",)))
    assert set(finding.pictures) == {"top"} and "other_speedups" in finding.tables
    finding.pictures["top"](tmp_path / "top.png")
    assert (tmp_path / "top.png").stat().st_size > 10_000
