"""Dumps as universes: every kind of columns gives the same bodies; unusable dumps are refused with a clear message."""

import re

from support import dumps
import numpy as np
import pytest

from gearquat_analysis import DumpError, Poses, open_dump

MOTION = dumps.Motion([3, 4, 5])
TIMES = [0.0, 1.0, 2.0]


@pytest.fixture
def write(tmp_path):
    def write(*args, **kwargs):
        return dumps.write(tmp_path / "poses.dump", *args, **kwargs)

    return write


def centers(path, **options):
    return Poses(open_dump(path, **options).atoms).run().results.center


def expected():
    return np.array([MOTION.centers(t) for t in TIMES])


def test_columns_are_read_in_double_precision(write):
    universe = open_dump(write(MOTION, TIMES), timestep=0.5)
    assert len(universe.residues) == 3 and universe.atoms.ids.tolist() == list(range(1, 13))
    assert universe.atoms.masses.tolist() == MOTION.masses.tolist()
    for time, ts in zip(TIMES, universe.trajectory):
        x, v = MOTION.sites(time)
        assert np.array_equal(ts.data["x"], x) and np.array_equal(ts.data["v"], v)
        assert ts.positions == pytest.approx(x + 50.0, abs=1e-5)  # MDAnalysis' own: from the corner
    assert universe.trajectory.time == 1.0 and universe.trajectory[1].data["step"] == 1


def test_atoms_may_be_in_any_order(write):
    rng = np.random.default_rng(0)
    path = write(MOTION, TIMES, lambda t, rows: rng.permutation(rows))
    assert centers(path) == pytest.approx(expected(), abs=1e-13)


BOX, EDGE = "-10 10", 20.0


def wrapped(time, rows, flags=False):
    """Positions in the box of EDGE; with image flags if requested."""
    images = np.floor((rows[:, 4:7] + EDGE / 2) / EDGE)
    rows = rows.copy()
    rows[:, 4:7] -= EDGE * images
    return np.hstack([rows, images]) if flags else rows


@pytest.mark.parametrize("bounds", ["pp pp pp", "pp pp ff"])
def test_image_flags(write, bounds):
    columns = "id mol type mass x y z vx vy vz ix iy iz"
    change = lambda t, rows: wrapped(t, rows, True)  # noqa: E731
    path = write(MOTION, TIMES, change, box=BOX, columns=columns, bounds=bounds)
    assert centers(path) == pytest.approx(expected(), abs=1e-13)


def test_without_image_flags_bodies_are_made_whole_and_followed(write):
    times = np.linspace(0.0, 400.0, 41)  # some bodies cross the box and move on
    fast = dumps.Motion([3, 4, 5], seed=3)
    assert (np.abs(fast.velocity) * 400 > EDGE).any()
    columns = "id mol type mass x y z vx vy vz"
    path = write(fast, times, wrapped, box=BOX, columns=columns)
    poses = Poses(open_dump(path).atoms).run()
    moved = poses.results.center - poses.results.center[0]
    assert moved == pytest.approx(
        np.array([fast.centers(t) for t in times]) - fast.center, abs=1e-11
    )
    assert poses.results.residual.max() < 1e-12


@pytest.mark.parametrize("unwrapped", [True, False])
def test_scaled_positions_in_a_triclinic_box(tmp_path, unwrapped):
    """Edges (20, 0, 0), (4, 20, 0), (-6, 3, 20); LAMMPS writes the bounds of the box around it."""
    edges = np.array([[20.0, 0, 0], [4, 20, 0], [-6, 3, 20]])
    origin = np.array([-10.0, -9, -8])
    small = dumps.Motion([3, 4, 5], spread=3.0)

    def change(time, rows):
        rows = rows.copy()
        rows[:, 4:7] = (rows[:, 4:7] - origin) @ np.linalg.inv(edges)
        return rows

    names = "xsu ysu zsu" if unwrapped else "xs ys zs"
    path = dumps.write(
        tmp_path / "t.dump", small, TIMES, change, columns=f"id mol type mass {names} vx vy vz"
    )
    bounds = "xy xz yz pp pp pp\n-16 14 4\n-9 14 -6\n-8 12 3"
    text = path.read_text().replace("pp pp pp\n-50 50\n-50 50\n-50 50", bounds)
    path.write_text(text)
    expected = np.array([small.centers(t) for t in TIMES])
    assert centers(path) == pytest.approx(expected, abs=1e-12)
    path.write_text(text.replace("-9 14 -6", "-9 14 -6.06"))
    assert np.abs(centers(path) - expected).max() > 1e-3


