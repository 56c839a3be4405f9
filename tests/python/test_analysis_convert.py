"""Converted trajectories, read back: times, positions and velocities for each of LAMMPS' unit styles."""

from support import dumps
import MDAnalysis
import numpy as np
import pytest

from gearquat_analysis import DumpError, Poses, open_dump
from gearquat_analysis.convert import convert
from gearquat_analysis.units import UNITS
from support.running import make_lmp_wheel

pytestmark = pytest.mark.filterwarnings("ignore:::MDAnalysis")

#: length in m and time in s of a unit of LAMMPS (its manual, command units); of lj as they are written
SI = {
    "lj": (1e-10, 1e-12),
    "real": (1e-10, 1e-15),
    "metal": (1e-10, 1e-12),
    "si": (1.0, 1.0),
    "cgs": (1e-2, 1.0),
    "electron": (5.29177e-11, 1e-15),
    "micro": (1e-6, 1e-6),
    "nano": (1e-9, 1e-9),
}
#: step of the dumps, ps, in steps; speeds in Å/ps; edge of the box, Å
STEP, EVERY, FIRST, SPEED, EDGE = 1e-3, 20, 100, 3.0, 100.0
TIMED = ("dcd", "xtc", "trr", "nc", "trz")

#: two molecules that fly apart, in a box and at a speed that are the same in all units
SCENE = """
clear
units {units}
atom_style molecular
boundary p p f
region box block 0 {edge} 0 {edge} 0 {edge}
create_box 1 box
create_atoms 1 single {a} {a} {a}
create_atoms 1 single {b} {a} {a}
create_atoms 1 single {a} {b} {b}
create_atoms 1 single {b} {b} {b}
set atom 1*2 mol 1
set atom 3*4 mol 2
mass 1 1.0
neighbor {skin} bin
pair_style zero {cut}
pair_coeff * *
velocity all set {v} 0 0
fix move all gear/quat molecule
timestep {dt}
dump plain all custom {every} {units}.plain id mol type mass xu yu zu vx vy vz
dump timed all custom {every} {units}.timed id mol type mass xu yu zu vx vy vz
dump_modify plain format float %.17g
dump_modify timed units yes time yes format float %.17g
reset_timestep {first}
run 80
"""


@pytest.fixture(scope="module")
def flights(tmp_path_factory):
    """Folder with STYLE.plain and .timed of each style, written by LAMMPS."""
    folder = tmp_path_factory.mktemp("flights")
    script = "echo none\n"
    for units, (meter, second) in SI.items():
        angstrom, ps = 1e-10 / meter, 1e-12 / second
        named = {"edge": EDGE, "a": 40.0, "b": 42.0, "cut": 12.0, "skin": 2.0}
        named = {name: value * angstrom for name, value in named.items()}
        named |= {"v": SPEED * angstrom / ps, "dt": STEP * ps, "every": EVERY, "first": FIRST}
        script += SCENE.format(units=units, **named)
    result = make_lmp_wheel(folder).run(script)
    assert result.returncode == 0, result.output
    return folder


def written(atoms, path, units, **options):
    """The universe of the written trajectory."""
    files = convert(atoms, path, units, **options)
    return MDAnalysis.Universe(str(files[-1]), str(path))


@pytest.mark.parametrize("units", SI)
@pytest.mark.parametrize("suffix", [*TIMED, "xyz", "pdb"])
def test_every_format_is_right_in_every_unit_style(flights, tmp_path, suffix, units):
    atoms = open_dump(flights / f"{units}.timed").atoms
    found = written(atoms, tmp_path / f"x.{suffix}", units)
    if suffix == "pdb":  # MDAnalysis does not find the box before a MODEL
        assert "CRYST1  100.000  100.000  100.000" in (tmp_path / "x.pdb").read_text()
    elif suffix == "xyz":  # of no element, as their masses say
        assert found.atoms.names.tolist() == ["T1"] * 4 or units != "lj"
    else:
        assert found.dimensions[:3] == pytest.approx([EDGE] * 3, rel=1e-6)
    x = np.array([ts.positions.copy() for ts in found.trajectory])
    moving = [ts.has_velocities for ts in found.trajectory]
    assert set(moving) == {suffix in ("trr", "nc", "trz")}
    digits = {"xtc": 6e-3, "pdb": 1e-3}.get(suffix, 1e-4)
    start = np.array([[40.0, 40, 40], [42, 40, 40], [40, 42, 42], [42, 42, 42]])
    assert x[0] == pytest.approx(start, abs=digits)
    moved = SPEED * STEP * EVERY * np.arange(5)
    assert x[:, :, 0] - x[0, :, 0] == pytest.approx(np.tile(moved, (4, 1)).T, abs=2 * digits)
    if suffix in TIMED:
        times = [ts.time for ts in found.trajectory]
        expected = STEP * (FIRST + EVERY * np.arange(5))
        assert times == pytest.approx(expected, rel=1e-6)
    if moving[0]:
        v = np.array([ts.velocities.copy() for ts in found.trajectory])
        assert v[..., 0] == pytest.approx(SPEED, rel=1e-6)
        # motion and speed agree, for any factors
        rate = (x[-1] - x[0])[:, 0] / (times[-1] - times[0])
        assert v[-1, :, 0] == pytest.approx(rate, rel=1e-3)


