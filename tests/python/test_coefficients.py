"""Coefficients of the corrector: placement and order, the search, properties against other ways to them."""

import re
from dataclasses import replace
from fractions import Fraction
from math import comb, factorial

import mpmath
import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks import __main__ as command
from benchmarks.engine.decks import ROOT
from benchmarks.reference.correctors import completed, decimals, placed
from benchmarks.studies import coefficients as study
from benchmarks.studies.coefficients import kernel, prediction, properties, spectral
from benchmarks.studies.coefficients.kernel import Corrector, gear
from benchmarks.studies.coefficients.properties import Linear
from benchmarks.studies.coefficients.search import LONG_STEPS, Search, spectrum

#: roots far from Gear's, of both kinds of rows
ROOTS = {
    "second": [[0.5 + 0.4j, 0.5 - 0.4j, -0.6, 0.3]],
    "first": [[0.3 + 0.6j, 0.3 - 0.6j, -0.5, 0.7], [-0.4 + 0.2j, -0.4 - 0.2j, 0.6, 0.1]],
}


def made(formulation):
    """A Corrector of decimals, with ROOTS and all order."""
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
def characteristic(c, order, terms):
    """Coefficients of s^0 ... s^(terms-1) of (e^s - 1)^N times

    order = 1: s c_0 + lambda (e_1 - s e_0) R c, order = 2: s^2/2 c_0 + lambda (e_2 - s^2/2 e_0) R c,

    R = (lambda - P)^-1, lambda = e^s: zero where lambda is a root of the step.
    """
    n = len(c)

    def times(a, b):
        return [sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(terms)]

    root = [Fraction(1, factorial(k)) for k in range(terms)]
    powers = [[Fraction(k == 0) for k in range(terms)]]
    for _ in range(n):
        powers.append(times(powers[-1], [Fraction(0), *root[1:]]))
    found, held, rows = [0] * terms, [0] * terms, list(c)
    for k in range(n):
        found = [x + rows[order] * y for x, y in zip(found, powers[n - k - 1])]
        held = [x + rows[0] * y for x, y in zip(held, powers[n - k - 1])]
        rows = [sum(comb(m, j) * rows[m] for m in range(j + 1, n)) for j in range(n)]
    found, held = times(root, found), times(root, held)
    below = [c[0] * y - x for x, y in zip(held, powers[n])]
    return [x + y / order for x, y in zip(found, [0] * order + below)]


def has_order(c, order, free_c0=False):
    """True if all conditions of order N are satisfied exactly (free_c0: without the condition on c_0)."""
    return not any(characteristic(c, order, len(c) + order - free_c0))


@pytest.mark.parametrize("formulation", ROOTS)
def test_coefficients_have_the_roots_and_the_order_that_were_asked_for(formulation):
    corrector = made(formulation)
    for roots, c in zip(ROOTS[formulation], corrector.sets):
        assert has_order(c, corrector.order)
        step = prediction.open_loop(np.array(c, dtype=float), corrector.order)
        found = np.linalg.eigvals(step[corrector.order :, corrector.order :])
        assert np.poly(found) == pytest.approx(np.poly([0.0, *roots]).real, abs=1e-6)
    refused = []
    for wrong in one_percent_off(corrector):
        sets = [list(c) for c in wrong.sets]
        refused.append(not all(has_order(c, corrector.order) for c in sets))
        # an entry of the tail that order does not contain changes nothing
        again = [completed(corrector.order, c[corrector.order :]) for c in sets]
        assert refused[-1] == (again != sets)
    assert refused.count(False) <= 2 * (3 - corrector.order)


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
    for c in corrector.sets:
        assert has_order(c, corrector.order, search.free_c0)
        assert has_order(c, corrector.order) != search.free_c0
    again, _ = search.run(seed=1, iterations=8)
    assert again == corrector


@pytest.mark.parametrize("values", spectral.VALUES)
def test_the_search_by_spectra_finds_the_set_of_the_kernel(values):
    own, wanted = kernel.tuned("second", values, any_norm=True), spectral.SpectralSearch(values=values)
    found, cost = wanted.run(seed=1, iterations=60)
    assert wanted.cost(own) == pytest.approx(cost, rel=1e-3) and max(wanted.excess(own)) < 1e-6
    np.testing.assert_allclose(found.floats, own.floats, rtol=1e-3)
    assert has_order(own.sets[0], 2, free_c0=True)
    # roots and c_0 have all been moved as far as constraints and drift permit
    c0, root = own.floats[0][0], np.linalg.eigvals(own.step(0.0))
    root = root[np.argmax(root.imag)]
    angle = np.angle(root) / np.pi
    inner = spectral.INNER
    others = (0.97, 1, 1), (inner, 0.98, 1), (inner, 1.02, 1), (inner, 1, 0.95), (inner, 1, 1.05)
    for modulus, turned, moved in others:
        assert wanted.cost(wanted.corrector([modulus, turned * angle, moved * c0])) > 1.005 * cost


def test_a_symmetric_method_has_no_drift_but_remembers_noise():
    c = (Fraction(0), Fraction(17, 24), Fraction(1), Fraction(7, 12), Fraction(7, 24))
    symmetric, wanted = Corrector("second", (c, c)), spectral.SpectralSearch()
    assert np.abs(prediction.response(symmetric, [0.2, 0.5, 1.0]).imag).max() < 1e-12
    assert wanted.excess(symmetric)[0] > 10


ODD = [n for n in kernel.VALUES["second"] if n % 2]


