"""change_box between runs: bodies keep their shapes, and their centers follow the box."""

import re

import numpy as np
import pytest
from scenes import (
    WATER_MASSES,
    frames,
    one_after_the_other,
    placed,
    two_molecules,
    water,
    water_data,
)

REMAPPED = "WARNING: Fix gear/quat: atoms of {} bodies were remapped with the box"
DEFORMED = "has another shape than in the last run, and a remap"
ANEW = "the box was remapped since the last run; histories are rebuilt"
FROM_ATOMS = "atoms were changed since the last run; bodies are rebuilt from them"
LENGTH = 9.9  # of the box of 27 molecules

CHANGES = {
    "scale": "change_box all x scale 1.3 y scale 1.1 z scale 0.97 remap",
    "final": "change_box all x final -1.0 11.0 y final 0.5 10.9 remap units box",
    "twice": "change_box all x scale 1.1 remap\nchange_box all x scale 1.05 z delta -0.1 0.4 remap units box",
    "a run between": "change_box all y scale 1.1 remap\nrun 0\nchange_box all y scale 1.1 x scale 0.99 remap",
    "part": "change_box all x scale 1.02 remap\nchange_box all boundary p p p",
}
TILTS = "change_box all xy final 0.7 yz delta 0.6 x scale 1.05 remap units box"


def rows(box):
    """Edges in rows, and the lowest corner, from the lines of a dump's frame."""
    box = np.array([line.split() for line in box.splitlines()], float)
    tilts = box[:, 2] if box.shape[1] == 3 else np.zeros(3)  # xy xz yz
    xy, xz, yz = tilts
    low = box[:, 0] - [min(0, xy, xz, xy + xz), min(0, yz), 0]
    high = box[:, 1] - [max(0, xy, xz, xy + xz), max(0, yz), 0]
    edges = np.diag(high - low)
    edges[1, 0], edges[2, 0], edges[2, 1] = tilts
    return edges, low


def boxes(path):
    """Edges and corner of each frame."""
    text = path.read_text().split("ITEM: BOX BOUNDS")[1:]
    return [rows("\n".join(part.splitlines()[1:4])) for part in text]


def before_and_after(lmp, change, words="", tilt=0.0, ranks=1, first="run 20\n", data=None, **settings):
    """Positions and velocities (27, 3, 6) and boxes before and after the change, and the result."""
    data = data or water_data(lmp.folder / "data.water", tilt=tilt)
    pose = "write_dump all custom {}.dump id xu yu zu vx vy vz modify sort id format float %.17g\n"
    run = first + pose.format("before") + change + "\nrun 0\n" + pose.format("after") + "run 20"
    deck = water(data, f"gear/quat molecule {words}", dt=0.5, run=run, steps=20, **settings)
    result = lmp.succeed(deck, ranks=ranks)
    found = []
    for name in ("before", "after"):
        path = lmp.folder / f"{name}.dump"
        (frame,) = frames(path).values()
        found.append((frame[:, 1:].reshape(-1, 3, 6), *boxes(path)[0]))
    return *found, result


def centers(sites):
    return np.einsum("m,bmk->bk", WATER_MASSES, sites[..., :3]) / WATER_MASSES.sum()


def check_remap(before, after, tolerance=1e-12):
    """Arms and velocities are constant, centers keep their positions relative to the edges of the box."""
    (old, old_edges, old_low), (new, edges, low) = before, after
    place = (centers(old) - old_low) @ np.linalg.inv(old_edges)
    arms = [x[..., :3] - centers(x)[:, None] for x in (old, new)]
    errors = [
        np.abs(arms[1] - arms[0]).max(),
        np.abs(new[..., 3:] - old[..., 3:]).max(),
        np.abs(centers(new) - place @ edges - low).max(),
    ]
    assert max(errors) < tolerance
    assert np.abs(centers(new) - centers(old)).max() > 0.01 * LENGTH


