"""What the fix tells of every body: its global array and its local data."""

import numpy as np
import pytest
from scenes import last_frame, water, water_data

COLUMNS = 28
BODIES = 27
MASSES = np.array([15.9994, 1.008, 1.008])
CENTER, VELOCITY, FORCE, TORQUE = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
IMAGE, QUATERNION, OMEGA, MOMENTUM = slice(12, 15), slice(15, 19), slice(19, 22), slice(22, 25)
ERRORS, ID = slice(25, 27), 27

# the array by thermo's own way (a vector of every column), the local data by a dump
OUTPUT = """
dump bodies all local {steps} bodies.dump {columns}
dump_modify bodies format float %.17g
"""


def bodies_of(lmp, ranks=1, steps=20, fix="gear/quat molecule", dt=1.0, **deck):
    """Local data sorted by ID (bodies, 28), sites of the last frame (bodies, 3, 6), the result."""
    data = water_data(lmp.folder / "data.water")
    columns = " ".join(f"f_move[{k + 1}]" for k in range(COLUMNS))
    more = OUTPUT.format(steps=steps, columns=columns) + deck.pop("after", "")
    result = lmp.run(water(data, fix, steps=steps, dt=dt, after=more, **deck), ranks=ranks)
    assert result.returncode == 0, result.output
    rows = (lmp.folder / "bodies.dump").read_text().rpartition("ITEM: ENTRIES")[2].splitlines()[1:]
    table = np.array([[float(word) for word in row.split()] for row in rows])
    sites = last_frame(lmp.folder / "poses.dump")[:, 1:7].reshape(BODIES, 3, 6)
    return table[table[:, ID].argsort()], sites, result


def matrix(q):
    """Rotation body -> space of quaternions with the scalar first, (..., 4) -> (..., 3, 3)."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def expect(found, right, tolerance):
    """Equal, and a table that is 1 % off would not be."""
    scale = np.abs(right).max()
    assert np.abs(found - right).max() < tolerance * scale
    assert np.abs(1.01 * found - right).max() > 100 * tolerance * scale


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_rows_are_those_of_the_sites(lmp, formulation):
    table, sites, _ = bodies_of(lmp, fix=f"gear/quat molecule formulation {formulation}")
    assert (table[:, ID] == np.arange(1, BODIES + 1)).all()
    x, v = sites[..., :3], sites[..., 3:]
    mass = MASSES.sum()
    center, velocity = (np.einsum("i,bij->bj", MASSES, y) / mass for y in (x, v))
    arms, relative = x - center[:, None], v - velocity[:, None]
    momentum = np.einsum("i,bij->bj", MASSES, np.cross(arms, relative))

    expect(table[:, CENTER] + 9.9 * table[:, IMAGE], center, 1e-12)
    assert ((table[:, CENTER] >= 0) & (table[:, CENTER] < 9.9)).all() and table[:, IMAGE].any()
    expect(table[:, VELOCITY], velocity, 1e-11)
    expect(table[:, MOMENTUM], momentum, 1e-11)
    assert np.linalg.norm(table[:, QUATERNION], axis=1) == pytest.approx(np.ones(BODIES), abs=1e-14)

    # the sites lie in the body frame where every molecule has them, and turn with omega
    turn = matrix(table[:, QUATERNION])
    body = np.einsum("bji,bkj->bki", turn, arms)
    assert np.abs(body - body[0]).max() < 1e-12 < 1e-3 < np.abs(body[0]).max()
    omega_space = np.einsum("bij,bj->bi", turn, table[:, OMEGA])
    expect(np.cross(omega_space[:, None], arms), relative, 1e-11)
    assert (table[:, ERRORS] > 0).all()


def test_the_first_columns_are_those_of_fix_rigid(lmp_tree):
    """Forces and torques too: after one tiny step both have the same sites."""
    columns = [f"f_move[{i}][{k}]" for i in (1, 14, 27) for k in range(1, 16)]
    more = f"thermo_style custom step {' '.join(columns)}\nthermo_modify format float %.17g\n"
    found = {}
    for fix in ("gear/quat molecule", "rigid/nve molecule"):
        data = water_data(lmp_tree.folder / "data.water")
        deck = water(data, fix, steps=1, dt=1e-4, run=more + "run 1")
        result = lmp_tree.run(deck)
        assert result.returncode == 0, result.output
        thermo = result.thermo[-1]
        found[fix] = np.array([thermo[c][-1] for c in columns]).reshape(3, 15)
    ours, theirs = found.values()
    for part in (CENTER, VELOCITY, FORCE, TORQUE):
        expect(ours[:, part], theirs[:, part], 1e-6)
    assert (ours[:, IMAGE] == theirs[:, IMAGE]).all()


@pytest.mark.parametrize("ranks", [2, 4])
def test_array_and_local_data_on_any_ranks(lmp_tree, ranks):
    one, _, _ = bodies_of(lmp_tree)
    shown = [(i, k) for i in (1, 13, 27) for k in (1, 4, 7, 10, 16, 20, 23, 26, 28)]
    columns = " ".join(f"f_move[{i}][{k}]" for i, k in shown)
    show = f"thermo_style custom step {columns}\nthermo_modify format float %.17g norm no\n"
    many, _, result = bodies_of(lmp_tree, ranks, run=f"{show}run 20")
    assert np.abs(one - many).max() < 1e-10
    thermo = result.thermo[-1]
    array = np.array([thermo[f"f_move[{i}][{k}]"][-1] for i, k in shown])
    assert array == pytest.approx([many[i - 1, k - 1] for i, k in shown], rel=1e-14)


def test_rows_follow_at_any_time(lmp_wheel):
    """Averages each step, and reductions over local data, see the present step."""
    after = """
