"""The manual states what the fix accepts, its examples run, its numbers are correct, and the first script runs."""

import re
from functools import partial
from importlib import metadata

import numpy as np
import pytest

from benchmarks.reference import stability
from lammps_gearquat import keywords
from support.pages import first_script
from support.running import ROOT, tree_source

SOURCES = ROOT / "src" / "GEARQUAT"
ARGUMENTS = (SOURCES / "gear_quat_arguments.cpp").read_text()
MANUAL = (ROOT / "doc" / "src" / "fix_gear_quat.rst").read_text()
LIMITS = (ROOT / "doc" / "theory.md").read_text().partition("## Limits of stability")[2].partition("\n## ")[0]


def section(title, text=MANUAL):
    """A section of the manual, without its title."""
    underlined = r"\n\"\"\"+\n"
    pattern = rf"^{re.escape(title)}{underlined}(.*?)(?=^[^\n]+{underlined}|\Z)"
    found = re.search(pattern, text, re.M | re.S)
    assert found, title
    return found[1]


# --- words of the command ------------------------------------------------------------------------
def documented_keywords(text):
    line = re.search(r"^\* keyword = (.*)$", section("Syntax", text), re.M)[1]
    return set(re.findall(r"\*([\w/]+)\*", line))


def documented_values(key, text):
    line = re.search(rf"^ +\*{key}\* value = (.*)$", section("Syntax", text), re.M)[1]
    return set(re.findall(r"\*(\w+)\*", line.partition("(")[0]))


TABLE = keywords.table()
WORDS = {key: set(row.words) for key, row in TABLE.items() if row.kind == "word"}


def test_every_keyword_is_documented():
    assert len(TABLE) >= 20
    assert documented_keywords(MANUAL) == set(TABLE)
    for key in TABLE:
        described = section("Description") + section("The test cases of the paper")
        assert f"*{key}*" in described, f"no description of *{key}*"
        listed = rf"^ +(?:\*\w+\* or )*\*{key}\* (?:or \*\w+\* )*values? = "
        assert re.search(listed, section("Syntax"), re.M), f"the list under Syntax does not have *{key}*"
        assert re.search(rf"\b{key}\b", section("Default")), f"section Default does not have {key}"
        without = MANUAL.replace(f" or *{key}*", "").replace(f"*{key}* or ", "")
        assert documented_keywords(without) != set(TABLE)


def test_every_value_is_documented():
    for key, words in WORDS.items():
        assert documented_values(key, MANUAL) == words
        assert documented_values(key, MANUAL.replace(f"*{min(words)}*", "")) != words


@pytest.mark.parametrize("key", [key for key in TABLE if TABLE[key].ranges])
def test_every_range_is_documented(key):
    syntax = section("Syntax").partition(f"*{key}* value")[2]
    syntax = syntax.partition("\n       *")[0]
    text = " ".join(syntax.split())
    assert TABLE[key].values.startswith("auto or ") == ("*auto* or " in syntax.splitlines()[0])
    for formulation, (least, most) in TABLE[key].ranges.items():
        assert re.search(rf"\b{least} to {most}\b" + (rf" for [^,]*\*{formulation}\*" if formulation else ""), text)


def test_every_default_is_documented():
    text = " ".join(section("Default").split())
    defaults = dict(re.findall(r"(\w+) = (\w+)", text.partition(", or reinit")[0]))
    stated = {key: row.default for key, row in TABLE.items() if re.fullmatch(r"\w+", row.default)}
    assert {key: defaults.pop(key) for key in stated} == stated
    for key, row in TABLE.items():
        if row.kind == "word" and row.standard() != row.standard("tolerance"):
            either = f"{key} = {row.standard()}, or {key} = {row.standard('tolerance')}"
            assert f"{either} with tolerance" in text


def test_a_list_that_is_cut_off_is_no_list():
    with pytest.raises(RuntimeError, match="does not list its keywords"):
        keywords.parse("ERROR: Unknown fix style gear/quat\n")


