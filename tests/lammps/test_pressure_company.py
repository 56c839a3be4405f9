"""Constant pressure beside walls, fields, random forces, frozen atoms and held bodies."""

import numpy as np
import pytest
from support.constant_pressure import REPULSIVE, dipoles_deck, ends, frame, pressed, trimers
from support.scenes import largest_change

#: for 8 trimers between z = 0 and 4; these forces have energies, and act only along z
SLIT = """
fix walls all wall/lj93 zlo EDGE 1.0 0.6 10.0 zhi EDGE 1.0 0.6 10.0
fix weight all gravity 1.0 vector 0 0 -1
fix_modify walls energy yes
fix_modify weight energy yes
"""
ALONG = "x 0.3 0.3 1.0 y 0.5 0.5 1.0 ptemp 1"
#: constant on some bodies, with an energy and a virial
FIELD = """
group some molecule 2 3
fix field some addforce 0.3 -0.2 0.4
fix_modify field energy yes virial yes
"""
ORIGIN = "iso 0.5 0.5 1.0 ptemp 1 fixedpoint 0 0 0"
#: one molecule among others that are frozen
GUEST = """
group guest molecule 4
group host subtract all guest
velocity host set 0 0 0
neigh_modify exclude group host host
"""
HELD = "force 1 off on off force 3 off off off torque 3 off off off"

SCENES = {
    "a slit": dict(words=ALONG, boundary="p p f", after=SLIT),
    "a slit, NPT": dict(
        words="x 0.3 0.3 1.0 y 0.5 0.5 1.0 temp 1 1 0.8", boundary="p p f", after=SLIT
    ),
    "a force that counts": dict(words=ORIGIN, before=FIELD),
    "it counts in a box that shears": dict(
        words=ORIGIN.replace("iso", "tri"), before="change_box all triclinic" + FIELD
    ),
    "frozen atoms": dict(words="iso 0.1 0.1 2.0 ptemp 1", before=GUEST),
    "frozen atoms, NPT": dict(words="aniso 0.1 0.1 2.0 temp 1 1 1", before=GUEST),
    "held bodies": dict(
        words=f"aniso 0.5 0.5 1.0 {HELD}",
        before="group slow molecule 1 3\nvelocity slow set 0 0 0",
    ),
}


@pytest.fixture(autouse=True)
def data(tmp_path):
    return trimers(tmp_path / "data.trimers")


def deck(name, dt=0.005, steps=100, words="", **settings):
    scene = dict(SCENES[name])
    text = pressed(
        f"{scene.pop('words')} {words}", dt, steps, pair=REPULSIVE, **(scene | settings)
    )
    return text.replace("fix move all", "fix move guest") if "frozen" in name else text


@pytest.mark.parametrize("name", SCENES)
def test_the_energy_is_constant_to_the_order(lmp_tree, name):
    """With 6 values; all these forces have energies."""
    words = "values 6 corrector gear"
    time = 3.2 if "frozen" in name else 0.4
    result, _ = ends(
        lmp_tree, [deck(name, dt, round(time / dt), words) for dt in (0.008, 0.004)]
    )
    coarse, fine = (largest_change(table) for table in result.thermo)
    assert coarse / fine > 2**4.5
    assert fine < 1e-4
    # the box has moved
    assert np.ptp(result.thermo[1]["Volume"]) > 0.1


@pytest.mark.parametrize("name", SCENES)
def test_ranks_and_restarts(lmp_tree, name):
    """Two ranks agree with one to rounding, and restart files continue bit for bit."""
    halves = deck(name, run="run 50\nwrite_restart half\nrun 50", processors="1 1 *")
    rest = deck(name, run="run 50", processors="1 1 *").replace(
        "read_data data.trimers", "read_restart half"
    )
    for line in ("velocity", "change_box"):  # the file has them
        rest = "\n".join(row for row in rest.split("\n") if not row.startswith(line))
    _, (whole, again) = ends(lmp_tree, [halves, rest])
    assert (whole == again).all()
    _, (two, on_two) = ends(lmp_tree, [halves, rest], ranks=2)
    assert (two == on_two).all()
    assert np.abs(whole - two)[:, :6].max() < 1e-10


def test_steps_that_follow_the_error(lmp_tree):
    """Forces are evaluated again in steps that are repeated."""
    for name in ("a slit", "a force that counts"):
        result, _ = ends(lmp_tree, [deck(name, words="tolerance 1e-8")])
        assert largest_change(result.thermo[0]) < 1e-3


def test_the_box_works_on_a_force_that_does_not_count(lmp_tree):
    """Its virial makes the difference, as does the point from which it is measured."""
    after = FIELD.replace(" virial yes", "")
    decks = [
        deck("a force that counts"),
        deck("a force that counts", before="", after=after),
    ]
    decks.append(deck("a force that counts").replace("fixedpoint 0 0 0", ""))
    result, _ = ends(lmp_tree, decks)
    first, *others = (largest_change(table) for table in result.thermo)
    assert all(other > 100 * first for other in others)


