"""The scene report: effects on or off with their reasons, and what the surroundings cost."""

import re

import pytest
from scenes import last_frame, two_molecules, water, water_data, whole_deck

TITLE = re.compile(r"^Fix gear/quat (\S+): (\d+) bodies of (.+) sites, (\d+) degrees of freedom$")
ROW = re.compile(r"^  (\S.{19}) (on |off)  (\S.*)$")
PAIRS = re.compile(r"^  (\d+) of (\d+) pairs in the neighbor lists \(\d+ %\) are (among|within)")


def report(result):
    """Lines of the first report, title first; none without one."""
    assert result.returncode == 0, result.output
    lines = result.log.splitlines()
    at = [k for k, line in enumerate(lines) if TITLE.match(line)]
    assert len(at) <= 1, "more than one report"
    if not at:
        return []
    end = next(k for k in range(at[0] + 1, len(lines)) if not lines[k].startswith("  "))
    return lines[at[0] : end]


def effects(lines):
    """Effect -> (on or off, reason)."""
    rows = [found.groups() for found in map(ROW.match, lines[1:]) if found]
    return {name.strip(): (state.strip(), reason) for name, state, reason in rows}


def proposals(lines):
    """Lines of the input script that the report proposes; two of a line are separated by ';'."""
    proposed = [line.strip().split("; ") for line in lines[1:] if line.startswith("    ")]
    return "\n".join(command for commands in proposed for command in commands)


# --- the words -----------------------------------------------------------------------------------
def test_once_and_short_by_default(lmp):
    lines = report(lmp.run(two_molecules(after="run 2\nrun 2")))
    assert TITLE.match(lines[0]).groups() == ("move", "2", "3", "12")
    assert 5 <= len(effects(lines)) <= len(lines) - 1 <= 14


def test_no_is_silent(lmp_tree):
    assert report(lmp_tree.run(two_molecules("molecule report no"))) == []


def test_long_says_what_is_left_out(lmp_tree):
    lines = report(lmp_tree.run(two_molecules("molecule report long", boundary="f f f")))
    rows = [k for k, line in enumerate(lines) if ROW.match(line)]
    for k in rows:
        state = ROW.match(lines[k])[2].strip()
        told = k + 1 < len(lines) and lines[k + 1].strip().startswith("leaves out ")
        assert told == (state == "off"), lines[k]
    bound = re.search(r"rounding of a coordinate, at most (\S+) of", "\n".join(lines))
    assert 0.5 * 2.0**-52 * 5 < float(bound[1]) < 0.5 * 2.0**-52 * 6


@pytest.mark.parametrize("ranks", [1, 2])
def test_another_word_is_refused(lmp_tree, ranks):
    result = lmp_tree.run(two_molecules("molecule report maybe"), ranks=ranks)
    assert result.returncode != 0
    assert "Fix gear/quat report: unknown value maybe (no, short or long)" in result.errors[0]


# --- effects -------------------------------------------------------------------------------------
SHAPES = {
    "points": ("0 0 0", 3),
    "linear": ("0 0 0, 1 0 0, 2 0 0", 5),
    "spherical tops": ("1 0 0, -1 0 0, 0 1 0, 0 -1 0, 0 0 1, 0 0 -1", 6),
    "symmetric tops": ("1 0 0, 0 1 0, -1 0 0, 0 -1 0", 6),
    "asymmetric tops": ("0 0 0, 1 0 0, 0 1.2 0.1", 6),
}


