"""The water scene: what data.water claims, and how smooth the two kinds of forces are."""

from dataclasses import dataclass

import numpy as np
import pytest

from running import EXAMPLES

DECK = EXAMPLES / "water" / "in.water"
DATA = EXAMPLES / "water" / "data.water"
MOLECULES = 500
R_OH, R_HH = 1.0, np.sqrt(8 / 3)  # Angstrom; the angle is acos(-1/3)
CUTOFF = 8.0

# LAMMPS' real units: Coulomb's constant, Boltzmann's, and g/mol (Angstrom/fs)^2 -> kcal/mol
COULOMB, BOLTZMANN, ENERGY = 332.06371, 0.0019872067, 48.88821291**2
MASS = np.array([15.9994, 1.008, 1.008])
EPSILON, SIGMA = 0.1553, 3.166


@dataclass
class Water:
    """``box`` edge; ``charge`` (500, 3); ``x``, ``v`` (500, 3 sites, 3), O first, unwrapped."""

    box: float
    charge: np.ndarray
    x: np.ndarray
    v: np.ndarray


@pytest.fixture(scope="module")
def water():
    text = DATA.read_text()
    edges = [line.split()[:2] for line in text.splitlines() if line.endswith("hi")]
    low, high = np.array(edges, dtype=float).T
    assert (low == 0).all() and (high == high[0]).all()
    atoms, velocities = text.partition("Atoms # full")[2].split("Velocities")
    atoms = np.loadtxt(atoms.split("\n"))
    velocities = np.loadtxt(velocities.split("\n"))
    atoms, velocities = (table[table[:, 0].argsort()] for table in (atoms, velocities))
    assert (atoms[:, 1] == np.repeat(np.arange(MOLECULES) + 1, 3)).all()
    assert (atoms[:, 2] == np.tile([1, 2, 2], MOLECULES)).all()
    x = atoms[:, 4:7] + atoms[:, 7:10] * high[0]
    shape = (MOLECULES, 3, 3)
    charge = atoms[:, 3].reshape(-1, 3)
    return Water(high[0], charge, x.reshape(shape), velocities[:, 1:4].reshape(shape))


# --- the data file ------------------------------------------------------------------------------
def misfit(x):
    """Largest deviation of a bond length from SPC/E."""
    pairs = ((0, 1, R_OH), (0, 2, R_OH), (1, 2, R_HH))
    return max(abs(np.linalg.norm(x[:, i] - x[:, j], axis=-1) - r).max() for i, j, r in pairs)


def stretching(x, v):
    """Largest rate at which a bond length changes."""
    pairs = ((0, 1), (0, 2), (1, 2))
    return max(
        abs(((x[:, i] - x[:, j]) * (v[:, i] - v[:, j])).sum(axis=-1)).max() for i, j in pairs
    )


def test_molecules_are_rigid(water):
    assert misfit(water.x) < 1e-12
    assert misfit(water.x * 1.01) > 1e-3
    assert stretching(water.x, water.v) < 1e-14
    bent = water.v.copy()
    bent[:, 1] *= 1.01
    assert stretching(water.x, bent) > 1e-5


def temperature(v):
    """Of rigid molecules with no momentum, kelvin."""
    kinetic = 0.5 * ENERGY * (MASS[:, None] * v**2).sum()
    return 2 * kinetic / ((6 * MOLECULES - 3) * BOLTZMANN)


def test_density_temperature_and_momentum(water):
    density = MOLECULES * MASS.sum() / (0.602214076 * water.box**3)
    assert density == pytest.approx(0.997, rel=1e-9)
    assert temperature(water.v) == pytest.approx(300.0, rel=1e-6)
    assert temperature(1.01 * water.v) != pytest.approx(300.0, rel=1e-3)
    momentum = MASS[:, None] * water.v
    assert abs(momentum.sum(axis=(0, 1))).max() < 1e-12 * abs(momentum).sum()


def peak(x, box, low, high):
    """Distance where g(OO) of one configuration is largest, in shells of 0.1 Angstrom."""
    gap = x[:, None, 0] - x[None, :, 0]
    gap -= box * np.round(gap / box)
    r = np.linalg.norm(gap, axis=-1)[np.triu_indices(MOLECULES, 1)]
    edges = np.arange(low, high, 0.1)
    count, _ = np.histogram(r, edges)
    middle = (edges[1:] + edges[:-1]) / 2
    return middle[np.argmax(count / middle**2)]


