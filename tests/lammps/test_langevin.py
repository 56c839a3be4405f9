"""Keyword langevin: exact laws at any damping time, the conserved quantity, ranks, masks, pressure, refusals."""

import numpy as np
import pytest
from support.scenes import TRIMER

DECK = """
units lj
dimension {dimension}
atom_style full
atom_modify map array sort 0 0.0
region box block 0 {side} 0 {side} {z}
create_box 2 box
molecule body trimer.mol
lattice {lattice}
create_atoms 0 box mol body 4711
mass 1 1.0
mass 2 2.0
pair_style {pair}
pair_coeff * * {coeff}
neigh_modify every 10 delay 0 check no exclude molecule/intra all
velocity all create 1.0 8981 mom no
comm_modify cutoff 4.0
timestep {dt}
{before}
fix move all gear/quat molecule langevin {langevin} report no {words}
{after}
thermo_style custom step econserve f_move[9] f_move[10] f_move[11] {columns}
thermo_modify norm no format float %.15g
thermo {every}
run {warm}
fix mean all ave/time {sample} 1 {sample} {averaged} file means
{run}
"""
T = 1.5


@pytest.fixture
def simulate(lmp_tree):
    """(settings of DECK) -> result, and the means (rows, columns) of the quantities in ``averaged``."""
    (lmp_tree.folder / "trimer.mol").write_text(TRIMER)

    def of(**changes):
        flat = changes.pop("flat", False)
        ranks = changes.pop("ranks", 1)
        settings = dict(
            dimension=2 if flat else 3, side=16, z="-0.5 0.5" if flat else "0 16", dt=0.05,
            lattice="sq 0.25 origin 0.5 0.5 0" if flat else "sc 0.125 origin 0.5 0.5 0.5", pair="zero 2.0", coeff="",
            before="", words="", after="fix flat all enforce2d" if flat else "", columns="", every=500, warm=500,
            sample=5, averaged="f_move[10] f_move[11]", run="run 2000", langevin=f"{T} {T} 0.25 4711",
        ) | changes  # fmt: skip
        result = lmp_tree.succeed(settings.pop("deck", DECK).format(**settings), ranks=ranks)
        return result, np.loadtxt(lmp_tree.folder / "means", ndmin=2)[:, 1:]

    return of


def z_score(samples, exact, blocks=20):
    """Deviation of a mean in errors, from the means of blocks."""
    means = np.array([block.mean() for block in np.array_split(samples, blocks)])
    return (samples.mean() - exact) / (means.std(ddof=1) / np.sqrt(blocks))


# --- exact laws -----------------------------------------------------------------------------------


@pytest.mark.parametrize("steps", [0.1, 40])
def test_temperature_at_any_damping_time(simulate, steps):
    """Without forces, translation and rotation have the target; the conserved quantity contains the heat."""
    result, means = simulate(langevin=f"{T} {T} {steps * 0.05} 4711", run="run 4000")
    for column in means.T:
        assert column.mean() == pytest.approx(T, rel=0.01)
        assert abs(z_score(column, T)) < 4
    conserved = result.thermo[-1]["Econserve"]
    assert np.ptp(conserved) < 1e-6 * np.ptp(result.thermo[-1]["f_move[9]"])


def test_two_dimensions_and_a_ramp(simulate):
    result, means = simulate(flat=True, langevin=f"{T} {2 * T} 0.1 4711", warm=0, run="run 4000")
    target = T + T * np.arange(len(means)) * 5 / 4000
    for column in means[40:].T:
        assert abs(z_score(column / target[40:], 1.0)) < 4
    assert "of 128 degrees of freedom of translation" in result.log and "and 64 of rotation" in result.log


TRAP = """
units lj
atom_style molecular
atom_modify map array
region box block 0 16 0 16 0 16
create_box 1 box
lattice sc 0.125
create_atoms 1 box
variable own atom id
set group all mol v_own
mass 1 1.0
pair_style zero 2.0
pair_coeff * *
timestep {dt}
fix move all gear/quat molecule langevin 1.5 1.5 {tau} 4711 report no
fix trap all spring/self 1.0
thermo 1000
run 200
fix mean all ave/time 2 1 2 f_trap file means
run 4000
"""


@pytest.mark.parametrize("dt, tau", [(0.8, 0.2), (0.4, 2.0)])
def test_a_harmonic_trap(lmp_tree, dt, tau):
    """k = m = 1: the variance is kT/k/(1 - (omega h)^2/4) exactly, as of velocity Verlet, at any damping."""
    lmp_tree.succeed(TRAP.format(dt=dt, tau=tau))
    potential = np.loadtxt(lmp_tree.folder / "means")[:, 1]
    exact = 512 * 1.5 * T / (1 - dt**2 / 4)
    assert potential.mean() == pytest.approx(exact, rel=0.01)
    assert abs(z_score(potential, exact)) < 4


