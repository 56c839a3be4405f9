"""Every error in the input ends the run, on all ranks, with a message that names the error."""

import re

import pytest
from support.scenes import two_molecules

ID1 = "1 3.0 0.33 0.4 0.03 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0"

ARGUMENTS = {
    **{f"molecule {key}": f"{key}: the value is missing; required: " for key in ("formulation", "tolerance", "infile")},
    "": "the body style is missing; required: single, molecule, group N ID1",
    "polygon": "Unknown fix gear/quat bodystyle: polygon (single, molecule, group or custom)",
    "group": "group: N is missing; required: N ID1 ID2",
    "group 0": "number of groups is 0 and must be a positive integer",
    "group 2 left": "2 group IDs expected, 1 given",
    "group 2 left nosuch": "group ID nosuch does not exist",
    "group 2 left all": "is in more than one of the groups",
    "group 3 left none right": "no atom of the fix group is in group none",
    "custom": "custom: i_name or v_name is missing",
    "custom i_nosuch": "requires an integer vector of that name",
    "custom d_real": "d_real is neither i_name nor v_name",
    "custom v_equal": "requires an atom-style or atomfile-style variable",
    "custom v_huge": "custom v_huge: the value of atom 6 is not a number between -1.07374e+09 and 1.07374e+09",
    "custom i_far": "custom i_far: the value of atom 6 is not a number between -1.07374e+09 and 1.07374e+09",
    "molecule sloppy yes": "keyword: sloppy; the keywords are formulation, values, corrector,",
    "molecule formulation third": "formulation: unknown value third (momentum, second or first)",
    "molecule formulation first formulation first": "keyword formulation is given twice",
    "molecule values 7.5": "values: 7.5 is not an integer; required: auto or 4 to 12 (momentum, second), 3 to 8 (first)",
    "molecule values 99999999999": "values: 99999999999 is not from 4 to 12",
    "molecule formulation second values 13": "values: 13 is not from 4 to 12, as formulation second requires",
    "molecule tolerance 1e-8 corrector tuned": "corrector cannot be used with tolerance: with a tolerance, bodies remember",
    "molecule preset paper tolerance 1e-8": "keyword preset paper cannot be used with tolerance: the paper has constant steps",
    "molecule c0 velocity": "keyword c0 requires formulation second",
    "molecule formulation first corrector tuned": "keyword corrector tuned requires formulation momentum: the others",
    "molecule formulation first passes 3": "passes: 3 is not from 1 to 2",
    "molecule passes 2": "keyword passes requires formulation second or first: formulation momentum neither",
    "molecule project maybe": "project: unknown value maybe (yes or no)",
    "molecule tolerance 0": "tolerance: 0 is not a positive number",
    "molecule tolerance nan": "nan is not a positive number",
    "molecule dtmin 0.1": "keyword dtmin requires keyword tolerance",
    "molecule tolerance 1e-8 dtmin 0.2 dtmax 0.1": "dtmin: 0.2 is larger than dtmax, 0.1",
    "molecule tolerance 1e-8 enrgy": "keyword: enrgy; tolerance takes a positive number and "
    "perhaps length or energy; the keywords are formulation, values",
    "molecule temp 1 1 0.1 5": "keyword: 5; temp takes Tstart Tstop Tdamp; the keywords are",
    "molecule tolerance 1e-8 length nan": "Unknown fix gear/quat keyword: nan",
    "molecule infile nosuch": "cannot open file nosuch",
    'molecule infile ""': "infile: the value is an empty word",
    "molecule infile bodies reinit yes": "reinit yes cannot be used with infile",
    "molecule force 1 on on": "force: zflag is missing; required: M xflag yflag zflag",
    "molecule force 1 on on yes": "force: unknown zflag yes (on or off)",
    "molecule force 3 off off off": "force: bodies 3 are neither a number from 1 to 2 nor a range",
    "molecule force ** off off off": "force: bodies ** are neither a number from 1 to 2 nor a range",
    "molecule force 99999999999999999999 on on off": "force: bodies 99999999999999999999 are neither",
    "molecule torque 2*1 off off off": "torque: bodies 2*1 are neither a number from 1 to 2",
    "molecule mol some force * on on off": "keyword force cannot be used with mol: the numbers of bodies",
    "molecule isokinetic total": "keyword isokinetic requires formulation first: its constraint",
    "molecule temp 1.0 1.0": "temp: Tdamp is missing; required: Tstart Tstop Tdamp",
    "molecule temp 1 -1 0.1": "temp: Tstop -1 is not a positive number",
    "molecule temp 1 1 0.1 tchain 0": "tchain: 0 is not from 1 to 10",
    "molecule formulation first isokinetic total temp 1 1 0.1": "keyword temp cannot be used with isokinetic: both keep",
    "molecule temp 1 2 0.1 tolerance 1e-8": "Tstart 1 and Tstop 2 differ, which cannot be used with tolerance",
    "molecule iso one 1 1": "iso: Pstart one is not a number",
    "molecule iso 1 1 1 aniso 1 1 1": "keyword iso cannot be used with aniso: it sets all directions",
    "molecule aniso 1 1 1 z 1 1 1": "keyword aniso cannot be used with z: it sets all directions",
    "molecule tri 1 1 1": "keywords tri, xy, xz and yz require a triclinic box; write change_box all triclinic",
    "molecule iso 1 1 1 couple xyz": "keyword iso cannot be used with couple: it couples all edges",
    "molecule x 1 1 1 y 1 1 2 couple xy": "couple: directions x and y need keywords with the same Pstart, Pstop and Pdamp",
    "molecule z 1 1 1 couple xy": "couple: directions x and y need keywords with the same",
    "molecule pchain 3": "keyword pchain requires keyword iso, aniso, tri, x, y, z, xy, xz or yz",
    "molecule iso 1 1 1 temp 1 1 0.1 ptemp 1": "keyword ptemp cannot be used with temp: their temperature",
    "molecule tri 1 1 1 force * on on off": "keyword force cannot be used with tri: in a box that shears",
    "molecule iso 1 1 1 mol some": "keyword iso cannot be used with mol: with a moving box",
    "molecule iso 1 2 1 tolerance 1e-8": "Pstart 1 and Pstop 2 differ, which cannot be used with tolerance",
    "molecule formulation first isokinetic total z 1 1 1": "keyword z cannot be used with isokinetic: constant kinetic energy",
    "molecule langevin 1 1 1 4711 temp 1 1 1": "keyword langevin cannot be used with temp",
    "molecule langevin 1 1 1 4711 values 5": "keyword langevin cannot be used with values",
    "molecule langevin 1 1 1 4711 formulation first": "keyword langevin requires formulation momentum: the friction acts",
    "molecule langevin 1 1 1 4711 iso 1 1 1 ptemp 1": "keyword ptemp cannot be used with langevin",
    **{f"molecule langevin 1 1 1 {seed}": "seed" for seed in ("0", "1.5", "1e12")},
    "single mol some": "keyword mol requires bodystyle molecule",
    "molecule formulation first isokinetic total mol some": "keyword mol cannot be used with isokinetic: inserted bodies add",
}
#: words whose errors depend on atoms, which are on all ranks; other words are the same on every rank
OF_ATOMS = {"group", "custom", "infile", "mol", "force", "torque"}
GROUPS = """
group none empty
group left id 1 2 3
group right id 4 5 6
fix real all property/atom d_real i_far
set group left i_far -2147483647
set group right i_far 2147483647
variable huge atom (id>3)*exp(1000)
variable equal equal 1.0
"""

