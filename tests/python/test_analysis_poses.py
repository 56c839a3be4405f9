"""Poses, velocities, energies and momenta of known motions; the same by every backend."""

import warnings

from support import dumps
import MDAnalysis
import numpy as np
import pytest
from MDAnalysis.exceptions import NoDataError
from scipy.spatial.transform import Rotation

from gearquat_analysis import Poses, averages, open_dump

COUNTS = [4, 3, 6, 2, 1]
MOTION = dumps.Motion(COUNTS, linear=[3])
TIMES = np.linspace(0.0, 30.0, 7)


@pytest.fixture(scope="module")
def dump(tmp_path_factory):
    return dumps.write(tmp_path_factory.mktemp("made") / "made.dump", MOTION, TIMES)


@pytest.fixture(scope="module")
def poses(dump):
    return Poses(open_dump(dump).atoms).run()


def test_poses_are_those_of_the_motion(poses):
    found = poses.results
    for k, time in enumerate(TIMES):
        assert found.center[k] == pytest.approx(MOTION.centers(time), abs=1e-12)
        turn = MOTION.turns(time) * MOTION.turns(0.0).inv()
        error = Rotation.from_quat(found.q[k], scalar_first=True) * turn.inv()
        assert error.magnitude()[:3].max() < 1e-12
    assert found.residual.max() < 1e-13


def test_signs_of_quaternions_do_not_jump(tmp_path):
    fast = dumps.Motion([4] * 20, omega=0.3)
    path = dumps.write(tmp_path / "fast.dump", fast, np.arange(60.0))
    q = Poses(open_dump(path).atoms).run().results.q
    assert (np.einsum("fbi,fbi->fb", q[1:], q[:-1]) > 0.0).all()
    assert (q[..., 0] < -0.1).any()  # so some had to be turned


def test_velocities_are_those_of_the_motion(poses):
    """For the linear body only rotation perpendicular to its axis moves its sites; a point does not turn."""
    found, omega = poses.results, np.tile(MOTION.omega, (7, 1, 1))
    axis = MOTION.shape[MOTION.of == 3][0]
    along = np.array([MOTION.turns(time)[3].apply(axis / np.linalg.norm(axis)) for time in TIMES])
    omega[:, 3] -= along * (along * omega[:, 3]).sum(axis=1, keepdims=True)
    omega[:, 4] = 0.0
    assert found.velocity == pytest.approx(np.array([MOTION.velocity] * 7), abs=1e-15)
    assert found.omega_space == pytest.approx(omega, abs=1e-15)
    assert found.velocity_residual.max() < 1e-15


def test_energies_and_momenta_are_those_of_the_sites(poses):
    """For rigid sites, direct sums over the sites give the same numbers."""
    found, totals = poses.results, poses.totals()
    for k, time in enumerate(TIMES):
        x, v = MOTION.sites(time)
        squares = 0.5 * np.bincount(MOTION.of, MOTION.masses * (v**2).sum(axis=1))
        kinetic = found.ke_translation[k] + found.ke_rotation[k]
        assert kinetic == pytest.approx(squares, rel=1e-12)
        momentum = MOTION.masses[:, None] * v
        assert totals["momentum"][k] == pytest.approx(momentum.sum(axis=0), abs=1e-12)
        about = np.cross(x, momentum).sum(axis=0)
        assert totals["angular_momentum_space"][k] == pytest.approx(about, abs=1e-11)
    assert totals["ke_rotation"] == pytest.approx(found.ke_rotation.sum(axis=1))
    assert (totals["residual"] == found.residual.max(axis=1)).all()


def test_residuals_see_what_is_not_rigid(tmp_path):
    def bent(time, rows):
        rows = rows.copy()
        rows[0, 4] += 1e-4 * time
        rows[5, 8] *= 1.01
        return rows

    path = dumps.write(tmp_path / "bent.dump", MOTION, TIMES, bent)
    found = Poses(open_dump(path).atoms).run().results
    assert (found.residual[1:, 0] > 1e-5).all() and found.residual[:, 1:].max() < 1e-13
    assert (found.velocity_residual[:, 1] > 1e-6).all()
    assert found.velocity_residual[:, 2:].max() < 1e-15


