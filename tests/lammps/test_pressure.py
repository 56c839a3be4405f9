"""Constant pressure: orders, the molecular virial, edges of the box, ensembles.

Unsupported settings are in test_bad_input.py, restarts and ranks in test_pressure_runs.py.
"""

import numpy as np
import pytest
from support.constant_pressure import GAUSS, distances, ends, frame, pressed, trimers
from support.scenes import largest_change, water, water_data, with_bonds

EDGES = ("Lx", "Ly", "Lz")
#: elements of the fix's vector: molecular pressures xx yy zz, target, rates of the box, its kinetic energy
KE, PRESSURES, TARGET, RATES, BOX_KE = 1, (16, 17, 18), 22, (23, 24, 25), 26


@pytest.fixture(autouse=True)
def data(tmp_path):
    return trimers(tmp_path / "data.trimers")


# --- the equations ------------------------------------------------------------------------------


def test_the_columns_belong_together(lmp_wheel):
    deck = pressed("values 7 x 0.3 0.5 1.0 y -0.2 0.1 1.0 z 0.8 0.6 1.0 temp 0.7 0.7 0.8", run="run 100")
    result, _ = ends(lmp_wheel, [deck])
    t = {name: np.array(column) for name, column in result.thermo[0].items()}
    f = lambda n: t[f"f_move[{n}]"]
    ramps = np.linspace(0, 1, 11)
    target = ((0.3 + 0.2 * ramps) + (-0.2 + 0.3 * ramps) + (0.8 - 0.2 * ramps)) / 3
    assert f(TARGET) == pytest.approx(target, rel=1e-12)
    assert sum(f(k) for k in PRESSURES) / 3 == pytest.approx(f(PRESSURES[0] - 1), rel=1e-12)
    # (N_f + d) kT Pdamp^2/d with the total momentum conserved
    mass = (21 + 3) * 0.7 / 3
    assert f(BOX_KE) == pytest.approx(0.5 * mass * sum(f(k) ** 2 for k in RATES), rel=1e-12)
    assert np.abs(t["Econserve"] - t["TotEng"] - t["Ecouple"]).max() < 1e-12
    rate = np.array([np.gradient(np.log(t[c]), 0.05)[1:-1] for c in EDGES])
    assert rate == pytest.approx(np.array([f(k)[1:-1] for k in RATES]), abs=0.02)


# --- the virial ---------------------------------------------------------------------------------


def at_rest(data, force):
    """A deck of water without steps."""
    columns = "vol " + " ".join(f"f_move[{k}]" for k in PRESSURES)
    settings = dict(pair=force, skin=2.0, before="velocity all set 0 0 0", columns=columns, run="run 0")
    deck = water(data, "gear/quat molecule iso 0 0 100 ptemp 300", **settings)
    return deck.replace("fix_modify move energy yes", "")


SMOOTH = """pair_style lj/gromacs/coul/gromacs 3.5 4.6
pair_coeff * * 0.0 1.0
pair_coeff 1 1 0.1553 3.166
"""
LONG = """pair_style hybrid/overlay lj/gromacs 3.5 4.6 {style}
pair_coeff * * lj/gromacs 0.0 1.0
pair_coeff 1 1 lj/gromacs 0.1553 3.166
pair_coeff * * {word}
pair_modify table 0
kspace_style {kspace} 1e-9
kspace_modify gewald 0.9 {mesh}
"""
COUL = dict(style="coul/long 4.6", word="coul/long")
TIP4P = """bond_style zero
bond_coeff 1 1.0
angle_style zero
angle_coeff 1 109.47
"""
OF_TIP4P = dict(style="tip4p/long 1 2 1 1 0.15 4.6", word="tip4p/long")
MESH = "order 7 mesh 48 48 48"
# Mesh and g belong to the first box, as in a run: sites of a molecule are not in the list, so g matters.  LAMMPS' erfc
# has seven digits and is not consistent with its derivatives in the forces.
FORCES = {
    "smooth": (SMOOTH, 1e-8),
    "ewald": (LONG.format(kspace="ewald", mesh="kmax/ewald 16 16 16", **COUL), 2e-5),
    "pppm": (LONG.format(kspace="pppm", mesh=MESH, **COUL), 2e-5),
    "tip4p": (TIP4P + LONG.format(kspace="pppm/tip4p", mesh=MESH, **OF_TIP4P), 2e-5),
}
NKTV2P = 68568.415


