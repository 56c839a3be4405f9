"""Dumps of the scenes: analysis compared with the numbers of the fix; the command and its output."""

import csv
import re
import shlex

from support import dumps
import numpy as np
import pytest
from click.testing import CliRunner
from support.dumps import analyze, columns
from scipy.spatial.transform import Rotation

from gearquat_analysis import Poses, open_dump
from lammps_gearquat.cli import main
from gearquat_analysis.units import UNITS
from benchmarks.reference import paper_problem, reference_state
from benchmarks.reference import quaternion as qt
from lammps_gearquat.launch import open_library
from support.pages import blocks
from support.running import EXAMPLES, ROOT, make_lmp_wheel

BODIES = paper_problem(1, dtype=np.float64).bodies
SITES = BODIES.sites_body


@pytest.fixture(params=["first", "second", "rigid"])
def dumped(request, run_case, tmp_path):
    """Thermo series and analyzed dump of the same steps of test case 1."""
    found = run_case(1, formulation=request.param, dt=0.01, steps=5000, every=1000, dump=1000)
    return found, open_dump(tmp_path / "poses.dump").atoms


def test_energies_are_those_of_the_fix(dumped):
    values, atoms = dumped
    poses = Poses(atoms).run()
    found = poses.results
    assert found.step.tolist() == values.step.tolist() == [0, 1000, 2000, 3000, 4000, 5000]
    assert found.center[:, 0] == pytest.approx(values.center, abs=1e-12)
    assert found.ke_translation[:, 0] == pytest.approx(values.translation, rel=1e-11)
    assert found.ke_rotation[:, 0] == pytest.approx(values.rotation, rel=1e-11)
    assert found.residual.max() < 1e-12 and found.velocity_residual.max() < 1e-12
    # the paper's shape, for any start
    assert Poses(atoms, reference=SITES).run().results.residual.max() < 1e-12
    assert poses.bodies.moments[0] == pytest.approx(BODIES.moments[0], rel=1e-13)


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_energy_belongs_to_the_dumped_pose(run_case, tmp_path, formulation):
    """The potential energy recomputed from the dumped sites agrees with thermo output."""
    steps = {"dt": 0.05, "steps": 1000, "every": 100, "dump": 100}
    values = run_case(1, formulation=formulation, **steps)
    cage = paper_problem(1, dtype=np.float64).field
    for k, ts in enumerate(open_dump(tmp_path / "poses.dump").trajectory):
        energy, _ = cage.energy_and_forces(ts.data["x"])
        # the remaining difference is of second order in corrected - predicted
        assert values.potential[k] == pytest.approx(energy, abs=1e-8)
        moved = cage.energy_and_forces(ts.data["x"] + [1e-4, 0, 0])[0]
        assert values.potential[k] != pytest.approx(moved, abs=1e-8)


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_pose_is_that_of_the_reference(run_case, tmp_path, formulation):
    """Recovered center and rotation compared with the independent integrator."""
    run_case(1, formulation=formulation, dt=0.02, steps=5000, every=5000, dump=5000)
    found = Poses(open_dump(tmp_path / "poses.dump").atoms, reference=SITES).run().results
    end = reference_state(paper_problem(1), 100.0).double
    assert found.center[-1, 0] == pytest.approx(end.center[0], abs=1e-7)
    turn = Rotation.from_quat(found.q[-1, 0], scalar_first=True).as_matrix()
    assert turn == pytest.approx(qt.rotation_space_body(end.q)[0], abs=1e-7)


TABLE = """
dump table all local ${dump} ${out}.table index f_move[*]
dump_modify table format float %.17g
"""


@pytest.fixture(scope="module")
def water(tmp_path_factory):
    """Folder with water.dump and water.table: 216 molecules, 5 frames of 20 fs."""
    folder = tmp_path_factory.mktemp("water")
    deck = (EXAMPLES / "water" / "in.water").read_text()
    # the run comes after the second dump
    deck = deck.replace("timestep ", TABLE + "timestep ").replace("forces.", str(EXAMPLES / "water" / "forces."))
    (folder / "in.water").write_text(deck)
    named = {"steps": 80, "every": 20, "dump": 20, "out": folder / "water"}
    data = (EXAMPLES / "water" / "data.water").read_text()
    (folder / "data.water").write_text(data)
    result = make_lmp_wheel(folder).run(folder / "in.water", named)
    assert result.returncode == 0, result.output
    return folder


