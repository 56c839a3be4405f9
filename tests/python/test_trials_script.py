"""The commands of a deck, as text."""

import pytest

from lammps_gearquat import keywords
from lammps_gearquat.trials import script
from lammps_gearquat.trials.script import DeckError


def test_lines_are_joined_as_lammps_joins_them():
    text = 'fix 1 all rigid group 2 &   \n a b\nprint """one\n two"""\n\nrun 5 # and &\n more'
    assert script.logical_lines(text) == [
        "fix 1 all rigid group 2  a b",
        'print """one\n two"""',
        "",
        "run 5 # and  more",
    ]


@pytest.mark.parametrize(
    "line, words",
    [
        ('print "a # b" # c', ["print", "a # b"]),
        ("if \"$x == 'y'\" then 'run 5'", ["if", "$x == 'y'", "then", "run 5"]),
        ('python f here """a "b" c"""', ["python", "f", "here", 'a "b" c']),
        ("it's one", ["it's", "one"]),
        ("print \"\" ''", ["print", "", ""]),
    ],
)
def test_words(line, words):
    assert script.split(script.strip_comment(line)) == words


def test_quote_finds_quotes_that_fit():
    for text in ("a b", 'a "b"', 'it\'s "b"'):
        assert [word.rstrip() for word in script.split(script.quote(text))] == [text]


def test_branches_of_an_if():
    words = script.split("if 1 then a 'b c' elif 2 d else e f")
    assert script.branches(words) == [("1", ["a", "b c"]), ("2", ["d"]), (None, ["e", "f"])]
    with pytest.raises(DeckError, match="not an if"):
        script.branches(script.split("if 1 do a"))


@pytest.mark.parametrize(
    "line, now, steps",
    [("run 100", 7, 100), ("run 1e3", 0, 1000), ("run 100 upto", 30, 70), ("run 100 upto", 100, 0)],
)
def test_run(line, now, steps):
    assert script.run_steps(line.split(), now) == steps
    assert script.run_steps([*line.split(), "every", "10", "NULL"], now) == steps


@pytest.mark.parametrize(
    "line, said",
    [
        ('run 10 every 5 "velocity all scale 1"', "velocity all scale 1"),
        ("run 10 start 0 stop 50", "start or stop"),
        ("run many", "not a run command"),
    ],
)
def test_runs_that_are_refused(line, said):
    with pytest.raises(DeckError, match=said):
        script.run_steps(script.split(line))


def parse(line):
    return script.parse_fix(line.split())


@pytest.mark.parametrize(
    "line, translated",
    [
        ("fix 1 all rigid single", "fix 1 all gear/quat single"),
        ("fix 1 a rigid/nve/omp molecule", "fix 1 a gear/quat molecule"),
        ("fix m a rigid/small molecule mol w", "fix m a gear/quat molecule"),
        ("fix 1 a rigid/nve/small custom i_b", "fix 1 a gear/quat custom i_b"),
        ("fix 1 a rigid group 2 x y infile f", "fix 1 a gear/quat group 2 x y infile f"),
        ("fix 1 a rigid single reinit no", "fix 1 a gear/quat single reinit no"),
        (
            "fix 1 a rigid group 2 x y force 1 off off off torque 2* off off on",
            "fix 1 a gear/quat group 2 x y force 1 off off off torque 2* off off on",
        ),
        ("fix 1 a rigid single reinit off infile f", "fix 1 a gear/quat single infile f"),
        ("fix 1 a rigid single reinit on couple xyz", "fix 1 a gear/quat single reinit yes"),
        ("fix 1 a rigid single infile f infile g", "fix 1 a gear/quat single infile g"),
        (
            "fix 1 a gear/quat molecule tolerance 1e-9 dtmax 1 torque * off off on report no force 1 on off on",
            "fix 1 a gear/quat molecule torque * off off on force 1 on off on",
        ),
        (
            "fix 1 a gear/quat molecule formulation first isokinetic separate rescale no",
            "fix 1 a gear/quat molecule isokinetic separate rescale no",
        ),
        (
            "fix 1 a gear/quat single start zero corrector gear c0 velocity infile f",
            "fix 1 a gear/quat single infile f",
        ),
    ],
)
def test_translation(line, translated):
    assert parse(line).text() == line.replace("infile f infile g", "infile g")
    assert script.translate(parse(line))[0].text() == translated


