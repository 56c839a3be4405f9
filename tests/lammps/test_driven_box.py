"""Boxes that other fixes change during a run: bodies follow as with fix rigid, and keep their shapes.

Unsupported settings are in test_bad_input.py.
"""

import numpy as np
import pytest
from support.constant_pressure import REPULSIVE, distances, ends, pressed, trimers
from support.scenes import template

TILTED = np.eye(3)
SOLVENT = """create_atoms 2 random 40 4711 NULL overlap 0.7 maxtry 500
group bodies molecule > 0
group solvent molecule 0
velocity solvent create 0.8 4712 loop geom
"""
#: commands after the fix, and whether the box is triclinic
BOXES = {
    "compressed": ("fix d all deform 1 x erate 0.3 y erate -0.2", False),
    "wiggle": ("fix d all deform 1 x wiggle 0.3 1.5 z wiggle 0.2 1.1", False),
    "trate and volume": ("fix d all deform 1 x trate 0.4 y volume z volume", False),
    "vel": ("fix d all deform 1 x vel 0.5 y scale 0.9 z final -0.1 3.2 units box", False),
    "variable": (
        "variable size equal 0.2*sin(4.0*time)\nvariable rate equal 0.8*cos(4.0*time)\n"
        "fix d all deform 1 x variable v_size v_rate",
        False,
    ),
    "sheared": ("fix d all deform 1 xy erate 0.5 xz erate 0.2", True),
    "sheared back and forth": ("fix d all deform 1 xy wiggle 0.5 1.0 x erate 0.3", True),
    "flips": ("fix d all deform 1 xy erate 4.0", True),
    "every third": ("fix d all deform 3 x erate 0.3", False),
    "press/berendsen": ("fix d all press/berendsen aniso 0.5 0.5 1.0", False),
    "press/langevin": ("fix d all press/langevin iso 3 3 1 temp 1 1 4711", False),
    "not remapped": ("fix d all deform 1 x erate -0.3 remap none", False),
    "flow": ("fix d all deform 1 xy erate 0.5 remap v", True),
    "flow back and forth": ("fix d all deform 1 xy wiggle 0.5 1.0 remap v", True),
    "flow that flips": ("fix d all deform 1 xy erate 4.0 remap v", True),
}


def driven(after, tilted, fix="gear/quat molecule", dt=0.001, steps=400, **settings):
    """A deck of trimers, moved by ``fix``."""
    deck = pressed("", dt, steps, data="data.tilted" if tilted else "data.trimers", after=after, **settings)
    deck = deck.replace("fix move all gear/quat molecule", f"fix move all {fix}")
    return deck.replace("ecouple econserve", "xy xz yz").replace(" f_move[*]", "")


@pytest.fixture(autouse=True)
def data(tmp_path):
    trimers(tmp_path / "data.tilted", spacing=1.5, change=TILTED)
    return trimers(tmp_path / "data.trimers", spacing=1.5)


@pytest.mark.parametrize("ranks", [1, 2])
def test_what_a_run_has_used_may_be_deleted(lmp_tree, ranks):
    before = "variable body atom mol\ngroup some molecule <= 4\ngroup others subtract all some\n"
    delete = "unfix d\nvariable body delete\ngroup others delete\nrun 5\nminimize 0 1e-3 2 10\nrun 5"
    after = "fix d all deform 1 x erate 0.3"
    settings = dict(before=before, run=f"run 5\n{delete}", pair=REPULSIVE)
    deck = driven(after, False, fix="gear/quat custom v_body", **settings)
    assert lmp_tree.succeed(deck, ranks=ranks).thermo[1]["Step"][-1] == 10


@pytest.mark.parametrize("name", [name for name in BOXES if name != "flow that flips"])
def test_bodies_follow_as_those_of_fix_rigid(lmp_wheel, name):
    """With a step at which both are accurate."""
    after, tilted = BOXES[name]
    decks = [driven(after, tilted, fix) for fix in ("gear/quat molecule", "rigid/small molecule")]
    result, frames = ends(lmp_wheel, decks)
    box = [np.array([t[c] for c in ("Lx", "Ly", "Lz", "Xy")]) for t in result.thermo]
    assert np.abs(box[0] - box[1]).max() < 1e-4
    assert np.abs(box[0] - box[0][:, :1]).max() > 1e-3
    assert np.abs(frames[0] - frames[1])[:, 3:6].max() < 5e-5


