"""What the bodies do: exact motions, energies, temperatures, pressures, units."""

import numpy as np
import pytest
from scenes import UNITS, last_frame, two_molecules, water, water_data

FORMULATIONS = ["first", "second"]
BOLTZMANN = 0.0019872067  # kcal/mol/K, LAMMPS' value in real units


def run(lmp, deck, ranks=1):
    result = lmp.run(deck, ranks=ranks)
    assert result.returncode == 0, result.output
    return result


# --- exact motions ----------------------------------------------------------------------------

FREE = """
units lj
atom_style molecular
atom_modify map array sort 0 0.0
dimension {dimension}
boundary f f p
region box block -50 50 -50 50 -0.5 0.5
create_box 1 box
{atoms}
mass 1 1.0
set group all mol 1
pair_style zero 2.0
pair_coeff * *
{before}
fix move all gear/quat molecule formulation {formulation}
timestep {dt}
thermo_style custom step ke pe f_move[1] f_move[2]
thermo_modify norm no format float %.17g
dump poses all custom {steps} free.dump id xu yu zu vx vy vz
dump_modify poses sort id format float %.17g
thermo {steps}
run {steps}
"""


def free(lmp, atoms, velocities, formulation, steps, dt, before="", dimension=3):
    text = "\n".join(f"create_atoms 1 single {x} {y} {z}" for x, y, z in atoms)
    text += "".join(
        f"\nset atom {i} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g}"
        for i, v in enumerate(velocities, 1)
    )
    deck = FREE.format(
        atoms=text, formulation=formulation, steps=steps, dt=dt, before=before, dimension=dimension
    )
    result = run(lmp, deck)
    return last_frame(lmp.folder / "free.dump")[:, 1:], result


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_point_in_a_spring(lmp_tree, formulation):
    """One atom alone is a body without rotation; its motion is a sine."""
    spring = "fix s all spring/self 4.0"
    atoms, velocities = [(0.1, 0.2, 0.0)], [(1.0, -0.5, 0.2)]
    end, result = free(lmp_tree, atoms, velocities, formulation, 2000, 0.001, spring)
    exact = np.array(atoms[0]) + np.array(velocities[0]) * np.sin(2.0 * 2.0) / 2.0
    assert np.abs(end[0, :3] - exact).max() < 1e-11
    assert np.abs(end[0, :3] - exact * 1.01).max() > 1e-4
    assert result.thermo[0]["f_move[2]"] == [0.0, 0.0]
    speed = np.array(velocities[0]) * np.cos(2.0 * 2.0)
    assert result.thermo[0]["f_move[1]"][-1] == pytest.approx(0.5 * speed @ speed, rel=1e-10)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("sites", [(0.0, 1.0), (-0.7, 0.1, 1.1)])
def test_a_linear_body_turns_about_two_axes(lmp_tree, formulation, sites):
    axis, sideways = np.array([2.0, -1.0, 2.0]) / 3, np.array([1.0, 2.0, 0.0]) / np.sqrt(5)
    arms = np.outer(np.array(sites) - np.mean(sites), axis)
    spin = 1.7
    drift = np.array([0.3, 0.1, 0.0])
    velocities = drift + np.outer(arms @ axis, sideways) * spin
    end, result = free(
        lmp_tree, 0.4 * arms, 0.4 * (velocities - drift) + drift, formulation, 1000, 0.002
    )
    t = 2.0
    exact = drift * t + 0.4 * np.outer(
        arms @ axis, np.cos(spin * t) * axis + np.sin(spin * t) * sideways
    )
    assert np.abs(end[:, :3] - exact).max() < 1e-11
    assert np.abs(end[:, :3] - exact * 1.01).max() > 1e-4
    energy = result.thermo[0]
    assert np.add(energy["f_move[1]"], energy["f_move[2]"]) == pytest.approx(
        energy["KinEng"], rel=1e-12
    )


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_two_dimensions_stay_two_dimensions(lmp_tree, formulation):
    atoms = [(0, 0, 0), (1, 0.2, 0), (0.3, 1.1, 0), (-0.4, 0.6, 0)]
    velocities = [(0.1, 0, 0), (0, 0.4, 0), (-0.7, 0, 0), (0, -0.3, 0)]
    flat = "fix flat all enforce2d\nfix s all spring/self 0.7"
    end, result = free(lmp_tree, atoms, velocities, formulation, 500, 0.01, flat, dimension=2)
    assert (end[:, [2, 5]] == 0.0).all()
    assert np.abs(end[:, :2] - np.array(atoms)[:, :2]).max() > 0.1


