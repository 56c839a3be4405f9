"""Coefficients of the corrector: placement and order, the search, and properties compared with other methods."""

import re
from dataclasses import replace
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

#: roots far from Gear's, of both kinds of rows
ROOTS = {
    "second": [[0.5 + 0.4j, 0.5 - 0.4j, -0.6, 0.3]],
    "first": [[0.3 + 0.6j, 0.3 - 0.6j, -0.5, 0.7], [-0.4 + 0.2j, -0.4 - 0.2j, 0.6, 0.1]],
}


def made(formulation):
    """A Corrector of decimals, with ROOTS and the full order."""
    order = 2 if formulation == "second" else 1
    sets = [completed(order, decimals(placed(order, roots))) for roots in ROOTS[formulation]]
    return Corrector(formulation, (tuple(sets[0]), tuple(sets[-1])))


def one_percent_off(corrector):
    """The Corrector with one wrong entry, for every entry except the entry that is 1 by definition."""
    for which in range(3 - corrector.order):
        for j in range(corrector.values):
            if j != corrector.order:
                sets = [list(c) for c in corrector.sets]
                for k in (which,) if corrector.order == 1 else (0, 1):
                    sets[k][j] *= Fraction(101, 100)
                yield replace(corrector, sets=tuple(map(tuple, sets)))


# --- order ------------------------------------------------------------------------------------------
def stepped(corrector, z):
    """Matrix of one step in extended precision, from the effect of a step on each row."""
    n, columns = corrector.values, []

    def predicted(rows):
        return [sum(comb(k, j) * rows[k] for k in range(j, n)) for j in range(n)]

    def corrected(rows, c, target):
        residual = target - rows[corrector.order]
        return [x + mpmath.mpmathify(weight) * residual for x, weight in zip(rows, c)]

    for k in range(n * (3 - corrector.order)):
        unit = [mpmath.mpf(i == k) for i in range(2 * n)]
        position, velocity = predicted(unit[:n]), predicted(unit[n:])
        if corrector.order == 2:
            columns.append(corrected(position, corrector.sets[0], -(z**2) / 2 * position[0]))
            continue
        velocity = corrected(velocity, corrector.sets[0], -z * position[0])
        position = corrected(position, corrector.sets[1], z * velocity[0])
        columns.append(position + velocity)
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


@pytest.mark.parametrize("formulation", ROOTS)
def test_coefficients_have_the_roots_and_the_order_that_were_asked_for(formulation):
    corrector = made(formulation)
    assert order_of(corrector) == pytest.approx(corrector.values + 1, abs=0.1)
    for roots, c in zip(ROOTS[formulation], corrector.sets):
        step = prediction.open_loop(np.array(c, dtype=float), corrector.order)
        found = np.linalg.eigvals(step[corrector.order :, corrector.order :])
        assert np.poly(found) == pytest.approx(np.poly([0.0, *roots]).real, abs=1e-6)
    assert sum(order_of(wrong) < corrector.values + 0.9 for wrong in one_percent_off(corrector)) >= 4


@pytest.mark.parametrize("formulation, values", [("first", 5), ("second", 5), ("second", 12)])
def test_roots_at_zero_are_gears(formulation, values):
    right = gear(formulation, values)
    rest = placed(right.order, np.zeros(values - right.order - 1))
    assert rest == pytest.approx([float(x) for x in right.sets[0][right.order :]], rel=1e-12)
    assert tuple(completed(right.order, right.sets[0][right.order :])) == right.sets[0]


# --- the search -------------------------------------------------------------------------------------
@pytest.mark.parametrize("formulation, values", [("second", 5), ("second", 6), ("first", 4)])
def test_a_short_search_finds_better_coefficients_of_exact_order(formulation, values):
    search = Search(formulation, values)
    corrector, cost = search.run(seed=1, iterations=8)
    classical = gear(formulation, values)
    assert cost == search.cost(corrector) < search.cost(classical) - 1.0
    assert 10 ** search.oscillation(corrector)[0] < 10 ** search.oscillation(classical)[0] / 3
    assert order_of(corrector) == pytest.approx(values + 1 - search.free_c0, abs=0.1)
    again, _ = search.run(seed=1, iterations=8)
    assert again == corrector


@pytest.mark.parametrize("values", spectral.VALUES)
def test_the_search_by_spectra_finds_the_set_of_the_kernel(values):
    own, wanted = kernel.tuned("second", values, any_norm=True), spectral.SpectralSearch(values=values)
    found, cost = wanted.run(seed=1, iterations=60)
    assert wanted.cost(own) == pytest.approx(cost, rel=1e-3) and max(wanted.excess(own)) < 1e-6
    np.testing.assert_allclose(found.floats, own.floats, rtol=1e-3)
    assert order_of(own) == pytest.approx(values, abs=0.1)


@pytest.mark.parametrize("formulation", ROOTS)
def test_tuned_sets_stand_noise_and_friction(formulation):
    for values in kernel.VALUES[formulation]:
        noise, friction = Search(formulation, values).disturbances(kernel.tuned(formulation, values))
        assert noise < 1e-3 and friction < 1e-3


def test_the_command_prints_lines_of_the_table():
    done = CliRunner().invoke(
        command.main, "coefficients --search second 5 --seed 2 --iterations 1".split()
    )
    number = r"(-?[\d.e-]+)L"
    pattern = rf"\{{SECOND, DRIVEN, \{{{number}, {number}\}}, {number}\}},\n"
    line = re.match(pattern, done.output)
    assert line, done.output
    c = completed(2, [Fraction(1), Fraction(line[1]), Fraction(line[2])])
    found = Corrector("second", ((Fraction(line[3]), *c[1:]),) * 2)
    assert f"tuned: cost {Search('second', 5).cost(found):.3f}\n" in done.output
    assert "Gear's: cost" in done.output
    done = CliRunner().invoke(command.main, "coefficients --search second 13".split())
    assert done.exit_code == 2 and "4 to 12 of second, 5 of spectral" in done.output


# --- linear properties ------------------------------------------------------------------------------
@pytest.mark.parametrize("formulation", ROOTS)
def test_properties_are_those_of_another_evaluation(formulation):
    corrector = made(formulation)
    found = Linear.of(corrector)
    damping, phase, _ = roots_of(corrector, properties.AT)
    assert (found.damping, found.phase) == pytest.approx((damping, phase), rel=1e-9)
    below, above = (roots_of(corrector, found.limit + shift)[2] for shift in (-1e-3, 1e-3))
    assert below < 1.0 < above
    assert found.memory == pytest.approx(np.abs(ROOTS[formulation]).max(), rel=1e-6)
    for wrong in one_percent_off(corrector):
        other = properties.principal(wrong, properties.AT)
        assert other != pytest.approx((damping, phase), rel=1e-4)


# --- motions ----------------------------------------------------------------------------------------
def test_motions_are_those_of_the_kernel_with_the_coefficients_that_are_given():
    known = (85.56573248988141, -6.06135624295223, 6.86227956266460)  # tests/unit/scenes.h
    right = gear("second", 7)
    assert np.linalg.norm(right.cage(0.025, compensate=True) - known) < 1e-10
    for wrong in list(one_percent_off(right))[1:3]:  # c_1 and c_3, whose order this is
        assert np.linalg.norm(wrong.cage(0.025, compensate=True) - known) > 2e-10