def dipoles(simulate, dt, time=500):
    """Mean of cos(theta) - exact in a field of 2 kT per dipole moment."""
    after = "fix field all efield 0.0 0.0 12.0\ncompute z all property/atom zu\nvariable own atom q*c_z/(0.3*512)\n"
    after += "compute cos all reduce sum v_own"
    result, means = simulate(
        dt=dt, langevin="1.8 1.8 1.0 4711", after=after, averaged="c_cos", sample=2, warm=round(20 / dt),
        run=f"run {round(time / dt)}",
    )  # fmt: skip
    return means[:, 0] - (1 / np.tanh(2.0) - 1 / 2.0)


def test_a_dipole_in_a_field(simulate):
    """The error is of second order in the step."""
    short, long = (dipoles(simulate, dt).mean() for dt in (0.07, 0.14))
    assert abs(short) < 0.01
    assert 2.0 < long / short < 8.0


def test_diffusion_of_a_free_body(simulate):
    """<r^2> = 6 D t with D = kT tau/m, minus the first times."""
    tau, time = 0.2, 100.0
    _, means = simulate(
        langevin=f"{T} {T} {tau} 4711", after="compute far all msd com no\nvariable far equal c_far[4]",
        averaged="v_far", sample=2000, run="run 2000", warm=0,
    )  # fmt: skip
    exact = 6 * T * tau / 4.0 * (time - tau * (1 - np.exp(-time / tau)))
    assert means[-1, 0] == pytest.approx(exact, rel=5 * np.sqrt(2 / 3 / 512))


def test_pressure(simulate):
    """An ideal gas of N bodies: <V> = (N + 1) kT/P."""
    _, means = simulate(
        side=8, z="0 8", words="iso 0.1 0.1 1.0", after="variable v equal vol", averaged="v_v f_move[10] f_move[11]",
        langevin=f"{T} {T} 0.5 4711", run="run 20000",
    )  # fmt: skip
    assert means[:, 0].mean() == pytest.approx(65 * T / 0.1, rel=0.03)
    for samples, exact in zip(means.T, (65 * T / 0.1, T, T)):
        assert abs(z_score(samples, exact)) < 4


FLOW = "change_box all triclinic\nfix flow all deform 1 xy erate 0.5 remap v\nvelocity all ramp vx -4 4 y 0 16 sum yes"


def test_in_a_flow_without_collisions(simulate):
    """With friction 1/tau on velocities relative to a flow of rate g, c_x^2 has the mean kT/m (1 + (g tau)^2/2)."""
    _, means = simulate(before=FLOW, langevin=f"{T} {T} 2.0 4711", run="run 4000")
    assert abs(z_score(means[:, 0], T * (1 + (0.5 * 2.0) ** 2 / 6))) < 4
    assert abs(z_score(means[:, 1], T)) < 4
    assert means[:, 0].mean() == pytest.approx(T * (1 + 1 / 6), rel=0.02)


def test_chain_in_a_flow(simulate):
    """One variable holds the temperature of the motion relative to the flow."""
    chains = dict(before=FLOW, pair="lj/cut 2.0", coeff="1.0 1.0", dt=0.004, sample=5)
    words = f"temp {T} {T} 0.2 tchain 1 thermostat separate"
    _, means = simulate(**chains, deck=DECK.replace("langevin {langevin}", words), run="run 4000", warm=2000)
    for column in means.T:
        assert column.mean() == pytest.approx(T, rel=0.005)


@pytest.mark.parametrize("tau", [0.0001, 0.1])
def test_pressure_keeps_the_conserved_quantity(simulate, tau):
    """To second order at any damping: the accelerations of bodies and box follow the random velocities."""
    changes = []
    for dt in (0.04, 0.02):
        result, _ = simulate(
            side=8, z="0 8", words="iso 1.0 1.0 1.0", langevin=f"{T} {T} {tau} 4711", dt=dt, run=f"run {round(80 / dt)}", warm=0,
            columns="vol", every=round(2 / dt),
        )  # fmt: skip
        table = result.thermo[-1]
        changes.append(np.std(table["Econserve"]))
        assert np.ptp(table["Volume"]) > 20
    assert changes[0] / changes[1] > 2.5
    assert changes[1] < 0.2


@pytest.mark.parametrize("tau, warned", [(0.05, True), (0.1, False)])
def test_fast_diffusion_is_warned_of(simulate, tau, warned):
    """The factor of diffusion is x coth x with x = h/(2 tau); 1.08 here."""
    result, _ = simulate(langevin=f"{T} {T} {tau} 4711", dt=0.05, warm=0, run="run 10")
    assert ("free bodies diffuse and drift 1.08 times too fast" in result.words) == warned


# --- what does not move ---------------------------------------------------------------------------


def test_components_that_are_off_stay_at_rest(simulate):
    result, _ = simulate(
        before="velocity all set 0 0 0", words="force * on on off torque * off off off", run="run 200",
        columns="f_move[2] f_move[1][6]", averaged="f_move[10]",
    )  # fmt: skip
    assert (np.array(result.thermo[-1]["f_move[2]"]) == 0.0).all()
    assert (np.array(result.thermo[-1]["f_move[1][6]"]) == 0.0).all()
    assert result.thermo[-1]["f_move[10]"][-1] == pytest.approx(T, rel=0.2)
