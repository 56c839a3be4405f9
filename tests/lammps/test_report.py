"""The report: effects that are on or off with their reasons, and the cost of the surroundings."""

import re
from fnmatch import fnmatchcase

import numpy as np
import pytest
from support.running import SCENES
from support.scenes import empty_box, last_frame, placed, random_rotation, two_molecules, water, whole_deck, write_data

TITLE = re.compile(r"^Fix gear/quat (\S+): (\d+) bodies of (.+) sites, (\d+) degrees of freedom$")
ROW = re.compile(r"^  (\S.{19}) (on |off)  (\S.*)$")
PAIRS = re.compile(r"^  (\d+) of (\d+) pairs in the neighbor lists \(\d+ %\) are (among|within)")


def lines_of(result):
    """Lines of the only report, title first; empty without one."""
    lines = result.log.splitlines()
    at = [k for k, line in enumerate(lines) if TITLE.match(line)]
    assert len(at) <= 1, "more than one report"
    if not at:
        return []
    end = next(k for k in range(at[0] + 1, len(lines)) if not lines[k].startswith("  "))
    return lines[at[0] : end]


def report(lmp, deck, variables=None, ranks=1):
    return lines_of(lmp.succeed(deck, variables, ranks=ranks))


def effects(lines):
    """Effect -> on or off, a space, the reason."""
    rows = [row.groups() for row in map(ROW.match, lines[1:]) if row]
    return {name.strip(): f"{state.strip()} {reason}" for name, state, reason in rows}


def proposals(lines):
    """Lines of the input script suggested in the report; two in a line are separated by ';'."""
    proposed = [line.strip().split("; ") for line in lines[1:] if line.startswith("    ")]
    return "\n".join(command for commands in proposed for command in commands)


def counted(lines):
    """Kind of pairs (among, within) -> (such pairs, all pairs)."""
    rows = [row.groups() for row in map(PAIRS.match, lines) if row]
    return {kind: (int(some), int(every)) for some, every, kind in rows}


# --- the keywords --------------------------------------------------------------------------------
def test_once_and_short_by_default(lmp_tree):
    lines = report(lmp_tree, two_molecules(after="run 2\nrun 2"))
    assert TITLE.match(lines[0]).groups() == ("move", "2", "3", "12")
    assert 5 <= len(effects(lines)) <= len(lines) - 1 <= 16


def test_no_is_silent(lmp_tree):
    assert report(lmp_tree, two_molecules("molecule report no")) == []


# --- effects -------------------------------------------------------------------------------------
SHAPES = {
    "points": ("0 0 0", 3),
    "linear": ("0 0 0, 1 0 0, 2 0 0", 5),
    "spherical tops": ("1 0 0, -1 0 0, 0 1 0, 0 -1 0, 0 0 1, 0 0 -1", 6),
    "symmetric tops": ("1 0 0, 0 1 0, -1 0 0, 0 -1 0", 6),
    "asymmetric tops": ("0 0 0, 1 0 0, 0 1.2 0.1", 6),
}


def bodies(*shapes, fix="molecule", apart=5, run="run 0", before="", **settings):
    """A deck with one body of each of the shapes along x, in a box that is not periodic."""
    sites = [np.array([site.split() for site in SHAPES[s][0].split(",")], float) for s in shapes]
    sites = [arms + [apart * k, 0, 0] for k, arms in enumerate(sites)]
    before = "pair_style lj/cut 3.0\npair_coeff * * 1.0 0.2\n" + before
    settings = dict(box="-10 30 -10 10 -10 10") | settings
    return placed(sites, fix=f"gear/quat {fix}", before=before, run=run, **settings)