compute sum all reduce sumsq f_move[4] inputs local
variable one equal f_move[3][1]
fix mean all ave/time 1 5 5 v_one c_sum file mean.txt format ' %.17g'
"""
    table, _, result = bodies_of(lmp_wheel, after=after, steps=5)
    more = (
        "thermo_style custom step c_sum v_one\nthermo 1\nthermo_modify norm no format float %.17g\n"
    )
    data = water_data(lmp_wheel.folder / "data.water")
    result = lmp_wheel.run(water(data, steps=5, dt=1.0, after=after, run=more + "run 5"))
    assert result.returncode == 0, result.output
    thermo = result.thermo[-1]
    each = np.array(thermo["c_sum"])
    means = np.loadtxt(lmp_wheel.folder / "mean.txt")[1:]
    assert means == pytest.approx([np.mean(thermo["v_one"][1:]), each[1:].mean()], rel=1e-12)
    assert means != pytest.approx([np.mean(thermo["v_one"][:-1]), each[:-1].mean()], rel=1e-12)
    assert each[-1] == pytest.approx((table[:, 3] ** 2).sum(), rel=1e-12)
    assert abs(each[-1] - each[1]) > 0.001 * abs(each[1])


@pytest.mark.parametrize("ranks", [1, 4])
def test_rows_follow_within_a_step(lmp_tree, ranks):
    """A variable that a fix reads while forces are evaluated leaves nothing behind for thermo."""
    after = """
variable push equal 0.0*f_move[1][1]
fix push all addforce v_push 0.0 0.0
"""
    shown = " ".join(f"f_move[{i}][{k + 1}]" for i in (1, 14, 27) for k in range(COLUMNS))
    show = f"thermo_style custom step {shown}\nthermo_modify format float %.17g norm no\n"
    table, _, result = bodies_of(lmp_tree, ranks, after=after, run=f"{show}run 20")
    thermo = result.thermo[-1]
    array = np.array([thermo[column][-1] for column in shown.split()]).reshape(3, COLUMNS)
    assert array == pytest.approx(table[[0, 13, 26]], rel=1e-14)
    assert 1.01 * array[:, : IMAGE.start] != pytest.approx(
        table[[0, 13, 26], : IMAGE.start], rel=1e-3
    )


# what computes sum over neighbors, ghost atoms among them: pairs, bonds, two groups, and one between outputs
NEIGHBORS = """
group oxygen type 1
group hydrogen type 2
compute pairs all pair/local eng
compute pair_sum all reduce sum c_pairs inputs local
compute groups oxygen group/group hydrogen pair yes
compute distances all pair/local dist
compute distance all reduce ave c_distances inputs local
variable energy equal c_pair_sum
variable force equal c_groups[1]
variable distance equal c_distance
fix energy all ave/time 7 1 7 v_energy v_force v_distance file {name}.between format " %.17g"
dump places all custom 7 {name}.places id type x y z
dump_modify places sort id format float %.17g
thermo_style custom step v_energy v_force v_distance
"""


def test_other_atoms_see_a_body_where_it_is(lmp_tree):
    """Ghost atoms are at the corrected pose when output or another fix reads them, on any number of ranks.

    In every seventh step the energy is that of the atoms as they are dumped.
    """
    data = water_data(lmp_tree.folder / "data.water")
    tables = {}
    for ranks in (1, 4):
        name = f"with{ranks}"
        deck = water(data, dt=2.0, steps=21, after=NEIGHBORS.format(name=name))
        result = lmp_tree.run(
            deck.replace("thermo_style custom step temp pe ke etotal press", ""), ranks=ranks
        )
        assert result.returncode == 0, result.output
        tables[ranks] = np.loadtxt(lmp_tree.folder / f"{name}.between")[1:]
        thermo = result.thermo[-1]
        last = [thermo[f"v_{key}"][-1] for key in ("energy", "force", "distance")]
        assert last == tables[ranks][-1, 1:].tolist()
    assert tables[4] == pytest.approx(tables[1], rel=1e-12, abs=0)
    again = water(data, "nve", thermo=1, dump="again", run="rerun with1.places dump x y z")
    result = lmp_tree.run(again)
    assert result.returncode == 0, result.output
    energies = result.thermo[-1]["PotEng"]
    assert energies[1:] == pytest.approx(tables[1][:, 1], rel=1e-12, abs=0)
    assert max(energies) > 1.01 * min(energies)