@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("change", CHANGES)
def test_shapes_stay_and_centers_follow(lmp_tree, change, ranks):
    """Bodies across all faces."""
    before, after, result = before_and_after(lmp_tree, CHANGES[change], ranks=ranks)
    check_remap(before, after)
    assert result.output.count(REMAPPED.format(27)) == 1 + (change == "a run between")
    assert ANEW in result.stdout and FROM_ATOMS not in result.stdout
    assert DEFORMED not in result.output


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_in_a_tilted_box(lmp, ranks):
    """Edges with changed directions shear the box, and no body."""
    before, after, _ = before_and_after(lmp, TILTS, tilt=2.0, ranks=ranks)
    check_remap(before, after)
    with pytest.raises(AssertionError):
        check_remap(before, (1.01 * after[0], *after[1:]))


@pytest.mark.parametrize("words", ["", "reinit no"])
@pytest.mark.parametrize("first", ["", "run 20\n"])
def test_before_the_first_run_and_without_a_new_look_at_atoms(lmp_tree, words, first):
    before, after, result = before_and_after(lmp_tree, CHANGES["scale"], words, first=first)
    check_remap(before, after)
    assert (ANEW in result.stdout) == bool(first)


def test_with_an_infile(lmp_tree):
    """With bodies from a file, centers cannot be computed from atoms."""
    data = water_data(lmp_tree.folder / "data.water")
    lmp_tree.succeed(water(data, dt=0.5, steps=1, run="run 0\nwrite_restart given"))
    infile = next(lmp_tree.folder.glob("given.*.gear_quat"))
    before, after, _ = before_and_after(
        lmp_tree, CHANGES["scale"], f"infile {infile}", first="", data=data
    )
    check_remap(before, after)


def test_a_group_alone_is_remapped(lmp_tree):
    """Two molecules far from the faces; the atoms of one of them are not in the group."""
    change = "group one molecule 1\nchange_box one x scale 1.1 remap"
    deck = two_molecules(after="run 1\n" + change + "\nrun 0\nwrite_dump all custom end id x y z modify sort id")
    deck = deck.replace("single 0.0 0.0 0.0", "single 3.0 0.0 0.0").replace("single 1.0", "single 4.0")
    result = lmp_tree.succeed(deck.replace("single 0.0 1.2", "single 3.0 1.2").replace("0.01", "1e-9"))
    (frame,) = frames(lmp_tree.folder / "end").values()
    x = frame[:, 1]
    assert REMAPPED.format(1) in result.output
    assert x[1] - x[0] == pytest.approx(1.0, abs=1e-5) and x[:3].mean() == pytest.approx(1.1 * 10 / 3, abs=1e-4)
    assert x[3:] == pytest.approx([5, 6, 5], abs=1e-5)


def test_velocities_may_change_as_well(lmp_tree):
    """Velocities are adopted from the atoms, as after any other command."""
    doubled = "variable v{0} atom 2*v{0}\nset group all v{0} v_v{0}\n"
    change = CHANGES["scale"] + "\n" + "".join(doubled.format(k) for k in "xyz")
    before, after, result = before_and_after(lmp_tree, change)
    assert after[0][..., 3:] == pytest.approx(2 * before[0][..., 3:], rel=1e-10, abs=1e-15)
    after[0][..., 3:] /= 2
    check_remap(before, after)


def test_energies_are_those_of_the_new_places(lmp_tree):
    """The trajectory is as if the fix had been defined after the change."""
    data = water_data(lmp_tree.folder / "data.water")
    written = "write_data written nocoeff\nrun 20"
    change = "change_box all x scale 1.05 y scale 1.04 z scale 1.01 remap"
    kept = water(data, dt=0.5, thermo=5, steps=20, run=f"run 20\n{change}\nrun 0\n{written}")
    fresh = water("written", dt=0.5, thermo=5, steps=20)
    result = lmp_tree.succeed(one_after_the_other([kept, fresh]))
    one, other = result.thermo[2]["TotEng"], result.thermo[3]["TotEng"]
    assert one == pytest.approx(other, abs=1e-9)
    assert abs(one[0] - result.thermo[0]["TotEng"][-1]) > 1


def test_a_data_file_right_after_the_change(lmp_tree):
    """LAMMPS writes the initial state of its next run."""
    data = water_data(lmp_tree.folder / "data.water")
    run = f"run 1\n{CHANGES['scale']}\nwrite_data written nocoeff"
    lmp_tree.succeed(water(data, steps=1, run=run), ranks=2)
    lmp_tree.succeed(water("written", steps=1, run="run 0", dump="again.dump"))
    sites = frames(lmp_tree.folder / "again.dump")[0][:, 1:4].reshape(27, 3, 3)
    bond = np.linalg.norm(sites[:, 1] - sites[:, 0], axis=1)
    assert bond == pytest.approx(27 * [1.0], abs=1e-12)