@pytest.mark.parametrize("name", FORCES)
def test_virial_is_the_change_of_energy_with_the_box(lmp_wheel, name):
    """Centers are scaled and molecules are not: differences of fourth order."""
    force, tolerance = FORCES[name]
    decks, d = [], 2e-4
    for k, axis in enumerate([None, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]):
        factors = np.ones(3)
        if axis is not None:
            factors[axis] = np.exp(d * (-2, -1, 1, 2)[(k - 1) % 4])
        data = with_bonds(water_data(lmp_wheel.folder / f"data.{k}", shift=1.65, factors=factors))
        decks.append(at_rest(data, force))
    result = lmp_wheel.succeed("\nclear\n".join(decks))
    tables = result.thermo
    virial = np.array([tables[0][f"f_move[{k}]"][0] for k in PRESSURES]) * tables[0]["Volume"][0] / NKTV2P
    energy = np.array([t["PotEng"][0] for t in tables[1:]]).reshape(3, 4)
    change = -(energy @ np.array([1, -8, 8, -1])) / (12 * d)
    scale = np.abs(virial).max()
    assert np.abs(virial - change).max() < tolerance * scale


def test_tail_corrections_are_those_of_thermo(lmp_wheel):
    force = "pair_style lj/cut 4.5\npair_coeff * * 0.0 1.0\npair_coeff 1 1 0.1553 3.166\npair_modify tail {}\n"
    data = water_data(lmp_wheel.folder / "data.0", shift=1.65)
    decks = [at_rest(data, force.format(tail)) for tail in ("no", "yes")]
    without, with_tail = lmp_wheel.succeed("\nclear\n".join(decks)).thermo
    of_thermo = with_tail["Press"][0] - without["Press"][0]
    assert abs(of_thermo) > 1.0
    for k in PRESSURES:
        assert with_tail[f"f_move[{k}]"][0] - without[f"f_move[{k}]"][0] == pytest.approx(of_thermo, rel=1e-9)


# --- edges --------------------------------------------------------------------------------------

COUPLES = {"xyz": (0, 1, 2), "xy": (0, 1), "yz": (1, 2), "xz": (0, 2)}


@pytest.mark.parametrize("couple", ["none", *COUPLES])
def test_coupled_edges_are_the_same(lmp_wheel, couple):
    """Results agree to the last digits for any corner of the box; other fixed points differ."""
    result, _ = ends(lmp_wheel, [pressed(f"aniso 0.3 0.3 1.0 temp 0.7 0.7 0.8 couple {couple}", run="run 200")])
    edges = np.array([result.thermo[0][c] for c in EDGES])
    assert largest_change(result.thermo[0]) < 1e-6
    tied = COUPLES.get(couple, (0,))
    for k in range(3):
        apart = np.abs(edges[k] - edges[tied[0]]).max()
        assert apart < 1e-14 * edges.max() if k in tied else apart > 1e-5, k


def test_an_edge_without_a_keyword_stays(lmp_wheel):
    result, _ = ends(lmp_wheel, [pressed("y 0.5 0.5 1.0 temp 0.7 0.7 0.8", run="run 200")])
    table = result.thermo[0]
    assert set(table["Lx"]) == set(table["Lz"]) == {4.0} and largest_change(table, "Ly") > 1e-3
    assert largest_change(table) < 1e-6


def test_the_fixed_point_stays(lmp_wheel):
    """The default, the center of the box, and another point."""
    columns = "thermo_style custom step xlo xhi ylo yhi zlo zhi econserve\nthermo_modify norm no format float %.17g"
    decks = [
        pressed(f"iso 0.5 0.5 1.0 {point}", run=columns + "\nrun 100")
        for point in ("", "fixedpoint 2 2 2", "fixedpoint 0 1 -3")
    ]
    result, frames = ends(lmp_wheel, decks)
    for table, (x, y, z) in zip(result.thermo, [(2, 2, 2), (2, 2, 2), (0, 1, -3)]):
        edge = np.array(table["Xhi"]) - np.array(table["Xlo"])
        for name, at in (("X", x), ("Y", y), ("Z", z)):
            part = (at - np.array(table[f"{name}lo"])) / edge
            assert np.ptp(part) < 1e-14 and np.ptp(edge) > 1e-4
    assert np.abs(frames[0] - frames[1]).max() == 0.0
    # the position of the box changes only positions
    assert np.abs(frames[0] - frames[2])[:, 3:6].max() < 1e-12


