"""examples/fields: LAMMPS' own fixes act on the sites of bodies."""


import numpy as np
import pytest


@pytest.fixture
def fields(lmp_tree, examples):
    """Run the example with an effect: fields(effect, **variables) -> result, columns of the log."""

    def run(effect, **variables):
        deck = (examples / "fields" / "in.fields").read_text()
        deck = deck.replace(" molecule.body", f" {examples / 'fields' / 'molecule.body'}")
        result = lmp_tree.succeed(deck, {"effect": effect, **variables})
        return result, {name: np.array(column) for name, column in result.thermo[-1].items()}

    return run


# acceleration of the common center: g, and q E / m
@pytest.mark.parametrize("effect, pull", [("gravity", -0.1), ("field", 0.5 * 0.2 / 4.0)])
def test_constant_forces_give_the_exact_fall(fields, effect, pull, formulation):
    _, log = fields(effect, words=f"formulation {formulation}")
    fallen = log["c_centre[3]"] - 0.5 * pull * log["Time"] ** 2
    assert np.abs(fallen).max() < 1e-12
    assert np.abs(fallen - 0.005 * pull * log["Time"] ** 2).max() > 1e-3  # 1 % is detected
    for k in (1, 2):
        assert np.abs(log[f"c_centre[{k}]"]).max() < 1e-12
    change = 1e-12 if effect == "gravity" else 1e-9  # dipoles oscillate
    assert log["TotEng"] == pytest.approx(np.full(11, log["TotEng"][0]), rel=change)
    assert np.ptp(log["KinEng"]) > 0.01 * log["KinEng"][0]


def test_a_wall_sends_bodies_back_and_keeps_the_energy(fields):
    _, log = fields("wall", steps=2000, dt=0.005)
    assert log["TotEng"] == pytest.approx(np.full(21, log["TotEng"][0]), rel=2e-6)
    assert log["PotEng"].max() > 0.1
    _, free = fields("none", steps=2000, dt=0.005)
    assert (log["c_centre[3]"] - free["c_centre[3]"])[-1] > 0.1