@pytest.mark.parametrize(
    "line, said",
    [
        (
            "fix 1 a rigid/nvt molecule temp 1 2 3 reinit no force 1 on on off",
            "gear/quat molecule reinit no force 1 on on off temp 1 2 3 tchain 10 thermostat separate$",
        ),
        (
            "fix 1 a rigid/nvt/small/omp single tparam 4 2 3 temp 1 2 3",
            "gear/quat single temp 1 2 3 tchain 4 thermostat separate$",
        ),
        (
            "fix 1 a rigid/npt/small molecule temp 1 1 1 iso 0 0 1",
            "other equations than keyword iso .*\n  fix 1 a gear/quat molecule temp 1 1 1 iso 0 0 1 tchain 10 thermostat separate pchain 10$",
        ),
        (
            "fix 1 a rigid/nph molecule y -1 0 9 x -1 0 9 couple xy pchain 4 dilate all",
            "\n  fix 1 a gear/quat molecule y -1 0 9 x -1 0 9 couple xy pchain 4$",
        ),
        ("fix 1 a rigid/meso molecule", "no such motion"),
        ("fix 1 a rigid molecule langevin 1 1 1 48", "langevin.*random"),
        ("fix 1 a rigid molecule temp 1 1 1", "keyword temp: this fix has no thermostat"),
        ("fix 1 a rigid/small molecule gravity g", "disable of fix gravity"),
        ("fix 1 a rigid everything", "the bodies: everything"),
        ("fix 1 a rigid group 3 x y", "determine the bodies"),
        ("fix 1 a rigid single sped 3", "unknown keyword sped"),
        ("fix 1 a rigid single infile", "infile lacks"),
        ("fix 1 a gear/quat single force 1 off off", "force lacks"),
        ("fix 1 a gear/quat single spin 3", "unknown keyword spin$"),
        ("fix 1 a gear/quat single tolerance 1 lenght", "keyword lenght; tolerance takes .* length or energy"),
    ],
)
def test_lines_that_are_refused(line, said):
    """Errors for keywords that fix gear/quat does not have, and for keywords that no fix accepts."""
    with pytest.raises(DeckError, match=said):
        script.translate(parse(line))


def test_keywords_of_the_method_are_replaced_and_those_of_the_body_kept():
    own = "formulation second start zero corrector gear c0 velocity"
    line = parse(f"fix 1 a gear/quat single {own} infile f")
    values = "formulation second values 8"
    assert line.with_numerics(values).text() == f"fix 1 a gear/quat single {values} infile f"
    for wrong in ("values", "valus 8", "infile g"):
        with pytest.raises(DeckError, match="pairs of a keyword"):
            line.with_numerics(wrong)


def test_what_is_left_out_is_said():
    """Commands that only write are not mentioned."""
    said = {
        "fix 1 a rigid/small molecule mol w": "keyword mol is left out; no atoms are added",
        "fix 1 a rigid single dilate all": "keyword dilate is left out; it acts with a barostat",
        "fix 1 a rigid single infile f reinit yes": "reinit is left out; bodies of an infile",
    }
    for line, words in said.items():
        (note,) = script.translate(parse(line))[1]
        assert words in note
    line = parse("fix 1 a gear/quat single compensate no tolerance 1e-9 dtmin 1e-5 report no")
    own, (note,) = script.for_trials(line)
    assert own.text() == "fix 1 a gear/quat single compensate no report no"
    assert note.startswith("fix 1 gear/quat: tolerance, dtmin left out, because trials have steps of")
    plain = parse("fix 1 a gear/quat single report no")
    assert script.for_trials(plain) == (plain, []) and script.translate(plain)[1] == []


def test_isokinetic_runs_are_tried_in_their_formulation_only():
    line = parse("fix 1 a gear/quat molecule formulation first isokinetic total")
    first = "formulation first values 5"
    assert line.takes(first) and not line.takes("formulation second") and not line.takes("values 5")
    assert (
        line.with_numerics(first).text() == f"fix 1 a gear/quat molecule {first} isokinetic total"
    )
    with pytest.raises(DeckError, match="isokinetic belongs to formulation first"):
        line.with_numerics("formulation second")
    assert parse("fix 1 a gear/quat molecule isokinetic none").takes("formulation second")


def test_every_keyword_of_the_fix_is_read():
    """The trials know the topics of all keywords, and keywords of other topics are omitted."""
    known = {"integration", "step", "bodies", "physics", "output"}
    assert {row.about for row in keywords.table().values()} == known
    for key, row in keywords.table().items():
        line = parse(f"fix 1 all gear/quat molecule {key} {' '.join(['x'] * row.arguments)}")
        assert line.keywords == ((key, ("x",) * row.arguments),)
        assert bool(script.for_trials(line)[1]) == (row.about == "step")
    line = parse("fix 1 all gear/quat molecule tolerance 1e-9 energy values 7")
    assert line.keywords == (("tolerance", ("1e-9", "energy")), ("values", ("7",)))


def test_words_that_need_quotes_get_them():
    words = ["fix", "1", "all", "gear/quat", "single", "infile", "my bodies.txt"]
    assert script.split(script.parse_fix(words).text()) == words


@pytest.mark.parametrize(
    "style",
    """langevin rigid/meso srd temp/csvr deposit gcmc atom/swap temp/rescale dt/reset deform npt
    nph/omp press/berendsen bond/react npt/asphere pimd/langevin""".split(),
)
def test_scenes_without_a_trajectory_are_refused(style):
    with pytest.raises(DeckError, match=f"fix th {style}: .*--without th leaves it out"):
        script.check_scene({"1": "rigid", "th": style}, ["lj/cut", "2.5"])


def test_scenes_with_a_trajectory_are_not():
    fixes = "rigid nve nvt gravity spring/self wall/reflect enforce2d setforce property/atom adapt"
    script.check_scene(
        dict(enumerate(fixes.split())), ["hybrid", "lj/cut", "2.5", "coul/long", "8"]
    )
    with pytest.raises(DeckError, match="pair_style dpd"):
        script.check_scene({}, ["hybrid", "dpd", "1", "1", "48"])