def test_in_two_dimensions(lmp_wheel):
    """The box keeps its height; orders are as in three dimensions."""
    trimers(lmp_wheel.folder / "data.flat", n=3, flat=True)
    flat = dict(dimension=2, data="data.flat", pair=GAUSS, after="fix flat all enforce2d")
    steps = (0.02, 0.01)
    decks = [pressed("values 7 aniso 0.3 0.3 1.0 temp 0.7 0.7 0.8", dt, round(0.4 / dt), **flat) for dt in steps]
    result, frames = ends(lmp_wheel, decks)
    changes = [largest_change(table) for table in result.thermo]
    assert changes[1] < 1e-6 and np.log2(changes[0] / changes[1]) > 5.4
    for table, rows in zip(result.thermo, frames):
        assert set(table["Lz"]) == {1.0} and largest_change(table, "Lx") > 1e-4
        assert np.abs(rows[:, [2, 5]]).max() == 0.0
        mean = np.add(table["f_move[16]"], table["f_move[17]"]) / 2
        assert mean == pytest.approx(np.array(table["f_move[15]"]), rel=1e-12)


# --- invariants ---------------------------------------------------------------------------------


LENGTHS = {"iso": ("iso {} 1.0", 50000, 1e-13), "aniso": ("aniso {} 1.0", 6000, 1e-12), "slow": ("aniso {} 300.0", 20000, 1e-12)}


@pytest.mark.parametrize("words, steps, tolerance", LENGTHS.values(), ids=LENGTHS)
def test_lengths_within_a_molecule_do_not_change(lmp_wheel, data, words, steps, tolerance):
    """In many steps, and in 400 runs of 10; positions many periods away have fewer digits.  With separate edges the box of
    this liquid becomes narrower than a molecule, unless the run is short or the barostat slow."""
    words = words.format("0.3 0.6") + " temp 0.7 0.9 0.8"
    many = "label loop\nvariable i loop 400\nrun 10 start 0 stop 4000\nnext i\njump SELF loop"
    settings = dict(thermo=10000, box="read_data data.trimers")
    runs = [(1e-9, "run 0", "begin"), (0.005, f"run {steps}", "long"), (0.005, many, "parts")]
    found = []
    for dt, text, name in runs:
        lmp_wheel.succeed(pressed(words, dt, run=text, end=name, **settings))
        box = [line.split() for line in (lmp_wheel.folder / name).read_text().splitlines()[5:8]]
        edges = np.array([float(hi) - float(lo) for lo, hi in box])
        found.append((edges, distances(frame(lmp_wheel.folder / name), edges)))
    (_, before), *after = found
    for edges, now in after:
        assert abs(edges - 4.0).max() > 0.01
        assert np.abs(now / before - 1.0).max() < tolerance


def test_the_total_momentum_stays_zero(lmp_wheel):
    """This is tested in a long run with chains, whose friction could amplify rounding; a drift velocity is constant."""
    momentum = "\n".join(f"variable p{c} equal mass(all)*vcm(all,{c})" for c in "xyz")
    columns = momentum + "\nthermo_style custom step econserve v_px v_py v_pz\nthermo_modify norm no format float %.17g\n"
    drift = "velocity all set 0.3 -0.2 0.1 sum yes"
    words = "iso 0.3 0.3 1.0 temp 0.7 0.7 0.8"
    decks = [pressed(words, 0.01, run=columns + "run 20000", before=b) for b in ("", drift)]
    result, _ = ends(lmp_wheel, decks)
    drifts = ((np.zeros(3), 1e-12), (24.0 * np.array([0.3, -0.2, 0.1]), 1e-8))
    for table, (exact, most) in zip(result.thermo, drifts):
        found = np.array([table[f"v_p{c}"] for c in "xyz"])
        assert np.abs(found - exact[:, None]).max() < most
        assert largest_change(table) < 1e-3


# --- ensembles ----------------------------------------------------------------------------------


def test_pressure_times_volume_and_the_energy_of_the_box(lmp_wheel):
    """<(P - P0) V> = -kT and three times W <G^2> = kT: wrong weights of the trace fail this test."""
    target, kt, damp = 1.0, 1.5, 0.5
    run = f"""variable work equal (f_move[15]-{target})*vol
variable rate equal f_move[23]^2
run 5000
reset_timestep 0
fix mean all ave/time 1 5000 5000 v_work v_rate file mean.dat
run 140000"""
    words = f"values 5 iso {target} {target} {damp} temp {kt} {kt} 0.5 thermostat separate"
    lmp_wheel.succeed(pressed(words, 0.01, run=run, thermo=20000), timeout=500)
    rows = np.loadtxt(lmp_wheel.folder / "mean.dat")[:, 1:]
    mean, error = rows.mean(axis=0), rows.std(axis=0) / np.sqrt(len(rows))
    mass = (21 + 3) * kt * damp**2
    assert abs(mean[0] + kt) < 4 * error[0] and error[0] < 0.03
    # all momenta in N_f: (1 - 1/N) kT
    assert abs(mean[0] + kt * 7 / 8) > 5 * error[0]
    assert abs(mass * mean[1] - kt) < 4 * mass * error[1] and mass * error[1] < 0.03 * kt
