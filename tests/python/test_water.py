"""The water scene: what data.water claims, and how smooth the two kinds of forces are."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial import cKDTree

from support.running import EXAMPLES

DECK = EXAMPLES / "water" / "in.water"
DATA = EXAMPLES / "water" / "data.water"
MOLECULES = 216
#: bonds of SPC/E in Angstrom; the angle is acos(-1/3)
BONDS = {(0, 1): 1.0, (0, 2): 1.0, (1, 2): np.sqrt(8 / 3)}
CUTOFF = 8.0

#: Coulomb's constant in LAMMPS' real units
COULOMB = 332.06371
MASS = np.array([15.9994, 1.008, 1.008])
EPSILON, SIGMA = 0.1553, 3.166


@dataclass
class Water:
    """``box`` edge; ``charge`` (n, 3); ``x`` (n, 3 sites, 3), O first, unwrapped."""

    box: float
    charge: np.ndarray
    x: np.ndarray


@pytest.fixture(scope="module")
def water():
    edges = [line.split()[:2] for line in DATA.read_text().splitlines() if line.endswith("hi")]
    low, high = np.array(edges, dtype=float).T
    assert (low == 0).all() and (high == high[0]).all()
    atoms = np.loadtxt(DATA.read_text().partition("Atoms # full")[2].splitlines())
    assert (atoms[:, 1] == np.repeat(np.arange(MOLECULES) + 1, 3)).all()
    assert (atoms[:, 2] == np.tile([1, 2, 2], MOLECULES)).all()
    return Water(high[0], atoms[:, 3].reshape(-1, 3), atoms[:, 4:7].reshape(MOLECULES, 3, 3))


# --- the data file ------------------------------------------------------------------------------
def misfit(x):
    """Largest deviation of a bond length from SPC/E."""
    lengths = {(i, j): np.linalg.norm(x[:, i] - x[:, j], axis=-1) for i, j in BONDS}
    return max(abs(lengths[bond] - r).max() for bond, r in BONDS.items())


def test_molecules_are_rigid(water):
    assert misfit(water.x) < 1e-12


def test_density(water):
    assert MOLECULES * MASS.sum() / (0.602214076 * water.box**3) == pytest.approx(0.997, rel=1e-9)


# --- energies -----------------------------------------------------------------------------------
def pair_energy(r, charges, oxygens, forces):
    """Energy of pairs of sites at distances r (n,), as in forces.smooth and forces.plain."""
    u = (r / CUTOFF) ** 2
    damping, switch = ((1 - u) ** 6, (1 - u**6) ** 6) if forces == "smooth" else (1.0, 1.0)
    sixth = (SIGMA / r) ** 6
    lennard_jones = np.where(oxygens, 4 * EPSILON * (sixth**2 - sixth), 0.0)
    return COULOMB * charges / r * damping + lennard_jones * switch


def potential_energy(water, forces, factor=1.0):
    """Sum over all pairs of sites of different molecules and their nearest images."""
    sites, charge = water.x.reshape(-1, 3), water.charge.ravel() * factor
    tree = cKDTree(sites % water.box, boxsize=water.box)
    i, j = tree.query_pairs(CUTOFF, output_type="ndarray").T
    i, j = np.array([i, j])[:, i // 3 != j // 3]
    gap = sites[i] - sites[j]
    r = np.linalg.norm(gap - water.box * np.round(gap / water.box), axis=1)
    oxygens = (i % 3 == 0) & (j % 3 == 0)
    return pair_energy(r, charge[i] * charge[j], oxygens, forces).sum()


@pytest.mark.parametrize("forces", ["smooth", "plain"])
def test_initial_energy(lmp_wheel, water, forces):
    """The sum is independent."""
    start = lmp_wheel.succeed(DECK, {"forces": forces, "steps": 0}).thermo[-1]
    assert start["PotEng"][0] == pytest.approx(potential_energy(water, forces), rel=1e-10)
    assert start["Temp"][0] == pytest.approx(300.0, rel=1e-9)


# --- smoothness ---------------------------------------------------------------------------------
TABLE = """
units real
atom_style full
read_data {data}
include {data.parent}/forces.{forces}
pair_write {kind} {n} r {first:.17g} {last:.17g} table pair {charges}
"""
PAIRS = {"1 1": (-0.8476, -0.8476), "1 2": (-0.8476, 0.4238), "2 2": (0.4238, 0.4238)}


def table(lmp, forces, kind, distances):
    """Energy and force of a pair at equidistant ``distances``, from LAMMPS."""
    settings = {"data": DATA, "forces": forces, "kind": kind, "n": len(distances)}
    settings |= {"first": distances[0], "last": distances[-1]}
    (lmp.folder / "table").unlink(missing_ok=True)
    lmp.succeed(TABLE.format(charges="{} {}".format(*PAIRS[kind]), **settings))
    lines = (lmp.folder / "table").read_text().split("\n\n")[-1].splitlines()
    _, r, energy, force = np.loadtxt(lines).T
    assert r == pytest.approx(distances, rel=1e-9)
    return energy, force


@pytest.mark.parametrize("kind", PAIRS)
def test_force_vanishes_smoothly_at_the_cutoff(lmp_wheel, kind):
    """Force and four derivatives of it are zero at the cut-off; with a plain cut-off nothing is."""
    gaps = np.array([0.04, 0.03, 0.02, 0.01])
    for forces, order in (("smooth", 5), ("plain", 0)):
        _, force = table(lmp_wheel, forces, kind, CUTOFF - gaps)
        slope = np.log(force[-2] / force[-1]) / np.log(gaps[-2] / gaps[-1])
        assert slope == pytest.approx(order, abs=0.1)


def order(lmp, forces, values):
    """Order of the error of positions after 12 fs between steps of 1 and 0.5 fs."""
    out, ends = lmp.folder / "out", {}
    for dt in (1.0, 0.5, 0.125):
        steps = round(12.0 / dt)
        variables = {"forces": forces, "fix": f"gear/quat molecule values {values}", "dt": dt, "out": out}
        lmp.succeed(DECK, variables | dict.fromkeys(("steps", "every", "dump"), steps))
        frame = out.with_suffix(".dump").read_text().rpartition("ITEM: ATOMS")[2]
        ends[dt] = np.loadtxt(frame.splitlines()[1:])[:, 4:7]
    errors = [np.linalg.norm(ends[dt] - ends[0.125]) for dt in (1.0, 0.5)]
    return np.log2(errors[0] / errors[1])


def test_smooth_forces_keep_the_order(lmp_wheel):
    """Six rows have order 5 for rotating bodies, and eight rows have order 7; with a plain cut-off the order is low."""
    assert order(lmp_wheel, "smooth", 6) > 4.5
    assert order(lmp_wheel, "smooth", 8) > 6.0
    assert order(lmp_wheel, "plain", 6) < 3.0
