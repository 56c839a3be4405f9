"""LAMMPS as a field: forces at exactly the given positions, in any box, wherever atoms move."""

import numpy as np
import pytest

from benchmarks.reference import paper_problem, reference_state
from benchmarks.engine.decks import SCENES
from benchmarks.reference.lammps_forces import DeckError, LammpsForces, deck_problem

BOX, CUT = np.array([9.0, 10.0, 11.0]), 4.0
CHARGE, EPSILON, SIGMA = (-0.8, 0.4), 0.5, 1.2

DECK = """
units lj
atom_style full
atom_modify sort 1 0.5
region box block 0 9 0 10 0 11
create_box 2 box
{atoms}
mass 1 16.0
mass 2 1.0
set type 1 charge -0.8
set type 2 charge 0.4
pair_style lj/cut/coul/cut 4.0
pair_coeff * * 0.5 1.2
neighbor 0.5 bin
neigh_modify every 10 delay 20 exclude molecule/intra all
velocity all create 1.0 4711
{fixes}
dump d all custom 1 never.dump id
thermo_style custom step temp
thermo_modify norm yes
timestep 0.001
run 100
"""


def molecules():
    """Positions (24, 3) of 8 bent molecules on a grid, each turned another way."""
    shape = np.array([[0, 0, 0], [0.9, 0.3, 0], [-0.2, 0.9, 0.3]])
    random = np.random.default_rng(5)
    grid = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    turns = [np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in grid]
    return np.concatenate([(g + 0.3) * BOX / 2 + shape @ t.T for g, t in zip(grid, turns)])


@pytest.fixture
def write_deck(tmp_path):
    """Writes the deck."""

    def write(fixes="fix move all rigid/nve/small molecule"):
        types = [1, 2, 2] * 8
        atoms = [
            f"create_atoms {kind} single {x:.17g} {y:.17g} {z:.17g}\n"
            f"set atom {k + 1} mol {k // 3 + 1}"
            for k, (kind, (x, y, z)) in enumerate(zip(types, molecules()))
        ]
        path = tmp_path / "in.small"
        path.write_text(DECK.format(fixes=fixes, atoms="\n".join(atoms)))
        return path

    return write


def brute_force(positions, box=BOX):
    """Energy and forces of every pair of molecules by the nearest image, within the cut-off."""
    charge = np.array([CHARGE[0], CHARGE[1], CHARGE[1]] * 8)
    body = np.arange(24) // 3
    gap = positions[:, None] - positions
    gap = gap - np.rint(gap / box) * box
    r = np.sqrt((gap**2).sum(axis=2)) + np.eye(24)
    counted = (body[:, None] != body) & (r < CUT)
    sixth = (SIGMA / r) ** 6
    coulomb = charge[:, None] * charge / r
    energy = np.where(counted, coulomb + 4 * EPSILON * (sixth**2 - sixth), 0).sum() / 2
    radial = (coulomb + 4 * EPSILON * (12 * sixth**2 - 6 * sixth)) / r**2
    return energy, (np.where(counted, radial, 0)[:, :, None] * gap).sum(axis=1)


@pytest.fixture
def small(write_deck):
    with LammpsForces(write_deck()) as field:
        yield field


def agrees(field, positions):
    """True if LAMMPS and the loop over all pairs agree."""
    energy, forces = field.energy_and_forces(positions)
    expected_energy, expected = brute_force(positions)
    near = np.abs(forces - expected).max() < 1e-11 * np.abs(expected).max()
    return near and abs(energy - expected_energy) < 1e-11 * abs(expected_energy)


def test_forces_are_those_of_every_pair(small):
    assert agrees(small, molecules())
    assert (small.ids == np.arange(1, 25)).all()


def test_forces_follow_the_atoms_anywhere(small):
    """Bodies drift through the box faster and faster, so neighbor lists are rebuilt and atoms are wrapped and
    sorted."""
    start, random, before = molecules(), np.random.default_rng(3), small.evaluations
    drift = np.repeat(random.normal(size=(8, 3)), 3, axis=0)
    for distance in (1e-6, 0.01, 0.2, 1.0, 2.0, 4.0, 7.0, 11.0, 7.5, 0.0):
        assert agrees(small, start + distance * drift)
    assert small.evaluations == before + 10


def test_whole_periods_make_no_difference(small):
    """At large distances a long double keeps digits that double precision would lose."""
    start = molecules().astype(np.longdouble)
    _, forces = small.energy_and_forces(start)
    random = np.random.default_rng(1).integers(-50, 50, size=start.shape)
    for periods, tolerance in ((random, 1e-11), (np.longdouble(2) ** 40, 1e-6)):
        _, shifted = small.energy_and_forces(start + periods * BOX)
        assert np.abs(shifted - forces).max() < tolerance * np.abs(forces).max()
    far = periods * BOX
    assert np.abs(((start + far).astype(float) - far) - start).max() > 1e-5


def test_tilted_boxes(write_deck):
    """A box tilted by whole periods is the same lattice."""
    tilt = "change_box all triclinic\nchange_box all xy final 4.5\n"
    with LammpsForces(write_deck(tilt + "fix move all rigid/nve/small molecule")) as field:
        tilted = field.energy_and_forces(molecules())
        shift = np.zeros((24, 3))
        shift[::2] = [4.5 - 18, 10, 0]  # one period of the tilted edge, two back along x
        again = field.energy_and_forces(molecules() + shift)
        assert again[0] == pytest.approx(tilted[0], rel=1e-11)
        assert np.abs(again[1] - tilted[1]).max() < 1e-10
        assert not agrees(field, molecules())


def test_case_1_in_lammps_is_case_1_in_the_cage():
    """The scene generator, LAMMPS' pair style and the notes on the paper agree."""
    cage, scene = paper_problem(1), deck_problem(SCENES / "in.case1")
    try:
        positions = cage.site_positions(cage.start)
        assert np.abs(scene.site_positions(scene.start) - positions).max() < 2e-14
        energy, forces = scene.field.energy_and_forces(positions)
        expected_energy, expected = cage.field.energy_and_forces(positions)
        assert abs(energy - expected_energy) < 2e-14 and np.abs(forces - expected).max() < 1e-14
        ends = [reference_state(problem, 50.0) for problem in (cage, scene)]
        assert np.abs(ends[0].center - ends[1].center).max() < 1e-12
    finally:
        scene.field.close()


REFUSED = {
    "fix move all nvt temp 1 1 1": r"with fix move \(nvt\) there is no reference trajectory",
    "fix move all nve\nfix hot all langevin 1 1 1 4711": r"with fix hot \(langevin\) there is",
    "fix move all nve\nfix back all recenter 1 1 1": r"one of these does: back \(recenter\)",
    "fix move all nonsense": "Unrecognized fix style 'nonsense'",
}


@pytest.mark.parametrize("fixes", REFUSED)
def test_fixes_that_leave_no_reference_are_refused(write_deck, fixes):
    with pytest.raises(DeckError, match=REFUSED[fixes]):
        LammpsForces(write_deck(fixes))
