"""Keyword points: ions and flexible molecules in the same box, and at the same pressure, as rigid bodies."""

import numpy as np
import pytest
from support.scenes import TRIMER, template

DECK = """
units lj
atom_style full
atom_modify map array sort 0 0.0
region box block 0 12 0 12 0 12
create_box 4 box bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 1
molecule rigid rigid.mol
molecule loose loose.mol
lattice sc 0.037037 origin 0.2 0.2 0.2
create_atoms 0 box mol rigid 4711
lattice sc 0.037037 origin 0.7 0.7 0.7
create_atoms 0 box mol loose 4712
lattice sc 0.0046296 origin 0.2 0.7 0.2
create_atoms 4 box
mass * 1.0
mass 2 2.0
pair_style {pair}
pair_coeff * * {coeff}
bond_style harmonic
bond_coeff 1 40.0 0.8
special_bonds lj/coul 0 1 1
group loose type 3 4
neighbor 0.4 bin
neigh_modify every 5 delay 0 check no exclude molecule/intra all
velocity all create {warmth} 8981 loop geom
comm_modify cutoff 4.0
timestep {dt}
{before}
fix move all gear/quat molecule {words} report no
thermo_style custom step vol econserve pe f_move[1] f_move[2]
thermo_modify norm no format float %.15g
thermo {every}
{run}
write_dump all custom end id x y z vx vy vz modify sort id format float %.17g
"""
LOOSE = template([(0, 0, 0), (0.8, 0, 0)], [3, 3], bonds=[(1, 2)])


@pytest.fixture
def simulate(lmp_tree):
    """(words of the fix, settings of DECK) -> result, positions and velocities at the end."""
    (lmp_tree.folder / "rigid.mol").write_text(TRIMER)
    (lmp_tree.folder / "loose.mol").write_text(LOOSE)

    def run(words, ranks=1, **changes):
        settings = dict(pair="buck 2.6", coeff="60.0 0.08 0.0", dt=0.004, before="", every=20, run="run 200", warmth=1.0)
        deck = changes.pop("deck", DECK).format(words=words, **(settings | changes))
        result = lmp_tree.succeed(deck, ranks=ranks)
        return result, np.loadtxt(lmp_tree.folder / "end", skiprows=9)[:, 1:]

    return run


def energy(result):
    table = {name: np.array(values) for name, values in result.thermo[-1].items()}
    return table["PotEng"] + table["f_move[1]"] + table["f_move[2]"]


def test_the_same_motion_as_with_a_variable(simulate):
    """Every atom of the group is a body, also within a molecule and with molecule ID 0."""
    result, end = simulate("points loose")
    assert "WARNING" not in result.log
    deck = DECK.replace("gear/quat molecule", "gear/quat custom v_own")
    variable = "variable own atom (type<3)*mol+(type>2)*(1000+id)"
    _, other = simulate("", deck=deck, before=variable)
    assert (end == other).all()


def test_proposed_exclusions_leave_flexible_molecules_alone(simulate):
    deck = DECK.replace("check no exclude molecule/intra all", "check no").replace("report no", "")
    said = "group rigid subtract all loose; neigh_modify exclude molecule/intra rigid"
    assert said in simulate("points loose", deck=deck, run="run 0")[0].words
    mended = deck.replace("fix move", said.replace("; ", "\n") + "\nfix move")
    _, mark, after = simulate("points loose", deck=mended, run="run 0")[0].words.partition("Setting up")
    assert mark and "neigh_modify exclude" not in after


def test_energy_to_the_order_of_the_method(simulate):
    decks = [dict(dt=dt, run=f"run {round(0.8 / dt)}", every=1) for dt in (0.016, 0.008)]
    errors = [np.ptp(energy(simulate("points loose values 7", **deck)[0])) for deck in decks]
    assert errors[0] / errors[1] > 2**5.5
    assert errors[1] < 3e-5


def test_pressure_of_a_mixture(simulate):
    """Without forces between N molecules, <V> = (N + 1) kT/P: bonds contribute what binds their atoms together."""
    words = "points loose langevin 1.2 1.2 0.5 4711 iso 0.2 0.2 1.0"
    setting = dict(pair="zero 1.0", coeff="", dt=0.03, every=10, run="run 1000\nrun 15000", warmth=1.2)
    volumes = np.array(simulate(words, **setting)[0].thermo[-1]["Volume"])
    exact = (64 + 64 + 8 + 1) * 1.2 / 0.2
    means = np.array([block.mean() for block in np.array_split(volumes, 20)])
    error = means.std(ddof=1) / np.sqrt(20)
    assert error < 0.01 * exact
    assert abs(volumes.mean() - exact) < 4 * error


def test_restart_and_ranks(simulate):
    _, whole = simulate("points loose", run="run 100\nwrite_restart half\nrun 100")
    resumed = DECK[: DECK.index("region box")] + "read_restart half\n" + DECK[DECK.index("mass *") :]
    resumed = resumed.replace("group loose type 3 4\n", "").replace("velocity all", "#")
    assert (simulate("points loose", deck=resumed, run="run 100")[1] == whole).all()
    assert simulate("points loose", deck=resumed, run="run 100", ranks=2)[1] == pytest.approx(whole, abs=1e-10)


@pytest.mark.parametrize(
    "words, said",
    [
        ("points nowhere", "points: group ID nowhere does not exist"),
        ("", "has molecule ID 0; take it out of the group, give it the ID of its body, or name it by keyword points"),
    ],
)
def test_refused(lmp_tree, simulate, words, said):
    simulate("points loose", run="run 0")
    deck = DECK.format(words=words, pair="zero 1.0", coeff="", dt=0.1, before="", every=1, run="run 0", warmth=1.0)
    lmp_tree.refuse(deck, said)
    group = deck.replace("fix move all gear/quat molecule " + words, "fix move some gear/quat molecule points loose")
    group = group.replace("timestep", "group some type 1 2\ntimestep")
    lmp_tree.refuse(group, "of group loose is not in the group of the fix")
    large = deck.replace("gear/quat molecule " + words, "gear/quat molecule points loose ").replace("timestep", "set atom 1 mol 1000000001\ntimestep")
    lmp_tree.refuse(large, "body 1000000001 has the ID of a point")
