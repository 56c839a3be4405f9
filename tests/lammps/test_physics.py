"""Motion of the bodies: exact solutions, energies, temperatures, pressures, units."""

import numpy as np
import pytest
from support.scenes import UNITS, frames, last_frame, placed, two_molecules, water, water_data

BOLTZMANN = 0.0019872067  # kcal/mol/K, LAMMPS' value in real units


# --- exact motions ----------------------------------------------------------------------------


def free(lmp, atoms, velocities, fix, steps, dt, **settings):
    """Positions and velocities of one body at the end, and the thermo table."""
    deck = placed([atoms], velocities, fix=fix, steps=steps, dt=dt, **settings)
    table = lmp.succeed(deck).thermo[0]
    return last_frame(lmp.folder / "poses.dump")[:, 1:], table


def test_a_point_in_a_spring(lmp_tree, fix):
    """A single atom is a body without rotation; its motion is a sine."""
    spring = "fix s all spring/self 4.0"
    x, v = np.array([[0.1, 0.2, 0.0]]), np.array([[1.0, -0.5, 0.2]])
    end, table = free(lmp_tree, x, v, fix, 2000, 0.001, before=spring)
    exact = x + v * np.sin(2.0 * 2.0) / 2.0
    assert np.abs(end[:, :3] - exact).max() < 1e-11
    assert table["f_move[2]"] == [0.0, 0.0]
    energy = 0.5 * ((v * np.cos(2.0 * 2.0)) ** 2).sum()
    assert table["f_move[1]"][-1] == pytest.approx(energy, rel=1e-10)


@pytest.mark.parametrize("sites", [(0.0, 1.0), (-0.7, 0.1, 1.1)])
def test_a_linear_body_turns_about_two_axes(lmp_tree, fix, sites):
    axis, sideways = np.array([2.0, -1.0, 2.0]) / 3, np.array([1.0, 2.0, 0.0]) / np.sqrt(5)
    arms = 0.4 * (np.array(sites) - np.mean(sites))
    drift, spin, t = np.array([0.3, 0.1, 0.0]), 1.7, 2.0
    velocities = drift + np.outer(arms, sideways) * spin
    end, table = free(lmp_tree, np.outer(arms, axis), velocities, fix, 1000, 0.002)
    exact = drift * t + np.outer(arms, np.cos(spin * t) * axis + np.sin(spin * t) * sideways)
    assert np.abs(end[:, :3] - exact).max() < 1e-11
    total = np.add(table["f_move[1]"], table["f_move[2]"])
    assert total == pytest.approx(table["KinEng"], rel=1e-12)


@pytest.mark.parametrize("ranks", [1, 2])
def test_atoms_in_no_body_are_left_alone(lmp_tree, ranks):
    """Atoms outside of the fix group, or in it but in none of the listed groups, do not change in any bit."""
    before = "group left id 1 2 3\ngroup some id 1 2 3 4 5"
    after = """
dump d all custom 50 all.dump id x y z vx vy vz
dump_modify d sort id format float %.17g
run 50
"""
    deck = two_molecules("group 1 left", before, after).replace("fix move all", "fix move some")
    forces = "pair_style lj/cut 9.0\npair_coeff * * 1.0 1.0"
    lmp_tree.succeed(deck.replace("pair_style zero 2.0\npair_coeff * *", forces), ranks=ranks)
    begin, end = frames(lmp_tree.folder / "all.dump").values()
    assert (begin[3:] == end[3:]).all()
    assert (np.abs(begin - end)[:3, 1:] > 1e-3).any(axis=1).all()


# --- energies ---------------------------------------------------------------------------------


def test_the_scalar_takes_the_energy_to_the_dumped_pose(lmp_tree, data, fix):
    """Large shifts (zero start, long steps): correct to 0.1 %, with a remainder of second order."""
    for steps, dt in ((10, 0.4), (20, 0.2), (40, 0.1)):
        deck = water(data, f"{fix} start zero", dt=dt, steps=steps, run="run {steps}\nrun 0")
        # a style whose forces are the derivative of its energies
        deck = deck.replace("lj/charmm/coul/charmm 2.7 3.9", "lj/cut/coul/cut 3.9")
        plain = deck.replace("fix_modify move energy yes", "")
        # of the last step, and with forces and energies of the dumped positions
        (corrected, at_the_pose), (raw, _) = (
            [table["PotEng"][-1] for table in lmp_tree.succeed(text).thermo]
            for text in (deck, plain)
        )
        assert abs(corrected - at_the_pose) < 1e-3 * abs(raw - at_the_pose)


