"""The manual says what the fix accepts, its examples run, its numbers are right; so is the first script."""

import re
from math import comb

import numpy as np
import pytest

from benchmarks.reference import stability
from lammps_gearquat import keywords
from pages import first_script
from running import ROOT

SOURCES = ROOT / "src" / "GEARQUAT"
ARGUMENTS = (SOURCES / "gear_quat_arguments.cpp").read_text()
FORCES = (SOURCES / "gear_quat_forces.cpp").read_text()
MANUAL = (ROOT / "doc" / "src" / "fix_gear_quat.rst").read_text()


def section(title, text=MANUAL):
    """A section of the manual, without its title."""
    underlined = r"\n\"\"\"+\n"
    pattern = rf"^{re.escape(title)}{underlined}(.*?)(?=^[^\n]+{underlined}|\Z)"
    found = re.search(pattern, text, re.M | re.S)
    assert found, title
    return found[1]


def strings(name, text):
    """Words of the first brace of strings after ``name``."""
    return re.findall(r'"([^"]+)"', re.search(rf"{name}\s*=\s*{{(.*?)}}", text, re.S)[1])


# --- words of the command ------------------------------------------------------------------------
def documented_keywords(text):
    line = re.search(r"^\* keyword = (.*)$", section("Syntax", text), re.M)[1]
    return set(re.findall(r"\*(\w+)\*", line))


def documented_values(key, text):
    line = re.search(rf"^ +\*{key}\* value = (.*)$", section("Syntax", text), re.M)[1]
    return set(re.findall(r"\*(\w+)\*", line.partition("(")[0]))


TABLE = keywords.table()
WORDS = {key: set(row.words) for key, row in TABLE.items() if row.kind == "word"}


def test_every_keyword_is_documented():
    assert len(TABLE) >= 20
    assert documented_keywords(MANUAL) == set(TABLE)
    for key in TABLE:
        assert f"*{key}*" in section("Description"), key
        without = MANUAL.replace(f" or *{key}*", "").replace(f"*{key}* or ", "")
        assert documented_keywords(without) != set(TABLE)


def test_every_value_is_documented():
    for key, words in WORDS.items():
        assert documented_values(key, MANUAL) == words
        assert documented_values(key, MANUAL.replace(f"*{min(words)}*", "")) != words


@pytest.mark.parametrize("key", [key for key in TABLE if TABLE[key].ranges])
def test_every_range_is_documented(key):
    syntax = section("Syntax").partition(f"*{key}* value")[2]
    text = " ".join(syntax.splitlines()[1].split())
    for formulation, (least, most) in TABLE[key].ranges.items():
        assert f"{least} to {most}" + (f" for *{formulation}*" if formulation else "") in text


def test_every_default_is_documented():
    text = " ".join(section("Default").split())
    defaults = dict(re.findall(r"(\w+) = (\w+)", text.partition(", or ")[0]))
    stated = {key: row.default for key, row in TABLE.items() if re.fullmatch(r"\w+", row.default)}
    assert {key: defaults.pop(key) for key in stated} == stated
    (second, first) = re.findall(r"\d+", TABLE["values"].default)
    limit = TABLE["values"].most_with_tolerance
    most = [min(TABLE["values"].ranges[formulation][1], limit) for formulation in ("second", "first")]
    with_tolerance = f"({most[0]} and {most[1]} with tolerance)"
    assert f"values = {second} for *second* and {first} for *first* {with_tolerance}" in text


def test_a_list_that_is_cut_off_is_no_list():
    with pytest.raises(RuntimeError, match="does not list its keywords"):
        keywords.parse("ERROR: Unknown fix style gear/quat\n")


def test_every_bodystyle_is_documented():
    styles = set(re.findall(r'style == "(\w+)"', ARGUMENTS)) - {"keywords"}
    line = re.search(r"^\* bodystyle = (.*)$", section("Syntax"), re.M)[1]
    assert set(re.findall(r"\*(\w+)\*", line)) == styles
    assert len(styles) == 4


@pytest.mark.parametrize("name", ["UNFOLLOWED_PAIRS", "FOLLOWED_FIXES"])
def test_what_the_start_follows_is_documented(name):
    table = section("Description").partition("in *start bootstrap*")[2]
    table = table.partition("Where something")[0]
    styles = strings(rf"{name}\[\]", FORCES)
    assert len(styles) >= 5  # the list was found
    for style in styles:
        assert re.search(rf"\*{style.strip('^$')}\b", table), style
    assert not re.search(r"\*nonsense\b", table)


