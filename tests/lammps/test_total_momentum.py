"""Keyword temp: by a rule, the total momentum is not heat in directions in which it is constant.

The rule depends on the box, the atoms and the styles of a run, and on nothing that happens in the run.
"""

import re

import numpy as np
import pytest
from support.running import EXAMPLES
from support.scenes import largest_change, last_frame, one_after_the_other, template, water
from support.constant_temperature import KINDS, TEMP, cluster
from support.step_control import tables

DUMBBELL = template([(-0.3, 0, 0), (0.3, 0, 0)], [1, 2], bonds=[(1, 2)])
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
        some = re.search("without those of the total momentum(?: along (.*?))?,", line)
        along = some[1].split(" and ") if some and some[1] else list("xyz") if some else []
        found.append((int(numbers[0]), "".join(along), int(numbers[1])))
    return found


def relative(table, along="xyz"):
    """Twice the kinetic energy of translation without the constant total momentum."""
    return 2 * np.array(table["f_move[1]"]) - sum(np.array(table[f"v_c{k}"]) for k in along)


# --- the rule -------------------------------------------------------------------------------------

WALLS = "fix it all wall/lj93 zlo -0.1 1.0 1.0 2.5 zhi 6.1 1.0 1.0 2.5"
# Commands after the fix -> directions in which the total momentum does not count.
OTHERS = {
    "": "xyz",
    "fix it all store/force": "xyz",
    "fix it all ave/time 1 5 5 f_move[1]": "xyz",
    "fix it all addforce 0 0 0": "",
    "fix it all addforce 0 0 0.01": "",
    "fix it one spring/self 1.0": "",
    "fix it one spring tether 1.0 NULL 3 NULL 0.0": "",
    "fix it one spring couple two 1.0 1 1 1 1": "",
    "fix it all gravity 1.0 vector 1 0 1": "",
    "fix it one viscous 0.3": "",
    WALLS: "",
    "run 0\nfix_modify move extra/dof 0": "",
    "fix it one spring couple two 1.0 1 1 1 1\nfix_modify move extra/dof 3": "xyz",
}


@pytest.mark.parametrize("kind", KINDS)
def test_a_fix_that_may_exert_forces_counts(lmp_tree, kind):
    """The log and the temperature of translation agree, also in the row of step 0."""
    words = f"temp 1.0 1.0 0.5 thermostat {kind}"
    bound = {WALLS: "f"}
    decks = [dumbbells(lmp_tree, after, words, bound=bound.get(after, "p")) for after in OTHERS]
    result = lmp_tree.succeed(one_after_the_other(decks))
    for (after, along), log in zip(OTHERS.items(), result.log.split("\nclear\n")):
        freedoms, of_total, of_rotation = said(log)[-1]
        assert (freedoms, of_rotation) == (24 - len(along), 16), after
        assert of_total == along or "extra/dof 3" in after, after
        assert ("total momentum because fix it" in log) == (not along and "fix it" in after), after
    runs = tables(result)
    assert len(runs) == len(OTHERS) + 1
    for (after, along), table in zip(OTHERS.items(), [run for run in runs if len(run["Step"]) > 1]):
        found = relative(table, along) / table["f_move[10]"]
        assert found == pytest.approx(24 - len(along), rel=1e-10), after
        assert table["f_move[11]"] == pytest.approx(2 * table["f_move[2]"] / 16, rel=1e-10)


def test_only_periodic_directions(lmp_tree):
    """A free cluster counts, unless the user knows better."""
    decks = [dumbbells(lmp_tree, bound="f"), dumbbells(lmp_tree, "fix_modify move extra/dof 3", bound="f")]
    log = lmp_tree.succeed(one_after_the_other(decks)).log
    assert said(log) == [(22, "xy", 16), (21, "", 16)]
    assert "of translation, without 3 by fix_modify extra/dof, and 16 of rotation" in log