def test_bodies_of_one_atom_and_rods_along_an_axis(lmp_tree):
    """A remap does not stretch these bodies, and its effect on other bodies is still detected."""
    bodies = [[(1, 2, 3)], [(3, 0, 0), (3, 0, 1.5)], [(-4, 0, 0), (-3, 0, 0)]]
    bodies = [np.array(body, float) for body in bodies]
    change = "change_box all x scale 1.1 y scale 0.9 remap"
    for words in ("", " reinit no"):
        run = f"run 0\n{change}\nrun 0\nwrite_dump all custom end id xu yu zu modify sort id format float %.17g"
        settings = dict(boundary="p p p", box="-10 10 -10 10 -10 10", run=run, steps=1)
        lmp_tree.succeed(placed(bodies, fix=f"gear/quat molecule{words}", **settings))
        (frame,) = frames(lmp_tree.folder / "end").values()
        right = [b + b.mean(axis=0) * [0.1, -0.1, 0] for b in bodies]
        assert frame[:, 1:] == pytest.approx(np.vstack(right), abs=1e-13)


def test_a_body_that_all_ranks_have(lmp_tree):
    """Longer than the ghost cutoff."""
    rod = np.column_stack([np.arange(-14, 14.5, 2), 0.1 * np.arange(-14, 14.5, 2), np.zeros(15)])
    bodies = [rod, rod + [0, 5, 5]]
    ends = []
    for ranks in (1, 4):
        run = "run 2\nchange_box all x scale 1.1 y scale 0.9 remap\nrun 50"
        settings = dict(boundary="p p p", box="-20 20 -20 20 -20 20", run=run, steps=50, dump="end.dump")
        deck = placed(bodies, before="velocity all create 1.0 4711 loop geom", **settings)
        result = lmp_tree.succeed("processors * 1 1\n" + deck, ranks=ranks)
        assert REMAPPED.format(2) in result.output
        ends.append(list(frames(lmp_tree.folder / "end.dump").values())[-1])
    assert ends[1] == pytest.approx(ends[0], abs=1e-11)
    sites = ends[0][:, 1:4].reshape(2, 15, 3)
    right = np.linalg.norm(rod[-1] - rod[0])
    assert np.linalg.norm(sites[:, -1] - sites[:, 0], axis=1) == pytest.approx([right, right], abs=1e-12)


UNLIKE = "change_box all x final -2 12 units box\nchange_box all x scale 1.2 remap"


def test_a_deformation_that_is_no_remap_is_told(lmp_tree):
    """The advice in the message helps."""
    inside = water_data(lmp_tree.folder / "inside.water", shift=1.65)
    _, _, result = before_and_after(lmp_tree, UNLIKE, data=inside)
    assert result.output.count(DEFORMED) == 1 and REMAPPED.format(27) not in result.output
    before, after, result = before_and_after(lmp_tree, UNLIKE.replace("\n", "\nrun 0\n"), data=inside)
    assert DEFORMED not in result.output and REMAPPED.format(27) in result.output
    arms = [x[0][..., :3] - centers(x[0])[:, None] for x in (before, after)]
    assert arms[1] == pytest.approx(arms[0], abs=1e-12)


QUIET = {
    "no change": "change_box all boundary p p p",
    "without remap": "change_box all x final -2 12 units box",
    "moved": "displace_atoms all move 0.3 0.2 0.1 units box",
    "turned": "displace_atoms all rotate 0 0 0 0 0 1 20",
    "another box": "displace_atoms all move 0.3 0 0 units box\nchange_box all z final -1 12 units box",
}


def test_other_changes_are_none_of_this(lmp_tree):
    data = water_data(lmp_tree.folder / "data.water", shift=1.65)
    decks = [
        water(data, dt=0.5, steps=5, run=f"run 5\n{change}\nrun 5") for change in QUIET.values()
    ]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert not re.search(f"remapped with the box|{DEFORMED}", result.output)
    assert result.stdout.count(FROM_ATOMS) == 3  # of the displaced ones
