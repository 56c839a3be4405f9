"""Bodies of any size on several ranks: larger than the ghost cutoff, together with small bodies.

A slab of 288 atoms lies across the boundaries of a box, among some hundred rigid trimers; the ghost
cutoff is 2.8, the slab extends 8 from its owner atom, which is not a ghost of all ranks. All move through the
box, so that the owner changes its rank too. Forces are smooth and the runs short: differences between ranks are due to rounding.
"""

import re

import numpy as np
import pytest
from support.running import make_lmp_tree
from support.scenes import (
    frames,
    last_frame,
    one_after_the_other,
    random_rotation,
    restarted,
    template,
    water,
    write_data,
)

BOX, STEPS, DT = 20.0, 200, 0.002
CELLS, SPACING = (12, 12, 2), 1.1

PAIRS = """
pair_style lj/charmm/coul/charmm 1.8 2.5
pair_coeff * * 1.0 1.0
"""
STRESS = """
compute stress all centroid/stress/atom NULL fix
compute sum all reduce sum c_stress[*]
"""


def slab_data(path, height=BOX, cells=CELLS, trimers=True, at=(0.3, 0.3, 0.28)):
    """A slab (molecule 1) and trimers in the lower 20 of a box that may be taller."""
    rng = np.random.default_rng(20251123)
    box = np.array([BOX, BOX, height])
    slab = (np.array(list(np.ndindex(*cells))) - (np.array(cells) - 1) / 2) * SPACING
    # one of the sites next to the middle is the nearest, the owner, and not by rounding
    slab[np.abs(slab).sum(axis=1).argsort(kind="stable")[2]] *= 0.8
    slab = slab @ random_rotation(rng).T + np.array(at) * BOX
    trimer = np.array([[0, 0, 0], [0.9, 0, 0], [0.2, 0.8, 0]])
    trimer -= trimer.mean(axis=0)
    molecules = [slab]
    for cell in np.ndindex(5, 5, 5) if trimers else ():
        atoms = (np.array(cell) + 0.5) * 4.0 + trimer @ random_rotation(rng).T
        apart = atoms[:, None] - slab
        apart -= BOX * np.round(apart / BOX)
        if np.linalg.norm(apart, axis=-1).min() > 1.2:
            molecules.append(atoms)
    rows, velocities = [], []
    for number, atoms in enumerate(molecules, 1):
        stream = np.array([9.0, 14.0, 0.0 if height > BOX else 5.0])
        velocity = stream + rng.normal(size=3) * (0.2 if number == 1 else 1.0)
        spin = rng.normal(size=3) * (0.1 if number == 1 else 1.0)
        image = np.floor(atoms / box)
        rows += [[number, 1, 0, *x] for x in np.hstack([atoms - image * box, image])]
        velocities += list(velocity + np.cross(spin, atoms - atoms.mean(axis=0)))
    lines = [f"0 {length} {axis}lo {axis}hi" for length, axis in zip(box, "xyz")]
    return write_data(path, lines, [1.0], rows, velocities)


def deck(data, name, fix="", after="", steps=STEPS, **settings):
    settings = dict(units="lj", dt=DT, pair=PAIRS, skin=0.3, dumped="proc") | settings
    settings |= dict(steps=steps, dump=f"{name}.dump", columns="f_move c_sum[*]")
    return water(data, f"gear/quat molecule {fix}", after=after + STRESS, **settings)


def end(lmp, text, name, ranks=1):
    """The last frame of the deck with that name."""
    lmp.succeed(text, ranks=ranks)
    return last_frame(lmp.folder / f"{name}.dump")


def difference(one, other):
    """Largest difference of positions, relative to the box, and of velocities, relative to the fastest atom."""
    moved = np.abs(one - other)
    return max(moved[:, 1:4].max() / BOX, moved[:, 4:7].max() / np.abs(one[:, 4:7]).max())


# additions to the plain run
WAYS = {
    "plain": dict(),
    "tiled": dict(comm="tiled", after="fix cut all balance 10 1.0 rcb"),
    "respa": dict(before="run_style respa 2 1"),
    "wide": dict(before="comm_modify cutoff 9.8"),
    "first": dict(fix="formulation first compensate yes"),
    "temp": dict(fix="temp 100.0 120.0 0.1", after="fix_modify move energy no"),
    "total": dict(fix="formulation first isokinetic total"),
    "separate": dict(fix="formulation first isokinetic separate"),
    "thermostat": dict(
        fix="temp 100.0 120.0 0.1 thermostat separate", after="fix_modify move energy no"
    ),
    "masks": dict(fix="force 1 off on on torque 1* on off on"),
    "tolerance": dict(fix="tolerance 1e-9 dtmax 0.004"),
    "wide tolerance": dict(fix="tolerance 1e-9 dtmax 0.004", before="comm_modify cutoff 9.8"),
    # the last, since it has two runs
    "timestep": dict(run="run 100\ntimestep 0.0015\nrun 100"),
}
RANKS = {
    1: ["plain", "first", "temp", "total", "separate", "thermostat", "masks", "timestep"],
    2: ["tiled", "separate", "thermostat"],
    4: list(WAYS),
}


