"""gearquat scatter: starts of flights, averages over them with their errors, and properties of a gas, in known cases."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.spatial.transform import Rotation

from gearquat_analysis.bodies import Bodies
from gearquat_analysis.units import UNITS
from lammps_gearquat.scatter import gas
from lammps_gearquat.scatter.flights import Facts
from lammps_gearquat.scatter.integrals import Collisions, estimates, quantities
from lammps_gearquat.scatter.sampling import REPLICAS, Plan
from lammps_gearquat.trials.script import DeckError
from support.atoms import ARGON, BOLTZMANN as KCAL, ION

BOLTZMANN, DALTON = 1.380649e-23, 1.66053907e-27
N = 16384
SEEDS = 100
WARM = KCAL * 300.0 / 0.2  # by the well of the ion


def facts(style="lj", mass=1.0, freedoms=(0, 0), charge=None):
    return Facts(freedoms, charge, mass / 2, True, style)


def plan_of(temperature=1.0, energy=None, rotation=1.0, largest=1.5, size=1.2, boltzmann=1.0, seed=1):
    """A Plan with the same ``size`` at all energies."""
    size = np.array([size, size])
    return Plan(seed, temperature, energy, rotation, energy or boltzmann * temperature, largest, size, np.array([0.0, 1.0]))


def numbers(plan, dimension, n):
    """The first ``n`` random numbers of a Plan."""
    found = np.empty((0, dimension))
    for points in plan.points(dimension):
        found = np.concatenate([found, points])
        if len(found) >= n:
            return found[:n]


def flown(diameter=1.0, n=N, **settings):
    """(columns, Plan): rigid spheres, which turn the velocity by 2 arccos(b / diameter)."""
    plan = plan_of(**settings)
    points = numbers(plan, 2, n)
    energy = plan.energies(points[:, 1])
    b = plan.impact(points[:, 0], energy)
    angle = 2.0 * np.arccos(np.minimum(b / diameter, 1.0))
    columns = {"flight": np.arange(n), "b": b, "energy": energy, "angle": angle, "energy_after": energy.copy()}
    return columns | {"fate": np.full(n, "parted"), "message": np.full(n, ""), "error_energy": 1e-6 * b}, plan


def averaged(columns, plan, facts):
    return {one.name: one for one in quantities(columns, plan, facts)}


def agrees(estimate, exact):
    return abs(estimate.value - exact) < 3.0 * estimate.error


# --- starts ---------------------------------------------------------------------------------------
@pytest.mark.parametrize("atoms, scale", [(ARGON, 2.0), (ION, 0.3)])
def test_densities_integrate_to_one(atoms, scale):
    """Weights are the inverse of the density of pi b^2, times the flux by the density of the energy."""
    plan = atoms.plan(1, scale)
    u = (np.arange(20000) + 0.5) / 20000
    for x in (0.01, 0.5, 4.0):
        energy = np.full(len(u), x * scale)
        b = plan.impact(u, energy)
        slope = np.gradient(np.pi * b**2, u)
        flux = x * np.exp(-x) / (x**1.5 * np.exp(-x) / (0.75 * np.sqrt(np.pi)))
        assert np.mean(np.abs(slope * flux / plan.weights(b, energy) - 1.0) < 1e-4) > 0.98 and b.max() <= plan.largest
    x = plan.energies(u) / scale
    assert np.mean(x) == pytest.approx(2.5, rel=1e-3) and np.mean(x < 1.0) == pytest.approx(
        quad(lambda x: x**1.5 * np.exp(-x) / (0.75 * np.sqrt(np.pi)), 0.0, 1.0)[0], abs=1e-4
    )


def made_up_pair():
    """An asymmetric body and a linear one, not along the axes of space."""
    shape = np.array([[1.0, 0.0, 0.3], [-0.5, 0.8, 0.0], [0.0, -0.7, -0.4], [2.0, 2.1, 2.2], [2.3, 2.0, 2.8]])
    bodies = Bodies([1, 1, 1, 2, 2], [1.0, 2.0, 3.0, 1.0, 4.0])
    bodies.set_shape(shape)
    mass = float(np.prod(bodies.mass) / bodies.mass.sum())
    return SimpleNamespace(bodies=bodies, reduced_mass=mass, units=UNITS["lj"], reach=9.0)


def test_starts():
    """The center of mass rests, all directions are alike, every axis with inertia has kT/2, and one energy is one."""
    pair, plan = made_up_pair(), plan_of(2.0, rotation=0.5, largest=4.0, size=2.0)
    points = numbers(plan, 13, 4096)
    assert 0.0 < points.min() and points.max() < 1.0
    # each of 16 intervals has one of 16 points, in every dimension of every sequence
    first = points[: 16 * REPLICAS].reshape(16, REPLICAS, 13)
    assert (np.sort((first * 16).astype(int), axis=0) == np.arange(16)[:, None, None]).all()
    flights = plan.starts(pair, points)
    for b, energy, start in flights[:50]:
        mass = pair.bodies.mass[:, None]
        assert np.abs((mass * start.center).sum(axis=0)).max() < 1e-14
        assert np.abs((mass * start.velocity).sum(axis=0)).max() < 1e-14
        away, relative = (start.center[1] - start.center[0], start.velocity[1] - start.velocity[0])
        assert np.linalg.norm(away) == pytest.approx(9.0) and away[2] < 0.0 and away[0] == pytest.approx(b)
        assert 0.5 * pair.reduced_mass * relative @ relative == pytest.approx(energy) and not relative[:2].any()
    q, momentum = (np.array([getattr(flight[2], name) for flight in flights]) for name in ("quaternion", "momentum"))
    for k in range(2):
        turn = Rotation.from_quat(q[:, k], scalar_first=True)
        assert np.mean(turn.as_matrix(), axis=0) == pytest.approx(0.0, abs=0.02)
        assert np.mean(turn.as_matrix() ** 2, axis=0) == pytest.approx(1 / 3, abs=0.01)
        along, moments = (turn.inv().apply(momentum[:, k]) @ pair.bodies.axes[k].T, pair.bodies.moments[k])
        assert np.mean(along**2, axis=0) == pytest.approx(moments * 0.5, abs=0.02 * pair.bodies.moments.max())
    cold = plan_of(None, 3.0, 0.0, 4.0).starts(pair, points[:20])
    assert {energy for _, energy, _ in cold} == {3.0} and not any(start.momentum.any() for _, _, start in cold)


# --- averages of atoms, by quadrature -------------------------------------------------------------
@pytest.mark.parametrize("atoms, temperature", [(ARGON, 300.0 / 119.8), (ION, WARM)], ids=["argon", "ion"])
def test_errors_of_1024_flights(atoms, temperature):
    """Stated errors are those of the deviations from exact integrals over many seeds."""
    found = []
    for seed in range(SEEDS):
        plan = atoms.plan(seed, temperature)
        rounds = atoms.rounds(plan)
        next(rounds)
        found.append([atoms.quantities(plan, next(rounds))[name] for name in "12"])
    value, error = np.moveaxis(found, -1, 0)
    exact = np.array([atoms.exact(k, temperature) for k in (1, 2)])
    rms = np.sqrt(np.mean(((value - exact) / error) ** 2, axis=0))
    assert ((0.8 < rms) & (rms < 1.2)).all() and (value.std(axis=0) / exact < 0.03).all()
    mean = value.std(axis=0, ddof=1) / np.sqrt(SEEDS)
    assert (np.abs(value.mean(axis=0) - exact) < 3.5 * mean + 1e-3 * exact).all()
    assert (np.abs(value.mean(axis=0) - 1.02 * exact) > 3.5 * mean + 1e-3 * exact).all()


def test_the_quadrature():
    """Omega(1,1)* and Omega(2,2)* of argon at T* = 1 and 5, of R. B. Bird, W. E. Stewart and E. N. Lightfoot, Transport
    Phenomena, 2nd edition, Wiley (2002), Table E.2."""
    for temperature, known in ((1.0, (1.440, 1.593)), (5.0, (0.8428, 0.9268))):
        assert [ARGON.exact(k, temperature) for k in (1, 2)] == pytest.approx(known, rel=2e-3)


def test_cross_sections_at_one_energy():
    """At 0.4 of the depth of the well, where bodies orbit."""
    exact = [ARGON.cross_section(order, [0.4])[0] for order in (1, 2)]
    deviations = []
    for seed in range(20):
        plan = ARGON.plan(seed, None, 0.4)
        found = ARGON.quantities(plan, next(ARGON.rounds(plan)))
        deviations.append([(found[name][0] - right) / found[name][1] for name, right in zip(("Q(1)", "Q(2)"), exact)])
    assert 0.7 < np.sqrt(np.mean(np.square(deviations))) < 1.3


# --- known cases ----------------------------------------------------------------------------------
@pytest.mark.parametrize("size", [0.5, 1.2, 1.5])
def test_rigid_spheres(size):
    """With flights that are drawn where they contribute, or where they do not."""
    found = averaged(*flown(size=size), facts())
    speed = np.sqrt(1.0 / np.pi)
    spheres = {"Omega(1,1)": speed * np.pi, "Omega(2,2)": 2.0 * speed * np.pi, "Omega(1,2)": 3.0 * speed * np.pi}
    spheres |= {
        "cross section": np.pi,
        "A*": 1.0,
        "C*": 1.0,
        "viscosity": 5.0 / 16.0 * speed,
        "diffusion": 3.0 / 8.0 * speed,
    }
    for name, exact in spheres.items():
        assert agrees(found[name], exact) and not agrees(found[name], 1.02 * exact), name


def test_one_energy():
    found = averaged(*flown(temperature=None, energy=2.0), facts())
    assert agrees(found["Q(1)"], np.pi) and agrees(found["Q(2)"], 2.0 / 3.0 * np.pi)


@pytest.mark.parametrize("style", ["real", "metal"])
def test_units(style):
    """Spheres of 3.64 A and 39.948 u at 300 K, computed in the SI."""
    settings = {"temperature": 300.0, "rotation": 300.0, "largest": 5.0, "size": 4.0, "boltzmann": UNITS[style].boltzmann}
    found = averaged(*flown(3.64, **settings), facts(style, 39.948, charge=(1.0, 0.0)))
    mass, sigma, thermal = 39.948 * DALTON, 3.64e-10, BOLTZMANN * 300.0
    viscosity = 5.0 / (16.0 * sigma**2) * np.sqrt(mass * thermal / np.pi)
    density = 101325.0 / thermal
    diffusion = 3.0 / (8.0 * density * sigma**2) * np.sqrt(thermal / (np.pi * mass))
    assert found["viscosity"].value == pytest.approx(viscosity * 1e6, rel=5e-3)
    assert found["diffusion"].value == pytest.approx(diffusion * 1e4, rel=5e-3)
    # K = q D / (k T), and K0 is K at 273.15 K and one atmosphere
    einstein = 1.602176634e-19 * diffusion / thermal * 273.15 / 300.0 * 1e4
    assert found["mobility"].value == pytest.approx(einstein, rel=5e-3)


def mixed(seed, warm, n=400_000):
    """Gain of rotation in collisions of linear molecules that mix all energy at random, in units of kT.

    Energies of translation have the density x exp(-x), and energies of both rotations with ``warm`` times T, too.
    """
    random = np.random.default_rng(seed)
    x, rotation = random.gamma(2.0, size=n), warm * random.gamma(2.0, size=n)
    return x, x - (x + rotation) * random.beta(2.0, 2.0, n)


def test_relaxation_of_rotation():
    """The rate from the squared gain at equal temperatures equals the mean gain at different temperatures."""
    x, gain = mixed(1, 1.0)
    difference = 0.1
    _, net = mixed(2, 1.0 + difference)
    # a gas of density 1, in which each molecule has c = 1 and half of the collisions of a pair are its own
    number, _, _ = gas.at_temperature(facts(freedoms=(2, 2)), 1.0)["collision number"]
    eta = 5.0 / (8.0 * 0.5 * np.sqrt(1.0 / np.pi) * 2.0)
    rate = 4.0 / (np.pi * eta * number({"transfer": np.mean(gain**2), "22": 2.0}))
    collisions = 4.0 * np.sqrt(1.0 / np.pi)
    lost = -net.mean() * collisions / 2.0 / difference
    assert gain.mean() == pytest.approx(0.0, abs=0.01)
    assert rate == pytest.approx(lost, rel=0.06)


def test_the_form_of_monchick_yun_and_mason():
    """With detailed balance both forms of the momentum flux have the same mean."""
    x, gain = mixed(3, 1.0)
    sine2 = np.random.default_rng(4).random(len(x))
    pairs = Collisions(x, x - gain, np.sqrt(1.0 - sine2), sine2, balanced=True)
    other = x**2 * sine2 + gain**2 / 3.0 - gain**2 * sine2 / 2.0
    assert pairs.f22.mean() == pytest.approx(other.mean(), rel=0.01)


def test_detailed_balance_changes_errors_only():
    """Means are the same with and without it; here velocities turn by any angle."""
    x, gain = mixed(5, 1.0)
    cosine = 2.0 * np.random.default_rng(6).random(len(x)) ** (1 / 3) - 1.0
    direct, both = (Collisions(x, x - gain, cosine, 1.0 - cosine**2, balanced) for balanced in (False, True))
    for some in (lambda pairs: pairs.change(0), lambda pairs: pairs.change(1), lambda pairs: pairs.f22):
        assert some(both).mean() == pytest.approx(some(direct).mean(), rel=0.02)
        assert np.std(some(both)) < np.std(some(direct))


def test_standard_errors():
    """The jackknife of a mean is the standard error over replicas, with the factor of Student's distribution."""
    deviations = []
    for trial in range(200):
        values = np.random.default_rng(trial).normal(1.0, 0.1, 160)
        functions = (lambda m: m["a"], lambda m: m["b"] / m["a"])
        known = {"a": values, "b": values**2}
        (value, error), (ratio, other) = estimates(known, np.arange(160) % 16, np.ones(160, bool), functions)
        replicas = values.reshape(10, 16).mean(axis=0)
        student = np.sqrt(15.0 / 13.0)
        assert value == pytest.approx(values.mean()) and error == pytest.approx(student * replicas.std(ddof=1) / 4.0)
        deviations.append((ratio - 1.01) / other)
    assert np.std(deviations) == pytest.approx(1.0, abs=0.1)


def test_flights_that_have_not_parted_are_counted():
    """The contribution of these flights is included in the error."""
    columns, plan = flown(size=1.5)
    columns["fate"] = np.where(np.arange(N) < 120, "unparted", "parted")
    columns["angle"][:120] = columns["energy_after"][:120] = np.nan
    found = averaged(columns, plan, facts())["cross section"]
    # they are taken as turned wherever they were in the whole area
    part = 1.5**2 * 120 / N
    assert found.value == pytest.approx(np.pi, rel=0.02) and found.error == pytest.approx(part * np.pi, rel=0.2)


def test_flights_that_cannot_be_averaged():
    columns, plan = flown(n=512)
    columns["fate"] = np.full(512, "unparted")
    with pytest.raises(DeckError, match="none of the 512 flights has parted: more --steps"):
        quantities(columns, plan, facts())
    columns, plan = flown(n=512)
    for wrong in (0.06, np.nan):
        columns["error_energy"][3] = wrong
        with pytest.raises(DeckError, match="use a smaller tolerance"):
            quantities(columns, plan, facts())