def test_atoms_in_no_body_are_left_alone(lmp):
    """Outside the fix group, and inside it but in none of the listed groups: not a bit changes."""
    before = "group left id 1 2 3\ngroup some id 1 2 3 4 5"
    after = """
dump d all custom 50 all.dump id x y z vx vy vz
dump_modify d sort id format float %.17g
run 50
"""
    deck = two_molecules("group 1 left", before, after).replace("fix move all", "fix move some")
    for ranks in (1, 2):
        run(
            lmp,
            deck.replace(
                "pair_style zero 2.0\npair_coeff * *",
                "pair_style lj/cut 9.0\npair_coeff * * 1.0 1.0",
            ),
            ranks,
        )
        text = (lmp.folder / "all.dump").read_text()
        frames = [np.loadtxt(frame.splitlines()[1:7]) for frame in text.split("ITEM: ATOMS")[1:]]
        begin, end = (
            frame.splitlines()
            for frame in text.replace("ITEM: TIMESTEP", "").split("ITEM: ATOMS")[1:3]
        )
        assert begin[4:7] == end[4:7]  # the same digits
        assert (np.abs(frames[0] - frames[1])[:3, 1:] > 1e-3).any(axis=1).all()


# --- energies ---------------------------------------------------------------------------------


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_the_scalar_takes_the_energy_to_the_dumped_pose(lmp_tree, formulation, ranks):
    """Large shifts (zero start, long steps): right to 0.1 %, what is left is of second order."""
    data = water_data(lmp_tree.folder / "data.water")
    fix = f"gear/quat molecule formulation {formulation} start zero"
    for steps, dt in ((10, 0.4), (20, 0.2), (40, 0.1)):
        deck = water(data, fix, dt=dt, steps=steps, run="run {steps}\nrun 0")
        # a style whose forces are the derivative of its energies
        deck = deck.replace("lj/charmm/coul/charmm 2.7 3.9", "lj/cut/coul/cut 3.9")
        thermo = run(lmp_tree, deck, ranks).thermo
        plain = run(lmp_tree, deck.replace("fix_modify move energy yes", ""), ranks).thermo
        at_the_pose = thermo[1]["PotEng"][0]  # forces and energies of the dumped positions
        correction = plain[0]["PotEng"][-1] - at_the_pose
        assert abs(thermo[0]["PotEng"][-1] - at_the_pose) < 1e-3 * abs(correction)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_kinetic_energies(lmp_tree, formulation):
    """The vector against LAMMPS' kinetic energy of the sites, after collisions and migration."""
    data = water_data(lmp_tree.folder / "data.water")
    deck = water(
        data, f"gear/quat molecule formulation {formulation}", steps=400, thermo=100
    ).replace("ke etotal", "ke etotal f_move[1] f_move[2] f_move[3]")
    table = run(lmp_tree, deck, ranks=2).thermo[0]
    total = np.add(table["f_move[1]"], table["f_move[2]"])
    assert total == pytest.approx(table["KinEng"], rel=1e-12)
    assert total != pytest.approx(np.multiply(1.01, table["KinEng"]), rel=1e-12)
    assert set(table["f_move[3]"]) == {0.0}


def test_unprojected_quaternions_show_their_norm(lmp_tree):
    data = water_data(lmp_tree.folder / "data.water")
    deck = water(data, "gear/quat molecule project no", dt=0.5, steps=100).replace(
        "ke etotal", "ke f_move[3]"
    )
    assert 1e-12 < run(lmp_tree, deck).thermo[0]["f_move[3]"][-1] < 1e-2


# --- temperature and pressure -----------------------------------------------------------------


def test_degrees_of_freedom(lmp_tree):
    """A point has 3, a dumbbell 5, a triangle 6; only bodies that are wholly in a group count."""
    before = "set atom 6 mol 3\n"
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
    result = run(lmp_tree, two_molecules(before=before, after=after))
    table = result.thermo[0]
    assert table["c_all"] == pytest.approx(2 * np.array(table["KinEng"]) / (6 + 5 + 3), rel=1e-12)
    assert "fix move" not in " ".join(result.errors)


