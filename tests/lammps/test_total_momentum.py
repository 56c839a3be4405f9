"""Keyword temp: the total momentum is not heat in directions in which it is constant.

These directions are measured, so only the effect of other fixes matters.
"""

import re

import numpy as np
import pytest
from running import EXAMPLES
from scenes import largest_change, last_frame, one_after_the_other
from heated import COLUMNS, COMMON, END, KINDS, TEMP, cluster, continued
from stepped import tables

DUMBBELL = """d

2 atoms
1 bonds

Coords

1 -0.3 0 0
2 0.3 0 0

Types

1 1
2 2

Bonds

1 1 1 2
"""
# Eight of them, with opposite charges that only fields act on; the first is also a group.
DUMBBELLS = """
units lj
atom_style full
atom_modify map array sort 0 0.0
boundary p p {bound}
region box block 0 6 0 6 0 6
create_box 2 box bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 2
lattice sc 0.037037037 origin 0.2 0.2 0.2
molecule d dumbbell
create_atoms 0 box mol d 4711
mass * 1.0
set type 1 charge 0.5
set type 2 charge -0.5
velocity all create 1.0 4711 loop geom
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
bond_style zero
bond_coeff *
group one molecule 1
group two molecule 2
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
timestep 0.003
{before}
fix move all gear/quat molecule {words}
{after}
variable cx equal mass(all)*vcm(all,x)^2
variable cy equal mass(all)*vcm(all,y)^2
variable cz equal mass(all)*vcm(all,z)^2
thermo_style custom step f_move[1] f_move[2] f_move[10] f_move[11] v_cx v_cy v_cz {columns}
thermo_modify norm no format float %.17g
thermo {every}
{run}
"""
WORDS = "temp 1.0 1.0 0.5 thermostat separate"


def dumbbells(lmp, after="", words=WORDS, before="", bound="p", columns="", every=5, run="run 20"):
    (lmp.folder / "dumbbell").write_text(DUMBBELL)
    names = dict(after=after, words=words, before=before, bound=bound, columns=columns)
    return DUMBBELLS.format(every=every, run=run, **names)


def said(log):
    """Degrees of freedom in the log: of translation, directions of the total momentum, of rotation."""
    found = []
    for line in re.findall("thermostat of (.*)", log):
        numbers = re.findall(r"(\d+) (?:degrees|of rotation)", line)
        some = re.search("total momentum along (.*?),", line)
        along = some[1].split(" and ") if some else list("xyz") if "total momentum" in line else []
        found.append((int(numbers[0]), "".join(along), int(numbers[1])))
    return found


def relative(table, along="xyz"):
    """Twice the kinetic energy of translation without the constant total momentum."""
    return 2 * np.array(table["f_move[1]"]) - sum(np.array(table[f"v_c{k}"]) for k in along)


# --- effects of other fixes -----------------------------------------------------------------------

