"""Bodies that are removed or inserted while the fix exists, and what velocity does to bodies."""

import re

import numpy as np
import pytest
from scenes import last_frame, two_molecules, water, water_data

N = 27  # molecules of the water box
BOLTZMANN = 0.0019872067  # kcal/mol/K
OXYGEN = 5 * 3 - 2  # of molecule 5

SPCE = """rigid water

3 atoms

Coords

1 0 0 0
2 0.81649658092772603 0.57735026918962576 0
3 -0.81649658092772603 0.57735026918962576 0

Types

1 1
2 2
3 2

Charges

1 -0.8476
2 0.4238
3 0.4238
"""

SHOW = """
compute_modify thermo_temp dynamic/dof yes
variable atoms equal count(all)
thermo_style custom step temp v_atoms f_move[1] f_move[2] {rows}
thermo_modify norm no lost error format float %.17g
thermo {every}
dump bodies all local {every} bodies.dump f_move[28] f_move[1] f_move[2] f_move[3]
dump_modify bodies format float %.17g
"""


def show(every=1, rows=()):
    return SHOW.format(every=every, rows=" ".join(f"f_move[{row}][28]" for row in rows))


def run_water(lmp, commands, ranks=1, fix="gear/quat molecule", before="", dt=1.0):
    """27 molecules in a box of 13.5 Angstrom, a femtosecond a step."""
    (lmp.folder / "molecule.spce").write_text(SPCE)
    data = water_data(lmp.folder / "data.water", spacing=4.5)
    deck = water(data, fix, dt=dt, steps=20, before=before, run=commands)
    return lmp.run(deck, ranks=ranks)


def bodies(lmp):
    """Frames of the local dump: arrays (bodies, 4), sorted by ID."""
    frames = []
    for text in (lmp.folder / "bodies.dump").read_text().split("ITEM: ENTRIES")[1:]:
        lines = text.partition("ITEM:")[0].splitlines()[1:]
        table = np.array([[float(word) for word in line.split()] for line in lines])
        frames.append(table[table[:, 0].argsort()])
    return frames


def temperature(thermo, row, molecules, freedoms=6):
    """What the kinetic energies of the fix and the freedoms of that many molecules make of it."""
    kinetic = thermo["f_move[1]"][row] + thermo["f_move[2]"][row]
    return 2 * kinetic / ((freedoms * molecules - 3) * BOLTZMANN)


def expect_temperature(thermo, row, molecules):
    assert thermo["v_atoms"][row] == 3 * molecules
    assert thermo["Temp"][row] == pytest.approx(temperature(thermo, row, molecules), rel=1e-6)
    assert thermo["Temp"][row] != pytest.approx(temperature(thermo, row, molecules + 1), rel=1e-3)


def close(a, b, tolerance):
    assert a.shape == b.shape
    assert np.abs(a - b).max() < tolerance
    assert np.abs(1.01 * a - b).max() > 100 * tolerance


# --- removed -------------------------------------------------------------------------------------
EVAPORATE = """
group some {members}
region everywhere block INF INF INF INF INF INF
fix out some evaporate 5 1 everywhere 4711 molecule {molecule}
"""


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_a_molecule_evaporates(lmp_tree, ranks):
    """As if it had been deleted between two runs, on any number of ranks, but for the histories: within a
    run they go on across the jump of the forces, which leaves an error of a velocity that grows with the step."""
    evaporate = EVAPORATE.format(members="molecule 5 17", molecule="yes")
    evaporate += show(rows=[5, 26]) + "run {steps}"
    result = run_water(lmp_tree, evaporate, ranks, dt=0.001)
    assert result.returncode == 0, result.output
    thermo = result.thermo[-1]
    present = [N] * 5 + [N - 1] * 5 + [N - 2] * 11
    for row, molecules in enumerate(present):
        expect_temperature(thermo, row, molecules)
    assert [len(frame) for frame in bodies(lmp_tree)] == present
    gone = sorted({5, 17} - set(bodies(lmp_tree)[5][:, 0]))
    assert len(gone) == 1
    # the array is sorted by ID and ends earlier now
    first = 5 if gone == [17] else 6
    assert thermo["f_move[5][28]"] == [5] * 5 + [first] * 5 + [6] * 11
    assert thermo["f_move[26][28]"] == [26] * 5 + [27] * 5 + [0] * 11
    dumped = last_frame(lmp_tree.folder / "poses.dump")

    between = f"""
run 4
group first molecule {gone[0]}
delete_atoms group first compress no
run 5
group second molecule 5 17
delete_atoms group second compress no
run 11
"""
    result = run_water(lmp_tree, between, dt=0.001)
    assert result.returncode == 0, result.output
    close(dumped, last_frame(lmp_tree.folder / "poses.dump"), 1e-6)