def test_structure_is_that_of_water(water):
    """First neighbours at 2.75 Angstrom, second ones where a tetrahedron has them, at 4.5."""
    assert abs(peak(water.x, water.box, 2.0, 6.0) - 2.75) <= 0.11
    assert abs(peak(water.x, water.box, 3.4, 5.6) - 4.5) <= 0.35


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
    sites = water.x.reshape(-1, 3)
    charge = water.charge.ravel() * factor
    index = np.arange(len(sites))
    total = []
    for i in index[:-1]:
        gap = sites[i + 1 :] - sites[i]
        gap -= water.box * np.round(gap / water.box)
        r = np.sqrt((gap**2).sum(axis=1))
        other = index[i + 1 :]
        near = (r < CUTOFF) & (other // 3 != i // 3)
        oxygens = (i % 3 == 0) & (other[near] % 3 == 0)
        charges = charge[i] * charge[other[near]]
        total.append(pair_energy(r[near], charges, oxygens, forces).sum())
    return np.sum(total)


@pytest.mark.parametrize("forces", ["smooth", "plain"])
def test_initial_energy(lmp_wheel, water, forces):
    """Independent sums, for every method."""
    expected = potential_energy(water, forces)
    kinetic = 0.5 * ENERGY * (MASS[:, None] * water.v**2).sum()
    for method in ("gear", "rigid", "rigid_big", "rigid_verlet"):
        result = lmp_wheel.run(DECK, {"forces": forces, "method": method, "steps": 0})
        assert result.returncode == 0, result.output
        start = {column: values[0] for column, values in result.thermo[-1].items()}
        assert start["c_potential"] == pytest.approx(expected, rel=1e-10)
        assert start["v_ketrans"] + start["v_kerot"] == pytest.approx(kinetic, rel=1e-10)
        assert start["v_total"] == pytest.approx(expected + kinetic, rel=1e-10)
    assert potential_energy(water, forces, 1.01) != pytest.approx(expected, rel=1e-3)


# --- smoothness ---------------------------------------------------------------------------------
TABLE = """
units real
atom_style full
read_data {data}
include {forces}
pair_write {kind} {n} r {first:.17g} {last:.17g} table pair {qi} {qj}
"""
PAIRS = {"1 1": (-0.8476, -0.8476), "1 2": (-0.8476, 0.4238), "2 2": (0.4238, 0.4238)}


def table(lmp, forces, kind, distances):
    """Energy and force of a pair at equidistant ``distances``, from LAMMPS."""
    qi, qj = PAIRS[kind]
    deck = TABLE.format(
        data=DATA,
        forces=DATA.parent / f"forces.{forces}",
        kind=kind,
        n=len(distances),
        first=distances[0],
        last=distances[-1],
        qi=qi,
        qj=qj,
    )
    (lmp.folder / "table").unlink(missing_ok=True)
    result = lmp.run(deck)
    assert result.returncode == 0, result.output
    lines = (lmp.folder / "table").read_text().split("\n\n")[-1].splitlines()
    values = np.loadtxt(lines)
    assert values[:, 1] == pytest.approx(distances, rel=1e-9)
    return values[:, 2], values[:, 3]


def vanishing_order(distances, force):
    """m of force ~ (cut-off - r)^m, from the last two of the distances."""
    ratio = force[-2] / force[-1]
    return np.log(ratio) / np.log((CUTOFF - distances[-2]) / (CUTOFF - distances[-1]))


@pytest.mark.parametrize("kind", PAIRS)
def test_force_vanishes_smoothly_at_the_cutoff(lmp_wheel, kind):
    """Force and four derivatives of it are zero at the cut-off; with a plain cut-off nothing is."""
    distances = CUTOFF - np.array([0.04, 0.03, 0.02, 0.01])
    _, force = table(lmp_wheel, "smooth", kind, distances)
    assert vanishing_order(distances, force) == pytest.approx(5, abs=0.1)
    _, force = table(lmp_wheel, "plain", kind, distances)
    assert vanishing_order(distances, force) == pytest.approx(0, abs=0.1)


@pytest.mark.parametrize("forces", ["smooth", "plain"])
@pytest.mark.parametrize("kind", PAIRS)
def test_force_is_the_slope_of_the_energy(lmp_wheel, forces, kind):
    step = 1e-3
    distances = 2.5 + step * np.arange(5)
    energy, force = table(lmp_wheel, forces, kind, distances)
    slope = (energy[0] - 8 * energy[1] + 8 * energy[3] - energy[4]) / (12 * step)
    assert force[2] == pytest.approx(-slope, rel=1e-7)
    qi, qj = PAIRS[kind]
    expected = pair_energy(distances, qi * qj, kind == "1 1", forces)
    assert energy == pytest.approx(expected, rel=1e-9)
    assert energy != pytest.approx(1.01 * expected, rel=1e-3)


def positions(lmp, **variables):
    """Unwrapped positions (1500, 3) after 12 fs."""
    out = lmp.folder / "out"
    steps = round(12.0 / variables["dt"])
    named = {"steps": steps, "every": steps, "dump": steps, "out": out, **variables}
    result = lmp.run(DECK, named)
    assert result.returncode == 0, result.output
    frame = out.with_suffix(".dump").read_text().rpartition("ITEM: ATOMS")[2]
    return np.loadtxt(frame.splitlines()[1:])[:, 4:7]


def slope(lmp, forces, values):
    """Order of the error of positions between steps of 1 and 0.5 fs."""
    exact = positions(lmp, forces=forces, values=values, dt=0.125)
    error = [
        np.sqrt(((positions(lmp, forces=forces, values=values, dt=dt) - exact) ** 2).mean())
        for dt in (1.0, 0.5)
    ]
    return np.log2(error[0] / error[1])


def test_smooth_forces_keep_the_order(lmp_wheel):
    """Six rows have order 5 for rotating bodies, eight have 7; a plain cut-off leaves little."""
    assert slope(lmp_wheel, "smooth", 6) > 4.5
    assert slope(lmp_wheel, "smooth", 8) > 6.0
    assert slope(lmp_wheel, "plain", 6) < 3.0