@pytest.mark.parametrize("deform", ["xy erate 0.5", "xy erate 4.0", "y erate -0.2"])
def test_bodies_that_pass_faces_move_as_atoms_do(lmp_wheel, deform):
    """Bodies of one atom in a flow and fix nve, both extrapolated from two steps: the box has an error of first order."""
    after, single = f"fix d all deform 1 {deform} remap v", "variable m atom id\nset group all mol v_m\n"
    words = ("gear/quat molecule", "nve")
    decks = [driven(after, True, fix, dt, round(1.5 / dt), before=single) for fix in words for dt in (0.0005, 0.00025)]
    decks.append(decks[1].replace("remap v", "remap none"))
    _, (coarse, fine, nve_coarse, nve_fine, mutant) = ends(lmp_wheel, decks)
    lags = np.abs(fine - coarse)[:, 3:6].max()
    assert np.abs(2 * fine - coarse - 2 * nve_fine + nve_coarse)[:, 3:6].max() < 0.1 * lags
    assert np.abs(mutant - fine)[:, 3:6].max() > 10 * lags


FLOW = "fix d all deform 1 xy erate 0.5 remap v"


def stretching(frame, rates):
    """The largest rate of a distance in a body, from unwrapped positions, and velocities and images of atoms.

    ``rates``: the velocities of the periods, in columns.
    """
    place, speed, image = frame[:, :3], frame[:, 3:6], frame[:, 6:9]
    assert len(np.unique(image, axis=0)) > 1
    apart, apace = (np.diff(w.reshape(-1, 3, 3), axis=1) for w in (place, speed + image @ rates.T))
    return np.abs((apart * apace).sum(axis=2)).max()


@pytest.mark.parametrize("words", ["", "formulation first"])
def test_atoms_have_the_velocities_of_their_images(lmp_wheel, words):
    """With fix deform remap v, also in other runs, and in runs from restart and data files."""
    straight = driven(FLOW, True, f"gear/quat molecule {words}", dt=0.005, steps=190)
    straight = straight.replace("id x y z vx", "id xu yu zu vx")
    halves = ("run 100\nrun 90", "run 100\nwrite_restart half\nwrite_data half.data nocoeff")
    twice, first = (straight.replace("run 190", half) for half in halves)
    again = straight.replace("read_data data.tilted", "read_restart half").replace("run 190", "run 90")
    anew = straight.replace("read_data data.tilted", "read_data half.data").replace("run 190", "run 90")
    later = straight.replace(FLOW, f"run 0\n{FLOW}")
    decks = [straight, twice, first, again, anew, later, straight.replace("remap v", "remap none")]
    result, frames = ends(lmp_wheel, decks)
    edge = 3.0  # of the box along y
    rates = np.zeros((3, 3))
    rates[0, 1] = 0.5 * edge
    for frame in frames[:-1]:
        assert stretching(frame, rates) < 1e-9
    assert stretching(frames[-1], rates) > 0.1
    straight, twice, _, again, anew, later = (frame[:, :6] for frame in frames[:-1])
    assert np.abs(again - twice).max() < 1e-9 and np.abs(anew - twice).max() < 1e-6
    assert np.abs(later - straight).max() < 1e-9
    assert np.abs(twice - straight).max() < 1e-4  # the second run begins with forces in another box
    assert "bodies are rebuilt" not in result.stdout


@pytest.mark.parametrize("ranks, cutoff", [(1, 2.0), (2, 0.3)])
def test_nobody_notices_who_leaves_or_arrives(lmp_tree, ranks, cutoff):
    """Free bodies in a flow; other fixes remove and insert bodies before atoms are wrapped."""
    (lmp_tree.folder / "dimer.mol").write_text(template([(-0.3, 0, 0), (0.3, 0, 0)]))
    deck = """
units lj
atom_style molecular
atom_modify map array sort 0 0.0
region b prism 0 10 0 10 0 10 0 0 0
create_box 1 b
molecule d dimer.mol
lattice sc 0.064
create_atoms 0 box mol d 123
mass 1 1.0
pair_style zero {cutoff}
pair_coeff * *
neighbor 0.2 bin
region whole block INF INF INF INF INF INF
region r block 4 8 1 9 4 8 units box
velocity all create 3.0 991 loop geom dist gaussian
timestep 0.005
{other}
fix d all deform 1 xy erate 0.5 remap v
fix move all gear/quat molecule mol d
run 500
write_dump all custom {end} id vx vy vz iy modify sort id format float %.17g
"""
    others = (
        "",
        "fix e all evaporate 100 2 whole 4711 molecule yes",
        "fix e all deposit 10 0 50 777 region r mol d near 0.1 vx 1 1",
    )
    runs = []
    for k, other in enumerate(others):  # a cutoff of 0.3 is less than the length of bodies, which all ranks then have
        lmp_tree.run(deck.format(other=other, end=f"{k}.dump", cutoff=cutoff), ranks=ranks)
        rows = np.loadtxt(lmp_tree.folder / f"{k}.dump", skiprows=9)
        rows[:, 1] += 5.0 * rows[:, 4]  # relative to the first image of the box
        runs.append({int(row[0]): row[1:4] for row in rows})
    alone, fewer, more = runs
    assert len(fewer) < len(alone) < len(more)
    for tag, speed in alone.items():
        assert np.abs(more[tag] - speed).max() < 1e-9
        assert tag not in fewer or np.abs(fewer[tag] - speed).max() < 1e-9


