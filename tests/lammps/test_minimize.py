"""Energy minimization of rigid bodies with LAMMPS' command minimize."""

import re

import numpy as np
import pytest
from support.constant_pressure import ARMS, FLAT_ARMS, GAUSS, MASSES, REPULSIVE, trimers
from support.scenes import one_after_the_other
from support.constant_pressure import dipoles_deck

DECK = """
units lj
dimension {dimension}
atom_style molecular
atom_modify map array
boundary {boundary}
read_data data.{data}
{pair}
neighbor 0.4 bin
neigh_modify delay 0 every 1 check yes exclude molecule/intra all
timestep 0.002
{before}
fix move all gear/quat {words}
compute w all pressure NULL virial
thermo_style custom step pe ke fnorm fmax vol c_w c_w[*]
thermo_modify norm no format float %.17g
thermo 10
{after}
write_dump all custom {end} id xu yu zu vx vy vz fx fy fz modify sort id format float %.17g
"""
MINIMIZE = "minimize 0.0 1e-8 3000 10000"


@pytest.fixture(autouse=True)
def data(tmp_path):
    tilted = np.array([[1.0, 0.1, 0.2], [0.0, 1.0, 0.1], [0.0, 0.0, 1.0]])
    trimers(tmp_path / "data.trimers", n=3, spacing=0.9)
    trimers(tmp_path / "data.tilted", n=3, spacing=0.9, change=tilted)
    trimers(tmp_path / "data.flat", n=4, spacing=0.9, flat=True)


def scene(after=MINIMIZE, **settings):
    known = dict(dimension=3, boundary="p p p", data="trimers", pair=GAUSS, before="", words="molecule", end="end.dump")
    return DECK.format(after=after, **(known | settings))


def molecules(path):
    """Positions, velocities and forces of the sites of all molecules, each of shape (molecules, 3, 3)."""
    rows = np.loadtxt(path, skiprows=9)[:, 1:]
    return [rows[:, k : k + 3].reshape(-1, 3, 3) for k in (0, 3, 6)]


def stretch(x, arms=ARMS):
    """The largest change of a distance between sites of a body, relative."""
    found, known = (np.linalg.norm(y - np.roll(y, 1, axis=-2), axis=-1) for y in (x, arms))
    return np.abs(found / known - 1).max()


def unlike_rigid(f, x):
    """The part of forces on sites that is not a rigid motion, relative: their components along the sides cancel."""
    side, difference = (y - np.roll(y, 1, axis=1) for y in (x, f))
    return np.abs((side * difference).sum(axis=-1)).max() / np.abs(f).max()


def loads(x, f):
    """Sum of forces, and torque about the center of mass, of shape (molecules, 3)."""
    center = (MASSES[:, None] * x).sum(axis=1, keepdims=True) / MASSES.sum()
    return f.sum(axis=1), np.cross(x - center, f).sum(axis=1)


def evaluations(result):
    return int(re.search(r"Iterations, force evaluations = \d+ (\d+)", result.output)[1])


@pytest.mark.parametrize("style, most", [("cg", 600), ("sd", 6000)])
def test_minimum(lmp_wheel, style, most):
    tolerance = {"cg": 1e-8, "sd": 1e-2}[style]
    result = lmp_wheel.succeed(scene(f"min_style {style}\nminimize 0.0 {tolerance} 20000 40000"))
    table = result.thermo[-1]
    energies = np.array(table["PotEng"])
    assert np.all(np.diff(energies) <= 1e-10 * np.abs(energies[-1]))
    assert energies[-1] < 0.9 * energies[0]
    assert evaluations(result) < most
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    assert np.linalg.norm(f) == pytest.approx(table["Fnorm"][-1], rel=1e-9)
    assert np.linalg.norm(f) < tolerance < 1e-3 * table["Fnorm"][0]
    assert stretch(x) < 1e-12


def test_temperature_before_the_first_run(lmp_wheel):
    """As created: bodies adopt the velocities of their atoms in a run, so all degrees of freedom of atoms count."""
    after = f"velocity all create 1.3 4711\nthermo_style custom step temp fnorm\n{MINIMIZE}"
    assert np.array(lmp_wheel.succeed(scene(after)).thermo[0]["Temp"]) == pytest.approx(1.3, rel=1e-9)


def test_same_minimum_on_two_ranks(lmp_wheel):
    found = []
    for ranks in (1, 2):
        result = lmp_wheel.succeed(scene("minimize 0.0 1e-5 3000 10000"), ranks=ranks)
        found.append([molecules(lmp_wheel.folder / "end.dump")[0], result.thermo[-1]["PotEng"][-1]])
    (x, energy), (other, its) = found
    assert np.abs(other - x).max() < 1e-5 and its == pytest.approx(energy, abs=1e-9)