def to_repeat(way):
    """The run (ranks, way) with the same trajectory as this way, for any number of ranks."""
    if "tolerance" in way:
        # rounding determines the last digits of every step: the same number of ranks, small bodies only
        return 4, "wide tolerance"
    return 1, way if way in RANKS[1] else "plain"


@pytest.fixture(scope="module")
def ends(tmp_path_factory):
    """(ranks, way) -> the last frame; (ranks, way, "begin"), "log" and "thermo" -> its other output."""
    lmp = make_lmp_tree(tmp_path_factory.mktemp("slab"))
    data = slab_data(lmp.folder / "data.slab")
    found = {}
    for ranks, ways in RANKS.items():
        names = [f"{ranks}-{way.replace(' ', '-')}" for way in ways]
        decks = [deck(data, name, **WAYS[way]) for name, way in zip(names, ways)]
        result = lmp.succeed(one_after_the_other(decks), ranks=ranks, timeout=300)
        logs = result.log.split("rigid bodies with")[1:]
        for name, way, log in zip(names, ways, logs):
            dumped = frames(lmp.folder / f"{name}.dump")
            found[ranks, way, "begin"], found[ranks, way] = dumped[0], dumped[STEPS]
            found[ranks, way, "log"] = log
        for way, table in zip(ways, result.thermo):
            found[ranks, way, "thermo"] = np.array([values[-1] for values in table.values()])
    return found


def ghosts(log):
    return float(re.findall(r"Nghost: +(\S+) ave", log)[-1])


@pytest.mark.tree
@pytest.mark.parametrize("ranks, way", [(n, way) for n in (2, 4) for way in RANKS[n]])
def test_the_trajectory_is_that_of_one_rank(ends, ranks, way):
    repeated = to_repeat(way)
    assert difference(ends[repeated], ends[ranks, way]) < 1e-12
    one, many = ends[*repeated, "thermo"], ends[ranks, way, "thermo"]
    assert np.abs(one - many).max() < 1e-10 * np.abs(one).max()
    large = "1 bodies reach further than ghost atoms" in ends[ranks, way, "log"]
    assert large == ("wide" not in way)


@pytest.mark.tree
def test_the_scene_tells(ends):
    """Ranks change, including the owner's, and there are no ghosts of the whole slab."""
    begin, end = ends[4, "plain", "begin"], ends[4, "plain"]
    slab = end[: np.prod(CELLS), 1:4]
    middle = np.linalg.norm(slab - slab.mean(axis=0), axis=1) < 1.0
    assert (begin[: len(slab), 7] != end[: len(slab), 7])[middle].all()
    assert set(end[:, 7]) == {0, 1, 2, 3}
    assert ghosts(ends[4, "plain", "log"]) < 0.5 * ghosts(ends[4, "wide", "log"])
    assert int(re.findall(r"Neighbor list builds = (\d+)", ends[4, "plain", "log"])[-1]) > 10
    assert difference(ends[1, "plain"], ends[1, "first"]) < 1e-6  # two methods for the same motion
    for way in ("total", "separate", "thermostat", "masks", "timestep"):
        assert difference(ends[1, "plain"], ends[1, way]) > 1e-5


def test_single_and_group(lmp_tree):
    """With the slab on two of four ranks."""
    data = slab_data(lmp_tree.folder / "data.slab", height=60.0, at=(0.3, 0.3, 0.5))
    words = {"single": "single", "group": "group 2 slab rest", "molecule": "molecule"}
    ends = {}
    for n, processors in ((1, "1 1 1"), (4, "1 1 4")):
        decks = []
        for name, style in words.items():
            text = deck(data, name, processors=processors, steps=60)
            groups = "group slab molecule 1\ngroup rest subtract all slab\n"
            text = text.replace("fix move all", f"{groups}fix move all")
            decks.append(text.replace("gear/quat molecule", f"gear/quat {style}"))
        lmp_tree.succeed(one_after_the_other(decks), ranks=n)
        for name in words:
            frame = last_frame(lmp_tree.folder / f"{name}.dump")
            assert len(set(frame[:, 7])) == min(n, 2)
            assert n == 1 or difference(ends[name], frame) < 1e-12
            ends[name] = frame
    assert difference(ends["group"], ends["molecule"]) > 1e-4