def test_reference_that_is_given(dump):
    """The quaternion is relative to the given coordinates."""
    universe = open_dump(dump)
    found = Poses(universe.atoms, reference=MOTION.shape + 5.0).run().results
    for k, time in enumerate(TIMES):
        turn = Rotation.from_quat(found.q[k], scalar_first=True) * MOTION.turns(time).inv()
        assert turn.magnitude()[:3].max() < 1e-12


def test_principal_reference_has_diagonal_inertia(dump):
    poses = Poses(open_dump(dump).atoms, reference="principal").run(stop=2)
    turn = Rotation.from_quat(poses.results.q[1, :3], scalar_first=True)
    omega_body = turn.inv().apply(poses.results.omega_space[1, :3])
    momentum_body = turn.inv().apply(poses.results.angular_momentum_space[1, :3])
    assert momentum_body == pytest.approx(poses.bodies.moments[:3] * omega_body, abs=1e-13)


def test_energies_have_the_units_of_lammps(dump):
    plain = Poses(open_dump(dump).atoms).run(stop=1).results
    real = Poses(open_dump(dump).atoms, units="real").run(stop=1).results
    assert real.ke_rotation == pytest.approx(48.88821291**2 * plain.ke_rotation, rel=1e-14)


def test_potential_energies_of_atoms(tmp_path):
    def add(time, rows):
        return np.column_stack([rows, np.arange(16) + time])

    path = dumps.write(tmp_path / "p.dump", MOTION, TIMES, add, columns=dumps.COLUMNS + " c_pe")
    poses = Poses(open_dump(path, potential="c_pe").atoms, potential="c_pe").run()
    assert poses.results.potential[0].tolist() == [6, 15, 57, 27, 15]


# --- how it is run -------------------------------------------------------------------------------
@pytest.mark.parametrize("file", [False, True])
@pytest.mark.parametrize("run", [{}, {"backend": "multiprocessing", "n_workers": 2}])
def test_every_backend_gives_the_same(dump, poses, tmp_path, file, run):
    other = Poses(open_dump(dump).atoms, out=tmp_path / "poses.npy" if file else None).run(**run)
    assert np.array_equal(other.results.table, poses.results.table)
    assert np.array_equal(other.results.step, poses.results.step)
    assert np.array_equal(other.times, poses.times)


@pytest.mark.parametrize("file", [False, True])
@pytest.mark.parametrize("span", [{"start": 1, "step": 2}, {"frames": [0, 3, 6]}])
def test_some_of_the_frames(dump, poses, tmp_path, file, span):
    out = tmp_path / "some.npy" if file else None
    found = Poses(open_dump(dump).atoms, out=out).run(**span).results
    chosen = span.get("frames", [1, 3, 5])
    assert found.step.tolist() == chosen
    # signs follow the frame before, so they may differ
    assert np.array_equal(found.center, poses.results.center[chosen])
    assert np.abs(found.q) == pytest.approx(np.abs(poses.results.q[chosen]), abs=1e-15)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"reference": np.eye(3)}, r"positions of shape \(16, 3\) are required, not \(3, 3\)"),
        ({"reference": "last"}, "first, principal or positions are required"),
        ({"units": "imperial"}, "units imperial: one of lj, real"),
        ({"potential": "c_pe"}, "no column c_pe was read with the dump"),
        ({}, "no frame is selected"),
    ],
)
def test_impossible_arguments(dump, arguments, text):
    with pytest.raises(ValueError, match=text):
        Poses(open_dump(dump).atoms, **arguments).run(start=7)


def test_csv_has_every_digit(poses, tmp_path):
    poses.to_csv(tmp_path / "poses.csv")
    found = dumps.columns(tmp_path / "poses.csv")
    columns = poses.to_dataframe()
    assert list(columns) == list(found.dtype.names) and len(found) == 35
    for name, values in columns.items():
        assert np.array_equal(values, found[name]), name
    assert found["body"][:6].tolist() == [1, 2, 3, 4, 5, 1]
    assert found["center_y"][7] == poses.results.center[1, 2, 1]
    assert found["q_3"][7] == poses.results.q[1, 2, 3]


