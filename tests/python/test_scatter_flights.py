"""gearquat scatter in LAMMPS: single flights against exact results, and runs of the command."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from support import colliding
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.integrate import quad
from scipy.optimize import brentq

from lammps_gearquat.cli import main
from lammps_gearquat.scatter import Plan, flights, open_pair, store
from lammps_gearquat.scatter.sampling import rotational, starts_of
from gearquat_analysis import Poses, open_dump
from gearquat_analysis.units import UNITS
from support.running import EXAMPLES

WHOLE = ("--temperature", "1", "--largest", "3", "--seed", "4")
#: the command in another process, as with the fixture few_pilots
FEW_PILOTS = "from lammps_gearquat.scatter import pilots; pilots.ALONG = 1; from lammps_gearquat.cli import main; main()"
#: for averages, whose errors are much larger than the errors of flights
COARSE = {"tolerance 1e-10": "tolerance 1e-8"}


@pytest.fixture(scope="module")
def dumbbells(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dumbbells")
    with open_pair(colliding.write(folder, colliding.DUMBBELLS, cutoff=4.0, inner=2.5)) as pair:
        yield pair


def run(deck, out, *options):
    """Output of the command."""
    result = CliRunner().invoke(main, ["scatter", str(deck), "--out", str(out), "--processes", "1", *options])
    assert result.exit_code == 0, result.output
    return result.output


def contents(out):
    return {name: (out / name).read_bytes() for name in ("flights.csv", "results.json")}


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
    with open_pair(colliding.write(tmp_path)) as pair:
        for flight in flights.fly(pair, Plan((1,), (2.0,), None, None, 3.0), range(12), 10_000):
            assert flight.fate == "parted" and flight.turnings == 1
            assert flight.angle == pytest.approx(deflection(flight.b, flight.energy), abs=2e-6)
            assert flight.error_energy < 1e-8 and flight.error_angular < 1e-8 and flight.error_momentum < 1e-13
            assert flight.closest == pytest.approx(nearest(flight.b, flight.energy), abs=2e-4)


def test_time_reversal(dumbbells):
    """A reversed flight ends with the initial velocities and angular momenta."""
    plan = Plan((2,), (2.0,), None, None, 2.0)
    for number in range(10):
        start = plan.start(dumbbells, number)
        end = dumbbells.fly(start)
        back = dumbbells.fly(end.reversed())
        assert np.abs(end.momentum - start.momentum).max() > 1e-3
        # orbiting bodies amplify errors exponentially
        error = 3e-7 if end.turnings == 1 else 1e-3
        assert back.velocity == pytest.approx(-start.velocity, abs=error)
        assert back.momentum == pytest.approx(-start.momentum, abs=error)


def test_a_flight_does_not_depend_on_those_before(dumbbells):
    plan = Plan((2,), (2.0,), None, None, 2.0)
    every = flights.fly(dumbbells, plan, range(6), 10_000)
    assert flights.fly(dumbbells, plan, [5, 2], 10_000) == [every[5], every[2]]


def test_poses(dumbbells):
    """In a flight without interaction both bodies turn freely."""
    number = np.arange(1)
    random = np.full((1, rotational(dumbbells)), 0.3)
    start = starts_of(dumbbells, 4.45 + number, 2.0 + number, 1.0 + number, random)[0][2]
    end = dumbbells.fly(start)
    assert end.velocity == pytest.approx(start.velocity, abs=1e-12)
    before, after = (dumbbells.turned(state.quaternion, dumbbells.bodies.shape) for state in (start, end))
    omega = dumbbells.bodies.divided_by_inertia(start.quaternion, start.momentum)
    for k in range(2):
        own = np.flatnonzero(dumbbells.bodies.of == k)[0]
        angle, axis = np.linalg.norm(omega[k]) * end.time, omega[k] / np.linalg.norm(omega[k])
        arm = before[own]
        turned = (
            np.cos(angle) * arm + np.sin(angle) * np.cross(axis, arm) + (1 - np.cos(angle)) * (axis @ arm) * axis
        )
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
    run(colliding.write(tmp_path, **COARSE), tmp_path / "out", "--temperature", "2", "--sigma", "1", "--count", "4096")
    found = json.loads((tmp_path / "out" / "results.json").read_text())
    for name, known in neufeld(2.0).items():
        quantity = found["quantities"][name]
        assert quantity["error"] < 0.015 * known
        assert abs(quantity["value"] - known) < 3.0 * quantity["error"] + 0.001 * known, name
    assert found["flights"]["unparted"] == found["flights"]["lost"] == 0


def test_detailed_balance(tmp_path, few_pilots):
    """Cold rotation gains energy; for equal temperatures see test_several_temperatures_of_molecules."""
    deck = colliding.write(tmp_path, colliding.DUMBBELLS, cutoff=4.0, inner=2.5, **COARSE)
    run(deck, tmp_path / "out", *WHOLE, "--rotation", "0.2", "--count", "384")
    cold = json.loads((tmp_path / "out" / "results.json").read_text())["quantities"]["gain"]
    assert cold["value"] > 3.0 * cold["error"]


def test_any_number_of_processes_and_parts(tmp_path, few_pilots):
    """The files are the same on two processes, continued after an interruption at any point, and merged from three
    parts."""
    deck = colliding.write(tmp_path)
    run(deck, tmp_path / "whole", *WHOLE, "--count", "60")
    expected = contents(tmp_path / "whole")
    run(deck, tmp_path / "two", *WHOLE, "--count", "60", "--processes", "2")
    assert contents(tmp_path / "two") == expected

    cut = tmp_path / "two" / "flights.csv"
    cut.write_bytes(expected["flights.csv"][:2503])
    (tmp_path / "two" / "results.json").unlink()
    run(deck, tmp_path / "two", *WHOLE, "--count", "60")
    assert contents(tmp_path / "two") == expected

    parts = []
    for first in (40, 20, 0):
        out = tmp_path / f"part{first}"
        run(deck, out, *WHOLE, "--first", str(first), "--count", "20")
        parts += ["--merge", str(out)]
    result = CliRunner().invoke(main, ["scatter", *parts, "--out", str(tmp_path / "merged")])
    assert result.exit_code == 0, result.output
    assert contents(tmp_path / "merged") == expected

    # and a gap that is filled later
    run(deck, out, *WHOLE, "--first", "30", "--count", "30")
    run(deck, out, *WHOLE, "--count", "60")
    assert contents(out) == expected


def test_what_is_known_of_flights_is_said(tmp_path, few_pilots):
    """Messages about flights that existed before, that are in two parts, and that are in no part."""
    deck, (one, two, three) = colliding.write(tmp_path), (tmp_path / name for name in "abc")
    run(deck, one, *WHOLE, "--count", "24")
    assert "16 of the 24 flights were in the folder before" in run(deck, one, *WHOLE, "--count", "8")
    run(deck, two, *WHOLE, "--first", "32", "--count", "8")
    parts = [word for part in (one, one, two) for word in ("--merge", str(part))]
    result = CliRunner().invoke(main, ["scatter", *parts, "--out", str(three)])
    assert "in several parts are counted once: 24" in result.output
    assert "Flights that no part has: 24 to 31" in result.output
    assert len((three / "flights.csv").read_text().splitlines()) == 1 + 32


def test_killed_and_continued(tmp_path, few_pilots):
    deck, out = colliding.write(tmp_path), tmp_path / "out"
    options = [*WHOLE, "--count", "150", "--processes", "1", "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", FEW_PILOTS, "scatter", str(deck), *options], start_new_session=True
    )
    table = out / "flights.csv"
    while not (table.exists() and table.stat().st_size > 5000):
        assert process.poll() is None
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    flown = len(table.read_bytes().splitlines())
    assert flown < 151
    run(deck, out, *options)
    run(deck, tmp_path / "whole", *WHOLE, "--count", "150")
    assert contents(out) == contents(tmp_path / "whole")


def test_it_flies_until_errors_are_small(tmp_path):
    deck = colliding.write(tmp_path)
    output = run(deck, tmp_path / "out", "--temperature", "2", "--error", "0.03")
    found = json.loads((tmp_path / "out" / "results.json").read_text())
    for name in ("Omega(1,1)", "Omega(2,2)"):
        assert found["quantities"][name]["error"] <= 0.03 * found["quantities"][name]["value"]
    # the part beyond the largest impact parameter is a tenth of this error
    assert max(found["settings"]["largest"]["left"][0].values()) < 3e-3
    assert 1.5 < found["settings"]["plan"]["largest"] < 3.0
    assert "orbiting" in output and {path.name for path in Path(tmp_path / "out").glob("*.png")} == {
        "deflection.png",
        "convergence.png",
    }


def test_flights_that_never_part_are_named(tmp_path):
    """There are few unparted flights here; if there were many, no number of flights could compensate for them."""
    deck, out = colliding.write(tmp_path), tmp_path / "out"
    output = run(deck, out, *WHOLE, "--count", "64", "--steps", "330")
    counts = json.loads((out / "results.json").read_text())["flights"]
    assert 0 < counts["unparted"] < 32 and "Unparted: " in output and "errors include their whole contribution" in output
    result = CliRunner().invoke(main, ["scatter", str(deck), "--out", str(out), *WHOLE, "--steps", "330", "--error", "1e-3"])
    assert result.exit_code == 1 and "more --steps are required, with another --out" in " ".join(result.output.split())


def test_flights_that_lammps_ends_are_lost(tmp_path):
    """Flights are lost here because the fix is refused."""
    with open_pair(colliding.write(tmp_path)) as pair:
        plan = Plan((1,), (2.0,), None, None, 3.0)
        pair._command_of_fix = "fix move all gear/quat molecule tolerance -1 energy"
        (lost,) = flights.fly(pair, plan, [0], 1000)
        assert lost.fate == "lost" and "tolerance" in lost.message and np.isnan(lost.angle)
        # and later flights are not affected
        (flight,) = flights.fly(pair, plan, [1], 1000)
        assert flight.fate == "parted"


def test_lists_of_hybrid_styles():
    """In a flight every style has the neighbors that it would have in a new run at that place."""
    close = 0
    with open_pair(EXAMPLES / "collisions" / "in.nitrogen") as pair:
        plan, lammps = Plan((1,), (300.0,), None, None, 5.0), pair.lammps
        for number in range(3):
            for steps in (300, 600, 900, 1200, 1500):
                end = pair.fly(plan.start(pair, number), steps)
                before = lammps.numpy.extract_atom("f")[:6].copy()
                lammps.command("run 0 post no")
                # the pose of a new run is the corrected one
                error = np.abs(lammps.numpy.extract_atom("f")[:6] - before).max()
                assert error < 1e-6 * (1.0 + np.abs(before).max())
                close += end.closest < 4.0
    assert close


# --- units ----------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def reduced(tmp_path_factory):
    """results.json of argon in units lj."""
    folder = tmp_path_factory.mktemp("lj")
    run(colliding.write_argon(folder, "lj"), folder / "out", "--temperature", "2", "--count", "32", "--sigma", "1")
    return json.loads((folder / "out" / "results.json").read_text())


@pytest.mark.parametrize("style", ["real", "si", "electron"])
def test_all_styles_of_units(tmp_path, style, reduced):
    """The same collisions in other units: the same plan, the same integrals relative to spheres."""
    sigma = colliding.SIGMA / (UNITS[style].angstrom * 1e-10)
    deck, out = colliding.write_argon(tmp_path, style), tmp_path / "out"
    run(deck, out, "--temperature", str(2.0 * colliding.WELL), "--count", "32", "--sigma", f"{sigma:.17g}")
    found = json.loads((out / "results.json").read_text())
    plan, other = found["settings"]["plan"], reduced["settings"]["plan"]
    assert found["settings"]["pair"]["cutoff"] == pytest.approx(7.0 * sigma, rel=1e-6)
    assert plan["largest"] == pytest.approx(sigma * other["largest"], rel=0.01)
    for name in ("s0", "s1"):
        assert plan[name] == pytest.approx(sigma**2 * other[name], rel=0.02)
    for name in ("Omega(1,1)*", "Omega(2,2)*"):
        value, exact = found["quantities"][name], reduced["quantities"][name]
        assert value["value"] == pytest.approx(exact["value"], rel=0.02)
        assert value["error"] == pytest.approx(exact["error"], rel=0.1)
    # 0.78 uPa s of the units, m^(1/2) epsilon^(1/2) / sigma^2, in units of the SI
    mass, thermal = 39.948 * 1.66053907e-27, 1.380649e-23 * colliding.WELL
    unit = np.sqrt(mass * thermal) / colliding.SIGMA**2 * 1e6
    assert found["quantities"]["viscosity"]["value"] == pytest.approx(
        unit * reduced["quantities"]["viscosity"]["value"], rel=0.02
    )


# --- several temperatures -------------------------------------------------------------------------
def test_several_temperatures_of_molecules(tmp_path):
    """Averages agree with flights at each temperature alone, and rotation gains nothing."""
    deck = colliding.write(tmp_path, colliding.DUMBBELLS, cutoff=4.0, inner=2.5, **COARSE)
    options = ("--temperature", "2", "--temperature", "1", "--largest", "3", "--count", "384")
    output = run(deck, tmp_path / "both", *options)
    assert "temperatures 1, 2: 384 flights" in output and "temperature 1:" in output
    both = json.loads((tmp_path / "both" / "results.json").read_text())["temperatures"]
    assert [answer["temperature"] for answer in both] == [1.0, 2.0]
    for answer in both:
        out = tmp_path / f"alone{answer['temperature']:g}"
        run(deck, out, "--temperature", f"{answer['temperature']:g}", "--largest", "3", "--count", "384", "--seed", "2")
        alone = json.loads((out / "results.json").read_text())["quantities"]
        for name in ("Omega(1,1)", "Omega(2,2)", "transfer"):
            one, two = answer["quantities"][name], alone[name]
            error = np.hypot(one["error"], two["error"])
            assert abs(one["value"] - two["value"]) < 3.5 * error < 0.85 * two["value"], name
        gain = answer["quantities"]["gain"]
        assert abs(gain["value"]) < 3.5 * gain["error"]


# --- one flight -----------------------------------------------------------------------------------
def test_a_flight_as_a_dump(tmp_path, few_pilots):
    """The dump contains the flight of the table, and the analysis reads it."""
    deck, out = colliding.write(tmp_path, colliding.DUMBBELLS, cutoff=4.0, inner=2.5), tmp_path / "out"
    run(deck, out, *WHOLE, "--count", "8")
    columns = flights.columns(store.parse(store.read_lines(out)))
    result = CliRunner().invoke(main, ["scatter", str(deck), "--out", str(out), "--replay", "5"])
    assert result.exit_code == 0 and f"{columns['angle'][5]:.12g}, and" in result.output
    universe = open_dump(out / "flight_5.dump")
    times = [ts.time for ts in universe.trajectory]
    assert len(times) == columns["steps"][5] + 1 and times[-1] == pytest.approx(columns["time"][5], rel=1e-12)
    masses, relative, distances = universe.atoms.masses[:2], [], []
    for _ in universe.trajectory:
        centers, velocities = (
            [masses @ array[2 * k : 2 * k + 2] / masses.sum() for k in (0, 1)]
            for array in (universe.atoms.positions, universe.atoms.velocities)
        )
        relative.append(velocities[1] - velocities[0])
        distances.append(np.linalg.norm(centers[1] - centers[0]))
    before, after = relative[0], relative[-1]
    angle = np.arctan2(np.linalg.norm(np.cross(before, after)), before @ after)
    assert angle == pytest.approx(columns["angle"][5], abs=2e-6)  # MDAnalysis has seven digits
    assert columns["closest"][5] == pytest.approx(min(distances), abs=2e-3)
    assert len(Poses(universe.atoms).run().results.time) == len(times)


def test_flights_that_cannot_be_replayed(tmp_path, few_pilots):
    deck, out = colliding.write(tmp_path), tmp_path / "out"
    run(deck, out, *WHOLE, "--first", "4", "--count", "8")

    def refused(*options):
        result = CliRunner().invoke(main, ["scatter", *map(str, options), "--out", str(out)])
        assert result.exit_code == 1
        return " ".join(result.output.split())

    assert "has no flight 3: it has 8 flights, with numbers from 4 to 11" in refused(deck, "--replay", 3)
    assert "temperature has to be left out" in refused(deck, "--replay", 5, "--temperature", 1)
    assert "DECK is required" in refused("--replay", 5)
    other = tmp_path / "in.other"
    other.write_text(deck.read_text().replace("1.0 1.0", "1.1 1.0"))
    assert "flights of other settings" in refused(other, "--replay", 5)
    out = tmp_path / "nowhere"
    assert "a folder with results" in refused(deck, "--replay", 5)


# --- what is told ---------------------------------------------------------------------------------
def heeds_interrupts():
    """A shell ignores interrupts in background processes."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_interrupted(tmp_path, few_pilots):
    """Ctrl-C says that flights are kept, and the same command continues."""
    deck, out = colliding.write(tmp_path), tmp_path / "out"
    options = [*WHOLE, "--count", "40000", "--processes", "1", "--out", str(out)]
    process = subprocess.Popen(
        [sys.executable, "-c", FEW_PILOTS, "scatter", str(deck), *options],
        start_new_session=True,
        preexec_fn=heeds_interrupts,
        stderr=subprocess.PIPE,
        text=True,
    )
    table = out / "flights.csv"
    while not (table.exists() and table.stat().st_size > 5000):
        assert process.poll() is None
        time.sleep(0.01)
    os.killpg(process.pid, signal.SIGINT)
    _, told = process.communicate(timeout=60)
    assert process.returncode == 130 and "Traceback" not in told
    kept = len(table.read_bytes().splitlines()) - 1
    assert f"Interrupted: {kept} flights are kept in {out}; the same command continues after them" in told
    assert "of the" in run(deck, out, *WHOLE, "--count", "8")