WALLS = "fix it all wall/lj93 zlo -0.1 1.0 1.0 2.5 zhi 6.1 1.0 1.0 2.5"
# Commands after the fix -> directions in which the total momentum is constant.
OTHERS = {
    "": "xyz",
    "fix it all store/force": "xyz",
    "fix it all setforce NULL NULL NULL": "xyz",
    "fix it all setforce NULL 0.0 NULL": "xyz",
    "fix it all addforce 0 0 0": "xyz",
    "fix it all aveforce NULL NULL NULL": "xyz",
    "fix it all viscous 0": "xyz",
    "fix it all restrain bond 1 5 0.5 0.5 1.0": "xyz",
    "fix it one spring couple two 1.0 1 1 1 1": "xyz",
    "fix it all efield 1.0 0.5 0.2": "xyz",
    "fix it all momentum 5 linear 1 1 1": "xyz",
    "fix it all external pf/array 1": "xyz",
    "group none empty\nfix it none addforce 0 0 1": "xyz",
    # springs of equal strength hold a center of mass at rest
    "fix it all spring/self 1.0": "xyz",
    "fix it one spring/self 1.0": "",
    "fix it all spring tether 1.0 3 3 3 0.0": "",
    "fix it all spring tether 1.0 NULL 3 NULL 0.0": "xz",
    "fix it all addforce 0 0 0.01": "xy",
    "fix it all aveforce NULL 0.1 NULL": "xz",
    "fix it all gravity 1.0 vector 1 0 1": "y",
    "set type 1 charge 0.6\nfix it all efield 1.0 0.0 0.0": "yz",
    "fix it one indent 10.0 cylinder z 0.5 0.2 1.0": "z",
    "fix it one viscous 0.3": "",
    WALLS: "xy",
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_fix_counts_by_what_it_does(lmp_tree, kind):
    """The log and the temperature of translation agree, also in the row of step 0."""
    words = f"temp 1.0 1.0 0.5 thermostat {kind}"
    bound = {WALLS: "f"}
    decks = [dumbbells(lmp_tree, after, words, bound=bound.get(after, "p")) for after in OTHERS]
    logs = lmp_tree.succeed(one_after_the_other(decks)).log.split("\nclear\n")
    for (after, along), log in zip(OTHERS.items(), logs):
        assert said(log)[-1] == (24 - len(along), along, 16), after
    runs = tables(lmp_tree.succeed(one_after_the_other(decks)))
    for (after, along), table in zip(OTHERS.items(), runs):
        later = after.endswith("spring/self 1.0") and not along  # not yet stretched at step 0
        found = relative(table, along)[later:] / table["f_move[10]"][later:]
        assert found == pytest.approx(24 - len(along), rel=1e-10), after
        others = [k for k in "xyz" if k not in along]
        assert all(table[f"v_c{k}"][-1] > 1e-9 for k in others), after
        assert all(table[f"v_c{k}"][-1] < 1e-25 for k in along), after
        assert table["f_move[11]"] == pytest.approx(2 * table["f_move[2]"] / 16, rel=1e-10)
    assert len(runs) == len(OTHERS)


def test_the_order_of_definition_does_not_matter(lmp_tree):
    """LAMMPS' setup has only the forces of fixes defined before ours."""
    field = "fix it all addforce 0 0 0.01"
    decks = [dumbbells(lmp_tree, after, WORDS, before, run="run 0") for after, before in ((field, ""), ("", field))]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert said(result.log) == 2 * [(22, "xy", 16)]
    one, other = result.thermo
    assert one["f_move[10]"] == pytest.approx(other["f_move[10]"], rel=1e-13)
    assert one["f_move[10]"][0] == pytest.approx(relative(one, "xy")[0] / 22, rel=1e-12)


def test_the_temperature_of_eight_dumbbells(lmp_tree):
    """An error of three in 37 degrees of freedom would be 8 %."""
    temperature = "variable T equal (2*(f_move[1]+f_move[2])-v_cx-v_cy-v_cz)/37"
    mean = "fix T all ave/time 10 9000 100000 v_T file mean"
    deck = dumbbells(lmp_tree, "fix it all store/force", run=f"run 10000\n{mean}\nrun 90000", every=100000)
    lmp_tree.succeed(deck.replace("thermo_style", f"{temperature}\nthermo_style"))
    found = float((lmp_tree.folder / "mean").read_text().split()[-1])
    assert found == pytest.approx(1.0, abs=0.03)
    assert found * 40 / 37 != pytest.approx(1.0, abs=0.03)


def test_atoms_outside_and_another_fix(lmp_tree):
    """External forces on the bodies need not be due to a fix."""
    atom = "create_atoms 1 single 0.2 0.2 1.7\ngroup bodies molecule > 0\ngroup free subtract all bodies"
    still = dumbbells(lmp_tree, before=atom)
    still = still.replace("fix move all", "fix move bodies").replace("all,", "bodies,").replace("(all)", "(bodies)")
    both = dumbbells(lmp_tree, "fix too others gear/quat molecule temp 1.0 1.0 0.5")
    both = both.replace("fix move all", "group some molecule 1 2 3\ngroup others subtract all some\nfix move some")
    log = lmp_tree.succeed(one_after_the_other([still, both])).log
    apart = [(6, "xyz", 6), (12, "xyz", 10)]  # until they collide
    assert said(log) == [(24, "", 16), *apart, (9, "", 6), (15, "", 10)]


def test_a_plane(lmp_tree):
    """Forces along z act on no degree of freedom; a field along y adds one again."""
    bodies = [[(0, 0, 0), (1, 0, 0)], [(0, 2, 0), (1, 2.2, 0)], [(2.5, 1, 0)]]
    settings = dict(bodies=bodies, dimension=2, box="-9 9 -9 9 -0.5 0.5", boundary="f f p")
    settings |= dict(after="fix flat all enforce2d", time=0.1)
    field = settings | dict(after="fix flat all enforce2d\nfix field all addforce 0 0.1 0")
    decks = [cluster(TEMP, **settings), cluster(TEMP, **field)]
    log = lmp_tree.succeed(one_after_the_other(decks)).log
    assert [one[::2] for one in said(log)] == [(4, 2), (5, 2)]
    assert "without those of the total momentum, and 2" in log
    assert "without those of the total momentum along x, and 2" in log


@pytest.mark.parametrize("mesh", ["pppm 1e-4", "pppm 1e-4\nkspace_modify diff ad"])
def test_a_mesh_is_no_force_from_outside(lmp_tree, mesh):
    """Forces that are derivatives of an interpolated energy do not add up to zero."""
    water = f"""
        units real
        atom_style full
        read_data {EXAMPLES / "water/data.water"}
        pair_style lj/cut/coul/long 8.0
        pair_coeff 1 1 0.1553 3.166
        pair_coeff 2 2 0.0 1.0
        pair_coeff 1 2 0.0 1.0
        kspace_style {mesh}
        neigh_modify exclude molecule/intra all
        fix move all gear/quat molecule temp 300 300 100
        compute f all reduce sum fx fy fz
        thermo_style custom step temp c_f[*]
        thermo 1
        run 5
        """
    decks = [water, water.replace("compute f", "fix field all addforce 0 0 0.05\ncompute f")]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert said(result.log) == [(1497, "xyz", 1500), (1498, "xy", 1500)]
    found = np.abs(result.thermo[0]["c_f[3]"]).max()
    assert found > 0.01 if "ad" in mesh else found < 1e-9


# --- forces that set in later ---------------------------------------------------------------------

LATER = "variable pull equal 0.2*(step>{})\nfix pull all addforce 0 v_pull 0\n"


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_a_force_that_sets_in_later(lmp_tree, ranks):
    """The conserved quantity continues, the vector is updated, and restarts and halves agree."""
    decks, parts = [], ("whole", "halves", "again")
    tail = {"whole": "run 60", "halves": "run 30\nwrite_restart half\nrun 30", "again": "run 30"}
    for part in parts:
        run = f"{tail[part]}\n{END.format(part)}"
        deck = cluster(f"{TEMP} thermostat separate", every=1, run=run, after=LATER.format(20))
        decks.append(continued(deck, "half") if part == "again" else deck)
    result = lmp_tree.succeed(one_after_the_other(decks), ranks=ranks)
    late = "since step 21 the forces on all bodies do not add up to zero, thermostat of 10 degrees"
    assert result.log.count(late) == 2 and "other degrees of freedom" not in result.log
    ends = [(lmp_tree.folder / f"{part}.end").read_text() for part in parts]
    assert ends[1] == ends[2] and (ranks > 1 or ends[0] == ends[1])
    whole, _, half, again = tables(result)
    for column in ("f_move[9]", "f_move[10]", "f_move[13]", "Econserve"):
        assert half[column][-1] == again[column][-1], column
        assert whole[column][-1] == pytest.approx(half[column][-1], rel=1e-11), column
    freedoms = 2 * whole["f_move[1]"] / whole["f_move[10]"]
    assert freedoms[:21] == pytest.approx(9, rel=1e-12) and 9.9 < freedoms[21] < 10.1
    assert np.ptp(whole["Econserve"][:21]) < 1e-3 < np.ptp(whole["TotEng"][:21])
    # energy removed by the chains: continuous when the degree of freedom is added
    power = 2 * whole["f_move[13]"] * whole["f_move[1]"] + 2 * whole["f_move[14]"] * whole["f_move[2]"]
    change = np.diff(whole["f_move[9]"])
    assert np.abs(change - 0.004 * (power[1:] + power[:-1]) / 2)[1:].max() < 1e-4
    assert np.abs(change).max() > 1e-3


def test_it_sets_in_while_the_step_changes(lmp_tree):
    words = f"{TEMP} tolerance 1e-8"
    settings = dict(columns="f_move[19]", every=1, run="run 60", after=LATER.format(20))
    result = lmp_tree.succeed(cluster(words, **settings))
    assert "since step 21 the forces" in result.log
    assert [one[0] for one in said(result.log)] == [9, 10]


def test_a_wall_that_is_left_still_counts(lmp_tree):
    """Between contacts the momentum is constant but still counts as heat: a second run and a restart continue."""
    settings = dict(after="fix wall all wall/harmonic zlo -3.2 100.0 0.0 1.0\n", every=1)
    settings["columns"] = "f_wall f_wall[1]"
    run = f"run 200\nwrite_restart half\nrun 100\n{END.format('halves')}"
    words = f"{TEMP} values 9"
    velocity = (0.0, 0.0, -2.0)
    deck = moving(words, velocity, run=run, **settings)
    rest = moving(words, velocity, run=f"run 100\n{END.format('again')}", **settings)
    again = re.sub("velocity all set.*", "", continued(rest, "half"))
    result = lmp_tree.succeed(one_after_the_other([deck, again]))
    first, second, _ = tables(result)
    touched = first["f_wall[1]"] != 0
    assert touched.any() and not touched[-1] and not second["f_wall[1]"][:10].any()
    assert [one[0] for one in said(result.log)] == [9, 10, 10]
    ends = [(lmp_tree.folder / f"{part}.end").read_text() for part in ("halves", "again")]
    assert ends[0] == ends[1]


def test_degrees_of_freedom_come_and_go(lmp_tree):
    """A field adds the momentum along it, and histories that start again without it remove it."""
    with_force = "fix pull all addforce 0 0 1\nrun 2\nunfix pull\nrun 2\n"
    result = lmp_tree.succeed(cluster(f"{TEMP} thermostat separate", run=4 * with_force))
    assert [one[0] for one in said(result.log)] == 4 * [10, 9]
    assert "or other degrees of freedom" in result.log


# --- a nonzero momentum ---------------------------------------------------------------------------


def moving(words, velocity, **settings):
    """The cluster with a common velocity."""
    shift = " ".join(f"{v:.17g}" for v in velocity)
    settings = dict(box="-90 90 -90 90 -90 90", style=f"velocity all set {shift} sum yes\n") | settings
    return cluster(words, **settings)


@pytest.mark.parametrize("kind", KINDS)
def test_a_common_motion_changes_nothing(lmp_tree, formulation, kind):
    """Poses in the moving frame, chains and temperatures are the same; the start includes this, too."""
    words = f"formulation {formulation} temp 0.4 0.8 0.3 thermostat {kind}"
    velocity = np.array([3.0, -2.0, 5.0])
    decks = [moving(words, u, dumped=name, every=1) for u, name in ((0 * velocity, ""), (velocity, "mol"))]
    decks = [deck.replace("poses.dump", f"poses{n}.dump") for n, deck in enumerate(decks)]
    still, boosted = tables(lmp_tree.succeed(one_after_the_other(decks)))
    for column in (10, 11, 13, 14, 2):
        name = f"f_move[{column}]"
        assert boosted[name] == pytest.approx(still[name], rel=1e-9, abs=1e-11), name
        assert np.ptp(still[name]) > 1e-3
    assert largest_change(boosted, "Econserve") < 2 * largest_change(still, "Econserve") + 1e-10
    ends = [last_frame(lmp_tree.folder / f"poses{n}.dump")[:, 1:7] for n in range(2)]
    motion = np.concatenate([velocity * still["Time"][-1], velocity])
    assert np.abs(ends[1] - ends[0] - motion).max() < 1e-9
    assert np.abs(ends[1] - ends[0]).max() > 1.0


def test_momentum_left_by_langevin(lmp_tree):
    """The common momentum is constant, does not count as heat, and changes nothing else."""
    before = "fix old all gear/quat molecule values 4\nfix bath all langevin 1 1 0.1 4711\nrun 100\n"
    before += "unfix bath\nunfix old"
    deck = dumbbells(lmp_tree, before=before, every=1, run="run 200")
    result = lmp_tree.succeed(deck)
    table = tables(result)[-1]
    assert said(result.log) == [(21, "xyz", 16)]
    assert relative(table) / table["f_move[10]"] == pytest.approx(21, rel=1e-10)
    for k in "xyz":
        assert table[f"v_c{k}"] == pytest.approx(table[f"v_c{k}"][0], rel=1e-9)
    energy = sum(table[f"v_c{k}"][0] for k in "xyz") / 2
    assert energy > 0.1
    told = re.search("move together with a kinetic energy of (.*) kT", result.log)
    assert float(told[1]) == pytest.approx(energy, rel=6e-3)


def test_the_advice_removes_it(lmp_tree):
    deck = moving(TEMP, (1.0, 0.0, 0.0), run="run 10\nvelocity all zero linear\nrun 10", style=COMMON)
    deck = deck.replace("run 10\n", "velocity all set 1 0 0 sum yes\nrun 10\n", 1)
    result = lmp_tree.succeed(deck.replace(COLUMNS, f"{COLUMNS} v_common"))
    first, second = tables(result)
    assert min(first["v_common"]) > 1.0 and max(second["v_common"]) < 1e-25
    assert result.log.count("move together") == 1


def test_bodies_that_only_move_together_are_cold(lmp_tree):
    deck = moving(TEMP, (1.0, 0.0, 0.0)).replace("velocity all create 0.6 4711 loop geom", "velocity all set 0 0 0")
    lmp_tree.refuse(deck, "kinetic energy of the bodies is zero apart from a common motion")


def test_a_single_body(lmp_tree):
    """A single body has no heat; a spring acts on it in the second step, and heats it."""
    alone = dict(bodies=[[(0.3, 0.1, 0.2)]], exclude="", time=0.2, columns="f_move[10] f_move[9]")
    decks = [cluster(TEMP, **alone), cluster(TEMP, after="fix it all spring/self 1.0\n", **alone)]
    decks = [deck.replace("velocity all create 0.6 4711 loop geom", "velocity all set 1 0.5 0.2") for deck in decks]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert said(result.log) == [(0, "xyz", 0), (0, "xyz", 0), (3, "", 0)]
    free, held = tables(result)
    assert set(free["f_move[10]"]) == set(free["f_move[9]"]) == {0.0}
    assert held["f_move[10]"][1:] == pytest.approx(2 * held["f_move[1]"][1:] / 3, rel=1e-12)
    assert abs(held["f_move[9]"][-1]) > 1e-2


def test_ranks(lmp_tree):
    """A heavy body among light bodies moves; the distribution of bodies over ranks does not matter."""
    ends, deck = [], moving(TEMP, (0.3, 0.2, 0.1), run="run 50\n" + END.format("a"), masses="mass 1 1.0\nmass 2 1000.0")
    heavy = deck.replace("set atom 4*6 mol 2", "set atom 4*6 mol 2 type 2")
    assert heavy != deck
    for ranks in (1, 2, 4):
        lmp_tree.succeed(heavy, ranks=ranks)
        ends.append(last_frame(lmp_tree.folder / "a.end"))
    assert max(np.abs(end - ends[0]).max() for end in ends) < 1e-11