def test_poses_are_those_of_the_fixs_own_array(water):
    """Quaternion, angular velocity and momentum, center and velocity, for 216 molecules."""
    sites = Poses(open_dump(water / "water.dump").atoms, reference="principal", units="real").run()
    last = (water / "water.table").read_text().rpartition("ITEM: ENTRIES")[2].splitlines()[1:]
    table = np.loadtxt(last)[:, 1:]
    table = table[table[:, 27].argsort()]  # column N of the fix is table[:, N - 1]
    table[:, :3] += table[:, 12:15] @ sites.results.cell[-1, 1:]  # images
    assert np.array_equal(sites.results.ids, table[:, 27])
    both = (Rotation.from_quat(q, scalar_first=True) for q in (sites.results.q[-1], table[:, 15:19]))
    assert (next(both) * next(both).inv()).magnitude().max() < 1e-12
    for name, own in (("center", slice(0, 3)), ("velocity", slice(3, 6)), ("angular_momentum_space", slice(22, 25))):
        found, expected = sites.results[name][-1], table[:, own]
        assert found == pytest.approx(expected, abs=1e-12 * np.abs(expected).max()), name


#: units of length and time in Å and ps (manual of LAMMPS, command units)
SIZES = {"lj": (1.0, 1.0), "real": (1.0, 1e-3), "metal": (1.0, 1.0), "si": (1e10, 1e12), "cgs": (1e8, 1e12)}
SIZES |= {"electron": (0.529177, 1e-3), "micro": (1e4, 1e6), "nano": (10.0, 1e3)}


def test_units_are_those_of_lammps():
    """The factors agree with LAMMPS."""
    lmp = open_library()
    try:
        for style, units in UNITS.items():
            lmp.commands_list(["clear", f"units {style}"])
            assert lmp.extract_global("mvv2e") == units.energy, style
            assert (units.angstrom, units.ps) == pytest.approx(SIZES[style], rel=1e-5), style
    finally:
        lmp.close()


