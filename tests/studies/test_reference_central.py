"""benchmarks/reference/central.py: quadrature of collision integrals, compared with trajectories and published
tables."""

from math import log

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from benchmarks.reference import central

#: T* -> Omega(1,1)*, Omega(2,2)* as printed in R. B. Bird, W. E. Stewart and E. N. Lightfoot, Transport
#: Phenomena, 2nd edition, Wiley 2002, Table E.2 (after L. Monchick and E. A. Mason, J. Chem. Phys. 35, 1676 (1961))
TABLE = {
    0.5: (2.066, 2.284),
    1.0: (1.440, 1.593),
    2.0: (1.075, 1.176),
    5.0: (0.8428, 0.9268),
    10.0: (0.7422, 0.8244),
}
#: A, B_1 to B_6 and C_1 to C_6 of S. U. Kim and C. W. Monroe, J. Comput. Phys. 273, 358 (2014):
#: Omega* = A + sum_k B_k / T*^k + C_k (ln T*)^k
KIM_MONROE = {
    (1, 1): (
        -1.10367290,
        (2.6431984, 0.0060432255, -0.15158773, 0.054237938, -0.0090468682, 0.00061742007),
        (1.6690746, -0.6914589, 0.15502132, -0.020642189, 0.0015402077, -0.000049729535),
    ),
    (1, 2): (
        1.35555540,
        (-0.44668594, 0.42734391, -0.16036459, 0.031461648, -0.0032587575, 0.00013860257),
        (-0.47499422, 0.14482036, -0.032158368, 0.0044357933, -0.00034138118, 0.000011259742),
    ),
    (2, 2): (
        -0.92032979,
        (2.3508044, 0.50110649, -0.47193769, 0.15806367, -0.026367184, 0.0018120118),
        (1.6330213, -0.69795156, 0.16096572, -0.02210944, 0.0017031434, -0.000056699986),
    ),
}


@pytest.fixture(scope="module")
def omega():
    return central.CollisionIntegrals()


def kim_monroe(order, power, temperature):
    a, b, c = KIM_MONROE[order, power]
    terms = enumerate(zip(b, c), start=1)
    return a + sum(x / temperature**k + y * log(temperature) ** k for k, (x, y) in terms)


def flown(potential, energy, b, far=200.0):
    """Cosine of the deflection of a trajectory; mass 2, so that the energy is the square of the speed."""

    def rates(_, y):
        r = np.hypot(y[0], y[1])
        return [y[2], y[3], *(-0.5 * potential.slope(r) / r * y[:2])]

    def gone(_, y):
        return np.hypot(y[0], y[1]) - far

    gone.terminal, gone.direction = True, 1
    start = [-((far**2 - b**2) ** 0.5), b, energy**0.5, 0.0]
    y = solve_ivp(rates, (0.0, 1e5), start, "DOP853", rtol=1e-12, atol=1e-13, events=gone).y[:, -1]
    return y[2] / np.hypot(y[2], y[3])


@pytest.mark.parametrize("energy", [0.1, 0.7, 0.81, 3.0, 100.0])
def test_deflections_are_those_of_trajectories(energy):
    """On both branches, with several turns about each other and above the limit of orbiting."""
    potential = central.LennardJones()
    scattering = central.Scattering(potential, energy)
    assert scattering.orbits == (energy < 0.8)
    low, high = scattering.wall, scattering.r_split
    inner = low + (scattering.r_inner - low) * np.array([0.3, 0.9, 0.9999])
    r_m = np.concatenate([inner, high * np.array([1.01, 1.05, 2.0])])
    chi = scattering.deflection(r_m)
    for r, angle in zip(r_m, chi):
        cosine = flown(potential, energy, float(scattering.b2(r)) ** 0.5)
        assert abs(np.cos(angle) - cosine) < 5e-6
    if scattering.orbits:
        assert chi.min() < -2 * np.pi


def test_tables_of_the_literature(omega):
    for temperature, printed in TABLE.items():
        for (order, power), value in zip(((1, 1), (2, 2)), printed):
            assert omega(order, power, temperature) == pytest.approx(value, rel=5e-4)
    for order, power in KIM_MONROE:
        for temperature in (0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 100.0):
            fit = kim_monroe(order, power, temperature)
            assert omega(order, power, temperature) == pytest.approx(fit, rel=2.5e-4)