DATA = """made up

12 atoms
1 atom types

-50 50 xlo xhi
-50 50 ylo yhi
-50 50 zlo zhi

Masses

1 2.5

Atoms # molecular

"""


def test_masses_and_molecules_of_a_data_file(write, tmp_path):
    data = tmp_path / "data.made"
    rows = "\n".join(f"{k + 1} {MOTION.of[k] + 1} 1 0 0 0" for k in reversed(range(12)))
    data.write_text(DATA + rows + "\n")
    path = write(MOTION, TIMES, lambda t, r: r[:, [0, 4, 5, 6]], columns="id xu yu zu")
    universe = open_dump(path, data=data)
    assert universe.atoms.masses.tolist() == [2.5] * 12
    assert universe.atoms.resids.tolist() == (MOTION.of + 1).tolist()
    poses = Poses(universe.atoms).run()
    assert "velocity" not in poses.results and poses.results.residual.max() < 1e-13
    data.write_text(DATA + "\n".join(rows.splitlines()[1:]) + "\n")
    with pytest.raises(DumpError, match="atom 12 of the dump is missing"):
        open_dump(path, data=data)


def data_of(tmp_path, atoms="", masses="1 2.5"):
    """A data file of all atoms of MOTION, type 1, with more text behind them."""
    rows = "\n".join(f"{k + 1} {MOTION.of[k] + 1} 1 0 0 0" for k in range(12))
    path = tmp_path / "data.made"
    path.write_text(DATA.replace("1 2.5", masses) + rows + "\n" + atoms)
    return path


VELOCITIES = "\nVelocities\n\n" + "".join(f"{k + 1} 0 0 0\n" for k in range(12))
PROPERTY = "\ni_body\n\n" + "".join(f"{k + 1} 7\n" for k in range(12))


def test_a_data_file_with_sections_of_fixes(write, tmp_path):
    """Unknown sections after the velocities do no harm; elsewhere the message names the file and the forbidden
    sections."""
    path = write(MOTION, TIMES, lambda t, r: r[:, [0, 4, 5, 6]], columns="id xu yu zu")
    atoms = open_dump(path, data=data_of(tmp_path, VELOCITIES + PROPERTY)).atoms
    assert atoms.masses.tolist() == [2.5] * 12 and atoms.resids.tolist() == (MOTION.of + 1).tolist()
    required = "data.made: MDAnalysis cannot read this data file .*; sections Masses and Atoms .*write_data ... nofix"
    with pytest.raises(DumpError, match=required):
        open_dump(path, data=data_of(tmp_path, PROPERTY))
    style = "id type x y z"  # all atoms are one residue to MDAnalysis, which is no body
    atomic = data_of(tmp_path)
    atomic.write_text(re.sub(r"(?m)^(\d+) \d+ 1 0 0 0$", r"\1 1 0 0 0", atomic.read_text()))
    with pytest.raises(DumpError, match="no column mol, .*a data file with molecules"):
        open_dump(path, data=atomic, atom_style=style)
    bare = data_of(tmp_path)
    bare.write_text(bare.read_text().replace("Masses\n\n1 2.5\n", ""))
    with pytest.raises(DumpError, match=required):
        open_dump(path, data=bare)