@pytest.mark.parametrize("values", ODD)
def test_a_free_c0_keeps_the_energy_of_an_oscillation(values):
    search, corrector = Search("second", values), kernel.tuned("second", values)

    def gain(factor):
        other = corrector.moved((factor - 1) * corrector.sets[0][0])
        if values in LONG_STEPS:
            z, amplitude = LONG_STEPS[values]
            return other.libration(z, (1.0, 0.8, 0.6), amplitude, 1000)
        return spectrum(other, [search.reach / 2])[0, 0]

    assert abs(gain(1)) < 0.1 * abs(gain(Fraction(101, 100)))


@pytest.mark.parametrize("formulation", ROOTS)
def test_tuned_sets_stand_noise_and_friction(formulation):
    for values in kernel.VALUES[formulation]:
        search = Search(formulation, values)
        noise, friction = search.disturbances(kernel.tuned(formulation, values))
        assert noise < 1e-3 and friction < 1e-3
        gears = search.disturbances(kernel.gear(formulation, values))
        assert max(gears) > 1e-3 or values < 9


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
def stepped(corrector, z):
    """Matrix of one step in extended precision, from a step of each row."""
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


@pytest.mark.parametrize("formulation", ROOTS)
def test_noise_of_the_kernel_is_that_of_its_rows(formulation):
    corrector, changes = made(formulation), []
    rows = np.zeros(corrector.values)
    c = corrector.floats[0]
    for step in range(300):
        new = prediction.open_loop(c, corrector.order) @ rows + (step == 0) * c / corrector.order
        changes.append(new[corrector.order - 1] - rows[corrector.order - 1])
        rows = new
    assert sum(changes) == pytest.approx(1.0, rel=1e-9)
    assert corrector.noise == pytest.approx(np.square(changes).sum(), rel=1e-9)


@pytest.mark.parametrize("formulation", ROOTS)
def test_an_oscillation_is_a_response_to_its_own_force(formulation):
    corrector, z = made(formulation), 0.5
    roots = np.linalg.eigvals(corrector.step(z))
    y = -1j * np.log(roots[np.argmin(abs(roots - np.exp(1j * z)))])
    assert y**2 == pytest.approx(z**2 * prediction.response(corrector, [y])[0], rel=1e-9)
    wrong = next(one_percent_off(corrector))
    assert y**2 != pytest.approx(z**2 * prediction.response(wrong, [y])[0], rel=1e-9)


@pytest.mark.parametrize("formulation", ROOTS)
def test_model_equations_have_their_order(formulation):
    """Errors fall with the order of the method, which for its least part is N - 1."""
    corrector = made(formulation)
    coarse, fine = (np.array(properties.models(corrector, z)) for z in (0.1, 0.05))
    assert np.all(np.log2(coarse / fine) > corrector.values - 1.5)
    wrong = list(one_percent_off(corrector))[corrector.order - 1]
    coarse, fine = (np.array(properties.models(wrong, z)) for z in (0.1, 0.05))
    assert np.any(np.log2(coarse / fine) < corrector.values - 0.2)


def test_rows_that_are_rescaled_grow_as_their_roots_say():
    corrector, ratio = made("second"), 1.25
    scaled = float(ratio) ** np.arange(corrector.values)
    step = prediction.open_loop(corrector.floats[0], 2)
    rows = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    sizes = []
    for _ in range(400):
        rows = scaled * (step @ rows)
        sizes.append(np.linalg.norm(rows[3:]))
        rows /= sizes[-1]
    growth = np.exp(np.mean(np.log(sizes[100:])))
    assert growth == pytest.approx(properties.radius(corrector, ratio), rel=2e-2)


# --- motions ----------------------------------------------------------------------------------------
def test_motions_are_those_of_the_kernel_with_the_coefficients_that_are_given():
    known = (85.56573248988141, -6.06135624295223, 6.86227956266460)  # tests/unit/scenes.h
    right = gear("second", 7)
    assert np.linalg.norm(right.cage(0.025, compensate=True) - known) < 1e-10
    for wrong in list(one_percent_off(right))[1:3]:  # c_1 and c_3, which order contains
        assert np.linalg.norm(wrong.cage(0.025, compensate=True) - known) > 2e-10


@pytest.mark.parametrize("formulation", ROOTS)
def test_changes_of_energy_fall_with_the_order(formulation):
    corrector, frequency = made(formulation), (1.0, 0.8, 0.6)
    swing = [abs(corrector.libration(h, frequency, 0.3, round(120 / h))) for h in (0.2, 0.1)]
    turn = [abs(corrector.free_top(h, 120.0)) for h in (0.2, 0.1)]
    for coarse, fine in (swing, turn):
        assert np.log2(coarse / fine) > corrector.values - 2
    assert corrector.libration(2.0, frequency, 0.3, 600) == kernel.LOST


# --- the page ---------------------------------------------------------------------------------------


def test_the_published_page_has_the_coefficients_of_the_kernel():
    page = (ROOT / "doc" / "coefficients.md").read_text(encoding="utf-8")
    formulation, values, _ = study.SHOWN[0]

    def row(corrector):
        damping, phase, _ = roots_of(corrector, properties.AT)
        found = rf"\| {formulation} \| {values} \| tuned \| \S+ \| {damping:.1e} \| {phase:.1e} \|"
        return re.search(found, page)

    corrector = kernel.tuned(formulation, values)
    assert row(corrector)
    assert not any(row(wrong) for wrong in one_percent_off(corrector))
