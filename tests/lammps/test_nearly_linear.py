"""Bodies with a small moment of inertia: followed, or refused before the first step with the moment named."""

import re

import numpy as np
import pytest
from scenes import one_after_the_other

O, C, LENGTH = 15.9994, 12.011, 1.16

# CO2 with its carbon off the axis; it spins about the axis of the smallest moment and tumbles
DECK = """
units real
atom_style molecular
atom_modify map array
region box block -20 20 -20 20 -20 20
create_box 2 box
mass 1 {O}
mass 2 {C}
{atoms}
pair_style zero 3.0
pair_coeff * *
timestep {dt}
fix move all {fix}
thermo_style custom step ke
thermo_modify format float %.15g
thermo 100
run {steps}
"""


def carbon_dioxide(
    bend, spin, tumble=0.002, fix="gear/quat molecule report no", dt=1.0, steps=200, n=1, mass=O
):
    total = 2 * mass + C
    sites = np.array([[-LENGTH, 0, 0], [0, bend, 0], [LENGTH, 0, 0]])
    arms = sites - np.array([mass, C, mass]) @ sites / total
    lines = []
    for molecule in range(n):
        for k, (site, arm) in enumerate(zip(sites, arms)):
            tag, v = 3 * molecule + k + 1, np.cross([spin if molecule == 0 else 0, 0, tumble], arm)
            y = site[1] + 3.0 * (molecule - n // 2)
            lines.append(f"create_atoms {1 + (k == 1)} single {site[0]} {y:.17g} {site[2]}")
            lines.append(
                f"set atom {tag} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g} mol {molecule + 1}"
            )
    return DECK.format(O=mass, C=C, atoms="\n".join(lines), fix=fix, dt=dt, steps=steps)


@pytest.mark.parametrize("bend, smallest", [(0.02, 0.0034932), (0.002, 3.4932e-05)])
def test_refused_with_the_smallest_moment(lmp_wheel, bend, smallest):
    """The moment by hand: m_C 2 m_O / M times the square of the bend."""
    assert C * 2 * O / (2 * O + C) * bend**2 == pytest.approx(smallest, rel=1e-4)
    for ranks in (1, 4):
        result = lmp_wheel.run(carbon_dioxide(bend, 2.7), ranks=ranks)
        assert result.returncode != 0 and not result.thermo
        assert len(set(result.errors)) == 1
        told = re.search(
            r"body 1 turns with an angular velocity of (\S+) about the axis of its smallest moment of inertia, (\S+), "
            r"the largest being (\S+): (\S+) radians in a step are more than 8 values can follow; use a time step of (\S+) ",
            " ".join(result.errors[0].split()),
        )
        omega, moment, largest, radians, step = map(float, told.groups())
        assert moment == pytest.approx(smallest, rel=1e-4) and largest == pytest.approx(
            43.06, rel=1e-3
        )
        assert omega == pytest.approx(2.7, rel=1e-3) and radians == pytest.approx(omega)
    result = lmp_wheel.run(carbon_dioxide(bend, 2.7, dt=step, steps=2000))
    assert result.returncode == 0, result.output  # at the step that the message names


def test_what_is_followed_is_not_refused(lmp_wheel):
    """The fastest of these spins ends in a thousand steps; a hundred more than are flown are right."""
    decks = [
        carbon_dioxide(bend, spin, steps=100) for bend in (0.02, 0.002) for spin in (0.1, 0.2, 0.3)
    ]
    result = lmp_wheel.run(one_after_the_other(decks))
    assert result.returncode == 0, result.output
    for table in result.thermo:
        assert table["KinEng"][-1] == pytest.approx(table["KinEng"][0], rel=3e-4)


def test_a_share_of_the_energy_that_will_be_too_much_is_warned_of(lmp_wheel):
    warning = "will turn, once it has its share of the kinetic energy, with an angular velocity of"
    for n, told in ((12, True), (3, False)):
        result = lmp_wheel.run(carbon_dioxide(0.02, 0.0, tumble=0.02, n=n, steps=5))
        assert result.returncode == 0, result.output
        assert (warning in " ".join(result.output.split())) == told


def test_an_infile_makes_it_linear(lmp_wheel):
    """As the message proposes."""
    inertia = 2 * O * LENGTH**2
    text = f"1\n1 {2 * O + C:.17g} 0 {C * 0.02 / (2 * O + C):.17g} 0 0 {inertia} {inertia} 0 0 0 0 0 0 0 0 0.1 0 0 0\n"
    (lmp_wheel.folder / "bodies").write_text(text)
    fix = "gear/quat molecule report no infile bodies"
    result = lmp_wheel.run(carbon_dioxide(0.02, 2.7, fix=fix, dt=2.0))
    assert result.returncode == 0, result.output


def test_the_blow_up_names_the_moment(lmp_wheel):
    """A torque that spins it up in the run."""
    deck = carbon_dioxide(0.02, 0.0).replace(
        "run 200",
        "group carbon type 2\nvariable push atom 1.0*step\nfix push carbon addforce 0 0 v_push\nrun 1000",
    )
    result = lmp_wheel.run(deck)
    assert result.returncode != 0
    words = " ".join(result.output.split())
    assert "blow-up in step" in words
    assert (
        "turns about the axis of its smallest moment of inertia, 0.0034932, the largest being 43.06"
        in words
    )


def test_a_run_of_no_steps_is_not_refused(lmp_wheel):
    """It serves to see energies, or to scale velocities: then the next one may be right."""
    deck = carbon_dioxide(0.02, 2.7, steps=0) + "velocity all scale 1.0\nrun 20\n"
    result = lmp_wheel.run(deck)
    assert result.returncode == 0, result.output
    assert len(result.thermo) == 2