@pytest.mark.parametrize("ranks", [1, 2])
def test_rows_of_bodies_that_are_gone_read_as_zeros(lmp_tree, ranks):
    """In thermo, in variables, in averages and in sums over a column."""
    evaporate = EVAPORATE.format(members="molecule 5 17", molecule="yes")
    commands = """
variable id equal f_move[27][28]
variable ids equal sum(f_move[28])
fix mean all ave/time 1 1 20 f_move[28] mode vector file mean
thermo_style custom step f_move[27][28] v_id v_ids
thermo 1
run {steps}
variable second equal f_move[27][28]
thermo_style custom step v_second
run 0
"""
    result = run_water(lmp_tree, evaporate + commands, ranks)
    assert result.returncode == 0, result.output
    thermo = result.thermo[0]
    assert thermo["f_move[27][28]"] == thermo["v_id"] == [27] * 5 + [0] * 16
    everyone = N * (N + 1) // 2
    assert thermo["v_ids"][4] == everyone and thermo["v_ids"][-1] == everyone - 5 - 17
    assert result.thermo[1]["v_second"] == [0]
    assert (lmp_tree.folder / "mean").read_text().split()[-4:] == ["26", "0", "27", "0"]


@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("atom", [OXYGEN, OXYGEN + 1, OXYGEN + 2])
def test_a_broken_body_is_noticed_in_a_run(lmp_tree, ranks, atom):
    commands = EVAPORATE.format(members=f"id {atom}", molecule="no") + "thermo 1\nrun {steps}"
    result = run_water(lmp_tree, commands, ranks)
    assert result.returncode != 0
    assert any("body 5 has 2 of its" in e and "removed as a whole" in e for e in result.errors)
    assert result.thermo[-1]["Step"][-1] == 4


def test_two_bodies_broken_at_once(lmp_tree):
    """One lost its owner, another one an atom: what is left adds up, and is noticed all the same."""
    for members in (f"id {OXYGEN} {OXYGEN + 4}", f"id {OXYGEN + 1} {OXYGEN + 3}"):
        commands = EVAPORATE.format(members=members, molecule="no").replace(
            "5 1 every", "5 2 every"
        )
        result = run_water(lmp_tree, commands + "run {steps}", 2)
        assert any("2 of its" in error for error in result.errors)


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_molecules_deleted_between_runs(lmp, ranks):
    commands = (
        show(20, rows=[24])
        + "run {steps}\ngroup gone molecule 1 9 27\ndelete_atoms group gone compress no\nrun {steps}"
    )
    result = run_water(lmp, commands, ranks)
    assert result.returncode == 0, result.output
    expect_temperature(result.thermo[0], -1, N)
    for row in (0, 1):
        expect_temperature(result.thermo[1], row, N - 3)
        assert result.thermo[1]["f_move[24][28]"][row] == 26
    # nothing was done to the others: those that stayed go on with their histories
    assert "atoms were changed" not in result.stdout
    assert len(bodies(lmp)[-1]) == N - 3


