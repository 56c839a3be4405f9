"""Coefficients of the corrector: placement and order, the search, and properties compared with other methods."""

import re
from fractions import Fraction
from math import comb

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import __main__ as command
from benchmarks.reference.correctors import completed, decimals, placed
from benchmarks.studies.coefficients import kernel, prediction, properties, spectral
from benchmarks.studies.coefficients.kernel import Corrector, gear
from benchmarks.studies.coefficients.properties import Linear
from benchmarks.studies.coefficients.search import Search

#: far from Gear's, and a Corrector of decimals with these roots and the full order
ROOTS = [0.5 + 0.4j, 0.5 - 0.4j, -0.6, 0.3]
MADE = Corrector(tuple(completed(decimals(placed(ROOTS)))))


def one_percent_off(corrector):
    """The Corrector with one wrong entry, for every entry except c_2, which is 1 by definition."""
    for j in range(corrector.values):
        if j != 2:
            c = list(corrector.c)
            c[j] *= Fraction(101, 100)
            yield Corrector(tuple(c))


# --- order ------------------------------------------------------------------------------------------
def stepped(corrector, z):
    """Matrix of one step in extended precision, from the effect of a step on each row."""
    n, columns = corrector.values, []
    for k in range(n):
        rows = [mpmath.mpf(comb(k, j)) for j in range(n)]
        residual = -(z**2) / 2 * rows[0] - rows[2]
        columns.append([x + mpmath.mpmathify(weight) * residual for x, weight in zip(rows, corrector.c)])
    return mpmath.matrix(columns).T


def roots_of(corrector, z):
    """Principal root and all others, in extended precision."""
    with mpmath.workdps(40):
        roots = mpmath.eig(stepped(corrector, mpmath.mpf(str(z))), left=False, right=False)
        roots.sort(key=lambda root: abs(root - mpmath.expj(z)))
        own = roots.pop(0)
        roots.sort(key=lambda root: abs(root - mpmath.expj(-z)))
        damping, phase = float(abs(own) - 1), float(mpmath.arg(own) - mpmath.mpf(str(z)))
        return damping, phase, max(float(abs(root)) for root in roots[1:])


def order_of(corrector):
    """The power of z with which the principal root misses exp(iz): N + 1 if the order is N."""
    sizes = [np.hypot(*roots_of(corrector, z)[:2]) for z in (0.02, 0.01)]
    return np.log2(sizes[0] / sizes[1])


def test_coefficients_have_the_roots_and_the_order_that_were_asked_for():
    assert order_of(MADE) == pytest.approx(MADE.values + 1, abs=0.1)
    found = np.linalg.eigvals(prediction.open_loop(MADE.floats)[2:, 2:])
    assert np.poly(found) == pytest.approx(np.poly([0.0, *ROOTS]).real, abs=1e-6)
    assert sum(order_of(wrong) < MADE.values + 0.9 for wrong in one_percent_off(MADE)) >= 4


@pytest.mark.parametrize("values", [5, 12])
def test_roots_at_zero_are_gears(values):
    right = gear(values)
    assert placed(np.zeros(values - 3)) == pytest.approx(right.floats[2:], rel=1e-12)
    assert tuple(completed(right.c[2:])) == right.c


# --- the search -------------------------------------------------------------------------------------
@pytest.mark.parametrize("values", [6, 7])
def test_a_short_search_finds_better_coefficients_of_exact_order(values):
    search = Search(values)
    corrector, cost = search.run(seed=1, iterations=8)
    classical = gear(values)
    assert cost == search.cost(corrector) < search.cost(classical) - 1.0
    assert 10 ** search.oscillation(corrector)[0] < 10 ** search.oscillation(classical)[0] / 3
    assert order_of(corrector) == pytest.approx(values + 1 - search.free_c0, abs=0.1)
    again, _ = search.run(seed=1, iterations=8)
    assert again == corrector


def test_the_search_by_spectra_finds_the_set_of_the_kernel():
    own, wanted = kernel.tuned(5), spectral.SpectralSearch()
    found, cost = wanted.run(seed=1, iterations=60)
    assert wanted.cost(own) == pytest.approx(cost, rel=1e-3) and max(wanted.excess(own)) < 1e-6
    np.testing.assert_allclose(found.floats, own.floats, rtol=1e-3)
    assert order_of(own) == pytest.approx(5, abs=0.1)


def test_tuned_sets_stand_noise_and_friction():
    for values in kernel.VALUES:
        noise, friction = Search(values).disturbances(kernel.tuned(values))
        assert noise < 1e-3 and friction < 1e-3


def test_the_command_prints_a_line_of_the_table():
    done = CliRunner().invoke(command.main, "coefficients --search 5 --seed 2 --iterations 1".split())
    number = r"(-?[\d.e-]+)L"
    line = re.match(rf"\{{\{{{number}, {number}\}}, {number}\}},\n", done.output)
    assert line, done.output
    c = completed([Fraction(1), Fraction(line[1]), Fraction(line[2])])
    found = Corrector((Fraction(line[3]), *c[1:]))
    assert f"tuned: cost {spectral.SpectralSearch().cost(found):.3f}\n" in done.output
    assert "Gear's: cost" in done.output
    done = CliRunner().invoke(command.main, "coefficients --search 13".split())
    assert done.exit_code == 2 and "only for 4 to 12" in done.output


# --- linear properties ------------------------------------------------------------------------------
def test_properties_are_those_of_another_evaluation():
    found = Linear.of(MADE)
    damping, phase, _ = roots_of(MADE, properties.AT)
    assert (found.damping, found.phase) == pytest.approx((damping, phase), rel=1e-9)
    below, above = (roots_of(MADE, found.limit + shift)[2] for shift in (-1e-3, 1e-3))
    assert below < 1.0 < above
    assert found.memory == pytest.approx(np.abs(ROOTS).max(), rel=1e-6)
    for wrong in one_percent_off(MADE):
        other = properties.principal(wrong, properties.AT)
        assert other != pytest.approx((damping, phase), rel=1e-4)


# --- motions ----------------------------------------------------------------------------------------
def test_motions_are_those_of_the_kernel_with_the_coefficients_that_are_given():
    known = (85.56573248988141, -6.06135624295223, 6.86227956266460)  # tests/unit/scenes.h
    right = gear(7)
    assert np.linalg.norm(right.cage(0.025, compensate=True) - known) < 1e-10
    for wrong in list(one_percent_off(right))[1:3]:  # c_1 and c_3, whose order this is
        assert np.linalg.norm(wrong.cage(0.025, compensate=True) - known) > 2e-10
