"""Flights of ``gearquat scatter`` beside DOP853 with forces of its own, and what the study makes of its data."""

import dataclasses

import numpy as np
import pytest

from benchmarks.engine.decks import EXAMPLES
from benchmarks.engine.page import render
from benchmarks.reference.encounters import CENTER, MOMENTUM, VELOCITY, Charges, Dispersion, Encounter
from benchmarks.studies import scatter as study
from benchmarks.studies.scatter import errors, flown, rivals


# --- the reference --------------------------------------------------------------------------------
def encounter(random):
    """Two different bodies with sites of both kinds of forces, and a packed state of them."""
    sites = [random.normal(size=(n, 3)) for n in (3, 4)]
    masses = [random.uniform(1, 2, n) for n in (3, 4)]
    sites = [x - m @ x / m.sum() for x, m in zip(sites, masses)]
    charges = np.outer(random.normal(size=3), random.normal(size=4))
    forces = [Dispersion(np.ones((3, 4)), np.ones((3, 4)), 2.0, 5.0), Charges(charges, 0.3, 6.0)]
    y = random.normal(size=(2, 13))
    y[:, CENTER] = [[0, 0, 0], [2.0, 2.5, 1.0]]
    return Encounter(sites, masses, forces, factor=2.5), y


@pytest.mark.parametrize("seed", range(4))
def test_rates_keep_energy_momentum_and_angular_momentum(seed):
    """And a torque or a force that is wrong by 1 % does not."""
    two, y = encounter(np.random.default_rng(seed))
    rates = two.rates(0.0, y.ravel()).reshape(2, 13)

    def change(rates, d=1e-5):
        return (two.energy((y + d * rates).ravel()) - two.energy((y - d * rates).ravel())) / (2 * d)

    size = 2.5 * np.abs(two.masses[:, None] * y[:, VELOCITY] * rates[:, VELOCITY]).sum()
    assert abs(change(rates)) < 2e-6 * size  # erfc has seven digits
    for part in (VELOCITY, MOMENTUM):
        wrong = rates.copy()
        wrong[0, part] *= 1.01
        assert abs(change(wrong)) > 1e-5 * size
    assert two.masses @ rates[:, VELOCITY] == pytest.approx(np.zeros(3), abs=1e-12 * size)
    orbital = np.cross(y[:, CENTER], two.masses[:, None] * rates[:, VELOCITY])
    assert (orbital + rates[:, MOMENTUM]).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * size)


def test_forces_end_at_the_cut_off():
    r = np.array([[4.999, 5.001, 5.999, 6.001]])
    one = np.ones((1, 4))
    energy, force = Dispersion(one, one, 2.0, 5.0).terms(r)
    assert np.abs(energy).max() < 1e-9 and np.abs(force).max() < 1e-6 and not force[0, 1:].any()
    energy, force = Charges(one, 0.3, 6.0).terms(r)
    assert np.abs(energy[0, 2:]).max() < 1e-6 and np.abs(force[0, 2:]).max() < 1e-4 and not force[0, 3]


@pytest.mark.parametrize("deck, temperature, largest", [("in.dumbbells", 2.0, 3.5), ("in.nitrogen", 300.0, 8.0)])
def test_flights_are_those_of_dop853(deck, temperature, largest):
    """Velocities and angular momenta after the encounter to 1e-8; flown back, they return."""
    rows = flown.beside_reference(deck, temperature, largest, 4, lambda: None)
    once = rows[rows[:, 2] <= 1]
    assert len(once) >= 3
    assert once[:, :2].max() < 1e-8 and once[:, 3].max() < 1e-7


# --- other methods --------------------------------------------------------------------------------
def test_errors_fall_with_the_tolerance_and_with_the_square_of_a_step():
    points = rivals.points(1, (1e-6, 1e-10), (4e-3, 1e-3), {"DOP853": (1e-6, 1e-10)}, lambda: None)
    gear, rigid, solver = (points[name] for name in ("fix gear/quat", "fix rigid/nve/small", "DOP853"))
    assert gear[1, 2] < 1e-2 * gear[0, 2] and solver[1, 2] < 1e-2 * solver[0, 2]
    assert rigid[0, 2] / rigid[1, 2] == pytest.approx(16.0, rel=0.2)
    assert rigid[1, 1] > 3.5 * rigid[0, 1]  # evaluations
    assert gear[1, 2] < 1e-3 * rigid[1, 2] and gear[1, 1] < rigid[1, 1]


# --- judging --------------------------------------------------------------------------------------
def run(**more):
    quantities = {f"Omega({a},{b})*": (value, 0.001) for a, b, value in ((1, 1, 1.4396), (2, 2, 1.5929), (1, 2, 1.204))}
    quantities |= {"gain": (0.1, 0.1), "viscosity": (18.0, 0.1), "cross section": (55.0, 0.2)}
    counts = dict.fromkeys(("flights", "orbiting", "unparted", "lost", "repeated"), 0)
    return flown.Run(quantities | more, {}, counts, {"energy": 1e-10})