@pytest.mark.filterwarnings("ignore")
def test_other_trajectories(dump, tmp_path):
    """Any universe of MDAnalysis can be used, in single precision."""
    import MDAnalysis

    universe = open_dump(dump)
    universe.atoms.write(str(tmp_path / "made.pdb"))
    universe.atoms.write(str(tmp_path / "made.trr"), frames="all")
    other = MDAnalysis.Universe(str(tmp_path / "made.pdb"), str(tmp_path / "made.trr"))
    other.atoms.masses = universe.atoms.masses
    found, exact = Poses(other.atoms).run().results, Poses(universe.atoms).run().results
    assert found.q[:, :3] == pytest.approx(exact.q[:, :3], abs=1e-4)
    assert found.center - found.center[0] == pytest.approx(exact.center - exact.center[0], abs=1e-4)
    assert found.omega_space == pytest.approx(exact.omega_space, abs=1e-5)


def test_a_universe_will_do(dump, poses):
    assert np.array_equal(Poses(open_dump(dump)).run().results.table, poses.results.table)


def test_atoms_that_are_there_twice(dump, poses):
    atoms = open_dump(dump).atoms
    with pytest.raises(ValueError, match="an atom is in the group twice; .*atoms.unique"):
        Poses(atoms + atoms[3:4])
    assert np.array_equal(Poses((atoms + atoms[3:4]).unique).bodies.mass, poses.bodies.mass)


@pytest.mark.parametrize("use", [averages.averages, Poses.totals, Poses.to_dataframe, lambda poses: poses.results.q])
def test_results_need_a_run(dump, use):
    with pytest.raises(NoDataError, match="results.* does not exist yet: call run"):
        use(Poses(open_dump(dump)))


def test_bodies_that_are_not_rigid(tmp_path):
    """Bodies that are not rigid are named; rigid bodies with six digits cause no warning, at any distance from the
    origin."""

    def bent(time, rows):
        rows[0, 4] += 0.02 * time * (time < 21.0)
        return rows

    path = dumps.write(tmp_path / "bent.dump", MOTION, TIMES, bent)
    with pytest.warns(UserWarning, match="bent.dump: body 1 is not rigid: at step 4 a site deviates by 0.* of the body's size"):
        Poses(open_dump(path)).run()
    for spread in (10.0, 1e3, 1e5):
        far = dumps.Motion(COUNTS, linear=[3], spread=spread)
        path = dumps.write(tmp_path / "far.dump", far, TIMES)
        lines = (line.split() for line in path.read_text().splitlines())
        text = [" ".join(f"{float(x):g}" for x in line) if len(line) == 10 else " ".join(line) for line in lines]
        path.write_text("\n".join(text) + "\n")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            Poses(open_dump(path)).run()


def test_other_formats_have_the_units_of_mdanalysis():
    universe = MDAnalysis.Universe.empty(6, n_residues=2, atom_resindex=[0, 0, 0, 1, 1, 1], trajectory=True)
    universe.add_TopologyAttr("masses", np.ones(6))
    universe.add_TopologyAttr("resids", [1, 2])
    with pytest.raises(ValueError, match="units metal are required"):
        Poses(universe.atoms, units="real")
    assert Poses(universe.atoms, units="metal").units == "metal"


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("parts", [1, 2])
def test_the_dump_reader_of_mdanalysis_has_no_units(dump, parts):
    """Velocities stay in LAMMPS' units, and times are in ps."""
    same = MDAnalysis.Universe.empty(16, n_residues=5, atom_resindex=MOTION.of)
    same.add_TopologyAttr("masses", MOTION.masses)
    same.add_TopologyAttr("resids", range(1, 6))
    same.load_new([str(dump)] * parts if parts > 1 else str(dump), format="LAMMPSDUMP")
    for units in ("metal", "real", "lj"):
        with pytest.raises(ValueError, match=f"units {units}: .*(LAMMPSDUMP).*gearquat_analysis.open_dump is required"):
            Poses(same, units=units)
    assert Poses(same).units is None and Poses(open_dump(dump), units="metal").units == "metal"
