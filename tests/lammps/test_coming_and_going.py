"""Removal and insertion of bodies, and the effect of command velocity on bodies."""

import numpy as np
import pytest
from support.scenes import SPCE, WATER_MASSES, frames, last_frame, last_numbers, placed, template, two_molecules
from support.insertion import INSERT, MOL, N, TEMPLATE, close, evaporating, liquid, poses

BOLTZMANN = 0.0019872067  # kcal/mol/K
OXYGEN = 5 * 3 - 2  # of molecule 5

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


def ids(lmp):
    """Of the bodies in each frame of the local dump, sorted."""
    return [sorted(frame[:, 0]) for frame in frames(lmp.folder / "bodies.dump").values()]


def expect_temperature(thermo, row, molecules):
    """The temperature corresponds to the kinetic energies of the fix with the degrees of freedom of this number of
    molecules."""

    def temperature(molecules):
        kinetic = thermo["f_move[1]"][row] + thermo["f_move[2]"][row]
        return 2 * kinetic / ((6 * molecules - 3) * BOLTZMANN)

    assert thermo["v_atoms"][row] == 3 * molecules
    assert thermo["Temp"][row] == pytest.approx(temperature(molecules), rel=1e-6)
    assert thermo["Temp"][row] != pytest.approx(temperature(molecules + 1), rel=1e-3)


@pytest.mark.parametrize("ranks", [1, 4])
def test_a_molecule_evaporates(lmp_tree, ranks):
    """The motion is as if the molecule had been deleted between two runs, on any number of ranks, except for the
    histories.

    Within a run histories continue across the jump of the forces, with an error that grows with the step.
    """
    commands = evaporating() + show(rows=[5, 26]) + "run {steps}"
    thermo = lmp_tree.succeed(liquid(lmp_tree, commands, dt=0.001), ranks=ranks).thermo[-1]
    present = [N] * 5 + [N - 1] * 5 + [N - 2] * 11
    for row, molecules in enumerate(present):
        expect_temperature(thermo, row, molecules)
    assert [len(frame) for frame in ids(lmp_tree)] == present
    (gone,) = {5, 17} - set(ids(lmp_tree)[5])
    # the array is sorted by ID and shorter now
    first = 5 if gone == 17 else 6
    assert thermo["f_move[5][28]"] == [5] * 5 + [first] * 5 + [6] * 11
    assert thermo["f_move[26][28]"] == [26] * 5 + [27] * 5 + [0] * 11
    dumped = poses(lmp_tree)

    between = f"""
run 4
group first molecule {gone}
delete_atoms group first compress no
run 5
group second molecule 5 17
delete_atoms group second compress no
run 11
"""
    lmp_tree.succeed(liquid(lmp_tree, between, dt=0.001))
    close(dumped, poses(lmp_tree), 1e-6)


@pytest.mark.parametrize("ranks", [1, 2])
def test_rows_of_bodies_that_are_gone_read_as_zeros(lmp_tree, ranks):
    """Rows are read in thermo, in variables, in averages and in sums over a column."""
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
    result = lmp_tree.succeed(liquid(lmp_tree, evaporating() + commands), ranks=ranks)
    thermo = result.thermo[0]
    assert thermo["f_move[27][28]"] == thermo["v_id"] == [27] * 5 + [0] * 16
    everyone = N * (N + 1) // 2
    assert thermo["v_ids"][4] == everyone and thermo["v_ids"][-1] == everyone - 5 - 17
    assert result.thermo[1]["v_second"] == [0]
    assert list(last_numbers(lmp_tree.folder / "mean", 4)) == [26, 0, 27, 0]


@pytest.mark.parametrize("atom, ranks", [(OXYGEN, 1), (OXYGEN, 4), (OXYGEN + 1, 2)])
def test_a_broken_body_is_noticed_in_a_run(lmp_tree, ranks, atom):
    deck = liquid(lmp_tree, evaporating(f"id {atom}", "no") + "thermo 1\nrun {steps}")
    message = "body 5 has lost some of its atoms; a body must be removed as a whole"
    assert lmp_tree.refuse(deck, message, ranks=ranks).thermo[-1]["Step"][-1] == 4


def test_two_bodies_broken_at_once(lmp_tree):
    """One body lost its owner, and another body lost an atom: the total number is consistent, but the error is
    detected."""
    for members in (f"id {OXYGEN} {OXYGEN + 4}", f"id {OXYGEN + 1} {OXYGEN + 3}"):
        commands = evaporating(members, "no", number=2) + "run {steps}"
        lmp_tree.refuse(liquid(lmp_tree, commands), "has lost some of its atoms", ranks=2)