def test_temperature_before_the_first_run_is_that_after_it(lmp_tree):
    data = water_data(lmp_tree.folder / "data.water")
    after = "compute t all temp\nrun 0\nvelocity all scale 300.0"
    table = run(lmp_tree, water(data, after=after), ranks=2).thermo[-1]
    assert table["Temp"][0] == pytest.approx(300.0, rel=1e-10)
    freedoms = 27 * 6 - 3
    assert 2 * table["KinEng"][0] / (freedoms * BOLTZMANN) == pytest.approx(300.0, rel=1e-6)


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_pressure_does_not_depend_on_the_time_step(lmp_tree, formulation):
    data = water_data(lmp_tree.folder / "data.water")
    fix = f"gear/quat molecule formulation {formulation}"
    pressure = {
        dt: run(
            lmp_tree, water(data, fix, dt=dt, steps=round(8 / dt), thermo=round(4 / dt))
        ).thermo[0]["Press"]
        for dt in (0.2, 0.1, 0.05)
    }
    assert pressure[0.2] == pytest.approx(pressure[0.05], rel=1e-6)
    assert pressure[0.1] == pytest.approx(pressure[0.05], rel=1e-7)

    # fix rigid's agrees but for its own error; its row 0 lacks part of the constraint forces
    rigid = run(
        lmp_tree, water(data, "rigid/nve/small molecule", dt=0.01, steps=800, thermo=400)
    ).thermo[0]["Press"]
    assert rigid[1:] == pytest.approx(pressure[0.05][1:], rel=1e-3)


@pytest.mark.parametrize("ranks", [1, 2])
def test_per_atom_stress_adds_up_to_the_pressure(lmp_tree, ranks):
    data = water_data(lmp_tree.folder / "data.water")
    after = """
compute stress all stress/atom NULL
compute sum all reduce sum c_stress[1] c_stress[2] c_stress[3] c_stress[4] c_stress[5] c_stress[6]
variable p equal -(c_sum[1]+c_sum[2]+c_sum[3])/(3*vol)
variable pxy equal -c_sum[4]/vol
"""
    deck = water(data, after=after, steps=50, thermo=10).replace("press", "press pxy v_p v_pxy")
    table = run(lmp_tree, deck, ranks).thermo[0]
    assert table["v_p"] == pytest.approx(table["Press"], rel=1e-10)
    assert table["v_pxy"] == pytest.approx(table["Pxy"], rel=1e-10)


def test_without_its_virial_the_pressure_is_another(lmp_tree):
    data = water_data(lmp_tree.folder / "data.water")
    with_it = run(lmp_tree, water(data, steps=10)).thermo[0]["Press"][-1]
    without = run(lmp_tree, water(data, steps=10, after="fix_modify move virial no")).thermo[0][
        "Press"
    ][-1]
    assert abs(with_it - without) > 0.01 * abs(with_it)


# --- units ------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", UNITS)
def test_all_units(lmp_tree, units):
    """The same motion as fix rigid's to its own error, in every system of units."""
    data = water_data(lmp_tree.folder / "data.water", units=units)
    after = "" if units == "real" else "thermo_modify lost error"
    mine = run(lmp_tree, water(data, units=units, dt=0.05, steps=200, dump="mine", after=after))
    run(
        lmp_tree,
        water(data, "rigid/nve/small molecule", units=units, dt=0.05, steps=200, dump="rigid"),
    )
    one, other = (last_frame(lmp_tree.folder / name)[:, 1:] for name in ("mine", "rigid"))
    start = np.loadtxt(data.read_text().partition("Velocities")[2].splitlines()[2:])[:, 1:]
    moved = np.abs(one[:, 3:] - start).max()  # forces have acted
    assert np.abs(one[:, 3:] - other[:, 3:]).max() < 3e-4 * moved
    assert np.abs(1.01 * one[:, 3:] - other[:, 3:]).max() > 3e-4 * moved

    # and energy is kept: the scalar and the kinetic energies are in the units of energy
    energy = mine.thermo[0]["TotEng"]
    assert abs(energy[-1] - energy[0]) < 0.2 * np.ptp(mine.thermo[0]["KinEng"])


# --- bodies from a file -----------------------------------------------------------------------