INFILES = {
    "": "the first line of file bodies is not the number of its bodies, 0",
    "x\n": "file bodies, line 1: the first line must be the number of bodies",
    f"2\n{ID1}\n": "the first line of file bodies is not the number of its bodies, 1",
    f"1\n{ID1}\n{ID1.replace('1', '2', 1)}\n": "the first line of file bodies is not the number of its bodies, 2",
    f"2\n{ID1}\n{ID1}\n": "file bodies, line 3: body 1 was given on line 2 already",
    f"1\n{ID1} 0\n": "file bodies, line 2 has 21 words instead of 20",
    f"# text\n\n1\n{ID1[:-2]}\n": "file bodies, line 4 has 19 words instead of 20",
    f"1\n{ID1.replace('0.33', 'zero')}\n": "file bodies, line 2: 'zero' is not a number",
    f"1\n{ID1.replace('0.33', 'nan')}\n": "file bodies, line 2: 'nan' is not a",
    f"1\n1.5{ID1[1:]}\n": "file bodies, line 2: '1.5' is not an integer",
    f"1\n0{ID1[1:]}\n": "file bodies, line 2: body ID 0 is not positive",
    f"1\n{10**20}{ID1[1:]}\n": f"body ID {10**20} is not positive or too large",
    f"1\n{ID1[:-1]}99999999999\n": "file bodies, line 2: image flag 99999999999 is too large",
    f"1\n{ID1.replace(' 1 1 1 0 0 0', ' 1 1 1 5 0 0')}\n": "tensor of body 1 has a negative principal",
    f"1\n7{ID1[1:]}\n": "no atom belongs to body 7",
    f"1\n{ID1} '\n": "file bodies, line 2 has 21 words instead of 20",
    f"1\n{ID1.replace('0.33', '0.33' + chr(0) + '5')}\n": "file bodies, line 2: '0.33' is not a number",
    f"1\n{ID1.replace(' 1 1 1 ', ' 1e308 1e308 1e308 ')}\n": "body 1 are not finite numbers",
    f"1\n{ID1.replace(' 1 1 1 ', ' 1 1 2.01 ')}\n": "moment of body 1 is more than the sum of the two",
    f"1\n{ID1.replace('0.33', '20.33')}\n": "center of mass of body 1 is far away from all its atoms",
    f"1\n{ID1[:-1]}1\n": "are its position and its image flags right?",
    f"1\n{ID1.replace('3.0', '0.0')}\n": "file bodies, line 2: mass 0.0 of body 1 is not positive",
}