# --- the command ---------------------------------------------------------------------------------
@pytest.mark.parametrize("jobs", [1, 2])
def test_command_leaves_tables_and_pictures(water, tmp_path, jobs):
    arguments = ["--units", "real", "--csv", "--jobs", jobs]
    result = analyze(water / "water.dump", tmp_path, *arguments)
    assert result.exit_code == 0, result.output
    assert "5 frames of 216 bodies were read, from time 0 to 80." in result.output
    exact = Poses(open_dump(water / "water.dump").atoms, "principal", units="real").run()
    assert np.array_equal(np.load(tmp_path / "poses.npy"), exact.results.table)
    assert columns(tmp_path / "poses.csv")["q_0"].tolist() == exact.to_dataframe()["q_0"].tolist()
    totals = columns(tmp_path / "totals.csv")
    assert totals["ke_rotation"] == pytest.approx(exact.totals()["ke_rotation"], rel=1e-15)
    found = columns(tmp_path / "correlations.csv")
    assert found["lag"].tolist() == [0, 20, 40, 60, 80]
    assert found["axis1_order1"][0] == pytest.approx(1.0)
    with open(tmp_path / "bodies.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(tmp_path / "averages.csv", newline="") as file:
        averages = {row["average"]: row["value"] for row in csv.DictReader(file)}
    assert "temperature of rotation about axis 3" in averages
    assert not averages["diffusion coefficient"]  # of five frames
    assert len(rows) == 216 and rows[0]["kind"] == "general" and float(rows[0]["mass"]) > 18.0
    for name in ("totals.png", "correlations.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    # files of the earlier analysis that this analysis does not write were removed
    result = analyze(water / "water.dump", tmp_path, "--units", "real")
    assert result.exit_code == 0 and "replace the earlier ones in" in result.output
    assert not (tmp_path / "poses.csv").exists() and (tmp_path / "averages.csv").exists()
    few = tmp_path / "few"
    result = analyze(water / "water.dump", few, "--units", "real", "--frames", ":2")
    assert result.exit_code == 0, result.output
    left = {"poses.npy", "bodies.csv", "totals.csv", "totals.png", "settings.json"}
    assert {path.name for path in few.iterdir()} == left


def files(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--timestep", "2"], "(--timestep)"),
        (["--select", "resid 1", "--frames", ":5"], "(--select, --frames)"),
        (["--units", "lj"], "(--units)"),
    ],
)
def test_an_analysis_of_other_settings_is_kept(tmp_path, arguments, text):
    """Results of another analysis are not overwritten; the same analysis is repeated, also of a dump that has grown."""
    path, motion = tmp_path / "made.dump", dumps.Motion([3, 3])
    dumps.write(path, motion, np.arange(8.0))
    out = tmp_path / "out"
    assert analyze(path, out).exit_code == 0
    before = files(tmp_path)
    result = analyze(path, out, *arguments)
    assert result.exit_code == 1 and f"out has results of other settings {text}: another --out is" in result.output
    assert files(tmp_path) == before
    assert analyze(path, tmp_path / "other", *arguments).exit_code == 0  # the advice
    path.write_text(path.read_text() + dumps.frame(8, motion.rows(8.0)))
    result = analyze(path, out, "--csv")
    assert result.exit_code == 0 and "replace the earlier ones in" in result.output
    assert len(columns(out / "totals.csv")) == 9


def test_an_analysis_of_another_dump_is_kept(tmp_path):
    """Results of another file, of the same file with another run, and of a release without settings.json are
    refused."""
    path, other, out = tmp_path / "made.dump", tmp_path / "other.dump", tmp_path / "out"
    dumps.write(path, dumps.Motion([3]), np.arange(8.0))
    dumps.write(other, dumps.Motion([3], seed=2), np.arange(8.0))
    assert analyze(path, out).exit_code == 0
    before = files(out)
    assert "other settings (the dump): another --out is required" in analyze(other, out).output
    path.write_text(other.read_text())
    assert "(the dump was rewritten): another --out is required" in analyze(path, out).output
    assert files(out) == before
    (out / "settings.json").unlink()
    assert "out has bodies.csv of unknown settings: another --out" in analyze(path, out).output


def test_command_tells_of_uneven_times_and_of_bodies_that_are_not_rigid(tmp_path):
    rows = dumps.Motion([3]).rows(0.0)
    frames = [f"ITEM: TIME\n{time}\n" + dumps.frame(k, rows) for k, time in enumerate((0.0, 1.0, 2.5))]
    rows[0, 4] += 1.0
    path = tmp_path / "made.dump"
    path.write_text("".join(frames) + "ITEM: TIME\n3.0\n" + dumps.frame(3, rows))
    result = analyze(path, tmp_path)
    assert result.exit_code == 0, result.output
    assert "Warning: there are no diffusion coefficients and correlation times" in result.output
    assert "made.dump: body 1 is not rigid: at step 3" in result.output
    assert (tmp_path / "averages.csv").exists() and not (tmp_path / "correlations.csv").exists()
    result = analyze(path, tmp_path / "one", "--frames", ":1", "--timestep", "7")
    assert "1 frame of 1 body was read" in result.output and "--timestep is not used" in result.output


def test_command_says_when_frames_are_too_far_apart(tmp_path):
    for omega, said in ((2.0, True), (0.02, False)):
        path = dumps.write(tmp_path / "far.dump", dumps.Motion([4], omega=omega), np.arange(8.0))
        result = analyze(path, tmp_path / str(omega))
        assert result.exit_code == 0, result.output
        assert ("the mean-square rotation is not" in result.output) == said


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--select", "resid 99"], "--select 'resid 99' selects no atom"),
        (["--select", "foo 99"], "--select 'foo 99': Unknown selection token: 'foo'"),
        (["--reference", "nofile"], "--reference nofile: 'principal', 'first' or a file with x"),
        (["--timestep", "0"], "'--timestep': 0.0 is not in the range x>0"),
        (["--frames", "99:"], "no frame is selected"),
        (["--frames", "a:b"], "START:STOP:STEP is required"),
        (["--body", "i_body"], "(--body), or give a data file with molecules (--data)"),
        (["--potential", "c_pe"], "no column c_pe"),
    ],
)
def test_command_refuses_clearly(tmp_path, arguments, text):
    path = dumps.write(tmp_path / "made.dump", dumps.Motion([3]), [0.0, 1.0])
    result = analyze(path, tmp_path, *arguments)
    assert result.exit_code != 0 and text in result.output
    assert "Traceback" not in result.output


def test_the_page_runs_as_it_stands(water, tmp_path, monkeypatch):
    """The commands and the Python of doc/analysis.md."""
    page = (ROOT / "doc" / "analysis.md").read_text()
    lines = re.findall("^    (gearquat analyze .*)$", page, re.M)
    assert len(lines) == 1
    monkeypatch.chdir(tmp_path)
    (tmp_path / "water.dump").symlink_to(water / "water.dump")
    for line in lines:
        result = CliRunner().invoke(main, shlex.split(line)[1:])
        assert result.exit_code == 0, result.output
    exec(compile(*blocks("../analysis", "python"), "doc/analysis.md", "exec"), {})
    assert len(columns(tmp_path / "poses.csv")) == 50