def test_frozen_atoms_and_held_bodies_ride_with_the_box(lmp_tree):
    """Places relative to the box are constant where nothing moves."""
    for name in ("frozen atoms", "held bodies"):
        text = deck(
            name,
            run="write_dump all custom start.dump id x y z vx vy vz ix iy iz modify sort id format float %.17g\nrun 200",
        )
        result, (after,) = ends(lmp_tree, [text])
        before, table = frame(lmp_tree.folder / "start.dump"), result.thermo[-1]
        edges = (
            np.array([4.0, 4.0, 4.0]),
            np.array([table[k][-1] for k in ("Lx", "Ly", "Lz")]),
        )
        low = [2.0 - edge / 2 for edge in edges]
        places = [
            (rows[:, :3] - at) / edge + rows[:, 6:9]
            for rows, at, edge in zip((before, after), low, edges)
        ]
        if name == "frozen atoms":
            still = [k for k in range(24) if k // 3 != 3]
            assert np.abs(places[1] - places[0])[still].max() < 1e-13
            continue
        centers = [
            np.average((at * edge).reshape(-1, 3, 3), axis=1, weights=[1.0, 0.7, 1.3])
            / edge
            for at, edge in zip(places, edges)
        ]
        moved = np.abs(centers[1] - centers[0])
        assert moved[0, [0, 2]].max() < 1e-13 and moved[2].max() < 1e-13
        assert moved[0, 1] > 1e-4 and moved[1].min() > 1e-4


def test_a_drifting_component_keeps_its_velocity(lmp_tree):
    """Relative to the box, with a thermostat of the others."""
    text = pressed(
        "aniso 0.5 0.5 1.0 temp 1 1 1 force 1 off on on", steps=200, pair=REPULSIVE
    )
    start = text.replace("run 200", "run 0")
    _, rows = ends(lmp_tree, [start, text])
    one, other = (np.average(r[:3, 3:6], axis=0, weights=[1.0, 0.7, 1.3]) for r in rows)
    assert one[0] == pytest.approx(other[0], rel=1e-10)
    assert abs(one[1] - other[1]) > 1e-3


def test_dipoles_in_a_field(lmp_tree):
    """Neutral molecules: the box does no work on the field."""
    words = "values 7 iso -0.25 -0.25 2.0 ptemp 0.4"
    fields = (
        "fix field all efield 0.5 -0.3 0.2\nfix_modify field energy yes\nthermo_style"
    )
    decks = [
        dipoles_deck(words, dt).replace("thermo_style", fields, 1)
        for dt in (0.01, 0.005)
    ]
    result, _ = ends(lmp_tree, [*decks, dipoles_deck(words, 0.005)])
    errors = [largest_change(table) for table in result.thermo]
    assert errors[0] / errors[1] > 2**5
    assert result.thermo[1]["PotEng"][0] != result.thermo[2]["PotEng"][0]


# --- exact laws -----------------------------------------------------------------------------------

GAS = "pair_style zero 0.5\npair_coeff * *"
BATH = "\nfix bath all langevin 1 1 2.0 4711"
WEIGHT = """
fix walls all wall/harmonic zlo 0.0 50.0 1.0 0.6 zhi 4.0 50.0 1.0 0.6
fix weight all gravity 1.0 vector 0 0 -1
"""
GASES = {
    "a gas in a slit": dict(
        words="x 1 1 5 y 1 1 5 couple xy ptemp 1", after=WEIGHT + BATH, boundary="p p f"
    ),
    "a flat gas of held bodies": dict(
        words="iso 1 1 5 langevin 1 1 2.0 4711 torque * off off off"
        " force 1*3 off on off force 4 off off off",
        before="velocity all set 0 0 0",
        dimension=2,
        exact=1 + (2 * 9 - 3 - 2) / 2,
    ),
}


@pytest.mark.parametrize("name", GASES)
def test_the_volume_of_an_ideal_gas(lmp_tree, tmp_path, name):
    """<V> = (N + 1) kT/P, with a variance of (N + 1) (kT/P)^2, since random forces change the total momentum.

    N: the number of components that are free, divided by the dimension.
    """
    scene = dict(GASES[name])
    flat = scene.get("dimension") == 2
    exact = scene.pop("exact", 9.0)
    trimers(tmp_path / "data.trimers", n=3 if flat else 2, flat=flat)
    text = pressed(scene.pop("words"), 0.02, 200000, pair=GAS, thermo=100, **scene)
    volume = np.array(lmp_tree.succeed(text).thermo[0]["Volume"][300:])
    for values in (volume, (volume - exact) ** 2):
        blocks = [block.mean() for block in np.array_split(values, 20)]
        assert abs(values.mean() - exact) < 4 * np.std(blocks, ddof=1) / np.sqrt(20)
        assert np.std(blocks, ddof=1) / np.sqrt(20) < 0.1 * exact


# --- other fixes ----------------------------------------------------------------------------------

OTHERS = (
    "addforce 0.1 0 0",
    "setforce NULL NULL 0.0",
    "planeforce 0 0 1",
    "lineforce 1 0 0",
    "spring tether 1.0 2.0 2.0 NULL 0.0",
    "spring/self 1.0 xyz",
    "indent 1.0 sphere 2.0 2.0 2.0 0.5",
    "viscous 0.1",
    "gravity 1.0 vector 1 0 0",
    "langevin 1 1 1 4711",
)


def test_fixes_after_this_one(lmp_tree):
    """The virial of the first step is that without the fix, and the motion is not."""
    decks = [
        pressed("iso 0.5 0.5 1.0 ptemp 1", steps=20, pair=REPULSIVE, after=after)
        for after in ("", *(f"fix it all {words}" for words in OTHERS))
    ]
    result, (alone, *frames) = ends(lmp_tree, decks, ranks=2)
    for words, table, rows in zip(OTHERS, result.thermo[1:], frames):
        assert table["f_move[15]"][0] == pytest.approx(
            result.thermo[0]["f_move[15]"][0], rel=1e-13
        ), words
        assert np.abs(rows - alone)[:, 3:6].max() > 1e-6, words