def seeds(spread=1.0, number=100):
    """Rows of errors.py of an ion, whose values deviate by ``spread`` times the errors."""
    random = np.random.default_rng(1)
    atoms, temperature = errors.CENTRAL["12-4 ion, 300 K"]
    columns = [np.arange(number), np.full(number, 512)]
    for order in (1, 2):
        exact = atoms.exact(order, order, temperature)
        columns += [exact * (1.0 + 0.01 * spread * random.normal(size=number)), np.full(number, 0.01 * exact)]
    return {("12-4 ion, 300 K", 0.03): np.column_stack(columns)}


def results():
    points = {
        "fix gear/quat": np.array([[0.002, 200, 1e-6], [0.004, 400, 1e-10]]),
        "fix rigid/nve/small": np.array([[0.002, 500, 1e-4], [2.0, 500_000, 1e-10]]),
        "DOP853": np.array([[0.03, 300, 1e-5], [0.15, 1200, 1e-11]]),
    }
    rows = np.array([[1e-11, 1e-10, 1, 1e-10], [1e-3, 1e-3, 3, 1e-3]])
    molecules = dict.fromkeys(("nitrogen", "helium"), run()) | {"ion": run(**{"cross section": (115.0, 1.0)})}
    return study.Results({1.0: run()}, molecules, run(), {"in.dumbbells": rows}, points, seeds())


def test_the_page_of_results_that_hold(tmp_path):
    finding = study.find(results())
    assert [m.what for m in finding.measurements if not m.holds] == []
    # logarithms are interpolated between the two settings
    values = {m.what: m.value for m in finding.measurements}
    ours, rigid = (0.002 * (1e-6 / 1e-9) ** (np.log(2) / np.log(1e4)), 0.002 * (1e-4 / 1e-9) ** 0.5)
    assert values["time of fix rigid/nve/small over that of the fix at 1e-09"] == pytest.approx(rigid / ours)
    text = render("scatter.md.j2", study.STUDY, finding, "Somewhere.")
    assert "| fix gear/quat |" in text and "120 µs" in text
    finding.pictures["scatter"](tmp_path / "scatter.png")
    assert (tmp_path / "scatter.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    "change, failing",
    [
        ({"integrals": {1.0: run(**{"Omega(1,1)*": (1.4396 * 1.01, 0.001)})}}, "Ω*: largest deviation"),
        ({"conservation": run(gain=(0.5, 0.1))}, "net transfer"),
        ({"errors": seeds(spread=1.2)}, "rms deviation by the error that is stated"),
        ({"reference": {"in.nitrogen": np.array([[1e-2, 1e-10, 1, 1e-10]])}}, "largest deviation of a velocity"),
    ],
)
def test_errors_are_noticed(change, failing):
    finding = study.find(dataclasses.replace(results(), **change))
    assert [m.what for m in finding.measurements if not m.holds][0].startswith(failing)


def test_parts_that_were_not_asked_for_are_left_out():
    finding = study.find(dataclasses.replace(results(), molecules=None, methods=None, integrals=None, errors=None))
    assert not finding.pictures and set(finding.tables) == {"orbiting"}


def test_seeds_that_are_done_are_kept(tmp_path, monkeypatch):
    """The study continues after those, of atoms by quadrature and of molecules with flights."""
    monkeypatch.setattr(errors, "CENTRAL", {"argon, T* = 2": errors.CENTRAL["argon, T* = 2"]})
    first = errors.of_atoms(tmp_path, 2, (0.1,), lambda: None)
    (file,) = tmp_path.glob("*.json")
    assert file.name == "argon_T_=_2_0.1.json"
    monkeypatch.setattr(errors, "until", lambda *_: pytest.fail("a seed is done again"))
    again = errors.of_atoms(tmp_path, 2, (0.1,), lambda: None)
    assert (again["argon, T* = 2", 0.1] == first["argon, T* = 2", 0.1]).all()
    assert first["argon, T* = 2", 0.1][:, :2].tolist() == [[1001, 512], [1002, 512]]

    pairs = {"argon": (EXAMPLES / "collisions" / "in.argon", (("tolerance", "1e-7"),), 300.0)}
    found = errors.of_molecules(tmp_path, 1, (0.1,), 1, lambda: None, pairs)["argon", 0.1]
    value, error = found[0, 2:4] / (np.pi * 3.405**2 * np.sqrt(0.0019872067 * 300.0 / (2 * np.pi * 19.974)) / 48.88821291)
    assert abs(value - errors.ARGON.exact(1, 1, 300.0 / 119.8)) < 4.0 * error < 0.1
    assert not (tmp_path / "argon_0.1").exists()