KINDS = bodies("points", "linear", "asymmetric tops")
TOP = bodies("symmetric tops")
PLANE = dict(dimension=2, boundary="f f p", box="-10 30 -10 10 -0.5 0.5")
FLAT = bodies("linear", **PLANE)
SIZES = "set atom * mass 1.0\nset atom * diameter 0.0\nset atom 2 diameter "
POINTS, SPHERE = (
    bodies("asymmetric tops", style="hybrid sphere molecular", masses=SIZES + diameter)
    for diameter in ("0", "0.5")
)
QUIET = two_molecules(after="fix_modify move virial no\nfix drag all viscous 0.1\nrun 1")
APART = "processors 2 1 1\n" + two_molecules(boundary="f f f")
ACROSS = APART.replace("single 0.0 0.0 0.0", "single -0.5 0.0 0.0")
EFFECTS = [
    (KINDS, 1, "rotation", "on points: 1, linear: 1, asymmetric tops: 1"),
    # the middle of the three in a line and the point are at their centers
    (KINDS, 1, "torques of forces", "on 5 sites are off the center of mass"),
    (TOP, 1, "rotation", "on symmetric tops: 1"),
    (TOP.replace("single 1 ", "single 1.01 "), 1, "rotation", "on asymmetric tops: 1"),
    (FLAT, 1, "rotation", "on in a plane: 1"),
    (two_molecules(boundary="f p f"), 1, "images", "on periodic in y;*"),
    (two_molecules(boundary="f f f"), 1, "images", "off no direction is periodic"),
    (two_molecules(), 1, "virial", "on *"),
    (QUIET, 1, "virial", "off fix_modify virial no"),
    (two_molecules(), 1, "predicted velocities", "off *"),
    (QUIET, 1, "predicted velocities", "on fix drag (viscous) may read them"),
    (two_molecules("molecule compensate yes"), 1, "compensated sums", "on keyword compensate"),
    (SPHERE, 1, "finite size", "on 1 sites are more than points"),
    (POINTS, 1, "finite size", "off all sites are points"),
    (two_molecules(), 1, "ghost bodies", "off one rank"),
    (APART, 2, "ghost bodies", "off every site is on the rank of its body"),
    (ACROSS, 2, "ghost bodies", "on 1 sites have their body on another rank"),
]


@pytest.mark.parametrize("deck, ranks, effect, told", EFFECTS)
def test_effects_and_their_reasons(lmp_tree, deck, ranks, effect, told):
    rows = effects(report(lmp_tree, deck, ranks=ranks))
    assert fnmatchcase(rows[effect], told), rows[effect]


@pytest.mark.parametrize("shape", SHAPES)
def test_degrees_of_freedom_of_a_shape(lmp_tree, shape):
    lines = report(lmp_tree, bodies(shape, shape))
    assert TITLE.match(lines[0])[4] == str(2 * SHAPES[shape][1])
    on = "off" if shape == "points" else "on"
    assert effects(lines)["rotation"] == f"{on} {shape}: 2"
    assert effects(lines)["torques of forces"].split()[0] == on


def test_degrees_of_freedom_of_other_bodies(lmp_tree):
    for deck, told in ((KINDS, ("3", "1 to 3", "14")), (FLAT, ("1", "3", "3"))):
        assert TITLE.match(report(lmp_tree, deck)[0]).groups() == ("move", *told)


# --- surroundings --------------------------------------------------------------------------------
def cage(exclude="", fix="molecule", body="body"):
    """Test case 1 without its exclusions; exclude: lines after the neighbor settings."""
    deck = whole_deck(SCENES / "in.case1")
    wanted = "exclude group cage cage exclude molecule/intra body"
    assert wanted in deck
    deck = deck.replace(wanted, f"\n{exclude}")
    return deck.replace("fix move body ${style}", f"fix move {body} gear/quat {fix} ")


