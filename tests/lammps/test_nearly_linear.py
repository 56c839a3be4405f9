"""Bodies with a small moment of inertia: followed, or refused before the first step."""

import re

import numpy as np
import pytest
from support.scenes import one_after_the_other, placed

O, C, LENGTH = 15.9994, 12.011, 1.16


# CO2 with its carbon off the axis; the first molecule rotates about the axis of the smallest moment
def carbon_dioxide(bend, spin, tumble=0.002, words="", dt=1.0, steps=200, n=1, **settings):
    sites = np.array([[-LENGTH, 0, 0], [0, bend, 0], [LENGTH, 0, 0]])
    arms = sites - np.average(sites, axis=0, weights=[O, C, O])
    bodies = [sites + [0, 3.0 * (k - n // 2), 0] for k in range(n)]
    omegas = [(0 if k else spin, 0, tumble) for k in range(n)]
    velocities = np.concatenate([np.cross(omega, arms) for omega in omegas])
    settings |= dict(units="real", boundary="p p p", masses=f"mass 1 {O}\nmass 2 {C}")
    settings |= dict(fix=f"gear/quat molecule report no {words}", dt=dt, steps=steps)
    return placed(bodies, velocities, kinds=[1, 2, 1] * n, **settings)


@pytest.mark.parametrize("bend", [0.02, 0.002])
def test_refused_before_the_first_step(lmp_wheel, bend):
    told = r"body 1 moves by \S+ and turns by (\S+) radians in one step"
    for ranks in (1, 4):
        result = lmp_wheel.refuse(carbon_dioxide(bend, 4.0), "body 1 moves", ranks=ranks)
        assert not result.thermo and len(set(result.errors)) == 1
        assert float(re.search(told, result.words)[1]) == pytest.approx(4.0, rel=1e-3)


def test_what_is_followed_is_not_refused(lmp_wheel):
    decks = [carbon_dioxide(bend, spin, steps=100) for bend in (0.02, 0.002) for spin in (0.3, 1.0, 3.0)]
    for table in lmp_wheel.succeed(one_after_the_other(decks)).thermo:
        assert table["KinEng"][-1] == pytest.approx(table["KinEng"][0], rel=3e-4)


def test_an_infile_makes_it_linear(lmp_wheel):
    """The remedy in the manual works."""
    mass, inertia = 2 * O + C, 2 * O * LENGTH**2
    line = f"1\n1 {mass} 0 {C * 0.02 / mass} 0 0 {inertia} {inertia} 0 0 0 0 0 0 0 0 0.1 0 0 0\n"
    (lmp_wheel.folder / "bodies").write_text(line)
    lmp_wheel.succeed(carbon_dioxide(0.02, 4.0, words="infile bodies", dt=2.0))


def test_a_run_of_no_steps_is_not_refused(lmp_wheel):
    """Run 0 can be used to print energies, or to scale velocities, so that the next run may be stable."""
    deck = carbon_dioxide(0.02, 4.0, run="run 0\nvelocity all scale 1.0\nrun 20")
    assert len(lmp_wheel.succeed(deck).thermo) == 2