@pytest.mark.parametrize("words, number, message", [
    ("", 3, "keywords of neither are in the command"),
    (WORDS, -1, "0 or more"),
    (WORDS, 25, "fix_modify extra/dof leave the bodies no degrees of freedom"),
])
def test_numbers_that_are_refused(lmp_tree, words, number, message):
    deck = dumbbells(lmp_tree, f"fix_modify move extra/dof {number}", words)
    lmp_tree.refuse(deck.replace("f_move[10] f_move[11]", ""), message, ranks=2)


def test_the_order_of_definition_does_not_matter(lmp_tree):
    field = "fix it all addforce 0 0 0.01"
    decks = [dumbbells(lmp_tree, after, WORDS, before, run="run 0") for after, before in ((field, ""), ("", field))]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert said(result.log) == 2 * [(24, "", 16)]
    one, other = result.thermo
    assert one["f_move[10]"] == pytest.approx(other["f_move[10]"], rel=1e-13)
    assert one["f_move[10]"][0] == pytest.approx(relative(one, "")[0] / 24, rel=1e-12)


def test_atoms_outside_and_another_fix(lmp_tree):
    """Bodies of another fix are atoms outside, too; atoms that another fix inserts count from then on."""
    atom = "create_atoms 1 single 0.2 0.2 1.7\ngroup bodies molecule > 0\ngroup free subtract all bodies"
    still = dumbbells(lmp_tree, before=atom)
    still = still.replace("fix move all", "fix move bodies").replace("all,", "bodies,").replace("(all)", "(bodies)")
    both = dumbbells(lmp_tree, "fix too others gear/quat molecule temp 1.0 1.0 0.5")
    both = both.replace("fix move all", "group some molecule 1 2 3\ngroup others subtract all some\nfix move some")
    log = lmp_tree.succeed(one_after_the_other([still, both])).log
    assert said(log) == [(24, "", 16), (9, "", 6), (15, "", 10)]
    assert "because 1 atoms are in no body of this fix" in log and "because 10 atoms" in log


def test_bodies_that_other_fixes_insert_bring_momentum(lmp_tree):
    """A stream of inserted bodies would otherwise drift for good."""
    log = lmp_tree.succeed(dumbbells(lmp_tree, words=f"{WORDS} mol d")).log
    assert said(log) == [(24, "", 16)]
    assert "because keyword mol takes in bodies that other fixes insert" in log


def test_held_bodies_count(lmp_tree):
    """A body that keyword force holds exerts forces on the others, in the directions in which it is held."""
    log = lmp_tree.succeed(dumbbells(lmp_tree, words=f"{WORDS} force 1 off on on")).log
    assert said(log) == [(21, "yz", 16)]


def test_a_plane(lmp_tree):
    """Forces along z act on no degree of freedom."""
    bodies = [[(0, 0, 0), (1, 0, 0)], [(0, 2, 0), (1, 2.2, 0)], [(2.5, 1, 0)]]
    settings = dict(bodies=bodies, dimension=2, box="-9 9 -9 9 -0.5 0.5", after="fix flat all enforce2d", time=0.1)
    decks = [cluster(TEMP, **settings, boundary=bound) for bound in ("p p p", "p f p")]
    log = lmp_tree.succeed(one_after_the_other(decks)).log
    assert [one[::2] for one in said(log)] == [(4, 2), (5, 2)]
    assert "without those of the total momentum, and 2" in log
    assert "without those of the total momentum along x, and 2" in log


@pytest.mark.parametrize("mesh", ["pppm 1e-4", "pppm 1e-4\nkspace_modify diff ad"])
def test_a_mesh_is_no_force_from_outside(lmp_tree, mesh):
    """Forces that are derivatives of an interpolated energy do not add up to zero."""
    pair = f"pair_style lj/cut/coul/long 8.0\npair_coeff * * 0.0 1.0\npair_coeff 1 1 0.1553 3.166\nkspace_style {mesh}"
    settings = dict(before="velocity all create 300.0 4711", after="compute f all reduce sum fx fy fz", columns="c_f[3]")
    deck = water(EXAMPLES / "water/data.water", "gear/quat molecule temp 300 300 100", dt=1.0, steps=5, thermo=1, pair=pair, **settings)
    result = lmp_tree.succeed(deck.replace("fix_modify move energy yes", ""))
    assert said(result.log) == [(645, "xyz", 648)]
    found = np.abs(result.thermo[0]["c_f[3]"]).max()
    assert found > 0.01 if "ad" in mesh else found < 1e-9