TEMP, ISO = "molecule temp 1 1 0.1", "molecule iso 1 1 1"
TWO = "group one molecule 1\ngroup two molecule 2"
TILTS, CHANGES_X = "change_box all triclinic", "Must not have multiple fixes change box parameter x"
#: fix and its keywords, before the fix, after it, message
SCENES = {
    "molecule ID 0": ("molecule", "set atom 5 mol 0", "", "atom 5 of the fix group has molecule ID 0"),
    "two fixes": ("molecule", "fix other all gear/quat single", "", "atom 6 is also moved by fix"),
    "and nve": ("molecule", "fix other all nve", "", "is also moved by fix other (nve)"),
    "and rigid": ("molecule", "fix other all rigid/nve/small molecule", "", "is also moved by fix other"),
    "step of zero": ("molecule", "", "timestep 0.0", "requires a time step that is not zero"),
    "minimize": ("molecule", "", "min_style fire\nminimize 0 0 10 10", "use min_style cg or sd"),
    "respa": ("molecule", "", "run_style respa 2 2 pair 1", "requires run_style respa to have the same step at all levels"),
    "flow and temp": (
        TEMP, TILTS, "fix d all deform 1 xy erate 0.1 remap v",
        "in the flow of fix deform remap v a chain of 3 variables does not hold the temperature",
    ),
    "box and tolerance": (
        "molecule tolerance 1e-6", "", "fix d all deform 1 x scale 0.9",
        "tolerance cannot be used with fix d (deform), whose box is a function of the number of the step",
    ),
    "part of a body": (
        "molecule", "", "group lost id 2\nrun 1\ndelete_atoms group lost compress no",
        "body 1 has lost some of its atoms; a body must be removed as a whole",
    ),
    # masses of single atoms are zero until they are set
    "no mass": ("molecule", "fix masses all property/atom rmass\nset atom 1*3 mass 1.0", "", "body 2 has no mass"),
    "only held": (
        f"{TEMP} force * off off off torque * off off off", "", "",
        "keywords force and torque or fix_modify extra/dof leave the bodies no degrees of freedom",
    ),
    "an axis": (f"{TEMP} torque 2 off off on", "", "", "turns off some components for body 2 and not all"),
    "energy yes": (TEMP, "", "fix_modify move energy yes", "temp cannot be used with fix_modify energy yes"),
    "berendsen": (TEMP, "", "fix bath all temp/berendsen 1 1 0.1", "and fix bath (temp/berendsen) is another one"),
    "langevin": (TEMP, "group half id 1", "fix bath half langevin 1 1 0.1 4711", "and fix bath (langevin) is another one"),
    "other atoms": (
        "group 1 one iso 1 1 1", TWO, "fix second two nve",
        "requires all moving atoms to be in bodies of this fix, and 3 that fix second (nve) moves are not",
    ),
    "two boxes": (
        "group 1 one iso 1 1 1", TWO, "fix second two gear/quat group 1 two",
        "fix move (gear/quat) changes the box without informing other fixes",
    ),
    "pressure and respa": (ISO, "", "run_style respa 2 1 pair 1", "cannot be used with run_style respa; use run_style verlet"),
    "a field before": (
        ISO, "fix a all addforce 0 0 1", "", "fix a (addforce) has to be defined after fix move, because its force does not count",
    ),
    "a field that counts": (
        ISO, "", "fix a all addforce 0 0 1\nfix_modify a virial yes",
        "fix a (addforce) has to be defined before fix move, because its force counts in the pressure",
    ),
    "at rest": (ISO, "velocity all set 0 0 0", "", "give them velocities first, or add keyword ptemp"),
    "one body": ("single iso 1 1 1", "", "", "constant pressure requires more than one body"),
    "some tilts": (
        "molecule x 1 1 1 y 1 1 1 xy 0 0 1", TILTS, "", "are given, which are x, y, z, xy, xz and yz; use keyword tri",
    ),
    "coupled tilts": (
        "molecule x 1 1 1 y 1 1 1 z 1 1 1 xy 0 0 1 xz 0 0 1 yz 0 0 1 couple xy", TILTS, "",
        "keyword xy cannot be used with couple: edges of a box",
    ),
    "a deforming box": (ISO, "", "fix d all deform 1 x scale 0.9", CHANGES_X),
    "fix nph": (ISO, "", "fix d all nph iso 1 1 1", CHANGES_X),
    "fast": ("molecule iso 1 1 0.001", "", "", "Pdamp"),
    "far": ("molecule iso 1e9 1e9 1000", "", "", "begin nearer to the target pressure, or use a longer Pdamp"),
    "fix_modify press": (ISO, "", "fix_modify move press thermo_press", "does not support fix_modify press"),
}  # fmt: skip