def bodies(*shapes, style="molecular", before="", after="run 0", fix="molecule", apart=5):
    """A deck with one body of each of the shapes along x, in a box that is not periodic."""
    lines, first = [], 1
    for k, shape in enumerate(shapes):
        sites = [[float(x) for x in site.split()] for site in SHAPES[shape][0].split(",")]
        for x, y, z in sites:
            lines.append(f"create_atoms 1 single {x + apart * k} {y} {z}")
        lines.append(f"set atom {first}*{first + len(sites) - 1} mol {k + 1}")
        first += len(sites)
    return "\n".join(
        [
            "units lj",
            f"atom_style {style}",
            "atom_modify map array",
            "boundary f f f",
            "region box block -10 30 -10 10 -10 10",
            "create_box 1 box",
            *lines,
            "set type 1 mass 1.0" if "sphere" in style else "mass 1 1.0",
            "pair_style lj/cut 3.0\npair_coeff * * 1.0 0.2",
            "neigh_modify exclude molecule/intra all",
            before,
            f"fix move all gear/quat {fix}",
            after,
        ]
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_kinds_of_bodies(lmp_tree, shape):
    lines = report(lmp_tree.run(bodies(shape, shape)))
    assert TITLE.match(lines[0])[4] == str(2 * SHAPES[shape][1])
    on = "off" if shape == "points" else "on"
    assert effects(lines)["rotation"] == (on, f"{shape}: 2")
    assert effects(lines)["torques of forces"][0] == on


def test_mixed_bodies(lmp):
    lines = report(lmp.run(bodies("points", "linear", "asymmetric tops")))
    assert TITLE.match(lines[0]).groups() == ("move", "3", "1 to 3", "14")
    assert effects(lines)["rotation"] == ("on", "points: 1, linear: 1, asymmetric tops: 1")
    # the middle of the three in a line and the point are at their centres
    assert effects(lines)["torques of forces"] == ("on", "5 sites are off the center of mass")


def test_nearly_equal_moments_are_not_equal(lmp_tree):
    deck = bodies("symmetric tops")
    assert effects(report(lmp_tree.run(deck)))["rotation"][1] == "symmetric tops: 1"
    stretched = deck.replace("single 1.0 0.0 0.0", "single 1.01 0.0 0.0")
    assert effects(report(lmp_tree.run(stretched)))["rotation"][1] == "asymmetric tops: 1"


def test_flat_models_turn_about_one_axis(lmp_tree):
    deck = bodies("linear").replace("boundary f f f", "dimension 2\nboundary f f p")
    deck = deck.replace("-10 10 -10 10\n", "-10 10 -0.5 0.5\n")
    lines = report(lmp_tree.run(deck))
    assert TITLE.match(lines[0])[4] == "3"
    assert effects(lines)["rotation"] == ("on", "in a plane: 1")


def test_images_only_in_periodic_directions(lmp_tree):
    found = effects(report(lmp_tree.run(two_molecules(boundary="f p f"))))
    assert found["images"][0] == "on" and found["images"][1].startswith("periodic in y;")
    found = effects(report(lmp_tree.run(two_molecules(boundary="f f f"))))
    assert found["images"] == ("off", "no direction is periodic")


def test_virial_and_readers_of_velocities(lmp_tree):
    found = effects(report(lmp_tree.run(two_molecules())))
    assert found["virial"][0] == "on" and found["predicted velocities"][0] == "off"
    after = "fix_modify move virial no\nfix drag all viscous 0.1\nrun 1"
    found = effects(report(lmp_tree.run(two_molecules(after=after))))
    assert found["virial"] == ("off", "fix_modify virial no")
    assert found["predicted velocities"] == ("on", "fix drag (viscous) may read them")


def test_compensated_sums(lmp_tree):
    found = effects(report(lmp_tree.run(two_molecules("molecule compensate yes"))))
    assert found["compensated sums"] == ("on", "compensate yes")


def test_finite_size(lmp_tree):
    before = "set atom 1 diameter 0.0\nset atom 2 diameter 0.5\nset atom 3 diameter 0.0"
    deck = bodies("asymmetric tops", style="hybrid sphere molecular", before=before)
    deck = deck.replace("set type 1 mass 1.0", "set atom * mass 1.0")
    found = effects(report(lmp_tree.run(deck)))
    assert found["finite size"] == ("on", "1 sites are more than points")
    found = effects(report(lmp_tree.run(deck.replace("0.5\nset", "0.0\nset"))))
    assert found["finite size"] == ("off", "all sites are points")


def test_ghost_bodies(lmp):
    found = effects(report(lmp.run(two_molecules())))
    assert found["ghost bodies"] == ("off", "one rank")
    deck = "processors 2 1 1\n" + two_molecules(boundary="f f f")
    found = effects(report(lmp.run(deck, ranks=2)))
    assert found["ghost bodies"] == ("off", "every site is on the rank of its body")
    across = deck.replace("single 0.0 0.0 0.0", "single -0.5 0.0 0.0")
    found = effects(report(lmp.run(across, ranks=2)))
    assert found["ghost bodies"] == ("on", "1 sites have their body on another rank")


# --- surroundings --------------------------------------------------------------------------------
def cage(examples, exclude="", fix="molecule", body="body"):
    """Test case 1 without its exclusions; exclude: lines after the neighbor settings."""
    deck = whole_deck(examples / "case1" / "in.case1")
    wanted = "exclude group cage cage exclude molecule/intra body"
    assert wanted in deck
    deck = deck.replace(wanted, f"\n{exclude}")
    return deck.replace("fix move body ${style}", f"fix move {body} gear/quat {fix} ")


def counted(lines):
    """Kind of pairs (among, within) -> (such pairs, all pairs)."""
    rows = [found.groups() for found in map(PAIRS.match, lines) if found]
    return {kind: (int(some), int(every)) for some, every, kind in rows}


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("fix", ["molecule", "single"])
def test_pairs_that_move_nothing_are_found_and_mended(lmp_tree, examples, fix, ranks):
    run = {"steps": 20, "every": 10}
    before = lmp_tree.run(cage(examples, fix=fix), run, ranks=ranks)
    lines = report(before)
    assert counted(lines) == {"among": (26 * 25 // 2, 30 * 29 // 2), "within": (6, 30 * 29 // 2)}
    after = lmp_tree.run(cage(examples, proposals(lines), fix), run, ranks=ranks)
    assert counted(report(after)) == {}
    old, new = before.thermo[-1], after.thermo[-1]
    for column in ("c_centre[1]", "v_ketrans", "v_kerot"):
        assert new[column] == pytest.approx(old[column], rel=1e-12)
    shift = [a - b for a, b in zip(old["c_potential"], new["c_potential"])]
    assert shift == pytest.approx([shift[0]] * 3, abs=1e-11) and abs(shift[0]) > 0.1


def test_each_is_told_alone(lmp_tree, examples):
    run = {"steps": 0}
    one = cage(examples, "neigh_modify exclude group cage cage")
    assert list(counted(report(lmp_tree.run(one, run)))) == ["within"]
    other = cage(examples, "neigh_modify exclude molecule/intra body")
    assert list(counted(report(lmp_tree.run(other, run)))) == ["among"]


def test_a_group_is_proposed_where_there_is_none(lmp_tree, examples):
    deck = cage(examples).replace("group cage subtract all body", "")
    lines = report(lmp_tree.run(deck, {"steps": 0}))
    assert "group still subtract all body\nneigh_modify exclude group still still" in proposals(
        lines
    )
    mended = deck.replace("fix move", proposals(lines) + "\nfix move")
    assert counted(report(lmp_tree.run(mended, {"steps": 0}))) == {}


def test_atoms_that_another_fix_moves_are_not_reported(lmp_tree, examples):
    exclude = "neigh_modify exclude molecule/intra body"
    deck = cage(examples, exclude).replace("fix move body", "fix other cage nve\nfix move body")
    assert counted(report(lmp_tree.run(deck, {"steps": 0}))) == {}
    some = deck.replace("fix other cage nve", "group some id 5:14\nfix other some nve")
    assert counted(report(lmp_tree.run(some, {"steps": 0})))["among"][0] == 16 * 15 // 2


def test_two_fixes_of_this_style(lmp_tree):
    two = "fix other right gear/quat molecule report no\nrun 0"
    deck = two_molecules("molecule", "group left id 1:3\ngroup right id 4:6", two)
    deck = deck.replace("fix move all", "fix move left")
    lines = report(lmp_tree.run(deck))
    assert counted(lines) == {"within": (3, 6)}
    assert proposals(lines) == "neigh_modify exclude molecule/intra left"


def test_pairs_beyond_the_list_are_not_counted(lmp):
    deck = bodies("points", "points", "points", after="run 0").replace(
        "fix move all", "fix move few"
    )
    deck = deck.replace("fix move", "group few id 1\nfix move")
    assert counted(report(lmp.run(deck))) == {}  # two fixed atoms, 5 apart
    near = deck.replace("single 10.0 0.0 0.0", "single 6.0 0.0 0.0")
    assert counted(report(lmp.run(near)))["among"] == (1, 1)


def test_atoms_that_no_body_uses(lmp):
    groups = "group left id 1:2\ngroup right id 4:6"
    deck = two_molecules("group 2 left right", groups)
    lines = report(lmp.run(deck))
    assert "  1 atoms of group all are in no body, all of them moved by no fix; " in "\n".join(
        lines
    )
    proposed = proposals(lines).splitlines()
    assert "neigh_modify exclude group left left exclude group right right" in proposed
    assert "group bodies union left right" in proposed
    mended = two_molecules("group 2 left right", groups + "\ngroup bodies union left right")
    text = "\n".join(report(lmp.run(mended.replace("fix move all", "fix move bodies"))))
    assert "in no body" not in text
    moved = two_molecules("group 2 left right", groups + "\ngroup third id 3\nfix third third nve")
    assert "in no body, 0 of them moved by no fix" in "\n".join(report(lmp.run(moved)))


# --- what is left out changes nothing ------------------------------------------------------------
MIXED = """
dump poses all custom 50 mixed.dump id x y z vx vy vz
dump_modify poses sort id format float %.17g
"""


def mixed(steps, formulation="second"):
    """Points, a rod and an asymmetric body that attract each other, across several ranks."""
    shapes = "points", "linear", "asymmetric tops", "points", "linear"
    deck = bodies(*shapes, after="", fix=f"molecule formulation {formulation}", apart=4)
    deck = deck.replace("-10 30", "-10 20")  # four ranks: a border in a rod
    deck = deck.replace("lj/cut 3.0", "lj/cut 50.0").replace("1.0 0.2", "1.0 1.5")
    return f"{deck}\nvelocity all create 1.0 4711 loop geom\ntimestep 0.002{MIXED}run {steps}\n"


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_points_among_tops_on_several_ranks(lmp_tree, formulation):
    """On four ranks bodies have ghosts or not, on one none: the same to rounding."""
    ends = []
    for ranks in (1, 4):
        result = lmp_tree.run("processors * 1 1\n" + mixed(50, formulation), ranks=ranks)
        assert effects(report(result))["ghost bodies"][0] == ("on" if ranks > 1 else "off")
        ends.append(last_frame(lmp_tree.folder / "mixed.dump"))
    assert ends[1] == pytest.approx(ends[0], abs=1e-12)
    start = lmp_tree.run(mixed(0, formulation))
    assert start.returncode == 0
    moved = ends[0][:, 1:] - last_frame(lmp_tree.folder / "mixed.dump")[:, 1:]
    assert abs(moved).max(axis=1).min() > 1e-3  # all of them


def test_a_lone_site_is_a_point_to_the_last_bit(lmp_tree):
    """An atom alone stays where it is placed: no rounding of its centre, whatever its mass."""
    deck = bodies("points").replace("single 0.0 0.0 0.0", "single 0.1 0.3 0.7")
    deck = deck.replace("mass 1 1.0", "mass 1 0.3").replace("run 0", "") + MIXED + "run 50"
    result = lmp_tree.run(deck)
    assert result.returncode == 0, result.output
    assert list(last_frame(lmp_tree.folder / "mixed.dump")[0, 1:4]) == [0.1, 0.3, 0.7]


# --- what is worth it ----------------------------------------------------------------------------
def kspace(data, exclude=""):
    deck = water(data, "gear/quat molecule", dt=0.5, steps=40, before=exclude)
    deck = deck.replace("check yes exclude molecule/intra all", "check yes")
    deck = re.sub("pair_style.*", "pair_style coul/long 4.0\nkspace_style ewald 1.0e-10", deck)
    return re.sub("pair_coeff 1 1.*\npair_coeff.*\npair_coeff.*", "pair_coeff * *", deck)


def test_exclusions_with_kspace_change_a_constant(lmp_tree):
    """And the report says that LAMMPS will warn; the motion is the same."""
    data = water_data(lmp_tree.folder / "data.water", shift=1.65)
    ends = []
    for exclude in ("", "neigh_modify exclude molecule/intra all"):
        result = lmp_tree.run(kspace(data, exclude))
        text = "\n".join(report(result))
        assert ("LAMMPS then warns of exclusions with a kspace style" in text) == (not exclude)
        assert ("exclusions used with KSpace" in result.output) == bool(exclude)
        ends.append((result.thermo[-1], last_frame(lmp_tree.folder / "poses.dump")))
    (table, frame), (excluded, excluded_frame) = ends
    assert excluded_frame == pytest.approx(frame, abs=1e-9)
    shift = [a - b for a, b in zip(table["PotEng"], excluded["PotEng"])]
    assert abs(shift[0]) > 1.0 and shift[1] == pytest.approx(shift[0], abs=1e-8)


def test_what_is_not_worth_a_line(lmp_tree):
    """A body among many atoms that move: less than 1 % of all pairs are its own."""
    data = water_data(lmp_tree.folder / "data.water", shift=1.65)
    deck = water(data, "gear/quat molecule", steps=1).replace("exclude molecule/intra all", "")
    few = deck.replace(
        "fix move all",
        "group one molecule 1\ngroup rest subtract all one\nfix nve rest nve\nfix move one",
    )
    assert counted(report(lmp_tree.run(few))) == {}
    assert list(counted(report(lmp_tree.run(deck)))) == ["within"]


def test_a_body_that_meets_its_own_image(lmp_tree):
    """Forces between a body and its image move it: no advice to leave them out."""
    near = two_molecules(after="run 0").replace("-10 10 -10 10 -10 10", "-4 8 -4 8 -4 8")
    assert list(counted(report(lmp_tree.run(near)))) == ["within"]
    box = near.replace("pair_style zero 2.0", "pair_style zero 10.0")
    assert counted(report(lmp_tree.run(box))) == {}
