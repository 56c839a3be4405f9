"""gearquat scatter in LAMMPS: single flights against exact results, and runs of the command."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import quad
from scipy.optimize import brentq

from gearquat_analysis.units import UNITS
from lammps_gearquat.cli import main
from lammps_gearquat.scatter import flights
from lammps_gearquat.scatter.pair import Pair
from support import colliding
from support.running import EXAMPLES

#: for averages, whose errors are much larger than the errors of flights
COARSE = {"tolerance 1e-10": "tolerance 1e-8"}
ROUND = ("--count", "512")


def planned(pair, seed=1, temperature=2.0):
    """(Plan, random numbers) of the first round."""
    facts, plan = flights.planned(pair, seed, temperature, None, temperature)
    return plan, next(plan.points(facts.dimension))


@pytest.fixture(scope="module")
def dumbbells(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dumbbells")
    with Pair(colliding.write(folder, colliding.DUMBBELLS, cutoff=4.0, inner=2.5)) as pair:
        yield pair


def run(deck, out, *options):
    """results.json, and the output of the command."""
    result = CliRunner().invoke(main, ["scatter", str(deck), "--out", str(out), "--processes", "1", *options])
    assert result.exit_code == 0, result.output
    return json.loads((out / "results.json").read_text()), result.output


def radial(b, energy):
    """Function of the distance of two atoms of the deck: the part of their energy in radial motion."""
    return lambda r: 1.0 - (b / r) ** 2 - colliding.smoothed(r) / energy


def nearest(b, energy):
    """Smallest distance of two atoms of the deck."""
    inner, grid = radial(b, energy), np.linspace(7.0, 0.7, 4000)
    first = np.argmax(inner(grid) < 0.0)
    return brentq(inner, grid[first], grid[first - 1], xtol=1e-15)


def deflection(b, energy):
    """Of two atoms of the deck, by quadrature, with r = r0 / sin(t)."""
    inner, closest = radial(b, energy), nearest(b, energy)

    def integrand(t):
        return b / closest * np.cos(t) / np.sqrt(inner(closest / np.sin(t)))

    corners = [np.arcsin(closest / r) for r in (6.0, 7.0) if r > closest]
    edges = [0.0, *sorted(corners), np.pi / 2 - 1e-7]
    whole = sum(quad(integrand, *pair, epsabs=1e-11, limit=200)[0] for pair in zip(edges, edges[1:]))
    # at the turning point the integrand is finite
    whole += 1e-7 * integrand(np.pi / 2 - 1e-4)
    return abs((np.pi - 2.0 * whole + np.pi) % (2.0 * np.pi) - np.pi)


def test_deflection_of_atoms(tmp_path):
    with Pair(colliding.write(tmp_path)) as pair:
        plan, points = planned(pair)
        for flight in flights.fly(pair, plan, 0, points[:12], 10_000):
            assert flight.fate == "parted" and flight.error_energy < 1e-8
            assert flight.angle == pytest.approx(deflection(flight.b, flight.energy), abs=2e-6)


def test_time_reversal(dumbbells):
    """A reversed flight ends with the initial velocities and angular momenta; bodies that orbit each other amplify errors."""
    plan, points = planned(dumbbells, seed=2)
    errors = []
    for _, _, start in plan.starts(dumbbells, points[:16]):
        end = dumbbells.fly(start)
        back = dumbbells.fly(replace(end, velocity=-end.velocity, momentum=-end.momentum))
        errors.append([np.abs(back.velocity + start.velocity).max(), np.abs(back.momentum + start.momentum).max()])
    assert np.median(errors, axis=0).max() < 3e-7 and np.max(errors) < 1e-3


def test_a_flight_does_not_depend_on_those_before(dumbbells):
    plan, points = planned(dumbbells)
    every = flights.fly(dumbbells, plan, 0, points[:6], 10_000)
    assert flights.fly(dumbbells, plan, 5, points[5:6], 10_000) == every[5:]


def test_poses(dumbbells):
    """In a flight without interaction both bodies turn freely."""
    plan, points = planned(dumbbells)
    points[0, 0] = 1.0 - 1e-12  # the largest impact parameter
    ((_, _, start),) = plan.starts(dumbbells, points[:1])
    end = dumbbells.fly(start)
    assert end.velocity == pytest.approx(start.velocity, abs=1e-12)
    before, after = (dumbbells.turned(state.quaternion, dumbbells.bodies.shape) for state in (start, end))
    omega = dumbbells.bodies.divided_by_inertia(start.quaternion, start.momentum)
    for k in range(2):
        own = np.flatnonzero(dumbbells.bodies.of == k)[0]
        angle, axis = (np.linalg.norm(omega[k]) * end.time, omega[k] / np.linalg.norm(omega[k]))
        arm = before[own]
        turned = np.cos(angle) * arm + np.sin(angle) * np.cross(axis, arm) + (1 - np.cos(angle)) * (axis @ arm) * axis
        assert after[own] == pytest.approx(turned, abs=1e-7)


def neufeld(temperature):
    """Omega(1,1)* and Omega(2,2)* of Lennard-Jones atoms, to 0.1 %.

    P. D. Neufeld, A. R. Janzen, R. A. Aziz, J. Chem. Phys. 57, 1100 (1972), without the oscillating terms.
    """
    one = 1.06036 * temperature**-0.1561 + 0.193 * np.exp(-0.47635 * temperature)
    one += 1.03587 * np.exp(-1.52996 * temperature) + 1.76474 * np.exp(-3.89411 * temperature)
    two = 1.16145 * temperature**-0.14874 + 0.52487 * np.exp(-0.7732 * temperature)
    return {"Omega(1,1)*": one, "Omega(2,2)*": two + 2.16178 * np.exp(-2.43787 * temperature)}


def test_collision_integrals_of_argon(tmp_path):
    found, _ = run(colliding.write(tmp_path, **COARSE), tmp_path / "out", "--temperature", "2", "--count", "4096")
    for order, known in enumerate(neufeld(2.0).values(), 1):
        quantity = found["quantities"][f"Omega({order},{order})"]
        value, error = (quantity[name] / (order * np.sqrt(2.0 * np.pi)) for name in ("value", "error"))
        assert error < 0.015 * known and abs(value - known) < 3.0 * error + 0.001 * known
    assert found["flights"]["unparted"] == found["flights"]["lost"] == 0


def test_rotation_of_molecules(tmp_path):
    """Cold rotation gains energy, and by detailed balance rotation of the same temperature does not."""
    deck = colliding.write(tmp_path, colliding.DUMBBELLS, cutoff=4.0, inner=2.5, **COARSE)
    cold, _ = run(deck, tmp_path / "cold", "--temperature", "1", "--rotation", "0.2", *ROUND)
    warm, _ = run(deck, tmp_path / "warm", "--temperature", "1", *ROUND)
    gains = [found["quantities"]["gain"] for found in (cold, warm)]
    assert gains[0]["value"] > 3.0 * gains[0]["error"] and abs(gains[1]["value"]) < 3.5 * gains[1]["error"]


def test_any_number_of_processes(tmp_path):
    deck = colliding.write(tmp_path, **COARSE)
    for name, number in (("one", "1"), ("two", "2")):
        run(deck, tmp_path / name, "--temperature", "1", *ROUND, "--processes", number)
    one, two = ((tmp_path / name / "flights.csv").read_text() for name in ("one", "two"))
    assert one == two and len(one.splitlines()) == 513


def test_it_flies_until_errors_are_small(tmp_path):
    found, output = run(colliding.write(tmp_path, **COARSE), tmp_path / "out", "--temperature", "2", "--error", "0.03")
    for name in ("Omega(1,1)", "Omega(2,2)"):
        assert found["quantities"][name]["error"] <= 0.03 * found["quantities"][name]["value"]
    assert "Change of the energy in a flight" in output and (tmp_path / "out" / "deflection.png").exists()


def test_flights_that_never_part_are_counted(tmp_path):
    found, output = run(
        colliding.write(tmp_path, **COARSE), tmp_path / "out", "--temperature", "1", *ROUND, "--steps", "180"
    )
    assert 0 < found["flights"]["unparted"] < 500 and "errors include their whole contribution" in output


def test_flights_that_lammps_ends_are_lost(tmp_path):
    """Flights are lost here because the fix is refused."""
    with Pair(colliding.write(tmp_path)) as pair:
        plan, points = planned(pair)
        pair._command_of_fix = "fix move all gear/quat molecule tolerance -1 energy"
        (lost,) = flights.fly(pair, plan, 0, points[:1], 1000)
        assert lost.fate == "lost" and "tolerance" in lost.message and np.isnan(lost.angle)
        # and later flights are not affected
        (flight,) = flights.fly(pair, plan, 1, points[1:2], 1000)
        assert flight.fate == "parted"


def test_lists_of_hybrid_styles():
    """In a flight every style has the neighbors that it would have in a new run at that place."""
    with Pair(EXAMPLES / "collisions" / "in.nitrogen") as pair:
        plan, points = planned(pair, temperature=300.0)
        lammps, starts = pair.lammps, plan.starts(pair, points)
        for _, _, start in sorted(starts, key=lambda one: one[0])[:3]:
            for steps in (300, 600, 900, 1200, 1500):
                pair.fly(start, steps)
                before = lammps.numpy.extract_atom("f")[:6].copy()
                lammps.command("run 0 post no")
                # the pose of a new run is the corrected one
                error = np.abs(lammps.numpy.extract_atom("f")[:6] - before).max()
                assert error < 1e-6 * (1.0 + np.abs(before).max())


@pytest.fixture(scope="module")
def reduced(tmp_path_factory):
    """results.json of argon in units lj."""
    folder = tmp_path_factory.mktemp("lj")
    return run(colliding.write_argon(folder, "lj"), folder / "out", "--temperature", "2", *ROUND)[0]


@pytest.mark.parametrize("style", ["real", "si", "electron"])
def test_all_styles_of_units(tmp_path, style, reduced):
    """The same collisions in other units."""
    sigma = colliding.SIGMA / (UNITS[style].angstrom * 1e-10)
    deck, out = colliding.write_argon(tmp_path, style), tmp_path / "out"
    found, _ = run(deck, out, "--temperature", str(2.0 * colliding.WELL), *ROUND)
    quantities, known = found["quantities"], reduced["quantities"]
    assert found["plan"]["largest"] == pytest.approx(7.0 * sigma, rel=1e-6)
    for key in ("value", "error"):
        assert quantities["cross section"][key] == pytest.approx(sigma**2 * known["cross section"][key], rel=0.02)
    # 0.78 uPa s of the units, m^(1/2) epsilon^(1/2) / sigma^2, in units of the SI
    mass, thermal = 39.948 * 1.66053907e-27, 1.380649e-23 * colliding.WELL
    unit = np.sqrt(mass * thermal) / colliding.SIGMA**2 * 1e6
    assert quantities["viscosity"]["value"] == pytest.approx(unit * known["viscosity"]["value"], rel=0.02)


def heeds_interrupts():
    """A shell ignores interrupts in background processes."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_interrupted(tmp_path):
    """After Ctrl-C the results are those of the flights so far."""
    deck, out = colliding.write(tmp_path, **COARSE), tmp_path / "out"
    options = ["--temperature", "1", "--error", "1e-6", "--processes", "1", "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", "from lammps_gearquat.cli import main; main()", "scatter", str(deck), *options],
        start_new_session=True,
        preexec_fn=heeds_interrupts,
        stderr=subprocess.PIPE,
        text=True,
    )
    told = process.stderr.readline()
    assert "512 flights: relative errors" in told
    time.sleep(0.5)
    os.killpg(process.pid, signal.SIGINT)
    _, rest = process.communicate(timeout=60)
    assert process.returncode == 0 and "Traceback" not in rest
    assert len((out / "flights.csv").read_text().splitlines()) % 16 == 1