def test_factors_are_those_of_lammps():
    assert set(UNITS) == set(SI)
    for units, (meter, second) in SI.items():
        assert UNITS[units].angstrom == pytest.approx(meter * 1e10, rel=1e-5)
        assert UNITS[units].ps == pytest.approx(second * 1e12)


LABEL = "LAMMPS units lj: 1 sigma is 1 Angstrom here, 1 tau is 1 ps"


@pytest.mark.parametrize("suffix", ["dcd", "xyz", "pdb", "trr"])
def test_lj_is_labeled(flights, tmp_path, suffix):
    """The file says so if it has room for text, and so do the file beside it and the command."""
    path = tmp_path / f"x.{suffix}"
    for units in ("real", "lj"):
        files = convert(open_dump(flights / f"{units}.timed").atoms, path, units)
        for name in files if suffix != "trr" else files[1:]:
            assert (LABEL.encode() in name.read_bytes()) == (units == "lj")
            assert f"LAMMPS units {units}: ".encode() in name.read_bytes()
    said = dumps.analyze(flights / "lj.timed", tmp_path, "--convert", tmp_path / f"other.{suffix}")
    assert said.exit_code == 0 and LABEL in said.output


# --- where units and times come from ---------------------------------------------------------------
@pytest.fixture(autouse=True)
def without_pictures(monkeypatch):
    for name in ("draw_totals", "draw_correlations", "draw_averages"):
        monkeypatch.setattr(f"gearquat_analysis.pictures.{name}", lambda *_: None)


@pytest.mark.parametrize("kind", ["plain", "timed"])
def test_options_or_the_dump_itself(flights, tmp_path, kind):
    path = tmp_path / "x.trr"
    stated = ["--units", "real", "--timestep", "1.0"] if kind == "plain" else []
    said = dumps.analyze(flights / f"real.{kind}", tmp_path, "--convert", path, *stated)
    assert said.exit_code == 0, said.output
    found = MDAnalysis.Universe(str(path.with_suffix(".pdb")), str(path))
    assert [ts.time for ts in found.trajectory][:2] == pytest.approx([0.1, 0.12])
    assert found.trajectory[0].velocities[:, 0] == pytest.approx(SPEED, rel=1e-6)
    assert np.diff(dumps.columns(tmp_path / "totals.csv")["time"]) == pytest.approx(20.0)


@pytest.mark.parametrize(
    ("kind", "arguments", "text"),
    [
        ("plain", ["--timestep", "1"], "--convert needs the units of the dump: give --units, or"),
        ("plain", ["--units", "real"], "needs the times of the frames: give --timestep, or write"),
        ("timed", ["--units", "lj"], "units lj: the dump says units real"),
    ],
)
def test_what_is_missing_is_named(flights, tmp_path, kind, arguments, text):
    said = dumps.analyze(
        flights / f"real.{kind}", tmp_path, "--convert", tmp_path / "x.dcd", *arguments
    )
    assert said.exit_code == 1 and text in said.output, said.output
    assert not (tmp_path / "x.dcd").exists()


def test_formats_without_times_need_none(flights, tmp_path):
    path = tmp_path / "x.xyz"
    said = dumps.analyze(flights / "real.plain", tmp_path, "--units", "real", "--convert", path)
    assert said.exit_code == 0 and path.exists(), said.output
    assert "numbers of steps are used instead" in said.output