# Dumbbells of an atomic system; body 3 goes.
DUMBBELLS = """
units lj
atom_style atomic
atom_modify map array
lattice sc 0.125
region box block 0 4 0 4 0 4
create_box 1 box
create_atoms 1 box
fix ids all property/atom i_body
variable body atom ceil(id/2)
set group all i_body v_body
mass 1 1.0
velocity all create 3.0 4711 loop geom
pair_style lj/cut 2.5
pair_coeff * * 1.0 1.0
timestep 0.002
fix move all gear/quat custom i_body
variable three atom i_body==3
group three variable three
thermo_style custom step {columns}
thermo_modify format float %.17g lost error
compute_modify thermo_temp dynamic/dof yes
run 100
{change}
run 100
"""


@pytest.mark.parametrize("ranks", [1, 2, 4])
def test_bodies_go_on_when_atoms_get_other_ids(lmp_tree, ranks):
    """delete_atoms as it is by default gives new IDs in an atomic system, reset_atoms in all systems."""
    columns = " ".join(f"f_move[{row}][{k}]" for row in (1, 2, 3, 4) for k in (1, 2, 3, 16, 28))
    changes = [
        "delete_atoms group three compress no",
        "delete_atoms group three",
        "delete_atoms group three compress no\nreset_atoms id",
        "delete_atoms group three\nwrite_restart renumbered",
    ]
    ends = []
    for change in changes:
        deck = DUMBBELLS.format(columns=columns, change=change)
        result = lmp_tree.run(deck, ranks=ranks)
        assert result.returncode == 0, result.output
        assert "bodies start" not in result.output
        ends.append([result.thermo[-1][column][-1] for column in columns.split()])
    for end in ends[1:]:
        assert end == pytest.approx(ends[0], rel=1e-12)
        assert ends[0][4::5] == [1, 2, 4, 5]


def test_all_bodies_may_go(lmp_tree):
    after = "run 2\ndelete_atoms group all compress no\nrun 2"
    assert lmp_tree.run(two_molecules(after=after), ranks=2).returncode == 0


# --- inserted ------------------------------------------------------------------------------------
INSERT = """
region within block 0 13 0 13 0 13
fix in all deposit {count} 0 5 4711 region within near 2.0 attempt 2000 mol spce rigid move &
  vx -0.01 0.01 vy -0.01 0.01 vz -0.01 0.01
"""
TEMPLATE = "molecule spce molecule.spce"
MOL = "gear/quat molecule mol spce"


