"""Constant pressure of bodies with dipoles: torques on atoms do not enter the diagonal of the molecular virial."""

import numpy as np
import pytest
from support.constant_pressure import MOMENT, TARGET, dipoles_deck, ends
from support.scenes import largest_change


def test_virial_is_the_change_of_energy_with_the_box(lmp_tree):
    """Centers move, and atoms and dipoles keep their directions."""
    d, words = 1e-3, "aniso 0 0 100 ptemp 1"
    changes = [np.ones(3)] + [1.0 + d * by * np.eye(3)[k] for k in range(3) for by in (-2, -1, 1, 2)]
    decks = [dipoles_deck(words, factors=c, motion=False) for c in changes]
    decks.append(dipoles_deck(words, moment=0.0, motion=False))
    result, _ = ends(lmp_tree, decks)
    first, *others, without = result.thermo

    def diagonal(table):
        return np.array([table[f"f_move[{k}]"][0] for k in (16, 17, 18)]) * table["Volume"][0]

    virial = diagonal(first)
    energy = np.array([t["PotEng"][0] for t in others]).reshape(3, 4)
    found = -(energy @ np.array([1, -8, 8, -1])) / (12 * d)
    scale = np.abs(virial).max()
    assert np.abs(virial - found).max() < 1e-8 * scale
    # without dipoles it differs
    assert np.abs(virial - diagonal(without)).max() > 0.03 * scale


@pytest.mark.parametrize("mode", ["iso {p} 2.0", "iso {p} 2.0 temp 0.4 0.4 0.8", "aniso {p} 2.0 temp 0.4 0.4 0.8"])
def test_orders(lmp_tree, mode):
    """Of velocities and conserved energy, compared with more values and shorter steps."""
    schemes, steps = {"values 5": 5, "values 7": 7}, (0.02, 0.01)
    words = mode.format(p=f"{TARGET} {TARGET}")
    decks = [dipoles_deck(f"values 9 {words}", 0.0025)]
    decks += [dipoles_deck(f"{scheme} {words}", dt) for scheme in schemes for dt in steps]
    decks.append(dipoles_deck(f"values 9 {words}", 0.0025, moment=1.01 * MOMENT))
    result, frames = ends(lmp_tree, decks)

    def errors(k):
        return np.abs(frames[k] - frames[0])[:, 3:6].max(), largest_change(result.thermo[k])

    found = np.array([errors(k) for k in range(1, len(decks) - 1)]).reshape(len(schemes), len(steps), 2)
    for values, (coarse, fine) in zip(schemes.values(), found):
        assert (np.log2(coarse / fine) > values - 1.4).all(), values
    assert errors(len(decks) - 1)[0] > 1e4 * found[0][1][0]


def test_shear_is_refused(lmp_tree):
    """Shear is refused, but not for points whose atom style has torques, nor for a tilted box with constant angles."""
    words = f"{TARGET} {TARGET} 2.0 ptemp 0.4"
    said = "shear components of the pressure require atoms that are points"
    lmp_tree.refuse(dipoles_deck("tri " + words, tilt=0.1), said)
    result, _ = ends(lmp_tree, [dipoles_deck("tri " + words, tilt=0.1, moment=0.0), dipoles_deck("iso " + words, tilt=0.1)])
    assert all(largest_change(table) < 1e-6 for table in result.thermo)
