"""Temperatures, diffusion and rotational correlation times of made-up motions whose values are known."""

import csv
import re
from types import SimpleNamespace

from support import dumps
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from test_analysis_diffusion import bound

from gearquat_analysis import averages, correlations
from gearquat_analysis.report import average_lines, write_averages

FRAMES, BODIES = 2000, 60
MOMENTS = np.array([3.0, 2.0, 1.0])


class Made(SimpleNamespace):
    def __len__(self):
        return BODIES


class Results(SimpleNamespace):
    def __contains__(self, name):
        return hasattr(self, name)


def bodies(moments=MOMENTS):
    moments = np.broadcast_to(moments, (BODIES, 3))
    return Made(
        mass=np.full(BODIES, 2.0),
        moments=moments,
        axes=np.broadcast_to(np.eye(3), (BODIES, 3, 3)),
        point=(moments == 0).all(axis=1),
        linear=(moments[:, 2] == 0) & (moments[:, 0] > 0),
    )


def thermal(translation=1.3, axes=(1.0, 1.1, 1.2), resting=True, moments=MOMENTS):
    """Poses with velocities of these temperatures."""
    rng = np.random.default_rng(3)
    made = bodies(moments)
    velocity = rng.normal(size=(FRAMES, BODIES, 3)) * np.sqrt(translation / 2.0)
    if resting:
        velocity -= velocity.mean(axis=1, keepdims=True)
    q = Rotation.random(FRAMES * BODIES, random_state=1).as_quat(scalar_first=True)
    spread = np.sqrt(np.divide(axes, made.moments, out=np.zeros((BODIES, 3)), where=made.moments > 0))
    omega = rng.normal(size=(FRAMES, BODIES, 3)) * spread
    turn = Rotation.from_quat(q, scalar_first=True)
    results = Results(
        time=np.arange(FRAMES, dtype=float),
        center=velocity.cumsum(axis=0),
        q=q.reshape(FRAMES, BODIES, 4),
        velocity=velocity,
        omega_space=turn.apply(omega.reshape(-1, 3)).reshape(FRAMES, BODIES, 3),
        ke_translation=0.5 * 2.0 * (velocity**2).sum(axis=2),
        ke_rotation=0.5 * (made.moments * omega**2).sum(axis=2),
    )
    return SimpleNamespace(results=results, bodies=made, units=None, unit=lambda name: "")


def near(average, expected):
    """The temperatures are within four standard errors, which are small; values that are 10 % off are not."""
    assert average[1] < 0.02 * expected
    assert abs(average[0] - expected) < 4 * average[1]
    assert abs(average[0] - 1.1 * expected) > 4 * average[1]


@pytest.mark.parametrize("resting", [True, False])
def test_temperatures(resting):
    found = averages.temperatures(thermal(resting=resting))
    about = {f"rotation about axis {k}": value for k, value in ((1, 1.0), (2, 1.1), (3, 1.2))}
    expected = {"translation": 1.3, "rotation": 1.1} | about
    assert set(found) == set(expected)
    for name, value in expected.items():
        near(averages.of_series(found[name]), value)


def test_the_difference_of_temperatures_has_its_own_error():
    """At constant energy the two are anticorrelated: their errors in quadrature are too small."""
    z, naive, poses = [], [], thermal(moments=np.array([3.0, 3.0, 0.0]))
    poses.results = Results(**{name: values[:500] for name, values in vars(poses.results).items()})
    for seed in range(40):
        exchange = bound(np.random.default_rng(seed), 500, 1, 1.0)[:, 0, 0]
        poses.results.ke_translation = np.outer(3.0 + 0.1 * exchange, np.full(BODIES, 0.65) * (1.0 - 1.0 / BODIES))
        poses.results.ke_rotation = np.outer(2.0 - 0.1 * exchange, np.full(BODIES, 0.65))
        known = {one.name: one for one in averages.averages(poses)[:3]}
        one, *both = (known[name] for name in (averages.DIFFERENCE, "temperature of translation", "temperature of rotation"))
        z.append(one.value / one.error)
        naive.append(one.value / np.hypot(both[0].error, both[1].error))
    z, naive = (np.sqrt(np.nanmean(np.square(values))) for values in (z, naive))
    assert 0.7 < z < 1.4 and naive > 1.2 * z