def test_gradient(lmp_wheel):
    """Force and torque by finite differences of the energy; the forces on atoms correspond to a rigid motion."""
    h, first, steps = 1e-3, 5, (-2, -1, 1, 2)
    turned = [f"{axis} {s * np.degrees(h):.17g}" for axis in ("1 0 0", "0 1 0", "0 0 1") for s in steps]
    moved = [" ".join(str(s * h * (k == n)) for k in range(3)) for n in range(3) for s in steps]
    lmp_wheel.succeed(scene("minimize 0.0 0.0 7 100\nwrite_data data.seven nocoeff"))
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    assert unlike_rigid(f, x) < 1e-12 < 1e-3 < unlike_rigid(f * [1.01, 1.0, 1.0], x)
    center = MASSES @ x[first] / MASSES.sum()
    at = " ".join(f"{c:.17g}" for c in center)
    displaced = [f"displace_atoms one move {way} units box" for way in moved]
    displaced += [f"displace_atoms one rotate {at} {way}" for way in turned]
    decks = [scene("run 0", data="seven", before=f"group one molecule {first + 1}\n{way}", end=f"{k}.dump")
             for k, way in enumerate(displaced)]
    result = lmp_wheel.succeed(one_after_the_other(decks))
    energies = np.array([table["PotEng"][-1] for table in result.thermo]).reshape(6, 4)
    slopes = -energies @ [1.0, -8.0, 8.0, -1.0] / (12 * h)
    known = np.concatenate([load[first] for load in loads(x, f)])
    assert np.abs(slopes - known).max() < 1e-8 * np.abs(known).max()


def test_velocities_go_with_the_bodies(lmp_wheel):
    """Velocities and body-frame angular velocities are constant: so are the energies in the next run."""
    after = f"run 0\nwrite_dump all custom begin.dump id xu yu zu vx vy vz fx fy fz modify sort id\n{MINIMIZE}"
    result = lmp_wheel.succeed(scene(f"{after}\nrun 50"))
    before, last = result.thermo[0], result.thermo[2]
    assert last["KinEng"][0] == pytest.approx(before["KinEng"][0], rel=1e-10)
    total = np.array(last["PotEng"]) + last["KinEng"]
    assert np.abs(total - total[0]).max() < 1e-4 * last["KinEng"][0]
    assert "minimize moves the bodies; histories are rebuilt" not in result.output    # there were no histories
    result = lmp_wheel.succeed(scene(f"run 5\n{MINIMIZE}\nrun 5"))
    assert "minimize moves the bodies; histories are rebuilt" in result.output


def test_held_components(lmp_wheel):
    """Bodies do not move along, or turn about, axes that keywords force and torque turn off."""
    words = "molecule force * on off on torque * off off on force 1 off off off torque 1 off off off"
    result = lmp_wheel.succeed(scene(f"minimize 0 0 0 1\nwrite_dump all custom begin.dump id xu yu zu vx vy vz fx fy fz "
                                     f"modify sort id format float %.17g\n{MINIMIZE}", words=words))
    (before, *_), (x, _, f) = (molecules(lmp_wheel.folder / f"{n}.dump") for n in ("begin", "end"))
    moved, turned = ((MASSES[:, None] * y).sum(axis=1) / MASSES.sum() for y in (before, x))
    assert np.abs((turned - moved)[:, 1]).max() < 1e-12 < 1e-2 < np.abs((turned - moved)[:, [0, 2]]).max()
    heights = [y[:, :, 2] - y[:, :1, 2] for y in (before, x)]
    assert np.abs(heights[1] - heights[0]).max() < 1e-12    # rotates only about z
    assert np.abs(x[0] - before[0]).max() < 1e-12
    assert np.linalg.norm(f) < 1e-8 and stretch(x) < 1e-12
    assert result.thermo[-1]["PotEng"][-1] < 0.99 * result.thermo[-1]["PotEng"][0]


def test_flat(lmp_wheel):
    after = f"fix plane all enforce2d\n{MINIMIZE}"
    result = lmp_wheel.succeed(scene(after, data="flat", dimension=2))
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    assert stretch(x, FLAT_ARMS) < 1e-12 and np.abs(x[:, :, 2]).max() == 0.0
    assert np.linalg.norm(f) < 1e-8 < 1e-6 * result.thermo[-1]["Fnorm"][0]


def test_rods_points_and_free_atoms(lmp_wheel):
    """Bodies of two atoms and of one, atoms of no body, and two fixes."""
    rods = "\n".join(f"set atom {3 * k + 3} mol {100 + k}" for k in range(9))
    before = f"{rods}\ngroup rods molecule 1:9\ngroup points molecule 100:108\ngroup whole molecule 10:20\n" \
        "group free subtract all rods points whole"
    after = f"fix other whole gear/quat molecule\nneigh_modify exclude molecule/intra all\n{MINIMIZE}"
    deck = scene(after, before=before + "\ngroup mine union rods points").replace("fix move all", "fix move mine")
    result = lmp_wheel.succeed(deck)
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    known = np.linalg.norm(ARMS[0] - ARMS[1])
    assert np.abs(np.linalg.norm(x[:9, 0] - x[:9, 1], axis=-1) / known - 1).max() < 1e-12
    assert stretch(x[9:20]) < 1e-12 < 1e-3 < stretch(x[20:])
    assert np.linalg.norm(f) < 1e-8
    assert result.thermo[-1]["PotEng"][-1] < 0.99 * result.thermo[-1]["PotEng"][0]