@pytest.mark.parametrize(
    ("name", "column", "wrong", "text"),
    [("type", 2, 2, "type 1 of atom 4, but 2 in the dump"), ("mass", 3, 2.525, "mass 2.5 of atom 4, .* 2.525 in the")],
)
def test_a_data_file_of_another_run(write, tmp_path, name, column, wrong, text):
    """Types or masses disagree, here by 1 %; six digits of a mass are enough."""
    data, names = data_of(tmp_path, masses="1 2.50000001"), np.array(dumps.COLUMNS.split())
    for value in (2.5 if name == "mass" else 1, wrong):

        def change(time, rows):
            rows[:, 3] = 2.5
            rows[3, column] = value
            return rows[:, names != "mol"]

        path = write(MOTION, TIMES, change, columns=" ".join(names[names != "mol"]))
        if value != wrong:
            assert open_dump(path, data=data).atoms.resids.tolist() == (MOTION.of + 1).tolist()
    with pytest.raises(DumpError, match=f"data.made: {text}"):
        open_dump(path, data=data)


def test_bodies_of_another_column(write):
    columns = dumps.COLUMNS.replace("mol", "i_body")
    assert centers(write(MOTION, TIMES, columns=columns), body="i_body").shape == (3, 3, 3)
    assert centers(write(MOTION, TIMES), body="type").shape == (3, 1, 3)


def test_atoms_in_no_body_are_left_out(write):
    def change(time, rows):
        rows[:3, 1] = 0
        return rows

    poses = Poses(open_dump(write(MOTION, TIMES, change)).atoms)
    assert poses.ids.tolist() == [2, 3]


@pytest.mark.parametrize("stated", [True, False])
def test_the_distance_of_frames(tmp_path, stated):
    """dt and totaltime follow from the times of frames: 20 steps of 0.5 are 10; dt is the mean if frames are uneven."""
    for steps in ([100, 120, 140, 160], [100, 120, 150, 160]):
        text = [dumps.frame(step, MOTION.rows(step)) for step in steps]
        if stated:
            text = [f"ITEM: TIME\n{0.5 * step}\n{frame}" for step, frame in zip(steps, text)]
        path = tmp_path / "even.dump"
        path.write_text("".join(text))
        trajectory = open_dump(path, timestep=None if stated else 0.5).trajectory
        assert trajectory.totaltime == 30.0 and trajectory.dt == trajectory.ts.dt == 10.0
        assert [ts.time for ts in trajectory] == [0.5 * step for step in steps]
        assert trajectory[2].dt == 10.0 and trajectory.totaltime == 30.0


@pytest.mark.parametrize("suffix", ["", ".gz", ".bz2"])
def test_compressed_dumps_are_read_forward(tmp_path, monkeypatch, suffix):
    """Frames agree with the plain file in any order, and a compressed file is not unpacked again for each frame."""
    import bz2
    import gzip

    times = np.arange(60.0)
    path = dumps.write(tmp_path / "made.dump", MOTION, times)
    packed = tmp_path / f"made.dump{suffix}"
    pack = {".gz": gzip.compress, ".bz2": bz2.compress, "": lambda data: data}[suffix]
    packed.write_bytes(pack(path.read_bytes()))
    backward, rewind = [], gzip._GzipReader._rewind

    def counted(reader):
        backward.append(reader)
        rewind(reader)

    monkeypatch.setattr(gzip._GzipReader, "_rewind", counted)
    trajectory = open_dump(packed).trajectory
    plain = Poses(open_dump(path)).run().results
    for span in ({}, {"step": 7}, {"start": 3, "stop": 40}, {"frames": [5, 2, 30]}):
        found = Poses(open_dump(packed)).run(**span).results
        chosen = span.get("frames", range(60)[slice(span.get("start"), span.get("stop"), span.get("step"))])
        assert np.array_equal(found.center, plain.center[list(chosen)])
    assert [trajectory[k].data["step"] for k in (9, 4, 4, 50, -1)] == [9, 4, 4, 50, 59]
    assert len(backward) < 20  # of 250 frames