def test_without_a_moment_there_is_no_temperature():
    found = averages.temperatures(thermal(moments=np.array([3.0, 3.0, 0.0])))
    assert set(found) == {"translation", "rotation"}  # both axes of a linear body are equal
    near(averages.of_series(found["rotation"]), 1.05)
    assert set(averages.temperatures(thermal(moments=np.zeros(3)))) == {"translation"}


#: moments of tops, turns that leave their inertia as it is, and temperatures of groups of axes with 1, 1.1 and 1.2
TOPS = [
    ([3.0, 2.001, 2.0], [1.0, 0.0, 0.0], {"axis 1": 1.0, "axes 2 and 3": 1.15}),
    ([3.0, 2.999, 1.0], [0.0, 0.0, 1.0], {"axes 1 and 2": 1.05, "axis 3": 1.2}),
    ([3.0, 2.999, 2.998], [0.5, 0.3, 0.8], {}),
]


@pytest.mark.parametrize(("moments", "turn", "expected"), TOPS)
def test_axes_of_equal_moments_are_arbitrary(moments, turn, expected):
    """Axes with equal moments have one average, which does not depend on the choice of the axes."""
    poses = thermal(moments=np.array(moments))
    found, before = averages.temperatures(poses), correlations.all_correlations(poses).functions
    about = {name.removeprefix("rotation about "): series for name, series in found.items() if " about " in name}
    assert set(about) == set(expected)
    for name, value in expected.items():
        near(averages.of_series(about[name]), value)
    assert not {"axis2_order1", "axis2_order2"} & set(before)
    angles = np.linspace(0.0, 2.0, BODIES)[:, None]  # a different choice in each body
    turns = Rotation.from_rotvec(angles * turn / np.linalg.norm(turn))
    poses.bodies.axes = np.swapaxes(turns.as_matrix(), 1, 2).copy()
    again, after = averages.temperatures(poses), correlations.all_correlations(poses).functions
    for name in found:  # moments differ by 5e-4
        assert again[name] == pytest.approx(found[name], rel=1e-3), name
    for name in before:
        assert after[name] == pytest.approx(before[name], abs=1e-12 * np.abs(before[name]).max()), name


def test_the_axis_of_some_is_arbitrary():
    """A symmetric top among bodies with three different moments: three axes are named, and two of them share the top."""
    poses = thermal(moments=np.array([[3.0, 2.0, 2.0 - (body % 2)] for body in range(BODIES)]), axes=(1.0, 1.1, 1.2))
    found = averages.temperatures(poses)
    expected = {"axis 1": 1.0, "axis 2": (1.1 + 1.15) / 2.0, "axis 3": (1.2 + 1.15) / 2.0}
    for name, value in expected.items():
        near(averages.of_series(found[f"rotation about {name}"]), value)
    assert {"axis2_order2", "axis3_order2"} <= set(correlations.all_correlations(poses).functions)


def test_the_error_of_independent_samples():
    """The error of n samples is 1/sqrt(n), within the uncertainty from ten blocks."""
    values = np.random.default_rng(5).normal(size=(200, 1000))
    errors = [averages.of_series(one)[1] for one in values]
    assert np.mean(np.square(errors)) == pytest.approx(1e-3, rel=0.15)
    few = averages.of_series(values[0, :5])
    assert few[0] == pytest.approx(values[0, :5].mean()) and np.isnan(few[1])


def test_all_samples_count():
    """All frames are used, also if they do not suffice for one more in each block."""
    series = np.arange(19.0) ** 2
    assert averages.of_series(series)[0] == pytest.approx(series.mean(), rel=1e-14)


def test_uneven_times():
    """Frames that are denser in time do not have a larger weight; results that need even times are left out, and a
    warning says why."""
    poses = thermal()
    results, even = poses.results, averages.averages(thermal())
    hot = np.arange(FRAMES) < FRAMES // 2
    results.time = np.cumsum(np.where(hot, 0.1, 1.0))
    results.ke_translation = results.ke_translation * np.where(hot, 2.0, 1.0)[:, None]
    with pytest.warns(UserWarning, match="no diffusion coefficients .* times: .* the time after frame 0 at 0.1 is 0.2"):
        found = averages.averages(poses)
    assert [one.name for one in found] == [one.name for one in even if one.name.startswith("temperature")]
    assert found[0].value == pytest.approx(1.3 * (2.0 * 0.1 + 1.0) / 1.1, rel=0.01)
    assert found[0].value < 1.3 * 1.2  # 1.3 x 1.5 if all frames had the same weight