# --- from rest ------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
def test_bodies_at_rest_warm_up(lmp_tree, kind):
    """Forces move them, and the thermostat adds the rest; the conserved quantity is constant from the start."""
    words = f"temp 1.0 1.0 0.5 thermostat {kind}"
    deck = dumbbells(lmp_tree, words=words, columns="econserve pe", every=20, run="run 6000")
    deck = deck.replace("velocity all create 1.0 4711 loop geom", "").replace("0.037037037", "0.06")
    result = lmp_tree.succeed(deck.replace("0 6 0 6 0 6", "0 5.108 0 5.108 0 5.108"))
    table = tables(result)[0]
    for column in ("f_move[10]", "f_move[11]"):
        assert table[column][0] == 0.0 and max(table[column]) < 20.0
        assert np.mean(table[column][150:]) == pytest.approx(1.0, abs=0.25)
    assert largest_change(table, "Econserve") < 0.1 * 20  # the cutoff costs energy, too


def test_nothing_moves_bodies_at_rest(lmp_tree):
    """Without forces they stay at rest."""
    deck = dumbbells(lmp_tree, words="temp 1.0 1.0 0.05", run="run 400").replace("lj/cut 2.5", "zero 2.5")
    deck = deck.replace("pair_coeff * * 1.0 1.0", "pair_coeff * *")
    result = lmp_tree.succeed(deck.replace("velocity all create 1.0 4711 loop geom", ""))
    assert not any(tables(result)[0]["f_move[1]"])


# --- changes between runs ---------------------------------------------------------------------------


def test_degrees_of_freedom_come_and_go(lmp_tree):
    """A field adds those of the total momentum for its runs, and histories start again."""
    with_force = "fix pull all addforce 0 0 1\nrun 2\nunfix pull\nrun 2\n"
    result = lmp_tree.succeed(cluster(f"{TEMP} thermostat separate", run=4 * with_force, boundary="p p p"))
    assert [one[0] for one in said(result.log)] == 4 * [12, 9]
    assert "or the degrees of freedom differ" in result.log


# --- a nonzero momentum ---------------------------------------------------------------------------


def moving(words, velocity, **settings):
    """The cluster with a common velocity."""
    shift = " ".join(f"{v:.17g}" for v in velocity)
    settings = dict(box="-90 90 -90 90 -90 90", boundary="p p p", style=f"velocity all set {shift} sum yes\n") | settings
    return cluster(words, **settings)


@pytest.mark.parametrize("kind", KINDS)
def test_a_common_motion_changes_nothing(lmp_tree, kind):
    """Poses in the moving frame, chains and temperatures are the same; the start includes this, too."""
    words = f"temp 0.4 0.8 0.3 thermostat {kind}"
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


def test_a_single_body(lmp_tree):
    """Alone in a periodic box a body has no heat; a tether adds its momentum."""
    alone = dict(bodies=[[(0.3, 0.1, 0.2)]], exclude="", time=0.2, columns="f_move[10] f_move[9]", boundary="p p p")
    decks = [cluster(TEMP, **alone), cluster(TEMP, after="fix it all spring/self 1.0\n", **alone)]
    decks = [deck.replace("velocity all create 0.6 4711 loop geom", "velocity all set 1 0.5 0.2") for deck in decks]
    result = lmp_tree.succeed(one_after_the_other(decks))
    assert said(result.log) == [(0, "xyz", 0), (3, "", 0)]
    free, held = tables(result)
    assert set(free["f_move[10]"]) == set(free["f_move[9]"]) == {0.0}
    assert held["f_move[10]"] == pytest.approx(2 * held["f_move[1]"] / 3, rel=1e-12)
    assert abs(held["f_move[9]"][-1]) > 1e-2