def test_every_bodystyle_is_documented():
    styles = set(re.findall(r'\{"(\w+)", BodyStyle::', ARGUMENTS))
    line = re.search(r"^\* bodystyle = (.*)$", section("Syntax"), re.M)[1]
    assert set(re.findall(r"\*(\w+)\*", line)) == styles
    assert len(styles) == 4


# --- what can be run -----------------------------------------------------------------------------
SCENE = """
units lj
atom_style molecular
atom_modify map array
region box prism -10 10 -10 10 -10 10 0 0 0
create_box 1 box
create_atoms 1 single 0.0 0.0 0.0
create_atoms 1 single 1.0 0.0 0.0
create_atoms 1 single 5.0 5.0 5.0
create_atoms 1 single 5.0 6.2 5.1
mass 1 1.0
molecule water dumbbell.txt
set atom 1*2 mol 1
set atom 3*4 mol 2
group clump id 1 2
group left id 1 2
group right id 3 4
group ions empty
fix property all property/atom i_body
set group left i_body 1
set group right i_body 2
variable body atom id>2
velocity all create 1.0 4711 loop geom
pair_style zero 2.0
pair_coeff * *
thermo_modify norm no
"""
DUMBBELL = "two\n\n2 atoms\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n"
BODIES = "1\n1 2.0 0.5 0 0 0 1 1 0 0 0 0.1 0 0 0 0.1 0 0 0 0\n"


def examples(text):
    """Lines of the Examples section, each a command."""
    return [line.strip() for line in section("Examples", text).splitlines() if "fix" in line]


def run_example(lmp, line):
    (lmp.folder / "bodies.txt").write_text(BODIES)
    (lmp.folder / "dumbbell.txt").write_text(DUMBBELL)
    before = "fix 1 all gear/quat molecule\n" if line.startswith("fix_modify") else ""
    return lmp.run(SCENE + before + line + "\nrun 2\n")


@pytest.mark.parametrize("line", examples(MANUAL))
def test_every_example_is_accepted(lmp_wheel, line):
    result = run_example(lmp_wheel, line)
    assert result.returncode == 0, result.output
    assert result.thermo[-1]["Step"] == [0, 2]


def words_of_examples(text):
    return {word for line in examples(text) for word in line.split()}


def test_every_keyword_has_an_example():
    styles = re.search(r"^\* bodystyle = (.*)$", section("Syntax"), re.M)[1]
    assert set(TABLE) | set(re.findall(r"\*(\w+)\*", styles)) <= words_of_examples(MANUAL)
    for key in TABLE:
        assert key not in words_of_examples(MANUAL.replace(f" {key} ", " ")), key


def test_an_example_that_is_wrong_is_noticed(lmp_wheel):
    for line in ("fix 1 all gear/quat molecule formulation third", "fix_modify 1 energy maybe"):
        assert run_example(lmp_wheel, line).returncode != 0


@pytest.mark.parametrize("ranks", [1, 2])
def test_the_first_script_runs(lmp_wheel, ranks):
    result = lmp_wheel.run(first_script(), ranks=ranks)
    assert result.returncode == 0, result.output
    thermo = result.thermo[-1]
    assert len(thermo["Step"]) > 3
    assert thermo["TotEng"] == pytest.approx([thermo["TotEng"][0]] * len(thermo["Step"]), abs=1e-6)
    assert max(thermo["KinEng"]) > 0.1  # the bodies move
    kinetic = np.add(thermo["f_move[1]"], thermo["f_move[2]"])
    assert kinetic == pytest.approx(thermo["KinEng"])


PAGES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
PAGES += [str(page.relative_to(ROOT)) for folder in ("doc", ".github") for page in (ROOT / folder).glob("**/*.md")]


@pytest.mark.parametrize("page", PAGES)
def test_every_link_leads_somewhere(page):
    path = ROOT / page
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text())
    assert [link for link in links if not (path.parent / link).exists()] == []


def test_the_script_of_the_readme_runs(lmp_wheel):
    """The first script that a reader sees conserves what it prints."""
    script = re.search(r"^```\n(units lj\n.*?)^```", (ROOT / "README.md").read_text(), re.M | re.S)[1]
    energy = lmp_wheel.succeed(script).thermo[-1]["Econserve"]
    assert np.ptp(energy) < 1e-5