def test_kinetic_energies(lmp_tree, data, fix):
    """The vector, compared with LAMMPS' kinetic energy of the sites, after collisions and migration."""
    columns = "f_move[1] f_move[2] f_move[3]"
    deck = water(data, fix, steps=400, thermo=100, columns=columns)
    table = lmp_tree.succeed(deck, ranks=2).thermo[0]
    total = np.add(table["f_move[1]"], table["f_move[2]"])
    assert total == pytest.approx(table["KinEng"], rel=1e-12)
    assert max(table["f_move[3]"]) == 0.0


def test_unprojected_quaternions_show_their_norm(lmp_tree, data):
    deck = water(data, "gear/quat molecule formulation second project no", dt=0.5, columns="f_move[3]")
    assert 1e-12 < lmp_tree.succeed(deck).thermo[0]["f_move[3]"][-1] < 1e-2


# --- temperature and pressure -----------------------------------------------------------------


def test_degrees_of_freedom(lmp_tree):
    """A point has 3, a dumbbell 5, a triangle 6; only bodies that are wholly in a group count."""
    after = """
group half id 1 2
compute all all temp
compute half half temp
compute_modify half extra/dof 0
compute_modify all extra/dof 0
thermo_style custom step ke c_all c_half
thermo_modify norm no format float %.17g
run 1
"""
    table = lmp_tree.succeed(two_molecules(before="set atom 6 mol 3\n", after=after)).thermo[0]
    assert table["c_all"] == pytest.approx(2 * np.array(table["KinEng"]) / (6 + 5 + 3), rel=1e-12)


def test_temperature_before_the_first_run_is_that_after_it(lmp_tree, data):
    after = "compute t all temp\nrun 0\nvelocity all scale 300.0"
    table = lmp_tree.succeed(water(data, after=after), ranks=2).thermo[-1]
    assert table["Temp"][0] == pytest.approx(300.0, rel=1e-10)
    freedoms = 27 * 6 - 3
    assert 2 * table["KinEng"][0] / (freedoms * BOLTZMANN) == pytest.approx(300.0, rel=1e-6)


def test_pressure_does_not_depend_on_the_time_step(lmp_tree, data, fix):
    def pressure(fix, dt):
        deck = water(data, fix, dt=dt, steps=round(8 / dt), thermo=round(4 / dt))
        return lmp_tree.succeed(deck).thermo[0]["Press"]

    coarse, middle, fine = (pressure(fix, dt) for dt in (0.2, 0.1, 0.05))
    assert coarse == pytest.approx(fine, rel=1e-6)
    assert middle == pytest.approx(fine, rel=1e-7)
    # fix rigid agrees within its error; its row 0 lacks part of the constraint forces
    rigid = pressure("rigid/nve/small molecule", 0.01)
    assert rigid[1:] == pytest.approx(fine[1:], rel=1e-3)


def test_without_its_virial_the_pressure_is_another(lmp_tree, data):
    whole, part = (
        lmp_tree.succeed(water(data, steps=10, after=after)).thermo[0]["Press"][-1]
        for after in ("", "fix_modify move virial no")
    )
    assert abs(whole - part) > 0.01 * abs(whole)


# --- units ------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", UNITS)
def test_all_units(lmp_tree, units):
    """The same motion as with fix rigid, within its error, in every system of units."""
    data = water_data(lmp_tree.folder / "data.water", units=units)
    settings = dict(units=units, dt=0.05, steps=200)
    ours = water(data, dump="ours", after="thermo_modify lost error", **settings)
    energy = lmp_tree.succeed(ours).thermo[0]
    lmp_tree.succeed(water(data, "rigid/nve/small molecule", dump="rigid", **settings))
    ours, rigid = (last_frame(lmp_tree.folder / name)[:, 4:] for name in ("ours", "rigid"))
    start = np.loadtxt(data.read_text().partition("Velocities")[2].splitlines()[2:])[:, 1:]
    moved = np.abs(ours - start).max()  # forces have acted
    assert np.abs(ours - rigid).max() < 3e-4 * moved
    # and energy is conserved: the scalar and the kinetic energies are in the units of energy
    drift = energy["TotEng"][-1] - energy["TotEng"][0]
    assert abs(drift) < 0.2 * np.ptp(energy["KinEng"])


