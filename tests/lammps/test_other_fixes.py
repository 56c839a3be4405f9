"""Other fixes that change velocities, positions or masses of the atoms of bodies: one table."""

import math
import re

import pytest
from support.running import ROOT
from support.scenes import one_after_the_other, placed, two_molecules, water, water_data

SOURCE = ROOT / "src/GEARQUAT/gear_quat_styles.cpp"
MANUAL = ROOT / "doc/src/fix_gear_quat.rst"

# 27 molecules whose sites attract each other, with a smooth cutoff: the energy is conserved
FORCES = "pair_style lj/gromacs 3.0 4.0\npair_coeff * * 0.1 2.2\n"


def molecules(lmp, after="", fix="gear/quat molecule report no", dt=0.5, steps=200, **deck):
    data = water_data(lmp.folder / "data.water", shift=1.65)
    columns = "econserve f_move[1] f_move[2] " + ("f_move[9]" if "isokinetic" in fix else "")
    deck = water(data, fix, dt=dt, steps=steps, after=after, columns=columns, **deck)
    return re.sub("pair_style.*\n(pair_coeff.*\n)*", FORCES, deck)


# --- the table -----------------------------------------------------------------------------------
def rows_of_the_code():
    """Pattern -> effect of such a fix."""
    rows = re.findall(r'\{"(\^[^"]+)",\s+([A-Z_| ]+),', SOURCE.read_text())
    effects = {"REFLECTION", "EXCHANGE", "CHANGE"}
    return {
        pattern: effect
        for patterns, facts in rows
        for effect in effects & set(facts.split(" | "))
        for pattern in patterns.split()
    }


def rows_of_the_manual():
    """Style -> the second column of its row."""
    table = MANUAL.read_text().split(".. other fixes begin")[1].split(".. other fixes end")[0]
    rows = re.findall(r"\* - (.*?)\n\s+- (.*?)(?=\n\s+\* -|\Z)", table, re.S)
    names = re.compile(r"\*([a-z_/]+)\*")
    told = [(style, text) for styles, text in rows for style in names.findall(styles)]
    assert len(dict(told)) == len(told)
    return dict(told)


def test_manual_and_code_have_the_same_table():
    words = {"REFLECTION": "ends the run", "CHANGE": "refused", "EXCHANGE": "needs its keywords"}
    code, manual = rows_of_the_code(), rows_of_the_manual()
    assert len(code) > 25
    for style, text in manual.items():
        acts = [act for pattern, act in code.items() if re.search(pattern, style)]
        assert acts, f"{style} is in the manual only"
        assert text.startswith(words[acts[0]]), style
    for pattern in code:
        assert any(re.search(pattern, style) for style in manual), f"{pattern} is not in the manual"


def test_patterns_are_the_beginnings_of_names():
    """Otherwise "langevin" would also be found in "press/langevin"."""
    rows = " ".join(re.findall(r'^    \{"([^"]+)"', SOURCE.read_text(), re.M)).split()
    assert len(rows) > 80
    assert [row for row in rows if not row.startswith("^")] == []


# --- refused -------------------------------------------------------------------------------------
REFUSED = {
    "momentum 10 linear 1 1 0 angular": "use velocity zero linear and velocity zero angular between runs",
    "temp/rescale 1 300 300 1 1.0": "use keyword temp or langevin, which act on bodies",
    "temp/berendsen 300 300 50": "use keyword temp or langevin, which act on bodies",
    "temp/csvr 300 300 50 4711": "use keyword temp or langevin, which act on bodies",
    "temp/csld 300 300 100 4711": "use keyword temp or langevin, which act on bodies",
    "heat 1 0.1": "give it a group without atoms of bodies",
    "ehex 1 0.1": "give it a group without atoms of bodies",
    "thermal/conductivity 10 x 20": "give it a group without atoms of bodies",
    "viscosity 10 x z 20": "give it a group without atoms of bodies",
    "oneway 1 half +x": "give it a group without atoms of bodies",
    "atom/swap 10 5 4711 300 types 1 2": "give it a group without atoms of bodies",
    "set 100 0 group all vx v_half": "use command set between runs",
    "recenter INIT INIT INIT": "cannot be used with fix other (recenter)",
    "langevin 300 300 100 4711 gjf vhalf": "leave out its keyword gjf",
}
NEEDS = "region half block 0 5 INF INF INF INF\nvariable half atom 0.5*vx\n"