# --- what can be run -----------------------------------------------------------------------------
SCENE = """
units lj
atom_style molecular
atom_modify map array
region box block -10 10 -10 10 -10 10
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
    assert max(thermo["KinEng"]) > 0.1  # they do move
    kinetic = np.add(thermo["f_move[1]"], thermo["f_move[2]"])
    assert kinetic == pytest.approx(thermo["KinEng"])


PAGES = ["README.md", *(str(page.relative_to(ROOT)) for page in (ROOT / "doc").glob("**/*.md"))]


@pytest.mark.parametrize("page", PAGES)
def test_every_link_leads_somewhere(page):
    path = ROOT / page
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text())
    assert [link for link in links if not (path.parent / link).exists()] == []


def test_the_tests_that_decisions_name_exist():
    text = (ROOT / "doc" / "decisions.md").read_text()
    names = set(re.findall(r"`((?:tests/\w+/)?(?:test_\w+|\w+)\.(?:py|cpp|sh|yaml))`", text))
    names -= {"run_tests.py"}  # LAMMPS' own
    assert len(names) > 30
    folders = [ROOT / "tests" / "lammps", ROOT]
    assert [n for n in names if not any((folder / n).exists() for folder in folders)] == []


def test_what_is_cited_is_this_version():
    project, citation = (
        re.search(r'^version(?: = |: )"?([\d.]+)"?$', (ROOT / name).read_text(), re.M)[1]
        for name in ("pyproject.toml", "CITATION.cff")
    )
    assert citation == project


# --- what LAMMPS' own manual asks of a page, from the Makefile of its doc folder ---------------------
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
def first_c(values):
    return np.array([float(c) for c in stability.first_order_coefficients(values)])


def second_c(values, c0="position"):
    return np.array([float(c) for c in stability.second_order_coefficients(values, c0)])


def pascal(n):
    return np.array([[comb(j, i) for j in range(n)] for i in range(n)], dtype=float)


def second(z, coefficients):
    """One step of x'' = -x with step z, as a matrix on the rows of the history."""
    n = len(coefficients)
    residual = np.zeros(n)
    residual[0], residual[2] = -z * z / 2, -1
    return (np.eye(n) + np.outer(coefficients, residual)) @ pascal(n)


def first(z, coefficients, predicted):
    """The same for x' = p, p' = -x; time in units of the step, so that p' = -z^2 x."""
    n = len(coefficients)
    rows = np.kron(np.eye(2), pascal(n))
    x, p = rows[:n], rows[n:]
    corrected = p + np.outer(coefficients, -z * z * x[0] - p[1])
    momentum = p[0] if predicted else corrected[0]
    return np.vstack([x + np.outer(coefficients, momentum - x[1]), corrected])


#: column of the manual's table -> numbers of values, one step of the test equation
COLUMNS = {
    "second": (range(4, 13), lambda n: lambda z: second(z, second_c(n))),
    "c0 velocity": (range(4, 13), lambda n: lambda z: second(z, second_c(n, "velocity"))),
    "first": (range(3, 9), lambda n: lambda z: first(z, first_c(n), False)),
    "momentum predicted": (range(3, 9), lambda n: lambda z: first(z, first_c(n), True)),
}


def stability_limit(step):
    """Least z at which a mode other than the oscillation itself grows."""
    for z in np.arange(0.01, 3.0, 0.005):
        modes = np.linalg.eigvals(step(z))
        others = [m for m in modes if min(abs(m - np.exp(s * z)) for s in (1j, -1j)) > 0.15]
        if max(np.abs(others), default=0.0) > 1.0:
            return z
    return np.inf


def growth(step, z):
    """Growth of the amplitude of the oscillation in a period."""
    modes = np.linalg.eigvals(step(z))
    own = np.abs(modes[np.abs(modes - np.exp(1j * z)).argmin()])
    return own ** (2 * np.pi / z) - 1


def documented_limits():
    """Column -> {N: limit} of the manual's table."""
    table = section("Choosing the time step").split("==\n\n")[0].split("==\n")
    names = re.split(r"\s{2,}", table[1].splitlines()[0])
    assert names == ["N", *COLUMNS]
    rows = [line.split() for line in table[2].splitlines() if not line.startswith("=")]
    assert all(len(row) == len(names) for row in rows)
    return {
        name: {int(row[0]): float(row[k]) for row in rows if row[k] != r"\-"}
        for k, name in enumerate(names)
        if k
    }


@pytest.mark.parametrize("name", COLUMNS)
def test_stability_limits_of_the_manual(name):
    values, step = COLUMNS[name]
    limits = documented_limits()[name]
    assert list(limits) == list(values)
    for n in values:
        assert limits[n] == pytest.approx(stability_limit(step(n)), abs=0.01)


def test_growth_of_the_manual():
    text = " ".join(section("Choosing the time step").split())
    found = [float(x) for x in re.findall(r"\d\.\de-\d+", text)]
    methods = ((second, second_c(8)), (lambda z, c: first(z, c, False), first_c(6)))
    expected = [abs(growth(lambda z: step(z, c), z)) for z in (0.2, 0.1) for step, c in methods]
    assert found == pytest.approx(expected, rel=0.02)
    assert (
        growth(lambda z: second(z, second_c(8)), 0.2)
        < 0
        < growth(lambda z: first(z, first_c(6), False), 0.2)
    )


def test_a_coefficient_wrong_by_one_percent_shows():
    right = second_c(8)
    for row in range(1, 8):
        wrong = right * np.where(np.arange(8) == row, 1.01, 1.0)
        found = growth(lambda z, wrong=wrong: second(z, wrong), 0.2)
        assert found != pytest.approx(growth(lambda z: second(z, right), 0.2), rel=2e-3)