@pytest.mark.parametrize("words", ARGUMENTS)
def test_arguments(lmp_wheel, words):
    ranks = 2 if OF_ATOMS & set(words.split()) else 1
    lmp_wheel.refuse(two_molecules(words, before=GROUPS), ARGUMENTS[words], ranks=ranks)


@pytest.mark.parametrize("text", INFILES)
def test_infile(lmp_wheel, text):
    (lmp_wheel.folder / "bodies").write_text(text)
    lmp_wheel.refuse(two_molecules("molecule infile bodies"), INFILES[text], ranks=2)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("name", SCENES)
def test_scene(lmp_tree, name, ranks):
    words, before, after, message = SCENES[name]
    lmp_tree.refuse(two_molecules(words, before=before, after=f"{after}\nrun 1"), message, ranks=ranks)


@pytest.mark.parametrize("axis", "xyz")
def test_a_pressure_along_a_direction_that_is_not_periodic(lmp_tree, axis):
    boundary = " ".join("f" if c == axis else "p" for c in "xyz")
    for words in ("iso 1 1 1", f"{axis} 1 1 1"):
        message = f"the box is not periodic along {axis}, so there is no constant pressure along {axis}"
        lmp_tree.refuse(two_molecules(f"molecule {words}", boundary=boundary), message, ranks=2)
    others = " ".join(f"{c} 1 1 10 " for c in "xyz" if c != axis)
    lmp_tree.succeed(two_molecules(f"molecule {others}", boundary=boundary))


