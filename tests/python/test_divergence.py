"""Analysis of series against made-up ones with known answers."""

import math

import numpy as np
import pytest
from synthetic import line, make

from benchmarks.engine import series
from benchmarks.studies.cases import divergence as dv
from lammps_gearquat.logs import Log


def test_parting_time_is_the_first_sample_beyond_the_threshold():
    still, moving = line(), line(rate=(0.03, 0.0, 0.04))  # 0.05 apart per unit of time
    assert dv.parting_time(still, moving, 0.99) == 20.0
    assert dv.parting_time(still, moving, 0.99 * 1.1) == 22.0
    assert math.isinf(dv.parting_time(still, moving, 5.01))


@pytest.mark.parametrize("there", [2.0, np.nan])
def test_parting_is_where_it_first_happens(there):
    """Coming back does not undo a parting; what is no number has parted."""
    gap = np.zeros((101, 3))
    gap[30, 1] = there
    assert dv.parting_time(line(), make(np.arange(101.0), gap), 1.0) == 30.0


def test_shorter_series_sets_the_end_and_times_have_to_agree():
    assert len(dv.separation(line(end=50), line(end=80))) == 51
    shifted = make(np.arange(101.0) * 1.01, np.zeros((101, 3)))
    with pytest.raises(ValueError, match="same times"):
        dv.separation(line(), shifted)


def test_drift_onset():
    time = np.arange(101.0)
    potential = np.where(time % 2 == 0, -1.0, 0.0)  # swing 1, limit 0.02
    error = np.where(time < 60, 0.0, 0.03)
    excursion = np.where(time == 10, 0.03, error)  # it comes back, so it is no drift
    for error, expected in (
        (error, (60.0, 1)),
        (-error, (60.0, -1)),
        (0.5 * error, (math.inf, 0)),
        (excursion, (60.0, 1)),
    ):
        assert dv.drift_onset(make(time, np.zeros((101, 3)), potential, error=error)) == expected


@pytest.mark.parametrize(
    "rate, axis", [((0, 0, -3), "-z"), ((0.1, 2.5, -2.4), "+y"), ((-4, 1, 1), "-x")]
)
def test_leaving(rate, axis):
    gone = line(rate=rate)
    speed = float(np.linalg.norm(rate))
    assert dv.leaving_axis(gone) == axis
    assert dv.leaving_time(gone) == math.floor(dv.OUTSIDE / speed) + 1
    inside = line(rate=np.array(rate) / 3)
    assert dv.leaving_axis(inside) == "" and math.isinf(dv.leaving_time(inside))


LOG = """LAMMPS (22 Jul 2025)
   Step          Time       c_centre[1]    c_centre[2]    c_centre[3]    c_potential     v_ketrans       v_kerot        v_total        v_qerror
         0  0 84 0 0 -3.5 1.25 1.5 -0.75 0
        10  0.5 84.25 0 1e-05 -3.5 1.25 1.5 -0.75 2.2204460492503131e-16
Loop time of 1.5 on 1 procs for 10 steps
"""


def test_a_series_is_read_and_written_with_every_digit(tmp_path):
    (tmp_path / "log").write_text(LOG)
    values = series.of_log(Log(tmp_path / "log"))
    assert values.time.tolist() == [0, 0.5]
    assert values.center[1].tolist() == [84.25, 0, 1e-05]
    assert values.q_error[1] == 2.2204460492503131e-16
    assert values.until(0.25).time.tolist() == [0]
    assert values.at(0.4) == 1
    values.total[1] = -1 / 3
    series.write_csv(tmp_path / "series.csv", values)
    table = np.loadtxt(tmp_path / "series.csv", delimiter=",", skiprows=1)
    assert (table[:, 2:5] == values.center).all() and (table[:, 8] == values.total).all()
