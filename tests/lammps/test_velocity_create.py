"""`velocity create T` gives bodies the temperature T before their first run."""

import numpy as np
import pytest
from support.scenes import one_after_the_other, template

ANGLES = np.arange(12) * np.pi / 6
PLATE = [
    (x + 0.5 * (y % 2), 0.87 * y, 0.0)
    for y in range(-3, 4)
    for x in range(-4, 5)
    if (x + 0.5 * (y % 2)) ** 2 + (0.87 * y) ** 2 < 11
]
SHAPES = {
    "rings": np.c_[2 * np.cos(ANGLES), 2 * np.sin(ANGLES), 0 * ANGLES],
    "plates": np.array(PLATE),
    "water": np.array([(0.0, 0.0, 0.0), (0.8165, 0.5774, 0.0), (-0.8165, 0.5774, 0.0)]),
    "dumbbells": np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]),
}

DECK = """
units lj
atom_style molecular
atom_modify map array
region b block 0 56 0 56 0 56
create_box 2 b
molecule m {file}
lattice sc 0.0029154519
create_atoms 0 box mol m 4711
group bodies molecule > 0
{free}
mass * 1.0
pair_style zero 2.5
pair_coeff * *
neigh_modify exclude molecule/intra all
comm_modify cutoff 9
timestep 0.001
{before}
fix move bodies gear/quat molecule {words}
{after}
compute T bodies temp
thermo_style custom step temp c_T f_move[1] f_move[2]
thermo_modify norm no format float %.17g
thermo 1
{run}
"""
#: 8^3 bodies with 3 + 3 (dumbbells: 3 + 2) degrees of freedom
BODIES = 512
CREATE = "velocity all create 1.5 4711 {}"


def deck(lmp, shape, before="", after="", free="", words="", run="run 1"):
    sites = SHAPES[shape]
    (lmp.folder / f"{shape}.mol").write_text(template(sites, [1 + (k > 0) for k in range(len(sites))]))
    return DECK.format(file=f"{shape}.mol", before=before, after=after, free=free, words=words, run=run)


def temperatures(table, shape, row=0):
    """Of translation and of rotation of the bodies."""
    axes = 2 if shape == "dumbbells" else 3
    return 2 * table["f_move[1]"][row] / (3 * BODIES), 2 * table["f_move[2]"][row] / (axes * BODIES)


def is_asked_for(table, shape, target=1.5):
    """Within four standard errors of a canonical distribution, 10 %."""
    assert temperatures(table, shape) == pytest.approx([target, target], rel=4 * (2 / (3 * BODIES)) ** 0.5)


@pytest.mark.parametrize("shape, loop", list(zip(SHAPES, ["", "loop geom", "dist gaussian mom no", "rot yes"])))
def test_before_the_first_run(lmp_tree, shape, loop):
    """The order of the two commands does not matter; between runs velocity scale sets the temperature exactly."""
    create = CREATE.format(loop)
    again = f"run 1\n{create}\nrun 0\nvelocity bodies scale 0.5\nrun 1"
    decks = [deck(lmp_tree, shape, before=create), deck(lmp_tree, shape, after=create, run=again)]
    before, after, _, later = lmp_tree.succeed(one_after_the_other(decks)).thermo
    is_asked_for(before, shape)
    is_asked_for(after, shape)
    assert later["c_T"][0] == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("shape", ["plates", "water"])
def test_beside_free_atoms(lmp_tree, shape):
    free = "create_atoms 1 random 4000 4711 NULL\ngroup free subtract all bodies"
    decks = [deck(lmp_tree, shape, free=free, **{where: CREATE.format("")}) for where in ("before", "after")]
    for table in lmp_tree.succeed(one_after_the_other(decks), ranks=2).thermo:
        is_asked_for(table, shape)
        assert table["Temp"][0] == pytest.approx(1.5, rel=0.05)
        assert table["c_T"][0] == pytest.approx(np.mean(temperatures(table, shape)), rel=0.02)


def test_with_a_thermostat(lmp_tree):
    """It begins at its target."""
    text = deck(lmp_tree, "rings", after=CREATE.format(""), words="temp 1.5 1.5 1.0")
    is_asked_for(lmp_tree.succeed(text).thermo[0], "rings")