@pytest.mark.parametrize("name", ["compressed", "variable", "flips", "press/berendsen"])
def test_shapes_stay_exact(lmp_wheel, name):
    """This is true also in the frame at the end of a step, after the box has moved."""
    after, tilted = BOXES[name]
    pose = "write_dump all custom begin.dump id xu yu zu modify sort id format float %.17g\n"
    run = f"{pose}run 401\nwrite_dump all custom done.dump id xu yu zu modify sort id format float %.17g"
    ends(lmp_wheel, [driven(after, tilted, run=run)])
    found = [np.loadtxt(lmp_wheel.folder / f"{n}.dump", skiprows=9)[:, 1:] for n in ("begin", "done")]
    lengths = [distances(np.hstack([x, np.zeros_like(x), np.zeros_like(x)]), np.ones(3)) for x in found]
    assert np.abs(lengths[1] - lengths[0]).max() < 1e-12
    assert np.abs(found[1] - found[0]).max() > 0.1


@pytest.mark.parametrize("name", ["not remapped", "flow that flips", "press/berendsen"])
def test_ranks_agree(lmp_tree, name):
    after, tilted = BOXES[name]
    after += "\npair_style buck 2.6\npair_coeff * * 60.0 0.08 0.0"
    deck = driven(after, tilted, pair="pair_style zero 2.6\npair_coeff * *")
    (one,), (four,) = (ends(lmp_tree, [deck], ranks)[1] for ranks in (1, 4))
    assert np.abs(one - four)[:, 3:6].max() < 1e-10


@pytest.mark.parametrize("barostat", ["npt temp 0.8 0.8 0.5 iso 0.6 0.6 1.0", "nph aniso 0.6 0.6 1.0"])
def test_a_barostat_of_the_solvent_carries_bodies(lmp_wheel, barostat):
    """If defined before or after the fix: the box moves in the middle of the step.

    With fix rigid the barostat uses half of the virial of an earlier step, so the volumes differ in the third digit.
    """
    line = f"fix d solvent {barostat}\n"
    decks = [
        driven("", False, before=SOLVENT + line),
        driven(line, False, before=SOLVENT),
        driven(line, False, "rigid/small molecule", before=SOLVENT),
        driven(line, False, before=SOLVENT, dt=0.0005, steps=800),
    ]
    result, frames = ends(lmp_wheel, [deck.replace("fix move all", "fix move bodies") for deck in decks])
    volumes = [np.array(t["Volume"]) for t in result.thermo]
    off = [np.abs(v - volumes[3]).max() / np.ptp(volumes[3]) for v in volumes[:3]]
    assert np.ptp(volumes[3]) > 1.0
    assert max(off[:2]) < 1e-3 and off[2] < 0.02
    assert max(np.abs(f - frames[3])[:, 3:6].max() for f in frames[:2]) < 1e-3


def test_beside_a_solvent_that_flows(lmp_wheel):
    after, tilted = BOXES["flow"]
    others = "fix others solvent nvt/sllod temp 0.8 0.8 0.5\n"
    decks = [
        driven(others + after, tilted, fix, before=SOLVENT).replace("fix move all", "fix move bodies")
        for fix in ("gear/quat molecule", "rigid/small molecule")
    ]
    _, frames = ends(lmp_wheel, decks)
    assert np.abs(frames[0] - frames[1])[:, 3:6].max() < 1e-4


def test_a_restart_in_the_middle_of_a_deformation_goes_on(lmp_wheel):
    """Like two runs, to rounding; the forces at the beginning of the second run are those of another box."""
    for name, words in (("compressed", ""), ("sheared", "temp 0.7 0.7 0.8"), ("wiggle", "formulation first")):
        after, tilted = BOXES[name]
        span = "start 0 stop 200"
        fix = f"gear/quat molecule {words}"
        straight = driven(after, tilted, fix, dt=0.005, run=f"run 200 {span}")
        twice = driven(after, tilted, fix, dt=0.005, run=f"run 100 {span}\nwrite_restart half\nrun 100 {span}")
        again = driven(after, tilted, fix, dt=0.005, run=f"run 100 {span}")
        again = again.replace("read_data data.tilted" if tilted else "read_data data.trimers", "read_restart half")
        result, frames = ends(lmp_wheel, [straight, twice, again])
        assert "histories of the restart file go on" in result.stdout and "anew" not in result.stdout
        assert np.abs(frames[2] - frames[1])[:, 3:6].max() < 1e-12
        assert np.abs(frames[1] - frames[0])[:, 3:6].max() < 1e-4