@pytest.mark.parametrize("words", REFUSED)
def test_refused_before_step_0(lmp_wheel, words):
    after = f"{NEEDS}fix other all {words}"
    result = lmp_wheel.refuse(molecules(lmp_wheel, after, steps=5), REFUSED[words], ranks=4)
    assert not result.thermo and len(set(result.errors)) == 1
    assert words.split()[0] in result.errors[0]


def test_a_group_without_bodies_is_not_refused(lmp_wheel):
    groups = "group free id 1:3\ngroup bound subtract all free\nfix nve free nve\n"
    decks = [
        molecules(lmp_wheel, f"{NEEDS}{groups}fix other free {words}", steps=1)
        for words in REFUSED
        if "recenter" not in words and "gjf" not in words
    ]
    deck = one_after_the_other(decks).replace("fix move all", "group some id 4:81\nfix move some")
    result = lmp_wheel.run(deck)
    assert "Fix gear/quat" not in " ".join(result.errors), result.output


BONDS = """
bond_style harmonic
bond_coeff 1 100.0 1.0
create_bonds single/bond 1 1 2
create_bonds single/bond 1 3 4
group body id 1 2
group free id 3 4
"""


def test_constraints_on_atoms_of_bodies(lmp_tree):
    """fix shake is accepted beside bodies, and refused on their atoms."""
    diatomics = [[(0, 0, 0), (1, 0, 0)], [(0, 2, 0), (1, 2, 0)]]
    room = "bond/types 1 extra/bond/per/atom 1 extra/special/per/atom 2"
    beside, on_them = (
        placed(
            diatomics,
            group="body",
            room=room,
            before=BONDS,
            after=f"fix hold {group} shake 1e-6 20 0 b 1\nfix nve free nve",
            steps=1,
        )
        for group in ("free", "all")
    )
    lmp_tree.succeed(beside)
    lmp_tree.refuse(on_them, "take the bonds and angles of bodies out of it")


# --- watched --------------------------------------------------------------
def test_reflecting_walls(lmp_tree):
    """The run ends in the step that moves an atom of a body."""
    fix = "fix wall all wall/reflect xlo -9.0 xhi {}\nvelocity all set 1.0 0 0\nrun {}"
    lmp_tree.succeed(two_molecules(after=fix.format(9.0, 50), boundary="f p p"))
    near = two_molecules(after=fix.format(6.2, 50), boundary="f p p")
    lmp_tree.refuse(near, "fix wall (wall/reflect) has moved atom 5 of body 2 in step", ranks=2)


@pytest.mark.parametrize("words", ["values 9", "corrector gear values 8", "formulation first corrector gear values 8"])
def test_values_that_random_forces_heat(lmp_wheel, words):
    """The warning advises the defaults, which cause none."""
    after = "fix t all langevin 1 1 1 4711\nrun 1"
    told = lmp_wheel.succeed(two_molecules(f"molecule {words}", after=after)).words
    line = r"forces of fix (.*) are random, and (?:\d values|formulation first) cannot follow them; leave out keywords (?:formulation, )?values and corrector"
    assert re.search(line, told)[1] == "t (langevin)"
    assert re.search(line, (ROOT / "doc/howto/read_log.md").read_text())
    assert "cannot follow" not in lmp_wheel.succeed(two_molecules(after=after)).words


@pytest.mark.parametrize(
    "part, words, error",
    [(0.001, "", 0.005), (0.05, "", 0.005), (0.2, "corrector gear values 4", 0.02)],
)
def test_velocities_fade_as_the_friction_says(lmp_wheel, part, words, error):
    """From weak friction to one that removes a fifth of a momentum in a step."""
    after = f"fix drag all viscous {part / 0.01}\nthermo 10\nthermo_style custom step temp\nrun 10"
    after += "\nthermo_modify format float %.17g"
    ours = lmp_wheel.succeed(two_molecules(f"molecule {words}", after=after)).thermo[-1]["Temp"]
    assert ours[-1] / ours[0] == pytest.approx(math.exp(-20 * part), rel=error)