def test_restarts_on_any_number_of_ranks(lmp_tree):
    """Results agree to the last bit on the same number of ranks, and to rounding on others."""
    data = slab_data(lmp_tree.folder / "data.slab")
    halves = f"run {STEPS // 2}\nwrite_restart {{name}}.restart\nrun {STEPS // 2}"
    whole = {}
    for ranks in (1, 4):
        name = f"whole{ranks}"
        whole[ranks] = end(lmp_tree, deck(data, name, run=halves.format(name=name)), name, ranks)
    for ranks in (1, 4):
        rest = {n: deck(data, f"rest{n}", steps=STEPS // 2) for n in whole}
        decks = [restarted(rest[n], f"whole{n}.restart") for n in whole]
        lmp_tree.succeed(one_after_the_other(decks), ranks=ranks)
        for n in whole:
            again = last_frame(lmp_tree.folder / f"rest{n}.dump")
            assert difference(whole[n], again) < 1e-12
            assert n != ranks or (whole[n] == again).all()


def test_a_body_that_loses_sight_of_its_owner_becomes_large(lmp_tree):
    """In mode multi the cutoff for ghosts of type 1 is 1.4, though the longest ghost cutoff is 2.8."""
    data = slab_data(lmp_tree.folder / "data.slab", cells=(4, 4, 2), at=(0.3, 0.4, 0.28))
    data.write_text(data.read_text().replace("1 atom types", "2 atom types").replace("Masses\n\n1 1", "Masses\n\n1 1\n2 1"))
    text = deck(data, "multi", before="comm_modify mode multi")
    text = text.replace("neighbor 0.3 bin", "neighbor 0.3 multi")
    text = re.sub(
        "pair_style .*\npair_coeff .*",
        "pair_style lj/cut 1.1\npair_modify shift yes\npair_coeff * * 1 0.98\npair_coeff 2 2 1 1 2.5",
        text,
    )
    one = end(lmp_tree, text, "multi")
    log = lmp_tree.succeed(text, ranks=4).log
    assert "1 bodies reach further than ghost atoms" in log
    assert difference(one, last_frame(lmp_tree.folder / "multi.dump")) < 1e-12


def test_a_large_body_goes_astray(lmp_tree):
    """All ranks detect it and report once, with the atom that has the largest force, on any rank."""
    data = slab_data(lmp_tree.folder / "data.slab")
    throw = "group slab molecule 1\nvelocity slab set 20000 NULL NULL"
    text = deck(data, "astray", before=throw)
    said = []
    for ranks in (1, 4):
        message = "blow-up in step 0, time 0: body 1 moves by 40"
        said += lmp_tree.refuse(text, message, ranks=ranks).errors
    assert len(said) == 2
    assert re.search(r"the largest force acts on its atom [1-9]", said[0])
    assert said[0].partition(" (src")[0] == said[1].partition(" (src")[0]


ROD = template([(k, 0, 0) for k in range(-4, 5)])
RAIN = """
region top block 3 17 3 17 3 17
fix rain all deposit 3 0 30 4711 region top near 2.0 attempt 1000 mol rod rigid move vx 8 9 vy 6 7
"""
REMOVE = f"""
group slab molecule 1
region box block EDGE EDGE EDGE EDGE EDGE EDGE
fix remove slab evaporate {STEPS // 2} 1 box 4711 molecule yes
compute_modify thermo_temp dynamic/dof yes
"""


def test_large_bodies_are_inserted(lmp_tree):
    """Rods of nine atoms, longer than the ghost cutoff, are inserted during the run."""
    data = slab_data(lmp_tree.folder / "data.slab", trimers=False)
    (lmp_tree.folder / "rod.mol").write_text(ROD)
    text = deck(data, "rain", fix="mol rod", before="molecule rod rod.mol", after=RAIN)
    one, two, four = (end(lmp_tree, text, "rain", ranks) for ranks in (1, 2, 4))
    assert len(one) == np.prod(CELLS) + 27
    assert difference(one, two) < 1e-12 and difference(one, four) < 1e-12


def test_a_large_body_is_removed(lmp_tree):
    """The slab is removed halfway; the trimers continue, and no rank keeps a copy."""
    text = deck(slab_data(lmp_tree.folder / "data.slab"), "removed", after=REMOVE)
    one, four = (end(lmp_tree, text, "removed", ranks) for ranks in (1, 4))
    assert one[0, 0] == np.prod(CELLS) + 1
    assert difference(one, four) < 1e-12
