"""Results as tables of pandas, and their units."""

import sys

from support import dumps
import numpy as np
import pytest

from gearquat_analysis import Poses, averages, correlations, open_dump, pictures
from gearquat_analysis.averages import Average, Averages
from gearquat_analysis.units import OF_RESULTS, UNITS, unit_of

TIMES = np.arange(0.0, 120.0)


@pytest.fixture(scope="module")
def dump(tmp_path_factory):
    return dumps.write(tmp_path_factory.mktemp("dump") / "made.dump", dumps.Motion([3, 4]), TIMES)


@pytest.fixture(scope="module")
def poses(dump):
    return Poses(open_dump(dump, timestep=0.5).atoms, units="metal").run()


def test_units_of_results(poses, dump):
    assert poses.unit("velocity") == "Å/ps" and poses.unit("ke_rotation") == "eV"
    assert poses.unit("angular_momentum_space") == "g/mol Å²/ps" and poses.unit("q") == ""
    assert unit_of("diffusion coefficient", "lj") == "σ²/τ" and unit_of("temperature", "lj") == "ε/k"
    # neither units nor times are known
    bare = Poses(open_dump(dump).atoms)
    assert bare.unit("time") == "step" and bare.unit("velocity") == ""


def test_without_times_only_what_is_found_from_frames_is_in_steps(dump):
    """Velocities are from the dump: a step of 5 fs makes the slope of the center per step 5 times the velocity."""
    poses = Poses(open_dump(dump).atoms, units="real").run()
    units = {"velocity": "Å/fs", "omega_space": "rad/fs", "angular_momentum_space": "g/mol Å²/fs", "momentum": "g/mol Å/fs"}
    units |= {"velocity_autocorrelation": "Å²/fs²", "time": "step", "lag": "step", "correlation time": "step"}
    units |= {"diffusion coefficient": "Å²/step", "velocity_residual": "Å/fs", "mean_square_displacement": "Å²"}
    assert {name: poses.unit(name) for name in units} == units
    assert poses.to_dataframe().attrs["units"]["velocity_x"] == "Å/fs"
    found = correlations.all_correlations(poses)
    assert found.units["velocity_autocorrelation_(T1)3"] == "Å²/fs²" and found.units["lag"] == "step"
    timed = Poses(open_dump(dump, timestep=5.0).atoms, units="real").run()
    assert np.array_equal(timed.results.velocity, poses.results.velocity) and timed.unit("velocity") == "Å/fs"
    assert timed.unit("diffusion coefficient") == "Å²/fs"
    _, deviation = pictures.draw_totals(poses, poses.totals()).axes
    labels = [text.get_text() for text in deviation.get_legend().get_texts()]
    assert labels == ["sites (Å)", "velocities (Å/fs)"] and deviation.get_xlabel() == "time (step)"


def test_units_of_the_dump_itself(dump, tmp_path):
    path = tmp_path / "stated.dump"
    path.write_text("ITEM: UNITS\nnano\n" + dump.read_text())
    assert Poses(open_dump(path).atoms).unit("center") == Poses(open_dump(path).atoms, units="nano").unit("center") == "nm"
    with pytest.raises(ValueError, match="units metal: the dump says units nano"):
        Poses(open_dump(path), units="metal")


@pytest.mark.parametrize("style", UNITS)
def test_every_letter_has_a_name(style):
    """No M, L, T, t, E or K for mass, length, time, energy and temperature is left."""
    for result in OF_RESULTS:
        names = {word for word in unit_of(result, style).replace("/", " ").replace("²", "").split()}
        assert not names & {"M", "L", "T", "t", "E"} and ("K" in names) <= (result == "temperature")


def test_tables_of_poses_and_functions(poses):
    frame, found = poses.to_dataframe(), correlations.all_correlations(poses)
    assert len(frame) == 240 and frame["body"][:3].tolist() == [1, 2, 1]
    assert frame.attrs["units"]["velocity_x"] == "Å/ps" and "q_0" not in frame.attrs["units"]
    assert frame["center_y"][7] == poses.results.center[3, 1, 1]
    frame = found.to_dataframe()
    assert frame["lag"][2] == 1.0 and frame.attrs["units"]["mean_square_rotation_(T1)3"] == "rad²"


def test_table_of_averages(poses):
    frame = averages.averages(poses).to_dataframe()
    assert list(frame) == ["name", "value", "error", "unit", "why"]
    row = frame.set_index("name").loc["diffusion coefficient of (T1)3"]
    assert row["unit"] == "Å²/ps" and np.isnan(row["value"]) and "not linear" in row["why"]  # free flight


def test_without_pandas_it_is_named(poses, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match=r"requires pandas, which comes with the extra \[frames\]"):
        poses.to_dataframe()


def test_pictures_show_values_with_errors(poses):
    """And the units of the axes."""
    known = Averages(
        [
            Average("temperature of rotation", 77.5, 0.53, "K"),
            Average("diffusion coefficient of (T1)3", 0.27, 0.02, "Å²/ps"),
            Average("correlation time of axis 1, order 2", np.nan, np.nan, "ps"),
        ]
    )
    temperature, diffusion = pictures.draw_averages(known).axes
    assert temperature.get_xlabel() == "temperature (K)" and temperature.texts[0].get_text() == "77.50 ± 0.53 K"
    (bar,) = diffusion.collections[0].get_segments()
    assert bar[:, 0] == pytest.approx([0.25, 0.29])
    assert pictures.draw_averages(known[2:]) is None
    squares = pictures.draw_correlations(correlations.all_correlations(poses), known).axes[0]
    labels = [text.get_text() for text in squares.get_legend().get_texts()]
    assert labels[0] == "displacement (Å²)\nD = 0.270 ± 0.020 Å²/ps"
    assert squares.get_xlabel() == "lag (ps)"
    energy, deviation = pictures.draw_totals(poses, poses.totals()).axes
    assert energy.get_ylabel() == "energy (eV)" and deviation.get_xlabel() == "time (ps)"
