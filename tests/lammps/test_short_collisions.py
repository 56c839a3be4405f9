"""Collisions that are too short for the time step, of a body between walls and of the molecules of a dilute gas."""

import re

import pytest

TRIMER = "trimer\n\n3 atoms\n\nCoords\n\n1 0 0 0\n2 0.9 0 0\n3 0.2 0.8 0\n\nTypes\n\n1 1\n2 1\n3 1\n"
DECK = """
units lj
atom_style full
boundary {boundary} {boundary} {boundary}
lattice sc 0.002
region box block 0 {cells} 0 {cells} 0 {cells}
create_box 1 box
molecule body trimer.mol
mass 1 1
pair_style {pair} 2.5
pair_coeff * * {coefficients}
neighbor 0.4 bin
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
{create}
timestep {dt}
thermo 1000
thermo_style custom step temp pe etotal
thermo_modify norm no format float %.17g
{before}
fix move all gear/quat molecule {words}
run {steps}
"""
GAS = {
    **dict(boundary="p", cells=4, pair="lj/smooth/linear", coefficients="1 1", before=""),
    "create": "create_atoms 0 box mol body 4711\nvelocity all create 1.0 4711 loop geom",
}
WALLS = " ".join(f"{axis}{side} EDGE 1.0 1.0 8.0" for axis in "xyz" for side in ("lo", "hi"))
LONE = {
    **dict(boundary="f", cells=2.5, pair="zero", coefficients=""),
    "create": "create_atoms 0 single 1.25 1.25 1.25 mol body 4711\nvelocity all set 2.0 0.3 0.4 units box",
    "before": f"fix walls all wall/lj126 {WALLS}\nfix_modify walls energy yes",
}
TOLD = re.compile(
    r"move: by step (\d+) collisions have been too short for the time step: in (\S+) % of all steps of bodies the "
    r"error exceeds 10 % of the motion; use a time step of (\S+) or shorter, or keyword tolerance"
)


def collide(lmp, scene, dt, time, words="", ranks=1, **changes):
    """The warnings, and the largest change of the energy as a part of its first value."""
    (lmp.folder / "trimer.mol").write_text(TRIMER)
    deck = DECK.format(dt=dt, words=words, **{"steps": round(time / dt), **scene, **changes})
    result = lmp.succeed(deck, ranks=ranks)
    energies = [energy for table in result.thermo for energy in table["TotEng"]]
    assert energies[0] > 0.0
    return TOLD.findall(result.words), max(abs(energy / energies[0] - 1.0) for energy in energies)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_body_between_walls(lmp_wheel, ranks):
    """The advised step conserves the energy, and is not warned of; neither is a tolerance."""
    ((step, part, advised),), lost = collide(lmp_wheel, LONE, 0.025, 400, ranks=ranks)
    assert int(step) <= 16000 and 0.001 < float(part) < 5 and lost > 0.03
    assert float(advised) == 0.012
    told, lost = collide(lmp_wheel, LONE, float(advised), 400, ranks=ranks)
    assert not told and lost < 0.003
    told, lost = collide(lmp_wheel, LONE, 0.025, 400, "tolerance 1e-7", ranks=ranks)
    assert not told and lost < 0.003


def test_a_dilute_gas(lmp_wheel):
    """One warning in several runs."""
    ((_, part, advised),), lost = collide(lmp_wheel, GAS, 0.016, 100, steps="3000\nrun 3000")
    assert 0.001 < float(part) < 0.1 and lost > 0.003
    told, lost = collide(lmp_wheel, GAS, float(advised), 100)
    assert not told and lost < 1e-3


@pytest.mark.parametrize(
    "words, before",
    [
        ("corrector gear", LONE["before"]),
        ("", LONE["before"] + "\nfix l all langevin 1.0 1.0 1.0 4711"),
        ("", ""),
    ],
)
def test_other_large_errors(lmp_wheel, words, before):
    """Errors of Gear's coefficients and of random forces are large in any case; a free body has none."""
    told, _ = collide(lmp_wheel, LONE, 0.016, 400, words, before=before, boundary="f" if before else "p")
    assert not told


def test_bodies_that_are_inserted(lmp_wheel):
    """Their histories settle in the first steps."""
    deposit = "fix in all deposit 20 0 20 4711 region box near 2.0 mol body vx 0.1 0.2 attempt 1000"
    told, _ = collide(lmp_wheel, GAS, 0.005, 5, create="create_atoms 0 single 2 2 2 mol body 4711\nvelocity all set 0.1 0.2 0.3", before=deposit)
    assert not told