@pytest.mark.parametrize("ranks", [1, 2, 4])
@pytest.mark.parametrize("formulation", ["first", "second"])
def test_molecules_are_inserted(lmp, ranks, formulation):
    """With their own bodies, and the same trajectory on any number of ranks."""
    fix = f"{MOL} formulation {formulation}"
    commands = INSERT.format(count=3) + show(rows=[28, 30]) + "run {steps}"
    # rows 28 to 30 are not there yet when thermo_style is read
    commands = commands.replace(" f_move[28][28] f_move[30][28]", "")
    commands += "\nthermo_style custom step f_move[28][28] f_move[30][28] f_move[30][1]\nrun 0"
    ends = []
    for number in {1, ranks}:
        result = run_water(lmp, commands, number, fix, TEMPLATE)
        assert result.returncode == 0, result.output
        thermo = result.thermo[0]
        present = [N + min((step + 4) // 5, 3) for step in range(21)]
        for row, molecules in enumerate(present):
            expect_temperature(thermo, row, molecules)
        frames = bodies(lmp)
        assert [len(frame) for frame in frames[:21]] == present
        assert frames[20][:, 0] == pytest.approx(range(1, N + 4))
        after = result.thermo[1]
        assert [after[f"f_move[{row}][28]"][-1] for row in (28, 30)] == [28, 30]
        assert "created after the fix" not in result.output
        ends.append(last_frame(lmp.folder / "poses.dump"))
    close(ends[0], ends[-1], 1e-9)


FIELD = """
units lj
atom_style full
atom_modify map array
region box block -20 20 -20 20 -20 20
create_box 2 box
mass 1 4.0
mass 2 1.0
molecule spce molecule.spce
pair_style zero 2.0
pair_coeff * *
neigh_modify every 1 delay 0 check yes
{atoms}
fix move all gear/quat molecule mol spce {words}
variable fx atom -0.5*x
variable fy atom -1.5*y-0.2*z
variable fz atom -0.8*z-0.2*y
fix field all addforce v_fx v_fy v_fz
timestep {dt}
{commands}
dump poses all custom 1 poses.dump id xu yu zu vx vy vz
dump_modify poses sort id time yes format float %.17g
run {steps}
"""


def insertion_error(lmp, dt, words, steps=None):
    """Of a molecule that is inserted and then moves in a field for about two units of time.

    The exact motion is that of a body which has it from the start, with steps of 0.01.
    """
    (lmp.folder / "molecule.spce").write_text(SPCE)
    steps = steps or round(2.0 / dt)
    insert = (
        "region here block 1 2 1 2 1 2\n"
        "fix in all deposit 1 0 1 4711 region here near 0.5 mol spce rigid move "
        "vx 0.3 0.3 vy -0.2 -0.2 vz 0.4 0.4"
    )
    deck = FIELD.format(atoms="", words=words, dt=dt, commands=insert, steps=steps + 1)
    result = lmp.run(deck)
    assert result.returncode == 0, result.output
    frames = (lmp.folder / "poses.dump").read_text().split("ITEM: TIME\n")[1:]
    begin, finish = (float(frames[k].split(None, 1)[0]) for k in (1, -1))
    start, end = (
        np.loadtxt(frame.split("ITEM: ATOMS")[1].splitlines()[1:4])
        for frame in (frames[1], frames[-1])
    )
    assert len(start) == 3
    atoms = [
        f"create_atoms {1 + (i > 0)} single {x:.17g} {y:.17g} {z:.17g}"
        for i, (x, y, z) in enumerate(start[:, 1:4])
    ]
    atoms.append("set atom 1*3 mol 1\nvelocity all set 0.3 -0.2 0.4")
    step = (finish - begin) / 200
    deck = FIELD.format(atoms="\n".join(atoms), words="", dt=step, commands="", steps=200)
    result = lmp.run(deck)
    assert result.returncode == 0, result.output
    return np.abs(end - last_frame(lmp.folder / "poses.dump"))[:, 1:].max()


@pytest.mark.parametrize("formulation", ["first", "second"])
@pytest.mark.parametrize("start, order", [("bootstrap", 2), ("zero", 1)])
def test_order_of_the_start_of_an_inserted_body(lmp_tree, formulation, start, order):
    """Forces at the insertion are known, nothing more; the first body of a fix may be inserted."""
    words = f"formulation {formulation} start {start}"
    errors = [insertion_error(lmp_tree, dt, words) for dt in (0.04, 0.02, 0.01)]
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert slopes == pytest.approx([order, order], abs=0.35)


@pytest.mark.parametrize("formulation", ["first", "second"])
def test_with_a_step_that_follows_the_error(lmp_tree, formulation):
    """But for the first step of the inserted body, which is as long as it was before."""

    def error(dt, eps):
        return insertion_error(lmp_tree, dt, f"formulation {formulation} tolerance {eps}", 300)

    fine = error(0.001, 1e-10)
    assert fine < 1e-6 and error(0.001, 1e-5) > 100 * fine and error(0.04, 1e-10) > 100 * fine


def test_a_restart_with_an_inserted_body(lmp_tree):
    insert = INSERT.format(count=1)
    whole = run_water(lmp_tree, insert + "run 10\nwrite_restart half\nrun 10", 2, MOL, TEMPLATE)
    assert whole.returncode == 0, whole.output
    dumped = last_frame(lmp_tree.folder / "poses.dump")
    deck = water("half", MOL, dt=1.0, steps=10, before=TEMPLATE)
    for word in ("atom_style", "pair_style", "pair_coeff"):
        deck = deck.replace(word, "#")
    result = lmp_tree.run(deck.replace("read_data", "read_restart"), ranks=2)
    assert result.returncode == 0, result.output
    close(dumped, last_frame(lmp_tree.folder / "poses.dump"), 1e-12)


@pytest.mark.parametrize("created", ["create_atoms", "deposit"])
def test_other_new_atoms_are_reported_once(lmp_tree, created):
    commands = {
        "create_atoms": "create_atoms 1 single 2 2 2\ncreate_atoms 1 single 2 2 7",
        "deposit": "region within block 0 13 0 13 0 13\n"
        "fix in all deposit 2 1 1 4711 region within near 2.0 attempt 2000",
    }[created]
    result = run_water(lmp_tree, f"run 5\n{commands}\nthermo 1\nrun 5\nrun 5", 2)
    assert result.returncode == 0, result.output
    number = {"create_atoms": 2, "deposit": 1}[created]  # the second one comes later
    assert result.log.count("belong to no body") == 1
    assert f"{number} atoms of the fix group were created" in result.log


@pytest.mark.parametrize(
    "words, message",
    {
        "molecule mol nosuch": "molecule template ID nosuch does not exist",
        "single mol spce": "keyword mol requires bodystyle molecule",
        "molecule": "rigid fix are not using the same molecule template",
    }.items(),
)
def test_wrong_templates(lmp, words, message):
    commands = INSERT.format(count=1) + "run 1"
    result = run_water(lmp, commands, 2, f"gear/quat {words}", TEMPLATE)
    assert result.returncode != 0
    assert any(message in error for error in result.errors)


STATED = {
    "mass": "4.5 mass",
    "all": "4.5 mass\n0.1 0.25 0.05 com\n2.0 1.5 3.0 0.1 0.05 -0.1 inertia",
}


def inserted(lmp, header, fix, dt, steps):
    """Velocities of the atoms of one molecule, `steps` after it came, in a constant field."""
    (lmp.folder / "molecule.spce").write_text(SPCE.replace("3 atoms", f"3 atoms\n{header}"))
    commands = (
        "region here block 1 2 1 2 1 2\n"
        "fix in all deposit 1 0 1 4711 region here near 0.5 mol spce rigid move "
        "vx 0.3 0.3 vy -0.2 -0.2 vz 0.4 0.4"
    )
    deck = FIELD.format(atoms="", words="", dt=dt, commands=commands, steps=steps + 1)
    deck = deck.replace("fix move all gear/quat molecule mol spce", f"fix move all {fix} mol spce")
    deck = re.sub("(?m)^variable f.*\n", "", deck).replace("v_fx v_fy v_fz", "0.5 -0.3 0.7")
    result = lmp.run(deck.replace("dump poses all custom 1 ", f"dump poses all custom {steps + 1} "))
    return result, lambda: last_frame(lmp.folder / "poses.dump")[:, 1:]


@pytest.mark.parametrize("header", STATED)
def test_a_template_that_states_its_mass(lmp_tree, header):
    """Centre and inertia too, turned as it is inserted: as rigid/small at a step ten times smaller."""
    result, frame = inserted(lmp_tree, STATED[header], "gear/quat molecule", 0.005, 200)
    assert result.returncode == 0, result.output
    assert "template spce states mass, center of mass or inertia other than" in result.output
    mine = frame()
    result, frame = inserted(lmp_tree, STATED[header], "rigid/nve/small molecule", 0.0005, 2000)
    assert result.returncode == 0, result.output
    assert mine == pytest.approx(frame(), abs=2e-3)
    result, frame = inserted(lmp_tree, "", "gear/quat molecule", 0.005, 200)
    assert "template spce states" not in result.output
    assert abs(mine - frame()).max() > 0.05  # what the atoms add up to moves otherwise


@pytest.mark.parametrize(
    "header, message",
    {
        "-1.0 mass": "mass",  # LAMMPS' own
        "1 1 3 0 0 0 inertia": "states a principal moment that is more than the sum of the two",
        "5 5 5 6 0 0 inertia": "states a negative principal moment",
        "9 0 0 com": "states a center of mass that is far away from all its atoms",
    }.items(),
)
def test_a_template_that_no_body_is(lmp_tree, header, message):
    result, _ = inserted(lmp_tree, header, "gear/quat molecule", 0.005, 5)
    assert result.returncode != 0 and message in result.errors[0]
    assert not result.thermo


def test_a_plugin_without_the_header_says_so(lmp_wheel):
    result, _ = inserted(lmp_wheel, STATED["mass"], "gear/quat molecule", 0.005, 5)
    assert result.returncode == 0, result.output
    words = " ".join(result.output.split())
    assert "mass, com and inertia in the header of molecule template spce" in words


# --- velocity ------------------------------------------------------------------------------------
def test_velocities_given_between_runs(lmp_tree):
    """Bodies take momentum and angular momentum of their atoms; the rest cannot be."""
    commands = show(5) + (
        "run 5\nvelocity all create 300.0 4711 mom yes rot no dist gaussian loop geom\n"
        "write_data given.data nocoeff\nrun 0\n"
        "write_dump all custom taken.dump id xu yu zu vx vy vz modify sort id format float %.17g\n"
        "velocity all scale 250.0\nrun 5\n"
    )
    for ranks in (1, 2):
        result = run_water(lmp_tree, commands, ranks)
        assert result.returncode == 0, result.output
        assert result.stdout.count("atoms were changed since the last run") == 1
        assert result.thermo[2]["Temp"][0] == pytest.approx(250.0, rel=1e-9)
        for row in (0, 1):
            expect_temperature(result.thermo[2], row, N)
        lines = (lmp_tree.folder / "given.data").read_text().partition("Velocities")[2].split("\n")
        given = np.array([[float(w) for w in line.split()] for line in lines if line.split()])
        given = given[given[:, 0].argsort()][:, 1:].reshape(N, 3, 3)
        taken = last_frame(lmp_tree.folder / "taken.dump")
        x, v = taken[:, 1:4].reshape(N, 3, 3), taken[:, 4:7].reshape(N, 3, 3)
        mass = np.array([15.9994, 1.008, 1.008])[:, None]
        center = (mass * x).sum(1, keepdims=True) / mass.sum()
        close((mass * v).sum(1), (mass * given).sum(1), 1e-12)
        close(
            (mass * np.cross(x - center, v)).sum(1),
            (mass * np.cross(x - center, given)).sum(1),
            1e-12,
        )
        assert np.abs(v - given).max() > 1e-3  # and the rest is gone


EMPTY = """
units real
atom_style full
atom_modify map array
region box block 0 13 0 13 0 13
create_box 2 box
mass * 10.0
pair_style zero 4.0
pair_coeff * *
molecule spce molecule.spce
fix move all gear/quat molecule mol spce
variable id equal f_move[1][28]
thermo_style custom step v_id f_move[2][28]
thermo 1
"""


def test_rows_may_be_asked_for_before_a_body_is_there(lmp_tree):
    """An empty box into which a molecule comes."""
    (lmp_tree.folder / "molecule.spce").write_text(SPCE)
    result = lmp_tree.run(EMPTY + INSERT.format(count=1) + "thermo_modify lost ignore\nrun 3\n")
    assert result.returncode == 0, result.output
    assert result.thermo[-1]["v_id"] == [0, 1, 1, 1]
    assert result.thermo[-1]["f_move[2][28]"] == [0, 0, 0, 0]