def test_forces_of_fixes_defined_later(lmp_wheel):
    """A slab in a field: forces added after this fix are included."""
    after = "variable fz atom -2.0*(z-1.35)\nvariable e atom (z-1.35)^2\n" \
        "fix well all addforce 0.0 0.0 v_fz energy v_e\nfix_modify well energy yes\n" + MINIMIZE
    result = lmp_wheel.succeed(scene(after, boundary="p p s"))
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    assert stretch(x) < 1e-12 and np.linalg.norm(f) < 1e-8
    energies = np.array(result.thermo[-1]["PotEng"])
    assert np.all(np.diff(energies) < 1e-10)
    assert result.thermo[-1]["Fnorm"][-1] == pytest.approx(np.linalg.norm(f), rel=1e-9)


@pytest.mark.parametrize("words, name", [("iso 20.0", "trimers"), ("aniso 22.0", "trimers"), ("tri 20.0", "tilted")])
def test_box_relax(lmp_wheel, words, name):
    """The molecular pressure becomes the target: the slope of the energy if only centers are scaled."""
    kind, pressure = words.split()[0], float(words.split()[1])
    after = f"fix box all box/relax {words} vmax 0.01\nminimize 0.0 1e-7 4000 20000\nunfix box\n{MINIMIZE}\n" \
        "write_data data.relaxed nocoeff"
    result = lmp_wheel.succeed(scene(after, data=name))
    x, _, f = molecules(lmp_wheel.folder / "end.dump")
    assert stretch(x) < 1e-12 and np.linalg.norm(f) < 1e-8
    table = result.thermo[-1]
    assert table["c_w"][-1] == pytest.approx(pressure, rel=1e-7)
    free = {"iso": 0, "aniso": 3, "tri": 6}[kind]
    found = [table[f"c_w[{k + 1}]"][-1] for k in range(free)]
    assert found == pytest.approx([pressure, pressure, pressure, 0.0, 0.0, 0.0][:free], abs=1e-6 * pressure)
    h = 1e-4
    change = "timestep 1e-9\nfix d all deform 1 x scale {0} y scale {0} z scale {0}\nrun 1\nunfix d\nrun 0"
    decks = [scene(change.format(1 + s * h), data="relaxed") for s in (1, -1)]
    result = lmp_wheel.succeed(one_after_the_other(decks))
    energies, volumes = (np.array([table[c][-1] for table in result.thermo[1::2]]) for c in ("PotEng", "Volume"))
    slope = -(energies[0] - energies[1]) / (volumes[0] - volumes[1])
    assert slope == pytest.approx(pressure, rel=1e-4)


@pytest.mark.parametrize(
    "words",
    ["temp 0.7 0.7 0.5", "tolerance 1e-6", "formulation first values 3 isokinetic total", "iso 1 1 1 ptemp 1", "start zero"],
)
def test_whatever_moves_the_bodies_in_runs(lmp_wheel, words):
    """Keywords of runs do not matter in a minimization between them; poses are stored in the shortest history."""
    result = lmp_wheel.succeed(scene(f"run 2\n{MINIMIZE}\nrun 2", words="molecule " + words))
    minimized, after = result.thermo[1], result.thermo[2]
    assert minimized["Fnorm"][-1] < 1e-8 < 1e-6 * minimized["Fnorm"][0]
    assert after["PotEng"][0] == pytest.approx(minimized["PotEng"][-1], rel=1e-12)
    assert stretch(molecules(lmp_wheel.folder / "end.dump")[0]) < 1e-12


def test_torques_of_atoms(lmp_tree):
    """Torques on dipoles rotate bodies of several atoms, and the line search finds a consistent gradient."""
    deck = dipoles_deck("report yes", moment=0.8)
    deck = re.sub(r"thermo_style custom .*", "thermo_style custom step pe fnorm", deck)
    deck = re.sub(r"^run .*$", "minimize 0.0 1e-9 5000 20000", deck, flags=re.M)
    table = lmp_tree.succeed(deck).thermo[-1]
    assert table["Fnorm"][-1] < 1e-9 < 1e-6 * table["Fnorm"][0]


@pytest.mark.parametrize("style", ["fire", "quickmin", "hftn"])
def test_minimizers_that_cannot(lmp_wheel, style):
    after = f"min_style {style}\n{MINIMIZE}"
    message = f"cannot be used with min_style {style}, which does not let fixes take part; use min_style cg or sd"
    assert len(set(lmp_wheel.refuse(scene(after), message, ranks=2).errors)) == 1


def test_forces_that_are_no_numbers(lmp_wheel):
    lines = (lmp_wheel.folder / "data.trimers").read_text().splitlines()
    at = lines.index("Atoms # molecular") + 2
    place = lines[at].split()[3:6]
    lines[at + 3] = " ".join([*lines[at + 3].split()[:3], *place, *lines[at + 3].split()[6:]])
    (lmp_wheel.folder / "data.twice").write_text("\n".join(lines) + "\n")
    message = "the force or torque on body 2 is not a number"
    assert len(set(lmp_wheel.refuse(scene(data="twice", pair=REPULSIVE), message, ranks=2).errors)) == 1
