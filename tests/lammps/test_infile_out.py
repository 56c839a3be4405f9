"""The text file beside every restart file, which keyword infile reads: a run continues from text files."""

import numpy as np
import pytest
from support.scenes import WATER_MASSES, expect, frames, last_frame, two_molecules, water, water_data
from support.paper_case import Case1, bodies_in, end

BODIES = 27
MASS, CENTER, INERTIA, VELOCITY = slice(1, 2), slice(2, 5), slice(5, 11), slice(11, 14)
MOMENTUM, IMAGE = slice(14, 17), slice(17, 20)
BOX = 9.9


# --- only the history is lost --------------------------------------------------------------------
def gap(case1, dt, body):
    """Deviation of a run continued from text files from the uninterrupted one: at its start and its end."""
    steps, folder = round(20 / dt), case1.lmp.folder
    write = "write_restart half\nwrite_data half.data nocoeff"
    whole = case1.run(f"run {steps}\n{write}\nrun {steps}", dt=dt, body=body)
    path = folder / "half.move.gear_quat"
    scene = case1.scene.replace("read_data ${data}.${body}", "read_data half.data")
    assert scene != case1.scene
    again = case1.run(f"run {steps}", scene=scene, dt=dt, body="unrotated", infile=path.name)
    starts = zip(again.thermo[0].values(), whole.thermo[1].values())
    at_start = max(abs(mine[0] - other[0]) for mine, other in list(starts)[2:])
    return at_start, np.abs(end(again, 0) - end(whole)).max()


@pytest.mark.parametrize("body", ["consistent", "unrotated"])
def test_a_run_goes_on_up_to_its_history(lmp_tree, examples, formulation, body):
    """The new start causes an error of the method's order; masses and moments of the file are used."""
    case1 = Case1(lmp_tree, examples, formulation)
    case1.variables["values"] = 5 if formulation == "first" else 6  # order 5 in each
    case1.variables["corrector"] = "gear"
    starts, gaps = zip(*(gap(case1, dt, body) for dt in (0.16, 0.08, 0.04)))
    assert max(starts) < 1e-13  # only the history is lost
    assert gaps[0] < 1e-7
    slopes = np.log2(np.divide(gaps[:-1], gaps[1:]))
    assert slopes == pytest.approx([5.0, 5.0], abs=0.4)


# --- contents of the file ------------------------------------------------------------------------
def write(lmp, ranks=1, fix="gear/quat molecule"):
    """Table of the file and sites (bodies, 3, 6) at the same step."""
    data = water_data(lmp.folder / "data.water")
    run = "run {steps}\nwrite_restart half\nwrite_data half.data nocoeff"
    lmp.succeed(water(data, fix, steps=20, dt=1.0, run=run), ranks=ranks)
    sites = last_frame(lmp.folder / "poses.dump")[:, 1:7].reshape(BODIES, 3, 6)
    kind = "rigid" if fix.startswith("rigid") else "move.gear_quat"
    return bodies_in(lmp.folder / f"half.{kind}"), sites


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_the_file_has_the_bodies(lmp_tree, ranks):
    table, sites = write(lmp_tree, ranks)
    assert (table[:, 0] == np.arange(1, BODIES + 1)).all()  # sorted
    x, v = sites[..., :3], sites[..., 3:]
    center, velocity = (np.einsum("i,bij->bj", WATER_MASSES, y) / WATER_MASSES.sum() for y in (x, v))
    arms = x - center[:, None]
    momentum = np.einsum("i,bij->bj", WATER_MASSES, np.cross(arms, v - velocity[:, None]))
    square = np.einsum("i,bij,bik->bjk", WATER_MASSES, arms, arms)
    inertia = np.trace(square, axis1=1, axis2=2)[:, None, None] * np.eye(3) - square
    order = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]

    expect(table[:, MASS], np.full((BODIES, 1), WATER_MASSES.sum()), 1e-14)
    expect(table[:, CENTER] + BOX * table[:, IMAGE], center, 1e-12)
    assert ((table[:, CENTER] >= 0) & (table[:, CENTER] < BOX)).all() and table[:, IMAGE].any()
    expect(table[:, INERTIA], inertia[:, order[0], order[1]], 1e-12)
    expect(table[:, VELOCITY], velocity, 1e-11)
    expect(table[:, MOMENTUM], momentum, 1e-11)


@pytest.mark.parametrize("fix", ["rigid/nve molecule", "rigid/nve/small molecule"])
def test_the_format_is_that_of_fix_rigid(lmp_tree, fix):
    """fix rigid reads our file, and our fix reads its file."""
    ours, _ = write(lmp_tree)
    poses = []
    for style in ("gear/quat molecule", fix):
        words = f"{style} infile half.move.gear_quat"
        deck = water("half.data", words, dt=1e-3, steps=1, dump="a.dump").replace("exclude", "#")
        lmp_tree.succeed(deck)
        poses.append(last_frame(lmp_tree.folder / "a.dump")[:, 1:])
    for part in (slice(0, 3), slice(3, 6)):
        expect(poses[1][:, part], poses[0][:, part], 1e-6)

    (lmp_tree.folder / "bodies").write_text((lmp_tree.folder / "half.move.gear_quat").read_text())
    theirs, _ = write(lmp_tree, fix=f"{fix} infile bodies")
    assert theirs.shape == ours.shape
    data = water_data(lmp_tree.folder / "data.water")
    lmp_tree.succeed(water(data, "gear/quat molecule infile half.rigid", steps=1))


def test_water_goes_on_on_other_ranks(lmp_tree):
    """Two continuations, on 1 and on 4 ranks, start from the same bodies."""
    table, sites = write(lmp_tree, ranks=2)
    fix, run = "gear/quat molecule infile half.move.gear_quat", "run {steps}\nwrite_restart again"
    found = []
    for ranks in (1, 4):
        lmp_tree.succeed(water("half.data", fix, dt=1.0, steps=20, run=run), ranks=ranks)
        first = frames(lmp_tree.folder / "poses.dump")[0][:, 1:].reshape(BODIES, 3, 6)
        expect(first[..., :3], sites[..., :3], 1e-12)
        expect(first[..., 3:], sites[..., 3:], 1e-11)
        found.append(bodies_in(lmp_tree.folder / "again.move.gear_quat"))
    assert np.abs(found[0] - found[1]).max() < 1e-10
    assert np.abs(found[0] - table).max() > 1e-3  # they have moved


def test_periodic_restarts_and_several_fixes(lmp_wheel):
    """A file for every restart file and for every fix."""
    deck = two_molecules("group 1 left", "group left id 1 2 3\ngroup right id 4 5 6", "").replace(
        "fix move all gear/quat group 1 left",
        "fix a all gear/quat group 1 left\nfix b all gear/quat group 1 right",
    )
    lmp_wheel.succeed(deck + "write_restart none\nrestart 5 run.*.restart\nrun 10")
    names = {path.name for path in lmp_wheel.folder.glob("*.gear_quat")}
    assert names == {f"run.{step}.restart.{fix}.gear_quat" for step in (5, 10) for fix in "ab"}
    for name in names:
        assert bodies_in(lmp_wheel.folder / name)[:, 0] == [1]


def test_a_file_that_cannot_be_written(lmp_wheel):
    (lmp_wheel.folder / "half.move.gear_quat").mkdir()
    deck = two_molecules(after="run 1\nwrite_restart half")
    lmp_wheel.refuse(deck, "cannot write file half.move.gear_quat", ranks=2)