def space_inertia(x, mass):
    arms = x - mass @ x / mass.sum()
    return np.einsum(
        "i,ijk->jk",
        mass,
        np.eye(3) * (arms**2).sum(1)[:, None, None] - np.einsum("ij,ik->ijk", arms, arms),
    )


def body_file(path, x, v, mass, scale=1.0, image=(0, 0, 0), box=20.0):
    centre, velocity = mass @ x / mass.sum(), mass @ v / mass.sum()
    tensor = space_inertia(x, mass) * scale
    spin = (mass[:, None] * np.cross(x - centre, v)).sum(0) * scale
    words = [
        "1",
        mass.sum(),
        *(centre - box * np.array(image)),
        *np.diag(tensor),
        tensor[0, 1],
        tensor[0, 2],
        tensor[1, 2],
    ]
    words += [*velocity, *spin, *image]
    path.write_text(
        "# a body\n\n1\n" + " ".join(w if isinstance(w, str) else f"{w:.17g}" for w in words) + "\n"
    )


INFILE_ATOMS = np.array([[0.0, 0, 0], [1.0, 0, 0], [0, 1.2, 0.1]])
INFILE_VELOCITIES = np.cross([0.4, -0.3, 0.8], INFILE_ATOMS) + [0.1, 0.2, 0.3]


def infile_run(lmp, fix, dump, dt=0.01, steps=100):
    given = "\n".join(
        f"set atom {i} vx {v[0]:.17g} vy {v[1]:.17g} vz {v[2]:.17g}"
        for i, v in enumerate(INFILE_VELOCITIES, 1)
    )
    after = f"""
dump d all custom {steps} {dump} id xu yu zu vx vy vz
dump_modify d sort id format float %.17g
timestep {dt}
run {steps}
"""
    deck = two_molecules("x", before=given, after=after).replace("gear/quat x", fix)
    run(lmp, deck)
    return last_frame(lmp.folder / dump)[:3, 1:]


@pytest.mark.parametrize("image", [(0, 0, 0), (1, -2, 3)])
@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_a_true_infile_changes_nothing(lmp_tree, formulation, image):
    """Stated as it is, the body moves as without a file; the other molecule is not in the file."""
    body_file(lmp_tree.folder / "true", INFILE_ATOMS, INFILE_VELOCITIES, np.ones(3), image=image)
    fix = f"gear/quat molecule formulation {formulation}"
    plain = infile_run(lmp_tree, fix, "plain")
    stated = infile_run(lmp_tree, fix + " infile true", "stated")
    assert np.abs(plain - stated).max() < 1e-12


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_an_infile_serves_fix_rigid_too(lmp_tree, formulation):
    """Another inertia than that of the sites: the same motion as fix rigid's with the same file."""
    tilted = INFILE_ATOMS @ np.array([[1.0, 0.2, 0], [0, 1, 0.3], [0.1, 0, 1]])
    body_file(lmp_tree.folder / "other", tilted, np.cross([0.4, -0.3, 0.8], tilted), np.ones(3))
    text = (lmp_tree.folder / "other").read_text()
    mine = infile_run(
        lmp_tree, f"gear/quat molecule formulation {formulation} infile other", "mine"
    )
    rigid = infile_run(
        lmp_tree, "rigid/nve/small molecule infile other", "rigid", dt=0.001, steps=1000
    )
    plain = infile_run(lmp_tree, f"gear/quat molecule formulation {formulation}", "plain")
    assert np.abs(mine - rigid).max() < 1e-5, text
    assert np.abs(mine - plain).max() > 1e-2


# --- r-RESPA ----------------------------------------------------------------------------------


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("levels", ["1", "2 1 bond 1 pair 2", "3 1 1 bond 1 angle 2 pair 3"])
def test_respa_with_equal_steps(lmp_tree, formulation, levels, ranks):
    data = water_data(lmp_tree.folder / "data.water")
    fix = f"gear/quat molecule formulation {formulation}"
    run(lmp_tree, water(data, fix, dump="verlet"), ranks)
    run(lmp_tree, water(data, fix, dump="respa", after=f"run_style respa {levels}"), ranks)
    difference = last_frame(lmp_tree.folder / "verlet") - last_frame(lmp_tree.folder / "respa")
    assert np.abs(difference).max() < 1e-12