OUT_OF_THE_PLANE = {
    **dict.fromkeys(["force * on on on", "torque 1 off on on"], "has to be off in a 2d simulation"),
    **dict.fromkeys(["z 1 1 1", "x 1 1 1 yz 0 0 1"], "in two dimensions there is no pressure component z, xz or yz"),
    "x 1 1 1 y 1 1 1 couple xz": "in two dimensions there is no edge along z; use couple xy",
}


@pytest.mark.parametrize("words", OUT_OF_THE_PLANE)
def test_out_of_the_plane(lmp_tree, words):
    deck = two_molecules(f"molecule {words}").replace("boundary", "dimension 2\nboundary", 1)
    deck = deck.replace("-10 10\ncreate_box", "-0.5 0.5\ncreate_box")
    deck = re.sub(r"(single \S+ \S+) \S+", r"\1 0.0", deck)
    lmp_tree.refuse(deck, OUT_OF_THE_PLANE[words], ranks=2)


def test_one_part_alone_has_a_temperature(lmp_tree):
    before = "velocity all set 0 0 0\ngroup one molecule 1\nvelocity one set 0.3 0 0.1"
    lmp_tree.succeed(two_molecules("molecule temp 1 1 0.1", before=before))


def test_empty_group(lmp_tree):
    deck = two_molecules().replace("fix move all", "group nobody empty\nfix move nobody")
    lmp_tree.refuse(deck, "no atom of the fix group is in a body")


def test_dynamic_group(lmp_tree):
    group = "region some block -5 5 -5 5 -5 5\ngroup some {words}\nfix move some"
    deck = two_molecules().replace("fix move all", group)
    lmp_tree.refuse(deck.format(words="dynamic all region some every 1"), "group some is dynamic, but bodies keep their atoms")
    lmp_tree.succeed(deck.format(words="region some"))
    for words in ("molecule points some", "group 1 some"):
        late = two_molecules(words, before=group.split("\n")[0] + "\ngroup some dynamic all region some every 1")
        lmp_tree.refuse(late, "group some is dynamic, but bodies keep their atoms")


def test_group_that_becomes_dynamic(lmp_tree):
    """LAMMPS refuses it, because the fix does not declare support: bodies do not change their atoms."""
    after = "variable some atom x<100\ngroup some dynamic all var some every 1\nrun 1"
    deck = two_molecules(after=after).replace("fix move all", "group some id 1:6\nfix move some")
    lmp_tree.refuse(deck, "does not allow use with a dynamic group")


def test_no_atom_map(lmp_tree):
    deck = two_molecules("single").replace("atom_style molecular", "atom_style atomic")
    deck = re.sub("atom_modify map array|set atom .* mol .", "", deck)
    lmp_tree.refuse(deck, "requires an atom map: write atom_modify map yes before the box")


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize(
    "words", ["molecule", "single", "group 2 left right", "custom v_half", "custom i_which"]
)
def test_good_arguments_are_not_refused(lmp_tree, words, ranks):
    before = GROUPS + """
variable half atom (id>3)*5-2
fix which all property/atom i_which
set group left i_which -7
set group right i_which 4
"""
    result = lmp_tree.succeed(two_molecules(words, before=before), ranks=ranks)
    bodies = 1 if words == "single" else 2
    assert f"{bodies} rigid bodies with 6 atoms" in result.stdout
