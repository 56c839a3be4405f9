"""Fitted orders, prices, verdicts and texts of ``benchmarks/run workprecision``, from made-up numbers."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from benchmarks.engine import checkout
from benchmarks.studies.workprecision import evaluate, figures, judge, measure, page, plan, results
from benchmarks.studies.workprecision import stability, tables
from benchmarks.studies.workprecision.evaluate import MET, MISSED, cost_of, fitted_order

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
def test_orders_asked_are_those_of_gear(formulation, values, order):
    assert evaluate.order_asked(formulation, values) == order


def test_order_with_the_coefficient_for_velocities():
    assert evaluate.order_asked("second", 6, "velocity") == 5


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
    assert cost_of(costs, errors, 1e-2) == evaluate.Cost(1.0, "at most")


def test_price_of_runs_that_went_astray():
    assert cost_of([np.nan, 2, 4], [np.inf, 1e-3, 1e-5], 1e-2) == evaluate.Cost(2.0)
    assert cost_of([1, 2, 4], [np.inf, 1e-3, 1e-5], 1e-2) == evaluate.Cost(2.0)
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
    found = evaluate.cheapest({"a": None, "b": evaluate.Cost(2.0), "c": evaluate.Cost(1.5)})
    assert found == ("c", evaluate.Cost(1.5))
    assert evaluate.cheapest({"a": None}) is None


@pytest.mark.parametrize(("measured", "verdict"), [(5.0, MET), (4.95, MISSED), (None, MISSED)])
def test_verdicts(measured, verdict):
    assert evaluate.at_least(measured, 5.0) == verdict
    assert evaluate.at_least(math.nan, 5.0) == evaluate.at_most(math.nan, 5.0) == MISSED
    assert (evaluate.at_most(5.0, 5.0), evaluate.at_most(5.05, 5.0)) == (MET, MISSED)


# --- errors of a run ------------------------------------------------------------------------------
MASSES = np.array([1.0, 2.0, 3.0, 1.0, 2.0, 3.0, 9.0])
MOLECULES = np.array([1, 1, 1, 2, 2, 2, 0])
BEFORE = np.random.default_rng(1).normal(size=(7, 3)) * 5


def moved(turns, shifts):
    """BEFORE with each body turned about its centre of mass and shifted."""
    after = BEFORE.copy()
    for body, turn, shift in zip((1, 2), turns, shifts):
        own = MOLECULES == body
        centre = MASSES[own] @ BEFORE[own] / MASSES[own].sum()
        after[own] = Rotation.from_rotvec(turn).apply(BEFORE[own] - centre) + centre + shift
    return after


def test_pose_errors_are_rms_over_bodies():
    reference = moved([[0.3, 1.0, 0.2], [2.0, 0.1, 0.0]], [[1, 2, 3], [0, 0, 1]])
    off = moved([[0.3, 1.0, 0.2], [2.0, 0.1, 0.0]], [[1, 2, 3 + 3e-9], [0, 4e-9, 1]])
    found = judge.pose_errors(MASSES, MOLECULES, BEFORE, off, reference)
    assert found[0] == pytest.approx(math.sqrt((9 + 16) / 2) * 1e-9, rel=1e-5)
    assert found[0] != pytest.approx(1.01 * math.sqrt(12.5) * 1e-9, rel=5e-3)
    assert found[1] < 1e-14


def test_orientation_error_is_an_angle():
    reference = moved([[0, 0, 0.5], [0, 0, 0]], np.zeros((2, 3)))
    off = moved([[0, 0, 0.5 + 2e-7], [0, 0, 0]], np.zeros((2, 3)))
    found = judge.pose_errors(MASSES, MOLECULES, BEFORE, off, reference)
    assert found[1] == pytest.approx(2e-7 / math.sqrt(2), rel=1e-6) and found[0] < 1e-14


def test_a_body_that_is_lost_is_infinitely_far():
    off = BEFORE.copy()
    off[0, 0] = math.nan
    assert judge.pose_errors(MASSES, MOLECULES, BEFORE, off, BEFORE) == (math.inf, math.inf)


def test_energy_error_and_drift():
    time = np.arange(0.0, 41.0)
    energy, drift = judge.energy_errors(time, -0.7 + 1e-6 * time)
    assert (energy, drift) == pytest.approx((4e-5, 1e-6), rel=1e-6)
    assert drift != pytest.approx(1.01e-6, rel=5e-3)
    assert judge.energy_errors(time, np.full(41, math.nan)) == (math.inf, math.inf)


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
    right = stability.second_order_coefficients

    def wrong(values, c0):
        return [1.01 * float(c) if row == 3 else c for row, c in enumerate(right(values, c0))]

    monkeypatch.setattr(stability, "second_order_coefficients", wrong)
    assert abs(tables.limit_of("second", 8) - LIMITS["second"][8]) > 2e-3 * LIMITS["second"][8]


@pytest.mark.parametrize("least", [3, 50, 99, 100, 101, 777])
def test_bisection_finds_the_fewest_steps(least):
    asked = []
    found = stability.fewest_steps(lambda n: asked.append(n) or n >= least, 100, 10_000)
    assert least <= found <= max(1.02 * least, least + 1) and len(asked) < 25


def test_bisection_gives_up():
    assert stability.fewest_steps(lambda n: False, 100, 1000) is None


# --- timings --------------------------------------------------------------------------------------
def test_competitors_take_turns():
    order = []
    found = measure.time_in_turn("ab", 5, lambda name: order.append(name) or 1.0)
    assert "".join(order) == "ab" * 5 and found["a"] == measure.Timing(5, 1.0, 1.0, 1.0)


def test_unsteady_runs_go_on():
    noise = iter(np.tile([0.01, 0.02], 100))
    calls = {"steady": 0, "noisy": 0}

    def once(name):
        calls[name] += 1
        return 0.01 if name == "steady" else next(noise)

    measure.time_in_turn(calls, 5, once)
    assert calls == {"steady": 5, "noisy": measure.MOST_ROUNDS}


def test_quartiles():
    found = measure.timing_of([5.0, 1.0, 2.0, 3.0, 4.0])
    assert found == measure.Timing(5, 2.0, 3.0, 4.0)


# --- tables and page ------------------------------------------------------------------------------
def made_up(order=7.0):
    """Results of case 1 in which every error is a power of the step."""
    found = results.Results()
    for method in plan.ALL_METHODS:
        rigid = method.family == plan.RIGID
        p, factor = (2.0, 0.1) if rigid else (order, 0.03)
        for steps in 400 * 2 ** np.arange(0, 12 if rigid else 7):
            dt = 200.0 / steps
            error, seconds = factor * dt**p, 1e-6 * steps
            found.runs.append(
                results.Row(
                    "case1",
                    method.key,
                    method.label,
                    method.family,
                    method.values,
                    method.passes,
                    int(steps),
                    dt,
                    0,
                    int(steps),
                    error,
                    error,
                    error,
                    error,
                    1e-16,
                    1e-9,
                    5,
                    0.99 * seconds,
                    seconds,
                    1.01 * seconds,
                )
            )
        found.limits.append(results.LimitRow("case1", method.key, 250, 0.8))
    for solver in tables.SOLVERS:
        for n in (1000, 2000, 4000, 64000):
            found.solvers.append(results.SolverRow("case1", solver, 1e-3, n, n**-3.0, 0.0))
    for method in plan.EVERY_N[: len(plan.EVERY_N) // 2]:
        p = evaluate.order_asked(method.family, method.values)
        for dt in 0.2 / 1.1 ** np.arange(20):
            row = results.OrderRow(method.family, method.values, dt, 0.1 * dt**p)
            found.orders.append(row)
    for name in tables.FORMULATIONS:
        for word, error in (("no", 2e-11), ("yes", 2e-12)):
            found.rounding += [results.RoundingRow(name, word, dt, error) for dt in (0.01, 0.001)]
    for method, time in ((plan.RIGID_NVE, 4e-7), (plan.DEFAULT, 3e-7)):
        found.modify.append(results.ModifyRow(method.key, method.label, 5, time, time, time))
    return found


def test_speedup_is_that_of_the_numbers():
    _, rows = tables.speedup(made_up())
    # error 1e-6: our step (1e-6/0.03)^(1/7), theirs (1e-6/0.1)^(1/2)
    expected = (1e-6 / 0.03) ** (1 / 7) / (1e-6 / 0.1) ** 0.5
    assert rows[1][2] == f"{tables.significant(expected)}×" and rows[1][4] == MET
    assert "extrapolated" not in rows[2][2] and "extrapolated" in rows[3][2]
    _, slow = tables.speedup(made_up(order=2.0))
    assert slow[1][4] == MISSED and slow[1][6] == MISSED


def test_evaluations_beside_scipy():
    _, rows = tables.evaluations(made_up())
    assert rows[0][4] == "≤ 1 000" and rows[3][4] == "2 154"
    assert [row[-1] for row in rows] == [MET, MET, MISSED, MISSED]
    _, worse = tables.evaluations(made_up(order=2.5))
    assert worse[2][-1] == MISSED


def test_orders_are_judged():
    found = made_up()
    assert [row[5] for row in tables.orders(found)[1] if row[3] != tables.NONE] == [MET] * 12
    found.orders = [replace(row, position=row.position**0.9) for row in found.orders]
    assert MISSED in [row[5] for row in tables.orders(found)[1]]


def test_rounding_and_modify_are_judged():
    assert [row[-1] for row in tables.rounding(made_up())[1]] == [MET, MISSED, MET, MISSED]
    _, _, share, _, verdict = tables.modify(made_up())[1][1]
    assert (share, verdict) == ("0.75×", MET)


def test_results_survive_their_files(tmp_path):
    found = made_up()
    found.write(tmp_path)
    assert results.read_results(tmp_path) == found


def test_page_and_readme(tmp_path):
    found, out, folder = made_up(), tmp_path / "out", tmp_path / "checkout"
    (out / "logs").mkdir(parents=True)
    (out / "logs" / "log.one").write_text("LAMMPS (1 Jan 2030)\n")
    figures.draw_all(out / "figures", found)
    for name in page.PICTURES:
        (out / "figures" / name).touch()
    (folder / "src" / "GEARQUAT").mkdir(parents=True)
    (folder / "doc").mkdir()
    frame = f"# Title\n{checkout.begin(page.COMMAND)}\nold\n{checkout.END}\nrest {checkout.END}\n"
    (folder / "README.md").write_text(frame)
    drift = tmp_path / "drift"
    drift.mkdir()
    (drift / "drift.md").write_text("## Very long runs\n\n![p](drift.png)\n")
    (drift / "drift.png").touch()
    page.publish(folder, out, found, drift)
    text, readme = (folder / "doc" / page.PAGE).read_text(), (folder / "README.md").read_text()
    for words in ("LAMMPS (1 Jan 2030)", "do not edit", "reconstructed", "Very long runs"):
        assert words in text
    for link in ("accuracy_cost/main.png", "accuracy_cost/drift.png"):
        assert f"({link})" in text and (folder / "doc" / link).is_file()
    assert "old" not in readme and f"(doc/{page.PAGE})" in readme and readme.startswith("# Title\n")
    page.publish(folder, out, found, drift)
    assert (folder / "README.md").read_text() == readme


def test_a_readme_without_the_block_is_refused(tmp_path):
    (tmp_path / "src" / "GEARQUAT").mkdir(parents=True)
    (tmp_path / "README.md").write_text("# Title\n")
    with pytest.raises(checkout.PublishError, match="README.md needs one"):
        checkout.find(tmp_path, page.COMMAND)