@pytest.mark.parametrize("fix, ranks", [("molecule", 2), ("single", 1)])
def test_pairs_that_move_nothing_are_found_and_mended(lmp_tree, fix, ranks):
    run = {"steps": 20, "every": 10}
    before = lmp_tree.succeed(cage(fix=fix), run, ranks=ranks)
    lines = lines_of(before)
    assert counted(lines) == {"among": (26 * 25 // 2, 30 * 29 // 2), "within": (6, 30 * 29 // 2)}
    after = lmp_tree.succeed(cage(proposals(lines), fix), run, ranks=ranks)
    assert counted(lines_of(after)) == {}
    old, new = before.thermo[-1], after.thermo[-1]
    for column in ("c_centre[1]", "v_ketrans", "v_kerot"):
        assert new[column] == pytest.approx(old[column], rel=1e-12)
    shift = np.subtract(old["c_potential"], new["c_potential"])
    assert np.ptp(shift) < 1e-11 and abs(shift[0]) > 0.1


def test_pairs_of_atoms_that_no_fix_moves(lmp_tree):
    """Each kind is reported separately; atoms moved by another fix are not counted."""

    def kinds(exclude, mover=""):
        deck = cage(f"neigh_modify exclude {exclude}")
        deck = deck.replace("fix move body", f"{mover}\nfix move body")
        return counted(report(lmp_tree, deck, {"steps": 0}))

    assert list(kinds("group cage cage")) == ["within"]
    assert list(kinds("molecule/intra body")) == ["among"]
    assert kinds("molecule/intra body", "fix other cage nve") == {}
    some = kinds("molecule/intra body", "group some id 5:14\nfix other some nve")
    assert some["among"][0] == 16 * 15 // 2


def test_a_group_is_proposed_where_there_is_none(lmp_tree):
    deck = cage().replace("group cage subtract all body", "")
    proposed = proposals(report(lmp_tree, deck, {"steps": 0}))
    assert "group still subtract all body\nneigh_modify exclude group still still" in proposed
    mended = deck.replace("fix move", proposed + "\nfix move")
    assert counted(report(lmp_tree, mended, {"steps": 0})) == {}


# --- omitted operations change nothing ------------------------------------------------------------


def test_a_lone_site_is_a_point_to_the_last_bit(lmp_tree):
    """A single atom stays at its position: no rounding of its center, for any mass."""
    deck = bodies("points", masses="mass * 0.3", steps=50, run="run 50")
    lmp_tree.succeed(deck.replace("single 0 0 0", "single 0.1 0.3 0.7"))
    assert list(last_frame(lmp_tree.folder / "poses.dump")[0, 1:4]) == [0.1, 0.3, 0.7]


# --- rounding of positions -----------------------------------------------------------------------
CARBON = np.array([12.011, 15.9994])  # masses of C and O
ROD = np.array([[0, 0, 0], [1.149, 0, 0], [-1.149, 0, 0]])


def carbon_dioxide(path, off=0.0):
    """64 molecules at random positions, across all boundaries; off: displacement of the middle, in Angstrom."""
    rng = np.random.default_rng(4711)
    atoms, length = [], 24.0
    for molecule, cell in enumerate(np.ndindex(4, 4, 4), 1):
        x = 6.0 * np.array(cell) + rng.uniform(-0.5, 0.5, 3) + (ROD + [[off, 0, 0], *2 * [[0, 0, 0]]]) @ random_rotation(rng)
        image = np.floor(x / length)
        atoms += np.column_stack([[molecule] * 3, [1, 2, 2], [0.0] * 3, x - length * image, image]).tolist()
    box = [f"0 {length} {axis}lo {axis}hi" for axis in "xyz"]
    velocities = np.zeros((len(atoms), 3)).tolist()
    return write_data(path, box, CARBON, atoms, velocities)


LENNARD_JONES = "pair_style lj/cut 8.0\npair_coeff 1 1 0.0559 2.757\npair_coeff * 2 0.16 3.033"


@pytest.mark.parametrize("off, sites, ranks", [(0.0, 128, 2), (1e-9, 192, 1)])
def test_a_middle_that_rounding_moves_is_at_the_center(lmp_tree, off, sites, ranks):
    data = carbon_dioxide(lmp_tree.folder / "data.co2", off)
    rows = effects(report(lmp_tree, water(data, run="run 0", pair=LENNARD_JONES), ranks=ranks))
    assert rows["torques of forces"] == f"on {sites} sites are off the center of mass"


def test_carbon_dioxide_with_three_decimals_is_linear(lmp_tree):
    """As data files have it; with two decimals, molecules are bent."""
    data = carbon_dioxide(lmp_tree.folder / "data.co2")
    head, atoms = data.read_text().split("Atoms", 1)
    for decimals, linear in ((3, True), (2, False)):
        rounded = re.sub(r"-?\d+\.\d{4,}(?:e-?\d+)?", lambda found: f"{float(found[0]):.{decimals}f}", atoms)
        (lmp_tree.folder / "data.rounded").write_text(f"{head}Atoms{rounded}")
        deck = water(lmp_tree.folder / "data.rounded", run="run 0", pair=LENNARD_JONES)
        assert ("tops" not in effects(report(lmp_tree, deck))["rotation"]) == linear


def test_atoms_at_the_same_place_are_a_point(lmp_tree):
    """For any masses; rounding of an arm does not become a moment of inertia."""
    atoms = "\n".join(["create_atoms 1 single 0.1 0.3 0.7"] * 2 + ["create_atoms 2 single 0.1 0.3 0.7"])
    masses = "set atom * mol 1\nmass 1 0.3\nmass 2 1.1"
    rows = effects(report(lmp_tree, empty_box(atoms, masses=masses, run="run 0")))
    assert rows["rotation"] == "off points: 1"
    assert rows["torques of forces"].startswith("off")


# --- pairs within bodies that interact ------------------------------------------------------------
ACTS = re.compile(r"WARNING: .*: pair style (\S+) acts between \d+ pairs of atoms within bodies;")
REMEDY = re.compile(r"the line that leaves them out(?: \([^)]*\))?: (.*?) \(src")


def dioxide(lmp, before="", fix="gear/quat molecule", pair=LENNARD_JONES, run="run 2", exclude=""):
    data = carbon_dioxide(lmp.folder / "data.co2")
    deck = water(data, fix, pair=pair, before=before, run=run, steps=2, dt=1.0)
    return deck.replace("check yes exclude molecule/intra all", f"check yes {exclude}")


def test_friction_within_bodies_is_no_constant(lmp_wheel):
    words = dict(style="sphere", masses="fix id all property/atom mol ghost yes\nset group all diameter 1.2 mass 1.0")
    words |= dict(before="comm_modify vel yes\npair_style gran/hooke 100.0 NULL 1.0 NULL 0.5 0\npair_coeff * *", exclude="", energies="pe", steps=1)
    atoms = "create_atoms 1 single 0 0 0\ncreate_atoms 1 single 1 0 0"
    said = lmp_wheel.succeed(empty_box(atoms, **words, fix="gear/quat single")).words
    assert ACTS.findall(said) == ["gran/hooke"] and "their friction may brake the rotation of bodies" in said


@pytest.mark.parametrize("words, ranks", [("molecule", 2), ("molecule report no", 1)])
def test_pairs_within_bodies_that_interact_are_named_and_mended(lmp_tree, words, ranks):
    first = lmp_tree.succeed(dioxide(lmp_tree, fix=f"gear/quat {words}"), ranks=ranks)
    assert ACTS.findall(first.output) == ["lj/cut"] and "do not move bodies" in first.words
    ((line),) = REMEDY.findall(first.output)
    assert line == "neigh_modify exclude molecule/intra all"
    ends = [last_frame(lmp_tree.folder / "poses.dump")]
    mended = lmp_tree.succeed(dioxide(lmp_tree, line, f"gear/quat {words}"), ranks=ranks)
    assert not ACTS.search(mended.output)
    ends.append(last_frame(lmp_tree.folder / "poses.dump"))
    assert ends[1] == pytest.approx(ends[0], abs=1e-6)  # compared with an energy of millions
    shift = np.subtract(first.thermo[0]["PotEng"], mended.thermo[0]["PotEng"])
    assert shift.min() > 1e5 and np.ptp(shift) < 1e-6 * shift[0]


def test_the_remedy_for_each_body_style(lmp_tree):
    bodies = [np.add([[0, 0, 0], [0.9, 0, 0], [0.4, 0.8, 0]], [4.0 * k, 0, 0]) for k in range(2)]
    pair = "pair_style lj/cut 3.0\npair_coeff * * 0.1 1.0\ngroup g0 id 1:3\ngroup g1 id 4:6\n"
    for words, line in (
        ("molecule", "neigh_modify exclude molecule/intra all"),
        ("single", "neigh_modify exclude group all all"),
        ("group 2 g0 g1", "neigh_modify exclude group g0 g0 exclude group g1 g1"),
    ):
        deck = placed(bodies, fix=f"gear/quat {words}", before=pair, run="run 2", steps=2, exclude="")
        result = lmp_tree.succeed(deck)
        assert ACTS.findall(result.output) == ["lj/cut"]
        assert REMEDY.findall(result.output) == [line]
        mended = lmp_tree.succeed(deck.replace("fix move all", f"{line}\nfix move all"))
        assert not ACTS.search(mended.output)


BONDED = """
bond_style zero
bond_coeff *
create_bonds many all all 1 1.1 1.2
"""
COULOMB = """
pair_style lj/cut/coul/long 8.0
pair_coeff * * 0.1 3.0
kspace_style ewald 1e-4
set type 1 charge 0.6
set type 2 charge -0.3
"""
HANDLED = {
    "exclusion": dict(exclude="exclude molecule/intra all"),
    "special bonds": dict(before=BONDED),
    "special bonds beside kspace": dict(before=BONDED + COULOMB),
    "no forces": dict(pair="pair_style zero 8.0\npair_coeff * *"),
    "beyond the cutoff": dict(pair="pair_style lj/cut 1.1\npair_coeff * * 0.1 1.0"),
}


@pytest.mark.parametrize("name", HANDLED)
def test_no_word_where_pairs_within_bodies_do_not_interact(lmp_tree, name):
    room = "extra/bond/per/atom 2 extra/special/per/atom 4"
    deck = dioxide(lmp_tree, **HANDLED[name])
    data = lmp_tree.folder / "data.co2"
    if "bond" in HANDLED[name].get("before", ""):
        data.write_text(data.read_text().replace("atom types", "atom types\n1 bond types", 1))
        deck = deck.replace(f"read_data {data}", f"read_data {data} {room}")
    assert not ACTS.search(lmp_tree.succeed(deck).output)
    if name == "special bonds":  # with partial weights
        deck = deck.replace("bond_style", "special_bonds lj 0 0.5 1\nbond_style")
        assert ACTS.search(lmp_tree.succeed(deck).output)


def test_no_word_of_a_body_that_meets_its_own_image(lmp_tree):
    near = two_molecules(before="pair_style lj/cut 10\npair_coeff * * 1 0.5", after="run 0")
    assert ACTS.search(lmp_tree.succeed(near.replace("lj/cut 10", "lj/cut 2")).output)
    assert not ACTS.search(lmp_tree.succeed(near.replace("-10 10 -10 10 -10 10", "-4 8 -4 8 -4 8")).output)
