"""The output for every body: the global array and the local data of the fix."""

import re

import numpy as np
import pytest
from support.scenes import WATER_MASSES, expect, last_frame, restarted, water, water_data
from scipy.spatial.transform import Rotation

BODIES = 27
ALL = " ".join(f"f_move[{k}]" for k in range(1, 29))
CENTER, VELOCITY, FORCE, TORQUE = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
IMAGE, QUATERNION, OMEGA, MOMENTUM = slice(12, 15), slice(15, 19), slice(19, 22), slice(22, 25)
ERRORS, ID = slice(25, 27), 27

# the array through thermo (a vector of every column), the local data through a dump
OUTPUT = f"""
dump bodies all local {{steps}} bodies.dump {ALL}
dump_modify bodies format float %.17g
"""


def bodies_of(lmp, ranks=1, steps=20, fix="gear/quat molecule", after="", **deck):
    """Local data sorted by ID (bodies, 28), sites of the last frame (bodies, 3, 6), thermo."""
    data = water_data(lmp.folder / "data.water")
    after = OUTPUT.format(steps=steps) + after
    result = lmp.succeed(water(data, fix, steps=steps, dt=1.0, after=after, **deck), ranks=ranks)
    table = last_frame(lmp.folder / "bodies.dump")
    sites = last_frame(lmp.folder / "poses.dump")[:, 1:7].reshape(BODIES, 3, 6)
    return table[table[:, ID].argsort()], sites, result.thermo[-1]


def shown(bodies, columns):
    """Columns of thermo that show elements of the array."""
    return [f"f_move[{i}][{k}]" for i in bodies for k in columns]


def last(thermo, columns):
    return np.array([thermo[column][-1] for column in columns])


def test_rows_are_those_of_the_sites(lmp_tree, fix):
    table, sites, _ = bodies_of(lmp_tree, fix=fix)
    assert (table[:, ID] == np.arange(1, BODIES + 1)).all()
    x, v = sites[..., :3], sites[..., 3:]
    center, velocity = (np.average(y, axis=1, weights=WATER_MASSES) for y in (x, v))
    arms, relative = x - center[:, None], v - velocity[:, None]
    momentum = np.einsum("i,bij->bj", WATER_MASSES, np.cross(arms, relative))

    expect(table[:, CENTER] + 9.9 * table[:, IMAGE], center, 1e-12)
    assert ((table[:, CENTER] >= 0) & (table[:, CENTER] < 9.9)).all() and table[:, IMAGE].any()
    expect(table[:, VELOCITY], velocity, 1e-11)
    expect(table[:, MOMENTUM], momentum, 1e-11)
    assert np.linalg.norm(table[:, QUATERNION], axis=1) == pytest.approx(np.ones(BODIES), abs=1e-14)

    # the sites have the same body-frame positions in all molecules, and rotate with omega
    turn = Rotation.from_quat(table[:, QUATERNION], scalar_first=True)
    body = np.einsum("bji,bkj->bki", turn.as_matrix(), arms)
    assert np.abs(body - body[0]).max() < 1e-12 < 1e-3 < np.abs(body[0]).max()
    omega_space = turn.apply(table[:, OMEGA])
    expect(np.cross(omega_space[:, None], arms), relative, 1e-11)
    assert (table[:, ERRORS] > 0).all()


def test_the_first_columns_are_those_of_fix_rigid(lmp_tree, data):
    """Forces and torques agree, too: after one tiny step both fixes have the same sites."""
    columns = shown((1, 14, 27), range(1, 16))
    rows = []
    for fix in ("gear/quat molecule", "rigid/nve molecule"):
        deck = water(data, fix, steps=1, dt=1e-4, columns=" ".join(columns))
        rows.append(last(lmp_tree.succeed(deck).thermo[-1], columns).reshape(3, 15))
    ours, theirs = rows
    for part in (CENTER, VELOCITY, FORCE, TORQUE):
        expect(ours[:, part], theirs[:, part], 1e-6)
    assert (ours[:, IMAGE] == theirs[:, IMAGE]).all()


@pytest.mark.parametrize("ranks", [2, 4])
def test_array_and_local_data_on_any_ranks(lmp_tree, ranks):
    one, _, _ = bodies_of(lmp_tree)
    indices, columns = (1, 13, 27), (1, 4, 7, 10, 16, 20, 23, 26, 28)
    names = shown(indices, columns)
    many, _, thermo = bodies_of(lmp_tree, ranks, columns=" ".join(names))
    assert np.abs(one - many).max() < 1e-10
    right = many[np.ix_(np.subtract(indices, 1), np.subtract(columns, 1))]
    assert last(thermo, names) == pytest.approx(right.ravel(), rel=1e-14)