def test_parts_of_bodies_are_refused(write, tmp_path):
    universe = open_dump(write(MOTION, TIMES))
    with pytest.raises(ValueError, match="parts of bodies are selected: 1 atom of 1 body left out, 1 of the 3 of body 1; whole"):
        Poses(universe.atoms[:2])
    with pytest.raises(ValueError, match="5 atoms of 2 bodies left out, 2 of the 4 of body 2; .*same residue as"):
        Poses(universe.atoms[[0, 1, 2, 3, 4, 7, 8]])
    assert Poses(universe.select_atoms("same residue as (id 1 5)")).ids.tolist() == [1, 2]  # the advice
    # and a dump of a part of the atoms that a data file has
    few = write(MOTION, TIMES, lambda t, r: r[:10, [0, 4, 5, 6]], columns="id xu yu zu")
    with pytest.raises(DumpError, match="the dump lacks 2 atoms of its bodies, such as atom 11 of body 3; .* whole bodies"):
        open_dump(few, data=data_of(tmp_path))
    whole = write(MOTION, TIMES, lambda t, r: r[:7, [0, 4, 5, 6]], columns="id xu yu zu")
    assert len(open_dump(whole, data=data_of(tmp_path)).residues) == 2


# --- what cannot be used -------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("id", "no column id; it is required to identify atoms"),
        ("mol", "no column mol, which has the IDs of bodies"),
        ("mass", "no column mass; dump it, or give a data file .--data."),
        ("yu", "no positions; columns xu yu zu or x y z are required"),
    ],
)
def test_missing_columns(write, name, text):
    kept = [column for column in dumps.COLUMNS.split() if column != name]
    rest = np.isin(dumps.COLUMNS.split(), kept)
    with pytest.raises(DumpError, match=text):
        open_dump(write(MOTION, TIMES, lambda t, rows: rows[:, rest], columns=" ".join(kept)))


def other_id(rows, new):
    return np.vstack([[new, *rows[0, 1:]], rows[1:]])


@pytest.mark.parametrize(
    ("when", "change", "text"),
    [
        (2.0, lambda rows: rows[:-1], "11 rows at step 2, 12 in the first frame; the number must"),
        (2.0, lambda rows: other_id(rows, 99), "other IDs at step 2 than in the first frame"),
        (1.0, lambda rows: np.vstack([rows, rows[:1]]), "13 rows at step 1, 12 in the first frame"),
        (0.0, lambda rows: other_id(rows, 2), "an ID occurs twice at step 0"),
    ],
)
def test_atoms_that_come_and_go(write, when, change, text):
    path = write(MOTION, [*TIMES, 3.0], lambda t, rows: change(rows) if t == when else rows)
    with pytest.raises(DumpError, match=text):
        Poses(open_dump(path).atoms).run()


@pytest.mark.parametrize("lost", [1, 30, 400, 1780, 1890])
def test_a_last_frame_that_is_cut_off(write, lost):
    """A dump of a run that was killed while it was writing, in the rows or in the header."""
    path = write(MOTION, TIMES)
    text = path.read_text()
    path.write_text(text[:-lost])
    with pytest.warns(UserWarning, match="poses.dump: the last frame is incomplete and is left out"):
        trajectory = open_dump(path).trajectory
    assert trajectory.cut_off and len(trajectory) == 2 and len(list(trajectory)) == 2
    assert not open_dump(write(MOTION, TIMES)).trajectory.cut_off


@pytest.mark.parametrize("kept", [30, 120, 172, 190, 400, -1])
def test_a_first_frame_that_is_cut_off(write, kept):
    path = write(MOTION, TIMES[:1])
    path.write_text(path.read_text()[:kept])
    with pytest.raises(DumpError, match="poses.dump: the dump ends within (its first frame|the header of a frame)"):
        open_dump(path)