def test_energies_are_weighted_as_temperatures(tmp_path):
    """The mean energy that the command prints is the temperature's: half of k T for each of 3 B degrees of freedom."""

    def slower(time, rows):
        rows[:, 7:10] *= 2.0 / (1.0 + time)
        return rows

    times = np.arange(60.0) ** 2 / 60.0
    path = dumps.write(tmp_path / "uneven.dump", dumps.Motion([3, 4]), times, slower)
    frames = path.read_text().split("ITEM: TIMESTEP")[1:]
    path.write_text("".join(f"ITEM: TIME\n{t}\nITEM: TIMESTEP{frame}" for t, frame in zip(times, frames)))
    result = dumps.analyze(path, tmp_path / "out")
    assert result.exit_code == 0, result.output
    with open(tmp_path / "out" / "averages.csv") as file:
        known = {row["average"]: float(row["value"]) for row in csv.DictReader(file)}
    printed = float(re.search("The mean of ke_translation is ([^ ]+)", result.output)[1])
    totals = dumps.columns(tmp_path / "out" / "totals.csv")["ke_translation"]
    assert printed == pytest.approx(0.5 * 6 * known["temperature of translation"], rel=1e-5)
    # the integral over time by the trapezoidal rule with longer ends, and not the plain mean
    assert printed == pytest.approx(np.average(totals, weights=np.gradient(times)), rel=1e-5)
    assert printed < 0.9 * totals.mean()


def test_the_error_of_weighted_samples():
    """With weights 1 and 3 it is sqrt(5 / 4) times the error with equal weights."""
    values = np.random.default_rng(6).normal(size=(400, 1000))
    weights = np.where(np.arange(1000) % 2, 1.0, 3.0)
    errors = [averages.of_series(one, weights=weights)[1] for one in values]
    assert np.mean(np.square(errors)) == pytest.approx(1.25e-3, rel=0.1)


@pytest.mark.parametrize("resting", [True, False])
def test_two_dimensions(resting):
    """Two degrees of freedom of translation and one of rotation; the slope of the mean square is 4 D."""
    poses = thermal(resting=resting)
    results, rng = poses.results, np.random.default_rng(4)
    results.velocity[..., 2] = 0.0
    results.center = rng.normal(size=(FRAMES, BODIES, 3)).cumsum(axis=0) * [1.0, 1.0, 0.0]
    spin = rng.normal(size=(FRAMES, BODIES)) * np.sqrt(1.1 / 3.0)
    results.omega_space = spin[..., None] * [0.0, 0.0, 1.0]
    results.ke_translation = (results.velocity**2).sum(axis=2)
    results.ke_rotation = 1.5 * spin**2
    found = averages.temperatures(poses)
    assert set(found) == {"translation", "rotation"}
    near(averages.of_series(found["translation"]), 1.3)
    near(averages.of_series(found["rotation"]), 1.1)
    known = {average.name: average for average in averages.averages(poses)}["diffusion coefficient"]
    assert abs(known.value - 0.5) < 3.0 * known.error < 0.1


def test_points_have_no_part_in_rotation():
    """Averages of rotation are the same with and without points among the bodies."""
    mixed = thermal(moments=np.array([MOMENTS if body % 3 else 0.0 * MOMENTS for body in range(BODIES)]))
    results, own = mixed.results, ~mixed.bodies.point
    results.q[:, ~own], results.omega_space[:, ~own] = [1.0, 0.0, 0.0, 0.0], 0.0
    few = {name: getattr(results, name)[:, own] for name in ("q", "omega_space", "center", "velocity")}
    made = {name: getattr(mixed.bodies, name)[own] for name in ("mass", "moments", "axes", "point", "linear")}
    alone = SimpleNamespace(results=Results(time=results.time, **few), bodies=Made(**made), unit=lambda name: "")
    both = [correlations.all_correlations(poses).functions for poses in (mixed, alone)]
    assert set(both[0]) == set(both[1]) and "axis1_order1" in both[0]
    for name in both[0]:
        if name.startswith(("axis", "omega", "mean_square_rotation")):
            assert both[0][name] == pytest.approx(both[1][name], rel=1e-12, abs=1e-12), name