@pytest.mark.parametrize("ranks", [1, 2])
def test_molecules_deleted_between_runs(lmp_tree, ranks):
    delete = "group gone molecule 1 9 27\ndelete_atoms group gone compress no"
    commands = show(20, rows=[24]) + f"run 20\n{delete}\nrun 20"
    result = lmp_tree.succeed(liquid(lmp_tree, commands), ranks=ranks)
    expect_temperature(result.thermo[0], -1, N)
    for row in (0, 1):
        expect_temperature(result.thermo[1], row, N - 3)
        assert result.thermo[1]["f_move[24][28]"][row] == 26
    # the other bodies have not changed, so they keep their histories
    assert "atoms were changed" not in result.stdout
    assert len(ids(lmp_tree)[-1]) == N - 3


# Dumbbells of an atomic system; body 3 is removed.
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


@pytest.mark.parametrize("ranks", [1, 2])
def test_bodies_go_on_when_atoms_get_other_ids(lmp_tree, ranks):
    """By default delete_atoms gives new IDs in an atomic system, reset_atoms in all systems."""
    columns = " ".join(f"f_move[{row}][{k}]" for row in (1, 2, 3, 4) for k in (1, 2, 3, 16, 28))
    ends = []
    for change in (" compress no", "", " compress no\nreset_atoms id", "\nwrite_restart renumbered"):
        deck = DUMBBELLS.format(columns=columns, change=f"delete_atoms group three{change}")
        result = lmp_tree.succeed(deck, ranks=ranks)
        assert "bodies start" not in result.output
        ends.append([result.thermo[-1][column][-1] for column in columns.split()])
    for end in ends[1:]:
        assert end == pytest.approx(ends[0], rel=1e-12)
        assert ends[0][4::5] == [1, 2, 4, 5]


def test_all_bodies_may_go(lmp_tree):
    after = "run 2\ndelete_atoms group all compress no\nrun 2"
    lmp_tree.succeed(two_molecules(after=after), ranks=2)