# --- bodies from a file -----------------------------------------------------------------------

SITES = np.array([[0.0, 0, 0], [1.0, 0, 0], [0, 1.2, 0.1]])  # of mass 1
OMEGA = np.array([0.4, -0.3, 0.8])
BOX = 20.0


def body_file(path, x, v, image=(0, 0, 0)):
    """A line of keyword infile for one body with these sites."""
    center, velocity = x.mean(axis=0), v.mean(axis=0)
    arms = x - center
    inertia = np.eye(3) * (arms**2).sum() - arms.T @ arms
    momentum = np.cross(arms, v).sum(axis=0)
    words = [1, len(x), *(center - BOX * np.array(image)), *np.diag(inertia)]
    words += [*inertia[[0, 0, 1], [1, 2, 2]], *velocity, *momentum, *image]
    path.write_text("# a body\n\n1\n" + " ".join(f"{word:.17g}" for word in words) + "\n")


def infile_run(lmp, fix, dt=0.01):
    """Positions and velocities of the first of two molecules at time 1."""
    given = np.cross(OMEGA, SITES) + [0.1, 0.2, 0.3]
    box = dict(box="-10 10 -10 10 -10 10", boundary="p p p")
    lmp.succeed(placed([SITES, SITES + 5.0], given, fix=fix, dt=dt, steps=round(1 / dt), **box))
    return last_frame(lmp.folder / "poses.dump")[:3, 1:]


@pytest.mark.parametrize("image", [(0, 0, 0), (1, -2, 3)])
def test_a_true_infile_changes_nothing(lmp_tree, fix, image):
    """With its actual properties in the file the body moves as without it; the other molecule is not in the file."""
    body_file(lmp_tree.folder / "true", SITES, np.cross(OMEGA, SITES) + [0.1, 0.2, 0.3], image)
    plain, stated = (infile_run(lmp_tree, fix + more) for more in ("", " infile true"))
    assert np.abs(plain - stated).max() < 1e-12


def test_an_infile_serves_fix_rigid_too(lmp_tree, fix):
    """With an inertia that differs from the inertia of the sites, the motion agrees with fix rigid with the same
    file."""
    tilted = SITES @ np.array([[1.0, 0.2, 0], [0, 1, 0.3], [0.1, 0, 1]])
    body_file(lmp_tree.folder / "other", tilted, np.cross(OMEGA, tilted))
    plain, stated = (infile_run(lmp_tree, fix + more) for more in ("", " infile other"))
    rigid = infile_run(lmp_tree, "rigid/nve/small molecule infile other", dt=0.001)
    assert np.abs(stated - rigid).max() < 1e-5
    assert np.abs(stated - plain).max() > 1e-2


# --- r-RESPA ----------------------------------------------------------------------------------


#: levels, words of the fix, ranks
LEVELS = [
    ("1", "formulation second", 1),
    ("2 1 bond 1 pair 2", "", 2),
    ("3 1 1 bond 1 angle 2 pair 3", "formulation first", 1),
    ("2 1 pair 1 kspace 2", "formulation first isokinetic total", 1),
    ("2 1 pair 2", "temp 300 300 50", 1),
    ("2 1 pair 2", "force 1*9 off on off torque 5* off off on", 1),
]


@pytest.mark.parametrize("levels, words, ranks", LEVELS)
def test_respa_with_equal_steps(lmp_tree, data, levels, words, ranks):
    ends = []
    for style in ("verlet", f"respa {levels}"):
        deck = water(data, f"gear/quat molecule {words}", after=f"run_style {style}")
        lmp_tree.succeed(deck.replace("fix_modify move energy yes", "") if "temp" in words else deck, ranks=ranks)
        ends.append(last_frame(lmp_tree.folder / "poses.dump"))
    assert np.abs(ends[0] - ends[1]).max() < 1e-12