def test_columns_in_another_order_from_frame_to_frame(write):
    """Columns may change their order, as after a restart with another script that appends; other columns are
    refused."""
    path = write(MOTION, TIMES)
    turned = np.arange(10)[::-1]
    names = dumps.COLUMNS.split()
    path.write_text(
        path.read_text()
        + dumps.frame(3, MOTION.rows(3.0)[:, turned], columns=" ".join(names[k] for k in turned))
    )
    found = Poses(open_dump(path).atoms).run().results
    assert found.center[3] == pytest.approx(MOTION.centers(3.0), abs=1e-13)
    assert found.velocity[3] == pytest.approx(MOTION.velocity, abs=1e-14)
    for kept, text in ((names[:7], "columns xu yu zu, in the first frame xu yu zu vx vy vz"), (names[1:], "no column id")):
        rows = MOTION.rows(4.0)[:, [name in kept for name in names]]
        path.write_text(path.read_text() + dumps.frame(4, rows, columns=" ".join(kept)))
        with pytest.raises(DumpError, match=f"poses.dump, step 4: {text}"):
            Poses(open_dump(path).atoms).run()
        write(MOTION, TIMES)


def test_a_row_with_a_missing_column(write):
    path = write(MOTION, TIMES)
    lines = path.read_text().splitlines()
    lines[-3] = lines[-3].rsplit(" ", 1)[0]
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(DumpError, match="poses.dump, step 2: a row with 9 columns; 10 are required"):
        Poses(open_dump(path)).run()


@pytest.mark.parametrize("column", [4, 8])
def test_what_is_not_finite(write, column):
    def spoil(time, rows):
        rows[5, column] = np.nan if time == 1.0 else rows[5, column]
        return rows

    with pytest.raises(ValueError, match="poses.dump, step 1: a site's (position|velocity) .*nan.* of body 2: finite"):
        Poses(open_dump(write(MOTION, TIMES, spoil)).atoms).run()


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        (b"ITEM: TIMESTEP", b"ITEM: LABEL\nlj\nITEM: TIMESTEP", "the header of a frame of a LAMMPS dump is required"),
        (b"ITEM: TIMESTEP", b"thermo", "the header of a frame of a LAMMPS dump is required"),
        (b"ITEM: ATOMS", b"ITEM: GRID", "a dump custom is required"),
        (b"ITEM: BOX BOUNDS pp pp pp", b"ITEM: BOX BOUNDS", "an orthogonal or restricted triclinic box"),
        (b"\n1 1 1 ", b"\n1 1 1 oops", "step 0: .*could not convert string"),
        (b"ITEM: TIMESTEP", b"\xff\xfe\0", "this is a binary file; a text dump is required"),
    ],
)
def test_other_files(write, old, new, text):
    path = write(MOTION, TIMES)
    path.write_bytes(path.read_bytes().replace(old, new))
    with pytest.raises(DumpError, match=text):
        open_dump(path)


def test_columns_of_other_fixes_do_no_harm(write):
    add = lambda t, rows: np.column_stack([rows, rows[:, 0]])  # noqa: E731
    path = write(MOTION, TIMES, add, columns=dumps.COLUMNS + " f_average[1]")
    assert centers(path) == pytest.approx(expected(), abs=1e-13)


def test_the_header_may_say_units_once_or_more(tmp_path):
    """A second run that appends to the dump repeats units and times."""
    motion = dumps.Motion([3])
    one = "ITEM: UNITS\nmetal\nITEM: TIME\n0.5\n" + dumps.frame(1, motion.rows(0.5))
    two = "ITEM: TIME\n1.5\n" + dumps.frame(2, motion.rows(1.5))
    path = tmp_path / "x.dump"
    path.write_text(one + two + one.replace("0.5", "2.5"))
    results = Poses(open_dump(path, timestep=7.0).atoms).run().results
    assert results.time.tolist() == [0.5, 1.5, 2.5]
    assert results.center[:2, 0] == pytest.approx(motion.center + motion.velocity * [[0.5], [1.5]])
    path.write_text("")
    with pytest.raises(DumpError, match="x.dump: the dump is empty"):
        open_dump(path)