def test_diffusion_of_a_random_walk():
    rng = np.random.default_rng(7)
    spread, dt = 0.3, 0.5
    center = rng.normal(size=(FRAMES, 500, 3)).cumsum(axis=0) * spread + 1e3
    found = averages.diffusion(dt * np.arange(FRAMES), center)
    expected = spread**2 / (2 * dt)
    assert found[0] == pytest.approx(expected, rel=0.03) and found[1] < 0.03 * expected
    assert np.isnan(averages.diffusion(np.arange(50.0), center[:50])[:2]).all()


def test_times_of_rotational_diffusion():
    """Small random turns about body axes: P1 and P2 decay with 2 D and 6 D."""
    rng, spread, dt = np.random.default_rng(11), 0.15, 2.0
    turn = Rotation.random(400, random_state=2)
    q = np.empty((FRAMES, 400, 4))
    for frame in range(FRAMES):
        q[frame] = turn.as_quat(scalar_first=True)
        turn = turn * Rotation.from_rotvec(spread * rng.normal(size=(400, 3)))
    time = dt * np.arange(FRAMES)
    for order, expected in ((1, dt / spread**2), (2, dt / (3 * spread**2))):
        value, error, _ = averages.rotational_time(time, q, [0.0, 0.6, 0.8], order)
        assert value == pytest.approx(expected, rel=0.06) and error < 0.06 * expected
    assert np.isnan(averages.rotational_time(time[:200], q[:200], [0, 0, 1], 1)[:2]).all()


def turning_about_z(angles):
    """Quaternions (F, B, 4) of turns by angles (F, B)."""
    return np.stack([np.cos(angles / 2.0), 0.0 * angles, 0.0 * angles, np.sin(angles / 2.0)], axis=-1)


def test_correlation_times_without_an_exponential_tail():
    """Free rotors have no correlation time, nor do bodies of which a tenth turn slowly; bodies that are all alike have
    one."""
    rng = np.random.default_rng(5)
    steps = 0.5 * rng.normal(size=(1000, 100))
    for slow, expected in ((1.0, True), (0.2, False)):
        scaled = steps * np.where(np.arange(100) < 15, slow, 1.0)
        one = averages.rotational_time(np.arange(1000.0), turning_about_z(np.cumsum(scaled, axis=0)), [1.0, 0, 0], 1)
        assert np.isfinite(one.value) == expected
        if expected:
            assert abs(one.value - 8.0) < 4.0 * one.error < 2.0  # 2 / variance of a step
    free = np.arange(1000.0)[:, None] * 0.3 * rng.normal(size=100)
    one = averages.rotational_time(np.arange(1000.0), turning_about_z(1.0 + 0.2 * np.arange(1000.0)[:, None] + 0.2 * free), [1, 0, 0], 1)
    assert np.isnan(one.value) and "exponential" in one.why


def test_the_integral_of_an_exponential():
    lag = 0.1 * np.arange(1000)
    assert averages.integral_time(lag, np.exp(-lag / 3.0)) == pytest.approx(3.0, rel=1e-3)
    assert np.isnan(averages.integral_time(lag, np.exp(-lag / 300.0)))


def test_what_is_too_short_is_told(tmp_path):
    found = averages.averages(thermal())
    text = average_lines(found)
    assert "The temperature of translation is 1.3" in text and " ± " in text
    assert "No " not in average_lines(found[:6])
    short = [*found[:1], averages.Average("correlation time", float("nan"), float("nan"), "", "it is short")]
    assert "No correlation time: it is short." in average_lines(short)
    write_averages(tmp_path / "a.csv", short)
    rows = (tmp_path / "a.csv").read_text().splitlines()
    slow = averages.Average("temperature of rotation", 0.1281, float("nan"), "K", "it drifts")
    assert average_lines([slow]) == "The temperature of rotation is 0.1281 K, with an unknown error: it drifts."
    assert rows[0] == "average,value,standard error,unit,error unknown because" and rows[2] == "correlation time,,,,it is short"