def test_times_of_the_dump_are_the_ones_that_count(flights, tmp_path):
    said = dumps.analyze(flights / "real.timed", tmp_path, "--timestep", "7")
    assert "--timestep is not used" in said.output and "time 100 to 180" in said.output
    assert open_dump(flights / "real.plain", timestep=7.0).trajectory[1].time == 7.0 * 120


# --- what formats cannot hold ----------------------------------------------------------------------
def made(path, times, scale=1.0):
    """A dump that contains its times, of 12 sites within 100 times ``scale``."""
    rows = dumps.Motion([6, 6]).rows(0.0) * np.repeat([1.0, scale, 1.0], [4, 3, 3])
    frames = [f"ITEM: TIME\n{time!r}\n" + dumps.frame(k, rows) for k, time in enumerate(times)]
    path.write_text("".join(frames))
    return open_dump(path).atoms


@pytest.mark.parametrize("start", [0.0, 0.3, 1e6, -2.0])
def test_dcd_keeps_any_first_time(tmp_path, start):
    times = start + 0.7 * np.arange(4)
    found = written(made(tmp_path / "x.dump", times.tolist()), tmp_path / "x.dcd", "metal")
    assert [ts.time for ts in found.trajectory] == pytest.approx(times, rel=1e-6, abs=1e-6)


def test_uneven_times(tmp_path):
    """Uneven times of a run with a changing step: xtc and trr store them, dcd is refused."""
    atoms = made(tmp_path / "x.dump", [0.0, 1.0, 2.5])
    assert [ts.time for ts in written(atoms, tmp_path / "x.trr", "metal").trajectory] == [0, 1, 2.5]
    with pytest.raises(ValueError, match="needs frames that are evenly spaced in time.*xtc and trr store"):
        convert(atoms, tmp_path / "x.dcd", "metal")
    assert len(written(atoms, tmp_path / "one.dcd", "metal", frames=slice(1)).trajectory) == 1


def test_sizes_that_xtc_and_pdb_do_not_hold(tmp_path):
    atoms = made(tmp_path / "x.dump", [0.0, 1.0])
    with pytest.raises(ValueError, match="xtc stores positions up to 2e\\+07 Å"):
        convert(atoms, tmp_path / "x.xtc", "si")
    large = written(atoms, tmp_path / "x.trr", "si")
    assert (tmp_path / "x.xyz").exists() and not (tmp_path / "x.pdb").exists()
    own = atoms.universe.trajectory[0].data
    found = large.trajectory[0].positions
    assert found == pytest.approx((own["x"] - own["origin"]) * 1e10, rel=1e-6)
    with pytest.raises(ValueError, match="PDB files must have coordinate values between"):
        convert(atoms, tmp_path / "large.pdb", "si")


def test_steps_beyond_32_bits(tmp_path):
    path = tmp_path / "x.dump"
    path.write_text(
        "".join(dumps.frame(3 * 10**9 + k, dumps.Motion([3]).rows(0.0)) for k in range(2))
    )
    found = written(open_dump(path, timestep=2.0).atoms, tmp_path / "x.trr", "metal")
    assert found.trajectory[0].time == pytest.approx(6e9)


@pytest.mark.parametrize("suffix", ["nonsense", "mol2", "gro"])
def test_formats_that_are_not_written(tmp_path, suffix):
    with pytest.raises(ValueError, match="MDAnalysis (writes no trajectories in this format|cannot write it)"):
        convert(made(tmp_path / "x.dump", [0.0, 1.0]), tmp_path / f"x.{suffix}", "lj")


# --- dumps with units and times ----------------------------------------------------------------------
def test_the_header_may_say_units_once_or_more(tmp_path):
    """A second run that appends to the dump repeats units and times."""
    motion = dumps.Motion([3])
    one = "ITEM: UNITS\nmetal\nITEM: TIME\n0.5\n" + dumps.frame(1, motion.rows(0.5))
    two = "ITEM: TIME\n1.5\n" + dumps.frame(2, motion.rows(1.5))
    path = tmp_path / "x.dump"
    path.write_text(one + two + one.replace("0.5", "2.5"))
    poses = Poses(open_dump(path).atoms).run()
    assert poses.results.time.tolist() == [0.5, 1.5, 2.5]
    assert poses.results.center[:2, 0] == pytest.approx(
        motion.center + motion.velocity * [[0.5], [1.5]]
    )
    path.write_text("")
    with pytest.raises(DumpError, match="x.dump: the dump is empty"):
        open_dump(path)