def test_rows_follow_at_any_time(lmp_wheel):
    """Averages in each step, and reductions over local data, use the present step."""
    after = """
compute sum all reduce sumsq f_move[4] inputs local
variable one equal f_move[3][1]
fix mean all ave/time 1 5 5 v_one c_sum file mean.txt format ' %.17g'
"""
    columns = "c_sum v_one"
    table, _, thermo = bodies_of(lmp_wheel, after=after, steps=5, thermo=1, columns=columns)
    each = np.array(thermo["c_sum"])
    means = np.loadtxt(lmp_wheel.folder / "mean.txt")[1:]
    assert means == pytest.approx([np.mean(thermo["v_one"][1:]), each[1:].mean()], rel=1e-12)
    assert means != pytest.approx([np.mean(thermo["v_one"][:-1]), each[:-1].mean()], rel=1e-12)
    assert each[-1] == pytest.approx((table[:, 3] ** 2).sum(), rel=1e-12)
    assert abs(each[-1] - each[1]) > 0.001 * abs(each[1])


@pytest.mark.parametrize("ranks", [1, 4])
def test_rows_follow_within_a_step(lmp_tree, ranks):
    """A variable that a fix reads while forces are evaluated does not affect thermo."""
    after = """
variable push equal 0.0*f_move[1][1]
fix push all addforce v_push 0.0 0.0
"""
    names = shown((1, 14, 27), range(1, 29))
    table, _, thermo = bodies_of(lmp_tree, ranks, after=after, columns=" ".join(names))
    array, rows = last(thermo, names).reshape(3, 28), table[[0, 13, 26]]
    assert array == pytest.approx(rows, rel=1e-14)


# sums of computes over neighbors, including ghost atoms: pairs, bonds, two groups, and one between outputs
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
fix energy all ave/time 7 1 7 v_energy v_force v_distance file between format " %.17g"
dump places all custom 7 places id type x y z
dump_modify places sort id format float %.17g
"""


def test_other_atoms_see_a_body_where_it_is(lmp_tree, data):
    """Ghost atoms are at the corrected pose when output or another fix reads them, on any number of ranks.

    In every seventh step the energy is computed from the dumped atoms.
    """
    names = ("v_energy", "v_force", "v_distance")
    deck = water(data, dt=2.0, steps=21, after=NEIGHBORS, columns=" ".join(names))
    tables = []
    for ranks in (4, 1):
        thermo = lmp_tree.succeed(deck, ranks=ranks).thermo[-1]
        tables.append(np.loadtxt(lmp_tree.folder / "between")[1:, 1:])
        assert last(thermo, names).tolist() == tables[-1][-1].tolist()
    assert tables[0] == pytest.approx(tables[1], rel=1e-12, abs=0)
    again = water(data, "nve", thermo=1, dump="again", run="rerun places dump x y z")
    energies = lmp_tree.succeed(again).thermo[-1]["PotEng"]
    assert energies[1:] == pytest.approx(tables[1][:, 0], rel=1e-12, abs=0)
    assert max(energies) > 1.01 * min(energies)


@pytest.mark.parametrize("ranks", [1, 4])
def test_a_dump_of_local_data_before_the_first_run(lmp_tree, ranks):
    """Both after the definition of the fix and after reading a restart file."""
    data = water_data(lmp_tree.folder / "data.water")
    write = f"write_dump all local {{}} {ALL} modify format float %.17g\n"
    run = write.format("early") + "run 0\n" + write.format("late") + "write_restart half"
    lmp_tree.succeed(water(data, run=run), ranks=ranks)
    again = restarted(water(data, run=write.format("again") + "\n"), "half")
    lmp_tree.succeed(again.replace("neighbor ", "pair_style zero 3.9\npair_coeff * *\nneighbor "), ranks=ranks)
    early, late, again = (last_frame(lmp_tree.folder / name) for name in ("early", "late", "again"))
    early, late, again = (table[table[:, ID].argsort()] for table in (early, late, again))
    assert early.shape == late.shape == again.shape == (BODIES, 28)
    known = np.r_[0:6, 12:28]
    for table in (early, again):
        assert table[:, known] == pytest.approx(late[:, known], rel=1e-13, abs=1e-13)


# --- the temperature of a group with parts of bodies ----------------------------------------------
GROUPS = "group oxygens type 1\ngroup hydrogens type 2\n"
TEMPERATURES = """
group some molecule 1:13
compute all all temp
compute o oxygens temp
compute h hydrogens temp
compute some some temp
thermo_style custom step c_all c_o c_h c_some
thermo_modify norm no
"""


@pytest.mark.parametrize("ranks", [1, 2])
def test_temperature_of_parts(lmp_tree, ranks):
    """One warning for each group with parts of bodies, also in several runs; none for groups of whole bodies."""
    text = water(water_data(lmp_tree.folder / "data.water"), "gear/quat molecule", steps=1, before=GROUPS)
    text = text.replace("fix_modify move energy yes\n", TEMPERATURES)
    told = lmp_tree.succeed(text + "\nrun 1", ranks=ranks).words
    found = re.findall(r"temperature of group (\w+), which has only some atoms of bodies such as \d+", told)
    assert sorted(found) == ["hydrogens", "oxygens"]