@pytest.mark.parametrize("formulation, ranks", [("momentum", 4), ("second", 2), ("first", 1)])
def test_molecules_are_inserted(lmp_tree, ranks, formulation):
    """Inserted molecules become bodies, and the trajectory is the same on any number of ranks."""
    commands = INSERT.format(count=3) + show() + "run {steps}"
    # rows 28 to 30 do not exist yet when thermo_style is parsed
    commands += "\nthermo_style custom step f_move[28][28] f_move[30][28] f_move[30][1]\nrun 0"
    ends = []
    for number in {1, ranks}:
        deck = liquid(lmp_tree, commands, f"{MOL} formulation {formulation}", TEMPLATE)
        result = lmp_tree.succeed(deck, ranks=number)
        present = [N + min((step + 4) // 5, 3) for step in range(21)]
        for row, molecules in enumerate(present):
            expect_temperature(result.thermo[0], row, molecules)
        assert [len(frame) for frame in ids(lmp_tree)] == present
        assert ids(lmp_tree)[20] == pytest.approx(range(1, N + 4))
        after = result.thermo[1]
        assert [after[f"f_move[{row}][28]"][-1] for row in (28, 30)] == [28, 30]
        assert "created after the fix" not in result.output
        ends.append(poses(lmp_tree))
    close(ends[0], ends[-1], 1e-9)


@pytest.mark.parametrize("ranks", [1, 2])
def test_molecules_that_nothing_moves_are_noticed(lmp_tree, ranks):
    """A fix that inserts molecules without its keyword rigid makes no bodies."""
    commands = INSERT.format(count=3).replace(" rigid move", "") + "run 12"
    said = "have inserted 9 atoms into its group that are in no body"
    assert said in lmp_tree.succeed(liquid(lmp_tree, commands, MOL, TEMPLATE), ranks=ranks).words
    whole = INSERT.format(count=3) + "run 12"
    assert "in no body" not in lmp_tree.succeed(liquid(lmp_tree, whole, MOL, TEMPLATE), ranks=ranks).words


FIELD = """
variable fx atom -0.5*x
variable fy atom -1.5*y-0.2*z
variable fz atom -0.8*z-0.2*y
fix field all addforce {force}
"""
THROW = """
region here block 1 2 1 2 1 2
fix in all deposit 1 0 1 4711 region here near 0.5 mol spce rigid move &
  vx 0.3 0.3 vy -0.2 -0.2 vz 0.4 0.4
"""


def in_field(lmp, dt, steps, bodies=(), force="v_fx v_fy v_fz", after=THROW, header="", **settings):
    """A deck: a molecule is inserted into a field, or starts there; ``header`` of the template."""
    (lmp.folder / "molecule.spce").write_text(SPCE.replace("3 atoms", f"3 atoms\n{header}"))
    common = dict(style="full", kinds=(1, 2, 2), masses=f"mass 1 4.0\nmass 2 1.0\n{TEMPLATE}")
    common |= dict(fix=MOL, after=FIELD.format(force=force) + after, dt=dt, steps=1, thermo=1)
    return placed(bodies, run=f"run {steps}", **(common | settings))


def insertion_error(lmp, dt, words, steps=None):
    """Error of a molecule that is inserted and then moves in a field for about two units of time.

    The exact motion is from a body that exists from the start, with steps of 0.01.
    """
    steps = steps or round(2.0 / dt)
    result = lmp.succeed(in_field(lmp, dt, steps + 1, fix=f"{MOL} {words}"))
    begin, finish = (result.thermo[0]["Time"][k] for k in (1, -1))
    thrown = frames(lmp.folder / "poses.dump")
    start, end = thrown[1], thrown[steps + 1]
    assert len(start) == 3
    step, velocities = (finish - begin) / 200, [(0.3, -0.2, 0.4)] * 3
    deck = in_field(lmp, step, 200, [start[:, 1:4]], after="", velocities=velocities)
    lmp.succeed(deck)
    return np.abs(end - poses(lmp))[:, 1:].max()


@pytest.mark.parametrize("start, order", [("bootstrap", 2), ("zero", 1)])
def test_order_of_the_start_of_an_inserted_body(lmp_tree, formulation, start, order):
    """At the insertion only the forces are known; the first body of a fix may be inserted."""
    words = f"formulation {formulation} start {start}"
    errors = [insertion_error(lmp_tree, dt, words) for dt in (0.04, 0.02, 0.01)]
    slopes = np.log2(np.divide(errors[:-1], errors[1:]))
    assert slopes == pytest.approx([order, order], abs=0.35)


@pytest.mark.parametrize(
    "words, message",
    [
        ("molecule mol nosuch", "molecule template ID nosuch does not exist"),
        ("molecule", "rigid fix are not using the same molecule template"),
    ],
)
def test_wrong_templates(lmp_tree, words, message):
    deck = liquid(lmp_tree, INSERT.format(count=1) + "run 1", f"gear/quat {words}", TEMPLATE)
    lmp_tree.refuse(deck, message, ranks=2)


MASS = "4.5 mass"
ALL = "4.5 mass\n0.1 0.25 0.05 com\n2.0 1.5 3.0 0.1 0.05 -0.1 inertia"
FALL = "0.5 -0.3 0.7"  # a constant field


def test_a_template_that_states_its_mass(lmp_tree):
    """Center and inertia are rotated at insertion, too; the motion agrees with rigid/small at a step ten times
    smaller.  Properties that another fix has computed, as fix gcmc does, are not stated."""
    said = "template spce gives a mass, center of mass or inertia that differ from its atoms"

    def move(header, fix=MOL, dt=0.005, steps=200, first=""):
        deck = in_field(lmp_tree, dt, steps + 1, force=FALL, header=header, fix=fix)
        result = lmp_tree.succeed(deck.replace("fix move all", f"{first}fix move all", 1))
        return poses(lmp_tree)[:, 1:], said in result.words

    mine, told = move(ALL)
    rigid, _ = move(ALL, "rigid/nve/small molecule mol spce", 0.0005, 2000)
    of_atoms, told_of_atoms = move("")
    computed, told_of_computed = move("", first="fix other all rigid/small molecule mol spce\nunfix other\n")
    assert told and not told_of_atoms and not told_of_computed
    assert mine == pytest.approx(rigid, abs=2e-3)
    assert abs(mine - of_atoms).max() > 0.05  # with the sums over atoms the motion differs
    assert (computed == of_atoms).all()


def test_a_plugin_without_the_header_says_so(lmp_wheel):
    result = lmp_wheel.succeed(in_field(lmp_wheel, 0.005, 5, force=FALL, header=MASS))
    assert "mass, com and inertia in the header of molecule template spce" in result.words


# --- velocity ------------------------------------------------------------------------------------
def test_velocities_given_between_runs(lmp_tree):
    """Bodies adopt the momentum and angular momentum of their atoms; the remaining velocities are not a rigid
    motion."""
    dump = "write_dump all custom {} id xu yu zu vx vy vz modify sort id format float %.17g\n"
    commands = show(5) + (
        "run 5\nvelocity all create 300.0 4711 mom yes rot no dist gaussian loop geom\n"
        + dump.format("given.dump")
        + "run 0\n"
        + dump.format("taken.dump")
        + "velocity all scale 250.0\nrun 5\n"
    )
    mass = WATER_MASSES[:, None]
    for ranks in (1, 2):
        result = lmp_tree.succeed(liquid(lmp_tree, commands), ranks=ranks)
        assert result.stdout.count("atoms were changed since the last run") == 1
        assert result.thermo[2]["Temp"][0] == pytest.approx(250.0, rel=1e-9)
        for row in (0, 1):
            expect_temperature(result.thermo[2], row, N)
        given, taken = (
            last_frame(lmp_tree.folder / f"{name}.dump")[:, 1:].reshape(N, 3, 6)
            for name in ("given", "taken")
        )
        arms = taken[..., :3] - (mass * taken[..., :3]).sum(1, keepdims=True) / mass.sum()
        given, taken = given[..., 3:], taken[..., 3:]
        close((mass * taken).sum(1), (mass * given).sum(1), 1e-12)
        momenta = ((mass * np.cross(arms, v)).sum(1) for v in (taken, given))
        close(*momenta, 1e-12)
        assert np.abs(taken - given).max() > 1e-3  # and the remaining velocities are lost


# --- exchange of molecules with a reservoir ------------------------------------------------------
CO2 = template([(0, 0, 0), (1.16, 0, 0), (-1.16, 0, 0)], [1, 2, 2])
GAS = """
units real
atom_style molecular
atom_modify map yes
pair_style lj/cut 9.0
region box block 0 22 0 22 0 22
create_box 2 box
mass 1 12.011
mass 2 15.9994
pair_coeff 1 1 0.0537 2.80
pair_coeff 2 2 0.1570 3.05
neigh_modify every 1 delay 0 check yes exclude molecule/intra all
molecule co2 co2.mol
{start}
group gas type 1 2
fix move gas gear/quat molecule temp 300 300 100 {mol}
fix mc gas gcmc 10 5 {moves} 0 4712 300.0 -6.0 0.5 mol co2 {rigid} tfac_insert 1.66667 {energy} group gas
compute tg gas temp
compute_modify tg dynamic/dof yes
variable n equal count(gas)/3
variable there equal f_mc[4]-f_mc[6]
variable ke equal f_move[1]+f_move[2]
thermo_style custom step c_tg v_n v_there v_ke f_move[10]
thermo_modify lost error norm no
thermo 50
dump poses all custom 50 poses.dump id mol xu yu zu
dump_modify poses sort id format float %.17g
run 200
run 200
"""
FILLED = "create_atoms 0 random 8 887 box mol co2 8871 overlap 3.0\nvelocity all create 300 4711"


def gas(lmp, start="", mol="mol co2", moves=0, rigid="rigid move", energy=""):
    (lmp.folder / "co2.mol").write_text(CO2)
    return GAS.format(start=start, mol=mol, moves=moves, rigid=rigid, energy=energy)


@pytest.mark.parametrize("start, energy, ranks", [("", "", 1), (FILLED, "full_energy", 1), (FILLED, "", 2), ("", "full_energy", 2)])
def test_molecules_of_a_reservoir(lmp_wheel, start, energy, ranks):
    """Fix gcmc inserts and removes whole bodies, in several runs, from an empty and from a filled box."""
    tables = lmp_wheel.succeed(gas(lmp_wheel, start, energy=energy), ranks=ranks).thermo
    before = 8 if start else 0
    for table in tables:
        assert table["v_n"] == [before + there for there in table["v_there"]]
    end = {name: values[-1] for name, values in tables[-1].items()}
    assert end["v_n"] > before + 10 and end["v_n"] > tables[0]["v_n"][-1]
    assert end["c_tg"] == pytest.approx(2 * end["v_ke"] / ((5 * end["v_n"] - 3) * BOLTZMANN), rel=1e-6)
    shapes = last_frame(lmp_wheel.folder / "poses.dump")[:, -3:].reshape(-1, 3, 3)
    for one in (1, 2):
        assert np.linalg.norm(shapes[:, one] - shapes[:, 0], axis=1) == pytest.approx(1.16, abs=1e-9)


def test_a_reservoir_that_is_not_told_of_bodies(lmp_wheel):
    instead = "to exchange whole bodies use its keywords mol and rigid, without MC moves, and keyword mol"
    lmp_wheel.refuse(gas(lmp_wheel, FILLED, mol="", rigid=""), instead)
    moved = lmp_wheel.refuse(gas(lmp_wheel, FILLED, moves=5, rigid=""), instead)
    assert "fix mc (gcmc) has moved atom" in moved.words