def test_every_file_that_a_page_names_exists():
    """Tests and sources; names without a folder are of tests/lammps or of the package."""
    folders = [ROOT, ROOT / "tests" / "lammps", SOURCES, tree_source() / "src"]
    for page in PAGES:
        names = set(re.findall(r"`([\w/*-][\w./*-]*\.(?:py|cpp|h|sh|yaml))`", (ROOT / page).read_text()))
        missing = {name for name in names if not any(any(f.glob(name)) for f in folders)}
        assert missing <= {"test_....py"}, page


def test_a_release_has_one_number_and_one_date():
    patterns = {
        "pyproject.toml": r'^version = "(.*)"',
        "src/analysis/pyproject.toml": r'^version = "(.*)"',
        "CHANGELOG.md": r"^## \[([\d.]+)\] - \d{4}-\d\d-\d\d$",
        "CITATION.cff": r"^version: (.*)",
        "cmake/packaging/conda/recipe.yaml": r'^  version: "(.*)"',
    }
    for name, pattern in patterns.items():
        number = re.search(pattern, (ROOT / name).read_text(), re.M)[1]
        assert number == metadata.version("lammps-gearquat"), name
    assert f'"gearquat-analysis=={number.rpartition(".")[0]}.*"' in (ROOT / "pyproject.toml").read_text()
    date = re.search(r"^## \[[\d.]+\] - (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.M)[1]
    assert f'date-released: "{date}"' in (ROOT / "CITATION.cff").read_text()


def test_every_picture_is_on_a_page():
    pages = "".join(path.read_text() for path in (ROOT / "README.md", *(ROOT / "doc").rglob("*.md")))
    pictures = [path.relative_to(ROOT / "doc").as_posix() for path in (ROOT / "doc").rglob("*.png")]
    assert pictures and not [picture for picture in pictures if picture not in pages]


# --- what LAMMPS' manual requires of a page, from the Makefile of its doc folder ---------------------
#: what -> pattern, example
MISTAKES = {
    "a character that is not ASCII": (r"[^\n -~]", "\u00e9"),
    "a role without its second colon": (r" :[a-z]+`", " :ref`a"),
    "a link with one underscore too few": (r" `[^`]+<[a-z][^`]+`[^_]", " `a <b>` "),
    "a role without a quote": (r":(?:ref|doc):[^`]", ":doc:a"),
    "a role without colons": (r"(?:ref|doc)`[^`]", "doc`a"),
    "space at the end of a line": (r"[ \t]$", "a "),
}


@pytest.mark.parametrize("what", MISTAKES)
def test_the_page_is_written_as_the_manual_of_lammps(what):
    pattern, example = MISTAKES[what]
    assert not re.search(pattern, MANUAL, re.M)
    assert re.search(pattern, MANUAL + example, re.M)


# --- numbers -------------------------------------------------------------------------------------
SECOND, FIRST = range(4, 13), range(3, 9)
#: column of the theory's table -> numbers of values, one step of the test equation
COLUMNS = {
    "momentum": (SECOND, stability.momentum_step),
    "second": (SECOND, stability.second_order_step),
    "c0 velocity": (SECOND, partial(stability.second_order_step, c0="velocity")),
    "first": (FIRST, stability.first_order_step),
    "momentum predicted": (FIRST, partial(stability.first_order_step, momentum="predicted")),
}


def documented_limits():
    """Column -> {N: limit} of the table in the theory."""
    table = [[cell.strip() for cell in line.split("|")[1:-1]] for line in LIMITS.splitlines() if line.startswith("| ")]
    names, rows = table[0], table[1:]
    assert names == ["N", *COLUMNS]
    assert all(len(row) == len(names) for row in rows)
    return {
        name: {int(row[0]): float(row[k]) for row in rows if row[k] != "–"}
        for k, name in enumerate(names)
        if k
    }


@pytest.mark.parametrize("name", COLUMNS)
def test_stability_limits_of_the_theory(name):
    values, step = COLUMNS[name]
    limits = documented_limits()[name]
    assert list(limits) == list(values)
    for n in values:
        assert limits[n] == round(stability.linear_limit(partial(step, n)), 2)
